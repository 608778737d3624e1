"""The acceleration history of the slab's point nearest to where somebody pointed."""

from __future__ import annotations

from typing import Any

from server.plots.curves import Curve, filtered_history, point_curve
from server.plots.deciding import acceleration_limit, cut_off, cut_off_words
from server.plots.figure import Figure, compose, table_row, trace
from server.plots.kind import FigureKind
from server.plots.limit_band import limit_band, limit_notes, peak_callout, room_for_callout
from server.plots.nearest import Nearest, nearest_slab_point
from server.plots.palette import line_style
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.text import beside, quantity
from solver.results import ChannelSpec
from solver.units import Units

__all__ = ["KIND", "point_acceleration"]


def point_acceleration(run: RunSource, request: FigureRequest) -> Figure:
    """Raw history while the run computes; afterwards the low-pass filtered one over it.

    Args:
        run: The run, finished or not.
        request: The place; window and points.

    Returns:
        The figure. It says which point is drawn, and how far it lies from the place.
    """
    assert request.place is not None
    found = nearest_slab_point(run.plan, request.place)
    curves = [] if found is None else _curves(run, found, request)
    judged = curves[-1:]
    limit = acceleration_limit(run)
    return compose(
        plan=run.plan,
        title=f"Vertical acceleration, {found.words}" if found else "Vertical acceleration",
        value_title="acceleration [m/s²]",
        traces=_traces(curves, request),
        table=[{**table_row(curve), "channel": ""} for curve in curves],
        summary=_summary(run, found, judged, limit),
        shapes=limit_band(limit),
        value_range=room_for_callout(run, curves, judged, limit),
        annotations=[
            *limit_notes(limit),
            *peak_callout(run, judged, limit, request, placed=False),
        ],
        request=request,
    )


def _curves(run: RunSource, found: Nearest, request: FigureRequest) -> list[Curve]:
    """As computed, and where the run is judged and whole as the verdict's filter leaves it."""
    spec = _spec(run, found)
    curves = [point_curve(run, spec, found.index, request, "as computed")]
    frequency = cut_off(run)
    if frequency is not None and request.low_pass is not None:
        history = run.slab_point(found.index)
        values = request.low_pass(history[:, None], run.plan.time_step, frequency)[:, 0]
        curves.append(filtered_history(run, spec, values, request, cut_off_words(run)))
    return curves


def _spec(run: RunSource, found: Nearest) -> ChannelSpec:
    """A channel that the point would have: accelerations share one offset in time."""
    offsets = [
        spec.time_offset
        for spec in run.plan.channels
        if spec.group == "deck" and spec.name.endswith("/acceleration")
    ]
    return ChannelSpec(
        name=f"{found.words}/acceleration",
        unit=Units.acceleration,
        title=f"Vertical acceleration, {found.words}",
        group="deck",
        place=found.place,
        time_offset=offsets[0] if offsets else 0.0,
    )


def _traces(curves: list[Curve], request: FigureRequest) -> list[dict[str, Any]]:
    style = line_style(0)
    if len(curves) < 2:
        return [trace(curve, request, style.color, 1.2) for curve in curves]
    raw, filtered = curves
    return [trace(raw, request, style.pale, 0.8), trace(filtered, request, style.color, 2.2)]


def _summary(
    run: RunSource, found: Nearest | None, judged: list[Curve], limit: float | None
) -> str:
    if found is None:
        return "This run records no points of a deck."
    said = f"The {found.words} is the nearest that is recorded, {found.distance_words}."
    peak = judged[0].peak(run.plan.window_start) if judged else None
    if run.committed == 0 or peak is None:
        return f"{said} No step has been computed yet."
    size = beside(abs(peak.value), limit, Units.acceleration)
    said += f" Greatest magnitude {judged[0].name}: {size} at t = {peak.time:.3f} s"
    if limit is None or cut_off(run) is None:
        return f"{said}."
    side = "within" if abs(peak.value) <= limit else "outside"
    return f"{said}, {side} ±{quantity(limit, Units.acceleration)}."


def _has(run: RunSource) -> bool:
    return not run.plan.modal and bool(len(run.plan.slab.coordinates))


KIND = FigureKind(
    name="point-acceleration",
    title="Acceleration at a point",
    group="deck",
    axis="time",
    draw=point_acceleration,
    has=_has,
    needs_place=True,
)
