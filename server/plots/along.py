"""Extremes along the axis of the track: of the deck's displacement, of its acceleration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from server.plots.curves import frames_in
from server.plots.request import FigureRequest
from server.plots.slab_grid import SlabGrid
from server.plots.source import PlanSource, RunSource
from solver.arrays import IntVector, Vector

__all__ = [
    "AccelerationAlong",
    "DisplacementAlong",
    "acceleration_along",
    "displacement_along",
]

MOST_FRAMES = 4000
"""Shapes that are read for one figure; a run has fewer."""
_SAME = 1e-6
_DECK = ("slab", "deck")


@dataclass(frozen=True, kw_only=True)
class DisplacementAlong:
    """Extremes of the deck's displacement, on its line nearest to the axis.

    Attributes:
        x: Ascending; where spans meet a place may come twice, shape (n,). [m]
        least: Shape (n,). [m]
        greatest: Shape (n,). [m]
        interval: Between the shapes that were looked at; 0 for fewer than two. [s]
    """

    x: Vector
    least: Vector
    greatest: Vector
    interval: float


@dataclass(frozen=True, kw_only=True)
class AccelerationAlong:
    """Greatest magnitude of the slab's acceleration over its width.

    Attributes:
        x: Ascending, shape (n,). [m]
        raw: As computed, shape (n,). [m/s2]
        filtered: After the verdict's filter, or None where nothing is judged. [m/s2]
    """

    x: Vector
    raw: Vector
    filtered: Vector | None


def displacement_along(run: RunSource, request: FigureRequest) -> DisplacementAlong | None:
    """Extremes over the stored shapes of the window; without one, from where peaks count.

    Returns:
        None where the run draws no deck or has no shape yet.
    """
    chosen = frames_in(run, _counted(run.plan, request), MOST_FRAMES)
    vertices = _axis_vertices(run.plan)
    if not len(chosen) or not vertices.size:
        return None
    heights = run.heights(vertices, chosen)
    interval = chosen.step * run.plan.frame_stride * run.plan.time_step
    return DisplacementAlong(
        x=run.plan.geometry.vertices[vertices, 0],
        least=heights.min(axis=0),
        greatest=heights.max(axis=0),
        interval=interval if len(chosen) > 1 else 0.0,
    )


def acceleration_along(run: RunSource) -> AccelerationAlong | None:
    """Greatest accelerations of the whole run; None while they are unknown."""
    peaks = run.slab_peaks()
    if peaks is None or not peaks.raw.size:
        return None
    grid = SlabGrid.of(run.plan.slab)

    def across(values: Vector) -> Vector:
        return np.nanmax(grid.values(values, grid.points(values)), axis=0)

    filtered = None if peaks.filtered is None else across(peaks.filtered)
    return AccelerationAlong(x=grid.x, raw=across(peaks.raw), filtered=filtered)


def _counted(plan: PlanSource, request: FigureRequest) -> FigureRequest:
    """The window asked for; where it has no beginning, from where peaks count."""
    start = plan.window_start
    if request.start is not None or (request.stop is not None and request.stop <= start):
        return request
    return FigureRequest(start=start, stop=request.stop)


def _axis_vertices(plan: PlanSource) -> IntVector:
    """Vertices of the deck's upper layer on its line nearest to the axis, along the track."""
    geometry = plan.geometry
    layers = [layer for layer in geometry.layers if layer.name in _DECK]
    if not layers:
        return np.empty(0, dtype=np.int64)
    used = np.unique(np.concatenate([layer.faces.ravel() for layer in layers]))
    across = geometry.vertices[used, 1]
    nearest = np.abs(across).min()
    # A strip has a left and a right edge at the same distance: the left one.
    lateral = across[np.abs(across) < nearest + _SAME].max()
    line = used[np.abs(across - lateral) < _SAME]
    return line[np.argsort(geometry.vertices[line, 0], kind="stable")]
