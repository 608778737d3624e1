"""Peaks of a deck's acceleration and displacement against the speed of the train."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from server.plots.figure import Figure, chart, value_axis
from server.plots.limit_band import NEAR_LIMIT
from server.plots.marks import (
    horizontal_line,
    horizontal_note,
    pointed,
    vertical_line,
    vertical_note,
)
from server.plots.palette import GRID, INK, LIMIT, MUTED, line_style
from server.plots.request import FigureRequest
from server.plots.text import beside, quantity, unit_text
from server.plots.theme import themed
from solver.units import Unit, Units

__all__ = ["Sweep", "SweepPoint", "speed_sweep"]

NEAR = 0.92
"""A resonance speed is near to the sweep within this part of its first or last speed."""
MARGIN = 0.06
"""Free width beside the first and the last speed, as a part of their distance."""
CALLOUT = 1.3
"""Height of an axis over what it has to show: words stand above the peak."""
LONE = 5.0
"""Free width beside a lone speed. [km/h]"""


@dataclass(frozen=True, kw_only=True)
class SweepPoint:
    """What one run of a sweep found.

    Attributes:
        run: Its id.
        speed: [m/s]
        acceleration: Greatest magnitude, low-pass filtered where the run is judged. [m/s2]
        displacement: Greatest magnitude at the middle of the judged spans, absent where no point
            is recorded. [m]
    """

    run: str
    speed: float
    acceleration: float | None
    displacement: float | None


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """A job's runs, as far as they have ended.

    Attributes:
        points: Of the runs that are done.
        planned: Speeds of all runs. [m/s]
        open: Runs that are still to come.
        limit: Of the acceleration, absent where nothing is judged. [m/s2]
        quantity: What the acceleration is, for example ``below 30 Hz``.
        frequency: Of the span, from which the resonance speeds are; absent where it is unknown.
            [Hz]
        origin: Where the frequency is from, in words.
        resonances: Order i and speed v = f d / i of each. [m/s]
    """

    points: tuple[SweepPoint, ...]
    planned: tuple[float, ...]
    open: int
    limit: float | None
    quantity: str
    frequency: float | None = None
    origin: str = ""
    resonances: tuple[tuple[int, float], ...] = ()


def speed_sweep(sweep: Sweep, request: FigureRequest) -> Figure:
    """Accelerations above, displacements below, over the speed.

    Args:
        sweep: The runs; ``customdata`` of each point is its run.
        request: Only its theme counts.

    Returns:
        The figure; it grows as runs end.
    """
    points = sorted(sweep.points, key=lambda point: point.speed)
    low, high = _range(sweep)
    shapes, notes = _resonances(sweep, low, high)
    if sweep.limit is not None:
        words = f"limit {quantity(sweep.limit, Units.acceleration)}"
        shapes.append(horizontal_line(sweep.limit, LIMIT))
        notes.append(horizontal_note(sweep.limit, words, LIMIT))
    name = f"greatest |acceleration| {sweep.quantity}".strip()
    middle = "mid-span" if sweep.limit is None else "judged mid-spans"
    traces = [
        _trace(points, name, lambda point: point.acceleration, Units.acceleration, 0, "y"),
        _trace(
            points,
            f"greatest |displacement| at {middle}",
            lambda point: point.displacement,
            Units.small_length,
            1,
            "y2",
        ),
    ]
    grid = {"gridcolor": GRID, "linecolor": GRID, "zerolinecolor": GRID}
    figure = chart(
        title="Peaks against the speed",
        x_axis={"title": {"text": "speed [km/h]"}, "range": [low, high], "anchor": "y2"},
        y_axis={
            **value_axis("acceleration [m/s²]", _height(traces[0]["y"], sweep.limit)),
            "domain": [0.46, 1.0],
        },
        more={
            "yaxis2": {
                **value_axis("displacement [mm]", _height(traces[1]["y"], None)),
                **grid,
                "domain": [0.0, 0.4],
            }
        },
        traces=traces,
        table=[_row(point, sweep) for point in points],
        summary=_summary(points, sweep),
        shapes=shapes,
        annotations=[*notes, *_peak(points, sweep, low, high)],
        meta={"axis": "speed"},
    )
    return themed(figure, request.theme)


def _trace(
    points: Sequence[SweepPoint],
    name: str,
    value: Callable[[SweepPoint], float | None],
    unit: Unit,
    number: int,
    axis: str,
) -> dict[str, Any]:
    style = line_style(number)
    known = [(point, found) for point in points if (found := value(point)) is not None]
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": name,
        "x": [_kilometres_per_hour(point.speed) for point, _ in known],
        "y": [float(f"{found * unit.scale:.7g}") for _, found in known],
        "yaxis": axis,
        "customdata": [point.run for point, _ in known],
        "line": {"color": style.color, "width": 1.6, "dash": style.dash},
        "marker": {"symbol": style.marker, "size": 8, "color": style.color},
        "hovertemplate": f"%{{x:.4~g}} km/h: %{{y:.4~g}} {unit_text(unit)}<extra></extra>",
        "meta": {"unit": unit.shown, "customdata": "run"},
    }


def _height(values: Sequence[float], limit: float | None) -> tuple[float, float] | None:
    """From zero to above the values and, once they come near to it, the limit."""
    top = max(values, default=0.0)
    if top <= 0.0:
        return None
    near = limit is not None and top >= NEAR_LIMIT * limit
    return 0.0, CALLOUT * max(top, limit if limit is not None and near else 0.0)


def _range(sweep: Sweep) -> tuple[float, float]:
    """Of all speeds that are planned, so that the figure stands still while it fills.

    A resonance just beyond them explains their peak, and so is in sight too.
    """
    speeds = [_kilometres_per_hour(speed) for speed in sweep.planned]
    if not speeds:
        return 0.0, 1.0
    beyond = [_kilometres_per_hour(speed) for _, speed in sweep.resonances]
    least, greatest = NEAR * min(speeds), max(speeds) / NEAR
    speeds += [speed for speed in beyond if least < speed < greatest]
    air = MARGIN * (max(speeds) - min(speeds)) or LONE
    return min(speeds) - air, max(speeds) + air


def _resonances(
    sweep: Sweep, low: float, high: float
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Lines at the resonance speeds in sight."""
    shapes: list[dict[str, Any]] = []
    notes: list[dict[str, Any]] = []
    for order, speed in sweep.resonances:
        shown = _kilometres_per_hour(speed)
        if low < shown < high:
            shapes.append(vertical_line(shown, MUTED, "dot"))
            words = f"f d / {order} = {shown:.0f} km/h"
            note = vertical_note(shown, words, MUTED)
            leftwards = shown > 0.5 * (low + high)
            # Above the displacements: the words of the greatest acceleration stand by the line too.
            place = {"yref": "y2 domain", "xanchor": "right" if leftwards else "left"}
            notes.append({**note, **place})
    return shapes, notes


