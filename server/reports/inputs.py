"""Every input of a study with its unit, and those in which studies differ."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from server.errors import pointer
from solver import studies
from solver.studies import Study, Template
from solver.units import Unit

__all__ = ["Difference", "Input", "differences", "inputs", "nearest_template"]

_NOT_PHYSICAL = frozenset({"/name", "/schema_version"})
"""What no result depends on."""
_OF_ANOTHER_KIND = 0.5
"""A study that differs from every template in more than this share of its inputs has none."""
_LONG = 4
"""From this many rows on, a table of numbers is read column by column."""

Path = tuple[str | int, ...]


@dataclass(frozen=True, kw_only=True)
class Input:
    """One input of a study.

    Attributes:
        pointer: JSON pointer into the study.
        value: As stored, SI; several numbers or names as a tuple.
        unit: None where it has none.
    """

    pointer: str
    value: Any
    unit: Unit | None


@dataclass(frozen=True, kw_only=True)
class Difference:
    """One input in which studies differ.

    Attributes:
        pointer: JSON pointer into the studies.
        values: Of each study, SI; None where a study has no such input.
        unit: None where it has none.
    """

    pointer: str
    values: tuple[Any, ...]
    unit: Unit | None


def inputs(study: Study) -> dict[str, Input]:
    """Every input by its pointer, in the order of the study's fields."""
    return {item.pointer: item for item in _walk(study, ())}


def differences(all_studies: Sequence[Study]) -> list[Difference]:
    """Inputs that are not the same in all studies, names left out."""
    found = [inputs(study) for study in all_studies]
    pointers = _together([at for known in found for at in known])
    return [
        difference
        for at in pointers
        if at not in _NOT_PHYSICAL
        for difference in [_difference(at, found)]
        if any(value != difference.values[0] for value in difference.values)
    ]


def _together(pointers: Sequence[str]) -> list[str]:
    """Each pointer once, those of one part of the study side by side."""
    once = list(dict.fromkeys(pointers))
    parts = list(dict.fromkeys(at.split("/")[1] for at in once))
    return sorted(once, key=lambda at: parts.index(at.split("/")[1]))


def nearest_template(study: Study, kind: str) -> tuple[Template, list[Difference]] | None:
    """The template that a study differs least from, and how: values of template and study.

    Args:
        study: The study.
        kind: Of the job; only templates of that kind count.

    Returns:
        None where the study is unlike all of them.
    """
    candidates = [
        (item, differences([item.study, study]))
        for item in _templates().values()
        if item.kind == kind
    ]
    if not candidates:
        return None
    best = min(candidates, key=lambda pair: (len(pair[1]), pair[0].study.name != study.name))
    return best if len(best[1]) <= _OF_ANOTHER_KIND * len(inputs(study)) else None


@cache
def _templates() -> Mapping[str, Template]:
    return studies.templates()


def _difference(at: str, found: Sequence[Mapping[str, Input]]) -> Difference:
    items = [known.get(at) for known in found]
    unit = next((item.unit for item in items if item is not None), None)
    values = tuple(None if item is None else item.value for item in items)
    return Difference(pointer=at, values=values, unit=unit)


def _walk(record: Any, path: Path) -> Iterator[Input]:
    """Inputs of a dataclass, nested ones included."""
    hints = _hints(type(record))
    for entry in dataclasses.fields(record):
        yield from _inputs_at(getattr(record, entry.name), hints[entry.name], (*path, entry.name))


def _inputs_at(value: Any, hint: Any, path: Path) -> Iterator[Input]:
    if dataclasses.is_dataclass(value):
        yield from _walk(value, path)
    elif _is_table(value):
        yield from _columns(value, path)
    elif isinstance(value, tuple) and any(dataclasses.is_dataclass(item) for item in value):
        for index, item in enumerate(value):
            yield from _walk(item, (*path, index))
    else:
        yield Input(pointer=pointer(path), value=value, unit=_unit(hint))


def _is_table(value: Any) -> bool:
    """Whether a value is a long list of records of numbers: samples, axles."""
    return (
        isinstance(value, tuple)
        and len(value) >= _LONG
        and all(dataclasses.is_dataclass(item) for item in value)
        and all(isinstance(cell, int | float) for item in value for cell in vars(item).values())
    )


def _columns(rows: Sequence[Any], path: Path) -> Iterator[Input]:
    """A table column by column: nobody reads samples cell by cell."""
    hints = _hints(type(rows[0]))
    for entry in dataclasses.fields(rows[0]):
        cells = tuple(getattr(row, entry.name) for row in rows)
        yield Input(
            pointer=pointer((*path, entry.name)), value=cells, unit=_unit(hints[entry.name])
        )


@lru_cache(maxsize=256)
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind, include_extras=True)


def _unit(hint: Any) -> Unit | None:
    """The unit in a declaration, or in that of a list's items."""
    found: Unit | None = None
    if get_origin(hint) is Annotated:
        hint, *metadata = get_args(hint)
        found = next((item for item in metadata if isinstance(item, Unit)), None)
    if found is None and get_origin(hint) is tuple:
        return _unit(get_args(hint)[0])
    return None if found is None or found.symbol == "1" else found
