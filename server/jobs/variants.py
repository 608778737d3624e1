"""Errors in a union of kinds, such as the trains: only those of the kind that was meant.

The solver's unions are plain: pydantic tries every kind and complains for each. The ``type`` that a
part of a study carries says which complaints a user should read.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, cast

__all__ = ["errors_of_chosen_kinds", "kinds_of"]

Error = Mapping[str, Any]


def kinds_of(schema: Mapping[str, Any]) -> dict[str, str]:
    """Class name of each kind to its ``type``, from the JSON schema of the whole.

    Args:
        schema: With ``$defs``.
    """
    found: dict[str, str] = {}
    for name, part in schema.get("$defs", {}).items():
        kind = part.get("properties", {}).get("type", {}).get("const")
        if kind is not None:
            found[name] = kind
    return found


def errors_of_chosen_kinds(
    errors: Sequence[Error], body: Any, kinds: Mapping[str, str]
) -> Iterator[Error]:
    """Pydantic's errors without those of kinds that were not meant; names of kinds taken out.

    Args:
        errors: With ``loc``, ``type``, ``msg``, ``input``.
        body: What was validated.
        kinds: From ``kinds_of``.

    Yields:
        Errors whose ``loc`` is a path in the body.
    """
    unmet: dict[tuple[str | int, ...], list[str]] = {}
    met: set[tuple[str | int, ...]] = set()
    for error in errors:
        path, kind, here = _split(error["loc"], body, kinds)
        if kind is None:
            yield error
        elif isinstance(here, dict) and cast(Any, here).get("type") == kinds[kind]:
            met.add(path)
            yield {**error, "loc": (*path, *error["loc"][len(path) + 1 :])}
        elif kinds[kind] not in unmet.setdefault(path, []):
            unmet[path].append(kinds[kind])
    for path, names in unmet.items():
        if path not in met:
            yield _unknown_kind(path, _value_at(body, path), names)


def _unknown_kind(path: Sequence[str | int], value: Any, names: Sequence[str]) -> Error:
    if not isinstance(value, dict):
        message = "is not an object with a type"
        return {"loc": path, "type": "not_a_kind", "msg": message, "input": value}
    given = cast(dict[str, Any], value).get("type", "")
    context = {"expected_tags": ", ".join(names)}
    return {
        "loc": (*path, "type"),
        "type": "union_tag_invalid",
        "msg": "is not a known type",
        "input": given,
        "ctx": context,
    }


def _split(
    location: Sequence[str | int], body: Any, kinds: Mapping[str, str]
) -> tuple[tuple[str | int, ...], str | None, Any]:
    """Path up to the name of a kind, that name, and the value there."""
    here = body
    for index, part in enumerate(location):
        if part in kinds and not (isinstance(here, dict) and part in here):
            return tuple(location[:index]), str(part), here
        here = _child(here, part)
    return tuple(location), None, here


def _value_at(body: Any, path: Sequence[str | int]) -> Any:
    for part in path:
        body = _child(body, part)
    return body


def _child(value: Any, part: str | int) -> Any:
    if isinstance(value, dict):
        return cast(dict[Any, Any], value).get(part)
    if isinstance(value, list) and isinstance(part, int) and part < len(cast(Any, value)):
        return cast(list[Any], value)[part]
    return None
