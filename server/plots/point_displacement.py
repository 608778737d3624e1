"""The displacement history of the point that is drawn nearest to where somebody pointed."""

from __future__ import annotations

import numpy as np

from server.plots.curves import Curve, frame_curve, raw_curve
from server.plots.figure import Figure, compose, table_row, trace
from server.plots.kind import FigureKind
from server.plots.nearest import Nearest, nearest_vertex
from server.plots.palette import line_style
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.text import quantity
from solver.results import ChannelSpec
from solver.units import Units

__all__ = ["KIND", "point_displacement"]

_SAME = 1e-3
"""A recorded point this near to a vertex is the vertex. [m]"""


def point_displacement(run: RunSource, request: FigureRequest) -> Figure:
    """The vertical displacement of a point of the drawn surface, bridge or rail.

    Args:
        run: The run, finished or not.
        request: The place; window and points.

    Returns:
        The figure. It says which point is drawn, how far it lies from the place, and how often its
        position is known: at every step where it is recorded, else in every stored shape.
    """
    assert request.place is not None
    found = nearest_vertex(run.plan, request.place)
    curve = None if found is None else _curve(run, found, request)
    return compose(
        plan=run.plan,
        title=f"Vertical displacement, {found.words}" if found else "Vertical displacement",
        value_title="displacement [mm]",
        traces=[] if curve is None else [trace(curve, request, line_style(0).color, 1.6)],
        table=[] if curve is None else [table_row(curve)],
        summary=_summary(run, found, curve),
        request=request,
    )


def _curve(run: RunSource, found: Nearest, request: FigureRequest) -> Curve:
    """Of the recorded channel where there is one at this very point, else of the stored shapes."""
    for spec in run.plan.channels:
        if spec.place is None or spec.group != "deck" or not spec.name.endswith("/displacement"):
            continue
        if np.allclose(spec.place, found.place, rtol=0.0, atol=_SAME):
            return raw_curve(run, spec, request, spec.name.removesuffix("/displacement"))
    spec = ChannelSpec(
        name="",
        unit=Units.small_length,
        title=f"Vertical displacement, {found.words}",
        group="deck",
        place=found.place,
    )
    return frame_curve(run, spec, found.index, request, found.words)


def _summary(run: RunSource, found: Nearest | None, curve: Curve | None) -> str:
    if found is None or curve is None:
        return "This run draws no surface."
    said = f"The {found.words} is the nearest that is drawn, {found.distance_words}."
    least, greatest = curve.minimum(), curve.maximum()
    if run.committed == 0 or least is None or greatest is None:
        return f"{said} No step has been computed yet."
    said += (
        f" It moves between {quantity(least.value, curve.unit)} at t = {least.time:.3f} s and "
        f"{quantity(greatest.value, curve.unit)} at t = {greatest.time:.3f} s"
    )
    if curve.spec.name or curve.time.size < 2:
        return f"{said}."
    interval = 1e3 * float(curve.time[1] - curve.time[0])
    return f"{said}, as seen every {interval:.3g} ms."


def _has(run: RunSource) -> bool:
    return not run.plan.modal and bool(len(run.plan.geometry.vertices))


KIND = FigureKind(
    name="point-displacement",
    title="Displacement at a point",
    group="deck",
    axis="time",
    draw=point_displacement,
    has=_has,
    needs_place=True,
)
