"""The greatest acceleration of every point of the slab, as a map from above.

It is the picture of figures 7.29 to 7.31 and 7.43 of the thesis: where the slab shakes most, and
how local that is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from server.plots.deciding import acceleration_limit, cut_off_words
from server.plots.figure import Figure, chart
from server.plots.kind import FigureKind, Variant
from server.plots.marks import (
    horizontal_line,
    horizontal_note,
    pointed,
    span_notes,
    vertical_line,
)
from server.plots.palette import INK, LIMIT, MAP_SCALE, ON_MAP, PAPER
from server.plots.request import FigureRequest
from server.plots.slab_grid import SlabGrid, greatest_index
from server.plots.source import RunSource
from server.plots.text import beside, coordinate, escape, quantity
from solver.arrays import BoolVector, Matrix, Vector
from solver.results import SlabPeaks
from solver.units import Units

__all__ = ["KIND", "slab_map"]

FILTERED = Variant(name="filtered", title="Low-pass filtered")
RAW = Variant(name="raw", title="As computed")
UNIT = "m/s²"


@dataclass(frozen=True, kw_only=True)
class _Map:
    """What is drawn: values and times of the slab's points, and the limit where it applies."""

    values: Vector
    times: Vector
    limit: float | None
    words: str


def slab_map(run: RunSource, request: FigureRequest) -> Figure:
    """The map of a finished run; a few words before.

    Args:
        run: The run, finished or not.
        request: ``filtered`` (where the run is judged) or ``raw``; the map is of the whole run,
            whatever the window.

    Returns:
        The figure.
    """
    peaks = run.slab_peaks()
    if peaks is None:
        return _figure(run, "greatest acceleration", [], [], _waiting(run))
    drawn = _map(run, peaks, request.variant)
    grid = SlabGrid.of(run.plan.slab)
    shown = grid.points(drawn.values)
    values, times = grid.values(drawn.values, shown), grid.values(drawn.times, shown)
    traces = [_heatmap(grid, values, times)]
    if drawn.limit is not None and bool((values > drawn.limit).any()):
        traces.append(_limit_contour(grid, values, drawn.limit))
    judged = _judged(run)
    top = greatest_index(drawn.values, judged if judged.any() else np.ones_like(judged))
    notes = span_notes(run.plan)
    if top is not None:
        traces.append(_peak_marker(run, drawn, top))
        notes.append(_peak_note(run, drawn, top))
    table = [_row(run, drawn, span) for span in range(len(run.plan.geometry.spans))]
    figure = _figure(
        run, drawn.words, traces, notes, _summary(run, drawn, top, judged), [*filter(None, table)]
    )
    return figure


def _map(run: RunSource, peaks: SlabPeaks, variant: str) -> _Map:
    if variant == RAW.name or peaks.filtered is None or peaks.filtered_time is None:
        words = "greatest |acceleration| as computed"
        return _Map(values=peaks.raw, times=peaks.raw_time, limit=None, words=words)
    return _Map(
        values=peaks.filtered,
        times=peaks.filtered_time,
        limit=acceleration_limit(run),
        words=f"greatest |acceleration| {cut_off_words(run) or 'filtered'}",
    )


def _figure(
    run: RunSource,
    words: str,
    traces: Sequence[dict[str, Any]],
    notes: Sequence[dict[str, Any]],
    summary: str,
    table: Sequence[dict[str, Any]] = (),
) -> Figure:
    spans, across = run.plan.geometry.spans, run.plan.slab.coordinates[:, 1]
    rails = np.unique(run.plan.geometry.wheels.lateral).tolist()
    lines = [vertical_line(float(x), ON_MAP) for x in spans[1:, 0]]
    lines += [horizontal_line(float(y), ON_MAP, "dot") for y in rails]
    sides = {True: "left rail", False: "right rail"}
    return chart(
        title=f"Slab: {words}",
        x_axis={
            "title": {"text": "x along the track [m]"},
            "range": [float(spans.min()), float(spans.max())],
        },
        y_axis={
            "title": {"text": "y across the track [m]"},
            "zeroline": False,
            "range": [float(across.min()), float(across.max())],
        },
        traces=traces,
        table=table,
        summary=summary,
        # Above: a map would hide what lies below it.
        shapes=[{**line, "layer": "above"} for line in lines if traces],
        annotations=[
            *notes,
            *(horizontal_note(float(y), sides[y > 0], INK) for y in rails if traces),
        ],
        meta={"axis": "position"},
    )


def _heatmap(grid: SlabGrid, values: Matrix, times: Matrix) -> dict[str, Any]:
    return {
        "type": "heatmap",
        "name": "greatest |acceleration|",
        "x": [round(float(x), 6) for x in grid.x],
        "y": [round(float(y), 6) for y in grid.y],
        "z": _numbers(values, 5),
        "customdata": _numbers(times, 9),
        "colorscale": [list(stop) for stop in MAP_SCALE],
        "zmin": 0.0,
        "zmax": float(np.nanmax(values)) or 1.0,
        "zsmooth": "best",
        "colorbar": {"title": {"text": f"[{UNIT}]"}},
        "hovertemplate": (
            f"x %{{x:.2f}} m, y %{{y:.2f}} m: %{{z:.3f}} {UNIT} at t = %{{customdata:.3f}} s"
            "<extra></extra>"
        ),
        "meta": {"unit": Units.acceleration.shown},
    }


