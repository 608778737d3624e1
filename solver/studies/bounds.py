"""Reads the bounds that the inputs declare, and finds the values outside them.

The declaration is the only one: the web edge reads the same ``Annotated`` bounds for its schema.
"""

from __future__ import annotations

import dataclasses
import math
import types
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import annotated_types as bounds

from solver.errors import InputError
from solver.units import Unit

__all__ = ["Finding", "violations"]

Path = tuple[str | int, ...]


@dataclass(frozen=True, kw_only=True)
class Finding:
    """Something about a value: an error or a warning.

    Attributes:
        path: Where, from the study's root.
        value: The value.
        reason: What is the matter.
        remedy: What to try.
    """

    path: Path
    value: Any
    reason: str
    remedy: str

    @classmethod
    def of(cls, error: InputError) -> Finding:
        """What a model itself refuses, at the place in the study that it names."""
        path = tuple(int(part) if part.isdigit() else part for part in error.field.split("."))
        return cls(path=path, value=error.value, reason=error.reason, remedy=error.remedy)


@lru_cache(maxsize=256)
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind, include_extras=True)


def violations(value: Any, path: Path = ()) -> Iterator[Finding]:
    """Every value of a dataclass, nested ones included, that its declaration does not allow."""
    hints = _hints(type(value))
    for entry in dataclasses.fields(value):
        yield from _check(getattr(value, entry.name), hints[entry.name], (*path, entry.name))


def _check(value: Any, hint: Any, path: Path) -> Iterator[Finding]:
    """Findings of one value against its type and metadata."""
    metadata: tuple[Any, ...] = ()
    if get_origin(hint) is Annotated:
        hint, *rest = get_args(hint)
        metadata = tuple(rest)
    origin = get_origin(hint)
    if origin is tuple:
        yield from _sequence(value, get_args(hint)[0], metadata, path)
    elif origin is Literal:
        if value not in get_args(hint):
            names = ", ".join(repr(choice) for choice in get_args(hint))
            yield Finding(path=path, value=value, reason="is not known", remedy=f"Use {names}.")
    elif dataclasses.is_dataclass(hint) or origin in (Union, types.UnionType):
        yield from _record(value, get_args(hint) or (hint,), path)
    else:
        yield from _scalar(value, hint, metadata, path)


def _record(value: Any, kinds: tuple[Any, ...], path: Path) -> Iterator[Finding]:
    """A nested dataclass, one of several kinds."""
    if isinstance(value, kinds):
        yield from violations(value, path)
        return
    names = " or ".join(kind.__name__ for kind in kinds)
    yield Finding(path=path, value=value, reason="is of another kind", remedy=f"Give {names}.")


def _sequence(
    value: Any, item_hint: Any, metadata: tuple[Any, ...], path: Path
) -> Iterator[Finding]:
    if not isinstance(value, tuple | list):
        yield Finding(path=path, value=value, reason="is not a list", remedy="Give a list.")
        return
    yield from _length(value, metadata, path)
    for index, item in enumerate(value):
        yield from _check(item, item_hint, (*path, index))


_SCALARS: dict[type, tuple[str, str]] = {
    str: ("is not a text", "Give a text."),
    bool: ("is neither true nor false", "Give true or false."),
    int: ("is not a whole number", "Give a whole number."),
    float: ("is not a number", "Give a number."),
}
"""What is the matter with a value that is not of its type, and the remedy."""


def _scalar(value: Any, kind: Any, metadata: tuple[Any, ...], path: Path) -> Iterator[Finding]:
    reason, remedy = _SCALARS[kind]
    if not _is_scalar(value, kind):
        yield Finding(path=path, value=value, reason=reason, remedy=remedy)
    elif kind is str:
        yield from _length(value, metadata, path)
    elif kind is not bool:
        unit = next((entry for entry in metadata if isinstance(entry, Unit)), None)
        for limit in metadata:
            yield from _limit(value, limit, unit, path)


def _is_scalar(value: Any, kind: type) -> bool:
    """Whether a value may stand where the type is declared: no truth value for a number, no NaN."""
    if isinstance(value, bool) or kind in (str, bool):
        return isinstance(value, kind) and isinstance(value, bool) == (kind is bool)
    if isinstance(value, int):
        return kind in (int, float)
    return kind is float and isinstance(value, float) and math.isfinite(value)


def _limit(value: float, limit: Any, unit: Unit | None, path: Path) -> Iterator[Finding]:
    tests = {
        bounds.Gt: ("gt", "is not greater than", lambda a, b: a > b),
        bounds.Ge: ("ge", "is less than", lambda a, b: a >= b),
        bounds.Lt: ("lt", "is not less than", lambda a, b: a < b),
        bounds.Le: ("le", "is greater than", lambda a, b: a <= b),
    }
    if type(limit) not in tests:
        return
    name, words, holds = tests[type(limit)]
    bound = getattr(limit, name)
    if not holds(value, bound):
        symbol = "" if unit is None or unit.symbol == "1" else f" {unit.symbol}"
        reason = f"{words} {bound:g}{symbol}"
        remedy = f"Give a value {_side(name)} {bound:g}{symbol}."
        yield Finding(path=path, value=value, reason=reason, remedy=remedy)


def _side(name: str) -> str:
    return {"gt": "greater than", "ge": "of at least", "lt": "less than", "le": "of at most"}[name]


def _length(value: Any, metadata: tuple[Any, ...], path: Path) -> Iterator[Finding]:
    for limit in metadata:
        if isinstance(limit, bounds.Len):
            most = limit.max_length
            if len(value) < limit.min_length or (most is not None and len(value) > most):
                yield Finding(
                    path=path,
                    value=value,
                    reason=f"has {len(value)} entries",
                    remedy=f"Give {limit.min_length} to {most}.",
                )
