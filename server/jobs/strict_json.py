"""Reads JSON from strangers: everything that is not plain, finite and unambiguous is refused.

Python's parser takes ``NaN``, ``Infinity``, ``1e999``, repeated keys, lone surrogates and any
depth. Each of them is found here, with its place, before anything else looks at the value.
"""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any, cast

import numpy as np

from server.errors import Finding, Problem, pointer, shortened

__all__ = ["LARGEST_DEPTH", "read_json"]

LARGEST_DEPTH = 64
"""A study is six levels deep."""
_LONGEST_INTEGER = 20
_MOST_FINDINGS = 100
# Possessive: a text that never ends is passed over once, not once from each of its quotes.
_TEXT = re.compile(rb'"(?:[^"\\]++|\\.)*+(?:"|\\?\Z)', re.DOTALL)
_SURROGATE = re.compile(rb"\\u[dD][89a-fA-F]")


@dataclass(frozen=True)
class _Unusable:
    """A number that JSON may not hold, as it was written."""

    text: str


class _Object(dict[str, Any]):
    """An object that remembers which keys it was given twice."""

    repeated: tuple[str, ...] = ()


def read_json(body: bytes) -> Any:
    """The value of a JSON text.

    Args:
        body: As it arrived.

    Returns:
        Dicts, lists, strings, finite numbers, booleans and None.

    Raises:
        Problem: 400 with pointer, value, reason and remedy.
    """
    text = _decoded(body)
    if _depth(body) > LARGEST_DEPTH:
        raise _refused("", f"is nested deeper than {LARGEST_DEPTH} levels", "Send a flat value.")
    parser = _Parser()
    try:
        value = json.loads(
            text,
            object_pairs_hook=parser.object,
            parse_constant=parser.unusable,
            parse_float=parser.float,
            parse_int=parser.integer,
        )
    except json.JSONDecodeError as error:
        near = text[max(0, error.pos - 10) : error.pos + 30]
        raise _refused(
            "",
            f"is no JSON: {error.msg} at line {error.lineno}, column {error.colno}",
            "Correct the text there.",
            near,
        ) from None
    if not parser.suspicious and not _SURROGATE.search(body):
        return value
    findings = list(islice(_findings(value, []), _MOST_FINDINGS))
    if findings:
        detail = "; ".join(f"{item.pointer or 'body'} {item.reason}" for item in findings[:3])
        raise Problem(400, "Unusable JSON", detail, errors=findings)
    return value


def _decoded(body: bytes) -> str:
    try:
        return body.decode("utf-8")
    except UnicodeDecodeError as error:
        raise _refused(
            "",
            f"is not UTF-8: byte {error.start} cannot be read",
            "Encode the text as UTF-8.",
            repr(body[error.start : error.start + 8]),
        ) from None


def _refused(at: str, reason: str, remedy: str, value: str = "") -> Problem:
    finding = Finding(pointer=at, value=shortened(value), reason=reason, remedy=remedy)
    return Problem(400, "Unusable JSON", f"The body {reason}.", errors=[finding])


def _depth(body: bytes) -> int:
    """Deepest nesting of brackets outside of texts; fast also for millions of them."""
    codes = np.frombuffer(_TEXT.sub(b"", body), np.uint8)
    opened = (codes == ord("[")) | (codes == ord("{"))
    closed = (codes == ord("]")) | (codes == ord("}"))
    levels = np.cumsum(opened.astype(np.int32) - closed.astype(np.int32))
    return int(levels.max(initial=0))


class _Parser:
    """Hooks of the parser, and whether any of them met something that needs a closer look."""

    def __init__(self) -> None:
        self.suspicious = False

    def unusable(self, text: str) -> _Unusable:
        """A number that cannot be."""
        self.suspicious = True
        return _Unusable(text)

    def float(self, text: str) -> Any:
        """A number with a point or an exponent."""
        value = float(text)
        return value if math.isfinite(value) else self.unusable(text)

    def integer(self, text: str) -> Any:
        """A whole number."""
        return int(text) if len(text) <= _LONGEST_INTEGER else self.unusable(text)

    def object(self, pairs: list[tuple[str, Any]]) -> _Object:
        """An object."""
        found = _Object(pairs)
        if len(found) < len(pairs):
            self.suspicious = True
            counts = Counter(key for key, _ in pairs)
            found.repeated = tuple(key for key, count in counts.items() if count > 1)
        return found


def _findings(value: Any, path: list[str | int]) -> Iterator[Finding]:
    """Everything unusable below a place."""
    if isinstance(value, _Unusable):
        yield Finding(
            pointer=pointer(path),
            value=shortened(value.text),
            reason="is not a finite number that can be computed with",
            remedy="Give a finite number.",
        )
    elif isinstance(value, str):
        if _has_lone_surrogate(value):
            yield Finding(
                pointer=pointer(path),
                value=shortened(value),
                reason="holds half of a character (a lone surrogate)",
                remedy="Send whole characters.",
            )
    elif isinstance(value, _Object):
        yield from _object_findings(value, path)
    elif isinstance(value, list):
        for index, item in enumerate(cast(list[Any], value)):
            yield from _findings(item, [*path, index])


def _object_findings(value: _Object, path: list[str | int]) -> Iterator[Finding]:
    for key in value.repeated:
        yield Finding(
            pointer=pointer([*path, key]),
            value=shortened(value[key] if not isinstance(value[key], _Unusable) else ""),
            reason="stands there more than once",
            remedy="Keep one of them.",
        )
    for key, item in value.items():
        if _has_lone_surrogate(key):
            yield Finding(
                pointer=pointer([*path, key]),
                value=shortened(key),
                reason="is a name with half of a character (a lone surrogate)",
                remedy="Send whole characters.",
            )
        else:
            yield from _findings(item, [*path, key])


def _has_lone_surrogate(text: str) -> bool:
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        return True
    return False
