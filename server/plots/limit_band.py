"""The band that a limit allows, and the peak that is held against it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from server.plots.curves import Curve
from server.plots.figure import window
from server.plots.marks import callout, horizontal_line, horizontal_note
from server.plots.palette import CURVES, LIMIT, WITHIN
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.text import beside, quantity
from solver.units import Units

__all__ = [
    "DECIDING",
    "DECIDING_COLOR",
    "NEAR_LIMIT",
    "limit_band",
    "limit_notes",
    "peak_callout",
    "room_for_callout",
]

DECIDING = "deciding point"
DECIDING_COLOR = CURVES[1]
NEAR_LIMIT = 0.2
"""Part of the limit that a curve has to reach for the axis to reach as far as the limit."""
AIR, ABOVE, BELOW = 0.06, 0.24, 0.45
"""Free height beside the curves, and beyond a peak that is named, as parts of the curves'.

Words above a peak may stand out over the axes; below one they would hide the axis' numbers.
"""


def limit_band(limit: float | None) -> list[dict[str, Any]]:
    """The allowed range, shaded between two lines; nothing without a limit."""
    if limit is None:
        return []
    allowed = {
        "type": "rect",
        "xref": "paper",
        "x0": 0,
        "x1": 1,
        "yref": "y",
        "y0": -limit,
        "y1": limit,
        "line": {"width": 0},
        "fillcolor": WITHIN,
        "opacity": 0.09,
        "layer": "below",
    }
    return [allowed, horizontal_line(limit, LIMIT), horizontal_line(-limit, LIMIT)]


def limit_notes(limit: float | None) -> list[dict[str, Any]]:
    """The limit in words, on its upper line."""
    if limit is None:
        return []
    return [horizontal_note(limit, f"±{quantity(limit, Units.acceleration)}", LIMIT)]


def peak_callout(
    run: RunSource,
    judged: Sequence[Curve],
    limit: float | None,
    request: FigureRequest,
    *,
    placed: bool = True,
) -> list[dict[str, Any]]:
    """Names the greatest value of the judged curves; its place too, unless the title says it."""
    peaks = [(curve, curve.peak(run.plan.window_start)) for curve in judged]
    known = [(curve, peak) for curve, peak in peaks if peak is not None]
    if not known:
        return []
    curve, peak = max(known, key=lambda pair: abs(pair[1].value))
    size = beside(abs(peak.value), limit, curve.unit)
    place = curve.spec.name.rsplit("/", 1)[0]
    where = f"{place}\n" if placed else ""
    words = f"{size}\n{where}t = {peak.time:.3f} s"
    start, stop = window(run.plan, request)
    color = DECIDING_COLOR if place.startswith(DECIDING) else CURVES[0]
    return [callout(peak, words, color, leftwards=peak.time > 0.5 * (start + stop))]


def room_for_callout(
    run: RunSource, curves: Sequence[Curve], judged: Sequence[Curve], limit: float | None
) -> tuple[float, float] | None:
    """Range of the axis: all curves, the limit once they come near to it, the peak's words.

    Args:
        run: The run.
        curves: All that is drawn.
        judged: The curves whose peak is named.
        limit: In display units.

    Returns:
        None where nothing has moved yet.
    """
    lows = [extreme.value for curve in curves if (extreme := curve.minimum())]
    highs = [extreme.value for curve in curves if (extreme := curve.maximum())]
    if not lows or max(highs) <= min(lows):
        return None
    low, high = min(lows), max(highs)
    if limit is not None and max(high, -low) >= NEAR_LIMIT * limit:
        low, high = min(low, -limit), max(high, limit)
    height = high - low
    low, high = low - AIR * height, high + AIR * height
    peaks = [peak.value for curve in judged if (peak := curve.peak(run.plan.window_start))]
    if peaks:
        top = max(peaks, key=abs)
        low = min(low, top - BELOW * height) if top < 0.0 else low
        high = max(high, top + ABOVE * height) if top >= 0.0 else high
    return low, high
