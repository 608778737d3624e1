"""Envelopes along the axis: displacements of the deck, or its greatest accelerations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from server.plots.along import (
    AccelerationAlong,
    DisplacementAlong,
    acceleration_along,
    displacement_along,
)
from server.plots.deciding import acceleration_limit, cut_off_words
from server.plots.figure import Figure, chart, line_trace, value_axis
from server.plots.kind import FigureKind, Variant
from server.plots.marks import horizontal_line, horizontal_note, span_notes, vertical_line
from server.plots.palette import LIMIT, MUTED, line_style
from server.plots.request import FigureRequest
from server.plots.source import PlanSource, RunSource
from server.plots.text import beside, coordinate, quantity
from solver.arrays import Vector
from solver.units import Unit, Units

__all__ = [
    "ACCELERATION",
    "DISPLACEMENT",
    "KIND",
    "along_axis",
    "along_line",
    "envelope",
    "limit_marks",
]

DISPLACEMENT = Variant(name="displacement", title="Displacement")
ACCELERATION = Variant(name="acceleration", title="Acceleration")


def envelope(run: RunSource, request: FigureRequest) -> Figure:
    """Least and greatest displacement on the axis, or greatest |acceleration| over the width.

    Args:
        run: The run, finished or not.
        request: ``displacement`` (of the window) or ``acceleration`` (of the whole run).

    Returns:
        The figure.
    """
    if request.variant == ACCELERATION.name:
        return _accelerations(run)
    return _displacements(run, request)


def along_axis(
    plan: PlanSource,
    *,
    title: str,
    y_axis: Mapping[str, Any],
    traces: Sequence[dict[str, Any]],
    table: Sequence[dict[str, Any]],
    summary: str,
    shapes: Sequence[dict[str, Any]] = (),
    annotations: Sequence[dict[str, Any]] = (),
) -> Figure:
    """A figure over the bridge, its joints marked."""
    spans = plan.geometry.spans
    joints = [vertical_line(float(x), MUTED, "dot") for x in spans[1:, 0]]
    return chart(
        title=title,
        x_axis={
            "title": {"text": "x along the track [m]"},
            "range": [float(spans.min()), float(spans.max())],
        },
        y_axis=y_axis,
        traces=traces,
        table=table,
        summary=summary,
        shapes=[*joints, *shapes],
        annotations=annotations,
        hover="x unified",
        meta={"axis": "position"},
    )


def along_line(
    name: str,
    x: Vector,
    values: Vector,
    unit: Unit,
    color: str,
    *,
    width: float = 1.6,
    dash: str = "solid",
) -> dict[str, Any]:
    """A line along the bridge, its values in display units."""
    shown = [float(f"{value:.7g}") for value in values.tolist()]
    places = np.round(x, 6).tolist()
    return line_trace(name, places, shown, unit, color=color, width=width, dash=dash)


def limit_marks(limit: float | None) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """The line of a limit of a magnitude, and its words."""
    if limit is None:
        return [], []
    words = f"limit {quantity(limit, Units.acceleration)}"
    return [horizontal_line(limit, LIMIT)], [horizontal_note(limit, words, LIMIT)]


def _displacements(run: RunSource, request: FigureRequest) -> Figure:
    found = displacement_along(run, request)
    unit = Units.small_length
    traces: list[dict[str, Any]] = []
    if found is not None:
        curves = (("least", found.least), ("greatest", found.greatest))
        for number, (name, values) in enumerate(curves):
            style = line_style(number)
            traces.append(
                along_line(name, found.x, unit.scale * values, unit, style.color, dash=style.dash)
            )
        recorded = _recorded(run)
        if recorded is not None and request.start is None and request.stop is None:
            traces.append(recorded)
    return along_axis(
        run.plan,
        title="Displacement of the deck on its axis, upward positive",
        y_axis=value_axis("displacement [mm]"),
        traces=traces,
        table=[] if found is None else _displacement_rows(found),
        summary=_displacement_words(run, found),
    )


def _recorded(run: RunSource) -> dict[str, Any] | None:
    """Extremes of the points whose displacement is recorded at every step, as marks."""
    peaks: Mapping[str, Mapping[str, float]] = (run.summary or {}).get("peaks", {})
    x: list[float] = []
    y: list[float] = []
    for spec in run.plan.channels:
        on_axis = spec.place is not None and abs(spec.place[1]) < 1e-6
        named = spec.group == "deck" and spec.name.endswith("/displacement")
        if on_axis and named and spec.place is not None and spec.name in peaks:
            peak = peaks[spec.name]
            x += [round(spec.place[0], 6)] * 2
            y += [float(f"{peak[side] * spec.unit.scale:.7g}") for side in ("least", "greatest")]
    if not x:
        return None
    style = line_style(2)
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "recorded at every step",
        "x": x,
        "y": y,
        "marker": {"symbol": style.marker, "size": 8, "color": style.color},
        "hovertemplate": "%{y:.4~g} mm",
        "meta": {"unit": Units.small_length.shown},
    }


def _accelerations(run: RunSource) -> Figure:
    found = acceleration_along(run)
    limit = acceleration_limit(run)
    unit = Units.acceleration
    traces: list[dict[str, Any]] = []
    if found is not None:
        style = line_style(0)
        judged = found.filtered is not None
        traces.append(
            along_line(
                "as computed", found.x, found.raw, unit, style.pale if judged else style.color
            )
        )
        if found.filtered is not None:
            name = cut_off_words(run) or "filtered"
            traces.append(along_line(name, found.x, found.filtered, unit, style.color, width=2.2))
    shapes, notes = limit_marks(limit)
    return along_axis(
        run.plan,
        title="Greatest |acceleration| over the slab's width",
        y_axis={**value_axis("|acceleration| [m/s²]"), "rangemode": "tozero"},
        traces=traces,
        table=[] if found is None else _acceleration_rows(run, found),
        summary=_acceleration_words(run, found, limit),
        shapes=shapes,
        annotations=[*notes, *span_notes(run.plan)],
    )


def _displacement_rows(found: DisplacementAlong) -> list[dict[str, Any]]:
    low, high = int(np.argmin(found.least)), int(np.argmax(found.greatest))
    return [
        {
            "extreme": name,
            "value": 1e3 * float(values[at]),
            "unit": "mm",
            "x [m]": float(found.x[at]),
        }
        for name, values, at in (("least", found.least, low), ("greatest", found.greatest, high))
    ]


def _acceleration_rows(run: RunSource, found: AccelerationAlong) -> list[dict[str, Any]]:
    curves = [("as computed", found.raw)]
    if found.filtered is not None:
        curves.append((cut_off_words(run) or "filtered", found.filtered))
    return [
        {
            "curve": name,
            "value": float(values.max()),
            "unit": "m/s²",
            "x [m]": float(found.x[int(np.argmax(values))]),
        }
        for name, values in curves
    ]


def _displacement_words(run: RunSource, found: DisplacementAlong | None) -> str:
    if found is None:
        no_step = run.committed == 0
        return "No step has been computed yet." if no_step else "This run draws no deck."
    unit = Units.small_length
    low, high = int(np.argmin(found.least)), int(np.argmax(found.greatest))
    words = (
        f"Least {quantity(1e3 * float(found.least[low]), unit)} at "
        f"x = {coordinate(found.x[low], 1)} m, greatest "
        f"{quantity(1e3 * float(found.greatest[high]), unit)} at "
        f"x = {coordinate(found.x[high], 1)} m"
    )
    seen = f"every {1e3 * found.interval:.3g} ms" if found.interval > 0.0 else "in one shape"
    return f"{words}, as seen {seen}."


def _acceleration_words(
    run: RunSource, found: AccelerationAlong | None, limit: float | None
) -> str:
    if run.committed == 0:
        return "No step has been computed yet."
    if found is None:
        unfinished = run.summary is None
        return (
            "The envelope is drawn when the run has been judged."
            if unfinished
            else "This run was stored before peaks were: compute it again to see them."
        )
    values = found.raw if found.filtered is None else found.filtered
    at = int(np.argmax(values))
    name = "as computed" if found.filtered is None else cut_off_words(run) or "filtered"
    size = beside(float(values[at]), limit, Units.acceleration)
    words = f"Greatest |acceleration| {name}: {size} at x = {coordinate(found.x[at], 1)} m"
    others = "; spans that are not judged are drawn too" if span_notes(run.plan) else ""
    return f"{words}{others}."


def _has(run: RunSource) -> bool:
    return not run.plan.modal and bool(len(run.plan.geometry.spans))


def _offers(run: RunSource, variant: str) -> bool:
    """A run that was stored before peaks were has none."""
    return variant == DISPLACEMENT.name or run.summary is None or run.slab_peaks() is not None


KIND = FigureKind(
    name="envelope",
    title="Envelope along the bridge",
    group="deck",
    axis="position",
    draw=envelope,
    has=_has,
    variants=(DISPLACEMENT, ACCELERATION),
    offers=_offers,
)
