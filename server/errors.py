"""Every error of the server, and the one place that turns errors into answers.

Problem            anything that ends as problem+json (RFC 9457): status, title, detail, errors
`-- Finding        one thing that is wrong: pointer, value, reason, remedy

solver InputError            -> 422
FastAPI's validation error   -> 422
Starlette's HTTPException    -> its status
anything else                -> 500, without a word of what is inside
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.responses import JSONResponse, Response

from solver.errors import InputError

__all__ = [
    "MEDIA_TYPE",
    "Finding",
    "Problem",
    "gone_missing",
    "install_errors",
    "pointer",
    "shortened",
    "validation_findings",
]

MEDIA_TYPE = "application/problem+json"
_VALUE_LENGTH = 80
_FINDINGS_SHOWN = 100

_log = logging.getLogger("trainbridge.errors")


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One thing that is wrong in what was sent.

    Attributes:
        pointer: JSON pointer into the body (RFC 6901), or the name of a query parameter.
        value: What stands there, in at most 80 characters.
        reason: Why it cannot be used.
        remedy: What to do.
    """

    pointer: str
    value: str
    reason: str
    remedy: str


class Problem(Exception):  # noqa: N818 (RFC 9457 calls it so)
    """An answer that says what went wrong and what to do."""

    def __init__(
        self,
        status: int,
        title: str,
        detail: str,
        *,
        errors: Sequence[Finding] = (),
        headers: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(detail)
        self.status = status
        self.title = title
        self.detail = detail
        self.errors = tuple(errors)
        self.headers = dict(headers or {})

    def document(self) -> dict[str, Any]:
        """The problem as JSON."""
        return {
            "type": "about:blank",
            "title": self.title,
            "status": self.status,
            "detail": self.detail,
            "errors": [asdict(item) for item in self.errors[:_FINDINGS_SHOWN]],
        }

    def response(self) -> Response:
        """The problem as an answer."""
        return JSONResponse(
            self.document(), self.status, headers=self.headers, media_type=MEDIA_TYPE
        )


def gone_missing(kind: str, name: str) -> Problem:
    """What was asked for does not exist."""
    return Problem(404, f"No such {kind}", f"There is no {kind} {shortened(name)}.")


def shortened(value: Any) -> str:
    """A value as text of at most 80 characters that every encoder can send."""
    if value is None or isinstance(value, bool):
        return "null" if value is None else str(value).lower()
    if isinstance(value, (dict, list)):
        # Never write out a large body to show 80 characters of it.
        text = "an object" if isinstance(value, dict) else "a list"
    elif isinstance(value, str):
        text = value[: _VALUE_LENGTH + 1]
    elif isinstance(value, int) and value.bit_length() > 512:
        text = f"a whole number of {value.bit_length()} bits"
    else:
        text = str(value)
    text = text.encode("utf-8", "backslashreplace").decode()
    return text if len(text) <= _VALUE_LENGTH else text[: _VALUE_LENGTH - 1] + "…"


def pointer(path: Sequence[str | int]) -> str:
    """A path as a JSON pointer, safe to send and not longer than a line."""
    parts = (str(part).replace("~", "~0").replace("/", "~1") for part in path)
    text = "".join(f"/{part[:_VALUE_LENGTH]}" for part in parts)
    return text.encode("utf-8", "backslashreplace").decode()


def validation_findings(
    errors: Sequence[Mapping[str, Any]], body: Any, *, prefix: Sequence[str | int] = ()
) -> list[Finding]:
    """Pydantic's errors as findings, the tags of unions taken out of their paths.

    Args:
        errors: As ``ValidationError.errors()`` gives them.
        body: What was validated: it tells a union's tag from a key.
        prefix: Path of ``body`` in the request.
    """
    found: list[Finding] = []
    for error in errors:
        kind = str(error["type"])
        if kind == "too_short" and _has_error_inside(error, errors):
            # Pydantic counts only the items that are right.
            continue
        path = _path_in(body, error["loc"])
        reason, remedy = _words(kind, error)
        value = "" if kind == "missing" else shortened(error.get("input"))
        at = pointer([*prefix, *path])
        found.append(Finding(pointer=at, value=value, reason=reason, remedy=remedy))
    return found


def install_errors(app: FastAPI) -> None:
    """Maps every error class to its answer."""

    @app.exception_handler(Problem)
    async def on_problem(_request: Request, error: Problem) -> Response:
        return error.response()

    @app.exception_handler(InputError)
    async def on_input(_request: Request, error: InputError) -> Response:
        finding = Finding(
            pointer=str(error.field),
            value=shortened(error.value),
            reason=error.reason,
            remedy=error.remedy,
        )
        return Problem(422, "Unusable value", str(error)[:500], errors=[finding]).response()

    @app.exception_handler(RequestValidationError)
    async def on_validation(_request: Request, error: RequestValidationError) -> Response:
        findings: list[Finding] = []
        for item in error.errors():
            place, *path = item["loc"]
            if place == "body":
                findings += validation_findings([{**item, "loc": path}], error.body)
            else:
                [finding] = validation_findings([{**item, "loc": ()}], None)
                findings.append(_at(finding, str(path[0]) if path else str(place)))
        detail = "; ".join(f"{item.pointer}: {item.reason}" for item in findings[:3])
        return Problem(422, "Unusable values", detail, errors=findings).response()

    @app.exception_handler(HTTPException)
    async def on_http(_request: Request, error: HTTPException) -> Response:
        title = HTTPStatus(error.status_code).phrase
        return Problem(
            error.status_code, title, str(error.detail), headers=error.headers
        ).response()

    @app.exception_handler(Exception)
    async def on_anything(request: Request, error: Exception) -> Response:
        _log.error("%s %s failed", request.method, request.url.path, exc_info=error)
        return Problem(
            500, "Internal error", "The server met an error of its own; its log says more."
        ).response()


def _at(finding: Finding, place: str) -> Finding:
    return Finding(pointer=place, value=finding.value, reason=finding.reason, remedy=finding.remedy)


def _path_in(body: Any, location: Sequence[str | int]) -> list[str | int]:
    """The location as a path in the body: what is neither key nor index there is a union's tag."""
    path: list[str | int] = []
    here = body
    for index, part in enumerate(location):
        last = index == len(location) - 1
        if isinstance(here, dict):
            known = part in here
            tag = not known and here.get("type") == part  # pyright: ignore[reportUnknownMemberType]
            if tag or (not known and not last):
                continue
            path.append(part)
            here = here.get(part)  # pyright: ignore[reportUnknownMemberType, reportUnknownVariableType]
        elif isinstance(here, list) and isinstance(part, int):
            path.append(part)
            here = here[part] if part < len(here) else None  # pyright: ignore[reportUnknownVariableType, reportUnknownArgumentType]
    return path


def _has_error_inside(error: Mapping[str, Any], errors: Sequence[Mapping[str, Any]]) -> bool:
    place = tuple(error["loc"])
    return any(
        len(other["loc"]) > len(place) and tuple(other["loc"][: len(place)]) == place
        for other in errors
    )


def _words(kind: str, error: Mapping[str, Any]) -> tuple[str, str]:
    """Reason and remedy of one of pydantic's error types."""
    context = error.get("ctx") or {}
    limits = {
        "greater_than": ("must be greater than {gt}", "Give a greater value."),
        "greater_than_equal": ("must be at least {ge}", "Give a greater value."),
        "less_than": ("must be less than {lt}", "Give a smaller value."),
        "less_than_equal": ("must be at most {le}", "Give a smaller value."),
        "too_long": ("has {actual_length} items, at most {max_length}", "Give fewer."),
        "too_short": ("has {actual_length} items, at least {min_length}", "Give more."),
        "literal_error": ("must be one of {expected}", "Choose one of these."),
        "union_tag_invalid": ("is not a known type", "Choose one of {expected_tags}."),
        "missing": ("is missing", "Add it."),
        "extra_forbidden": ("is not a field here", "Remove it, or correct its name."),
        "dataclass_unexpected_keyword_argument": ("is not a field here", "Remove it."),
        "unexpected_keyword_argument": ("is not a field here", "Remove it, or correct its name."),
        "float_type": ("is not a number", "Write a number, without quotes."),
        "int_type": ("is not a whole number", "Write a whole number, without quotes."),
        "bool_type": ("is neither true nor false", "Write true or false, without quotes."),
        "string_type": ("is not a text", "Write a text in quotes."),
    }
    reason, remedy = limits.get(kind, (str(error["msg"]), "See the field's description."))
    try:
        return reason.format(**context), remedy.format(**context)
    except (KeyError, IndexError, ValueError):
        return str(error["msg"]), "See the field's description."