def _limit_contour(grid: SlabGrid, values: Matrix, limit: float) -> dict[str, Any]:
    return {
        "type": "contour",
        "name": escape(f"limit {quantity(limit, Units.acceleration)}"),
        "x": [round(float(x), 6) for x in grid.x],
        "y": [round(float(y), 6) for y in grid.y],
        "z": _numbers(values, 5),
        "contours": {"start": limit, "end": limit, "size": 1.0, "coloring": "none"},
        "line": {"color": LIMIT, "width": 2.5, "dash": "dash"},
        "showscale": False,
        "showlegend": True,
        "hoverinfo": "skip",
        "meta": {"unit": Units.acceleration.shown},
    }


def _peak_marker(run: RunSource, drawn: _Map, point: int) -> dict[str, Any]:
    x, y, _ = run.plan.slab.coordinates[point].tolist()
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "peak" if not run.plan.slab.judged_spans else "peak of the judged slab",
        "x": [round(x, 6)],
        "y": [round(y, 6)],
        "customdata": [round(float(drawn.times[point]), 9)],
        "marker": {
            "symbol": "x",
            "size": 11,
            "color": LIMIT,
            "line": {"color": PAPER, "width": 1},
        },
        "hoverinfo": "skip",
        "meta": {"unit": "m"},
    }


def _peak_note(run: RunSource, drawn: _Map, point: int) -> dict[str, Any]:
    x, y, _ = run.plan.slab.coordinates[point].tolist()
    spans = run.plan.geometry.spans
    size = beside(float(drawn.values[point]), drawn.limit, Units.acceleration)
    words = f"{size}\n{_place(x, y)}\nt = {drawn.times[point]:.3f} s"
    note = pointed(x, y, words, INK, leftwards=x > 0.5 * (spans.min() + spans.max()))
    # Towards the middle of the slab: beyond its edge the words would hide the axis' title.
    across = run.plan.slab.coordinates[:, 1]
    upwards = y <= 0.5 * (across.min() + across.max())
    return {**note, "ay": -abs(note["ay"]) if upwards else abs(note["ay"])}


def _judged(run: RunSource) -> BoolVector:
    slab = run.plan.slab
    return np.isin(slab.span, slab.judged_spans)


def _row(run: RunSource, drawn: _Map, span: int) -> dict[str, Any] | None:
    slab = run.plan.slab
    point = greatest_index(drawn.values, slab.span == span)
    if point is None:
        return None
    x, y, _ = slab.coordinates[point].tolist()
    return {
        "span": span + 1,
        "value": float(drawn.values[point]),
        "unit": UNIT,
        "x [m]": round(x, 6) + 0.0,
        "y [m]": round(y, 6) + 0.0,
        "time [s]": float(drawn.times[point]),
        "judged": "yes" if span in slab.judged_spans else "no",
    }


def _summary(run: RunSource, drawn: _Map, top: int | None, judged: BoolVector) -> str:
    if top is None:
        return "No acceleration is known."
    x, y, _ = run.plan.slab.coordinates[top].tolist()
    size = beside(float(drawn.values[top]), drawn.limit, Units.acceleration)
    part = "the judged slab" if judged.any() else "the slab"
    said = f"The {drawn.words} of {part} is {size} at {_place(x, y)}, t = {drawn.times[top]:.3f} s"
    if drawn.limit is None:
        return f"{said}. It is as computed: limits are for filtered accelerations."
    over = int(np.count_nonzero(drawn.values[judged] > drawn.limit))
    side = "within" if drawn.values[top] <= drawn.limit else "outside"
    return (
        f"{said}, {side} {quantity(drawn.limit, Units.acceleration)}; "
        f"{over} of {int(judged.sum())} judged points exceed it."
    )


def _waiting(run: RunSource) -> str:
    if run.committed == 0:
        return "No step has been computed yet."
    if run.summary is None:
        return "The map is drawn when the run has been judged."
    return "This run was stored before maps were: compute it again to see one."


def _place(x: float, y: float) -> str:
    return f"x = {coordinate(x, 1)} m, y = {coordinate(y, 2)} m"


def _numbers(values: Matrix, figures: int) -> list[list[float | None]]:
    return [
        [float(f"{value:.{figures}g}") if np.isfinite(value) else None for value in row]
        for row in values.tolist()
    ]


def _has(run: RunSource) -> bool:
    """A slab that is one line of points, a plain beam's, makes no map."""
    if run.plan.modal or not run.plan.slab.span.size or SlabGrid.of(run.plan.slab).y.size < 2:
        return False
    return run.summary is None or run.slab_peaks() is not None


def _offers(run: RunSource, variant: str) -> bool:
    """A run that is not judged has nothing filtered."""
    peaks = run.slab_peaks()
    return variant == RAW.name or peaks is None or peaks.filtered is not None


KIND = FigureKind(
    name="slab-map",
    title="Greatest acceleration over the slab",
    group="slab",
    axis="position",
    draw=slab_map,
    has=_has,
    variants=(FILTERED, RAW),
    offers=_offers,
)