def _greatest(points: Sequence[SweepPoint]) -> tuple[SweepPoint, float] | None:
    known = [(point, point.acceleration) for point in points if point.acceleration is not None]
    return max(known, key=lambda pair: pair[1], default=None)


def _peak(
    points: Sequence[SweepPoint], sweep: Sweep, low: float, high: float
) -> list[dict[str, Any]]:
    worst = _greatest(points)
    if worst is None:
        return []
    point, value = worst
    speed = _kilometres_per_hour(point.speed)
    words = f"{beside(value, sweep.limit, Units.acceleration)}\n{speed:.4g} km/h"
    note = pointed(speed, value, words, INK, leftwards=speed > 0.5 * (low + high))
    return [{**note, "ay": -26}]


def _row(point: SweepPoint, sweep: Sweep) -> dict[str, Any]:
    value, moved = point.acceleration, point.displacement
    judged = "" if value is None or sweep.limit is None else _side(value, sweep.limit)
    return {
        "speed [km/h]": _kilometres_per_hour(point.speed),
        "acceleration [m/s²]": value,
        "displacement [mm]": None if moved is None else moved * Units.small_length.scale,
        "verdict": judged,
        "run": point.run,
    }


def _summary(points: Sequence[SweepPoint], sweep: Sweep) -> str:
    to_come = f" {sweep.open} of {len(sweep.planned)} runs are still to come." if sweep.open else ""
    worst = _greatest(points)
    if worst is None:
        return f"No run has been judged yet.{to_come}"
    point, value = worst
    said = (
        f"Greatest |acceleration| {sweep.quantity}: "
        f"{beside(value, sweep.limit, Units.acceleration)} "
        f"at {_kilometres_per_hour(point.speed):.4g} km/h"
    )
    if sweep.limit is not None:
        limit = sweep.limit
        over = sum((point.acceleration or 0.0) > limit for point in points)
        side = "within" if value <= limit else "outside"
        said += f", {side} {quantity(limit, Units.acceleration)}"
        said += f"; {over} of {len(points)} speeds exceed it" if over else ""
    said += "."
    if sweep.frequency is not None and sweep.resonances:
        order, speed = sweep.resonances[0]
        origin = f" ({sweep.origin})" if sweep.origin else ""
        said += (
            f" Resonance v = f d / i, f = {quantity(sweep.frequency, Units.frequency)}{origin}: "
            f"{_kilometres_per_hour(speed):.0f} km/h for i = {order}."
        )
    return f"{said}{to_come}"


def _side(value: float, limit: float) -> str:
    return "exceeds" if value > limit else "within"


def _kilometres_per_hour(speed: float) -> float:
    return float(f"{speed * Units.speed.scale:.7g}")
