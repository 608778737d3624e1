"""Values in the words and units of an engineer."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, cast

from solver.units import Unit

__all__ = ["input_name", "number", "percent", "shown", "speed", "unit_text", "with_unit"]

_MINUS = "\N{MINUS SIGN}"
_RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_SHOWN_ITEMS = 24
_REPEATED = 3
"""Equal neighbours in a list that are counted instead of repeated."""
_MEANINGS: dict[tuple[str, float | None], str] = {
    ("/approach/length", 0.0): "follows from the train",
    ("/approach/bed_stiffness", 0.0): "matched to the track's deflection",
    ("/outputs/cut_off_frequency", 0.0): "the standard's",
    ("/line_speed", 0.0): "not stated",
    ("/train/axles/stiffness", 0.0): "follows from the bounce frequency",
    ("/train/axles/damping", 0.0): "follows from the damping ratio",
}
"""Values that stand for something else; in a column of a table, where every row has it."""
_ROW = re.compile(r"/\d+(?=/)")
"""Of a short table, whose cells are read one by one."""


def number(value: float | None, figures: int = 4) -> str:
    """A number with a few figures, thousands apart; a dash where there is none."""
    if value is None:
        return "–"
    text = f"{value:.{figures}g}"
    if "e" in text and 1e-4 <= abs(value) < 1e12:
        decimals = max(0, figures - 1 - _order(value))
        text = f"{value:.{decimals}f}"
    if "e" in text:
        mantissa, exponent = text.split("e")
        power = str(int(exponent)).translate(_RAISED)
        return f"{mantissa.replace('-', _MINUS)}·10{power}"
    whole, point, part = text.partition(".")
    grouped = f"{int(whole):,}".replace(",", "\N{NARROW NO-BREAK SPACE}")
    sign = _MINUS if whole.startswith("-") else ""
    return f"{sign}{grouped.lstrip('-')}{point}{part}"


def _order(value: float) -> int:
    return int(f"{abs(value):e}".split("e")[1])


def percent(share: float, figures: int = 2) -> str:
    """A share in percent."""
    return f"{number(100.0 * share, figures)} %"


def speed(value: float) -> str:
    """A speed in km/h. ``value`` in m/s."""
    return f"{number(round(3.6 * value, 1), 5)} km/h"


def with_unit(value: float | None, unit: Unit | None, figures: int = 4) -> str:
    """An SI value in its display unit."""
    if value is None or unit is None:
        return number(value, figures)
    return f"{number(value * unit.scale, figures)} {unit_text(unit)}".strip()


def unit_text(unit: Unit | str | None) -> str:
    """A unit's display symbol as people print it."""
    if unit is None:
        return ""
    symbol = unit if isinstance(unit, str) else unit.shown
    raised = re.sub(r"(?<=[ms])([234])\b", lambda found: found[1].translate(_RAISED), symbol)
    return "" if raised == "1" else raised


def shown(value: Any, unit: Unit | None, pointer: str = "") -> str:
    """An input's value in its display unit, whatever it is."""
    meaning = _MEANINGS.get((_ROW.sub("", pointer), _only(value)))
    if meaning is not None:
        return meaning
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return with_unit(value, unit, 6)
    if isinstance(value, tuple | list):
        return _list(cast(Sequence[Any], value), unit)
    # Choices and names of car types are written as in JSON; a text of the user's stands as it is.
    return str(value).replace("_", " ") if pointer != "/name" else str(value)


def _only(value: Any) -> float | None:
    """A number, or the one that all rows of a column have; None where there is none."""
    rows = cast(Sequence[Any], value) if isinstance(value, tuple | list) else (value,)
    numeric = bool(rows) and all(isinstance(row, int | float) for row in rows)
    return float(rows[0]) if numeric and all(row == rows[0] for row in rows) else None


def _list(values: Sequence[Any], unit: Unit | None) -> str:
    if not values:
        return "none"
    if not all(isinstance(item, int | float) for item in values):
        return _names([str(item).replace("_", " ") for item in values])
    scale = 1.0 if unit is None else unit.scale
    symbol = "" if unit is None else f" {unit_text(unit)}"
    numbers = [float(item) * scale for item in values]
    steps = [after - before for before, after in pairwise(numbers)]
    even = len(numbers) > 3 and all(abs(step - steps[0]) < 1e-6 * abs(steps[0]) for step in steps)
    if even:
        ends = f"{number(numbers[0], 6)} to {number(numbers[-1], 6)}{symbol}"
        return f"{ends} in steps of {number(steps[0], 6)} ({len(numbers)})"
    return _names([number(item, 6) for item in numbers]) + symbol


def _names(items: Sequence[str]) -> str:
    """Equal neighbours once with their count, and not too many of them."""
    groups: list[tuple[str, int]] = []
    for item in items:
        if groups and groups[-1][0] == item:
            groups[-1] = (item, groups[-1][1] + 1)
        else:
            groups.append((item, 1))
    texts: list[str] = []
    for name, count in groups:
        texts += [name] * count if count < _REPEATED else [f"{count} × {name}"]
    rest = len(texts) - _SHOWN_ITEMS
    return ", ".join(texts[:_SHOWN_ITEMS]) + (f" and {rest} more" if rest > 0 else "")


def input_name(pointer: str) -> tuple[str, str]:
    """Section and name of an input: ``/track/pad_stiffness`` reads Track, pad stiffness."""
    first, *rest = pointer.strip("/").split("/")
    words: list[str] = []
    for part in rest:
        if part.isdigit():
            words[-1] = f"{words[-1].removesuffix('s')} {int(part) + 1}"
        else:
            words.append(part.replace("_", " "))
    section = first.replace("_", " ").capitalize()
    return (section, ", ".join(words)) if words else ("Study", section.lower())
