"""From a stored channel to the curve that is drawn: window, extremes, decimation, display unit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from server.plots.decimation import extreme_indices
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from solver.arrays import Vector
from solver.errors import InputError
from solver.results import ChannelSpec
from solver.units import Unit

__all__ = [
    "Curve",
    "Extreme",
    "channel_named",
    "few_on_one_path",
    "filtered_curve",
    "filtered_history",
    "frame_curve",
    "frames_in",
    "point_curve",
    "raw_curve",
]


_FEW = 4
"""Masses on one path of which all are drawn."""


@dataclass(frozen=True, kw_only=True)
class Extreme:
    """A value of a curve and when it occurs.

    Attributes:
        time: [s]
        value: In display units.
    """

    time: float
    value: float


@dataclass(frozen=True, kw_only=True)
class Curve:
    """A history inside the window, in display units, before decimation.

    Attributes:
        name: What the curve is called in legend and table.
        spec: The channel it came from.
        time: Shape (n,). [s]
        values: In display units, shape (n,).
    """

    name: str
    spec: ChannelSpec
    time: Vector
    values: Vector

    @property
    def unit(self) -> Unit:
        """Unit of the channel."""
        return self.spec.unit

    def minimum(self) -> Extreme | None:
        """The least value, absent while there is none."""
        return self._extreme(self.values)

    def maximum(self) -> Extreme | None:
        """The greatest value, absent while there is none."""
        return self._extreme(-self.values)

    def peak(self, since: float) -> Extreme | None:
        """The value of greatest magnitude from a time on, absent while there is none."""
        counted = np.where(self.time >= since, -np.abs(self.values), np.nan)
        return self._extreme(counted)

    def decimated(self, points: int) -> tuple[list[float], list[float | None]]:
        """Time and values with at most ``points`` points, every extreme kept."""
        keep = extreme_indices(self.values, points)
        time = np.round(self.time[keep], 9)
        return time.tolist(), [_short(value) for value in self.values[keep].tolist()]

    def _extreme(self, key: Vector) -> Extreme | None:
        if not np.isfinite(key).any():
            return None
        index = int(np.nanargmin(key))
        return Extreme(time=float(self.time[index]), value=float(self.values[index]))


def channel_named(run: RunSource, name: str) -> ChannelSpec:
    """The channel of that name.

    Raises:
        InputError: The run has no such channel.
    """
    for spec in run.plan.channels:
        if spec.name == name:
            return spec
    raise InputError(
        "channels", name[:80], "is no channel of this run", "The run's channels list the names."
    )


def few_on_one_path(masses: Sequence[ChannelSpec]) -> Sequence[ChannelSpec]:
    """All of a few masses that follow one another; of more the first and the last, which differ
    most."""
    return masses if len(masses) <= _FEW else [masses[0], masses[-1]]


def raw_curve(
    run: RunSource, spec: ChannelSpec, request: FigureRequest, name: str | None = None
) -> Curve:
    """A channel as recorded, as far as the run has come."""
    start, stop = _window(run, spec, request)
    values = run.channel(spec.name, start, stop)
    return _curve(run, spec, name or spec.title, start, values)


def filtered_curve(
    run: RunSource, spec: ChannelSpec, stored: str, request: FigureRequest, name: str
) -> Curve:
    """A low-pass filtered history of a finished run, stored beside the channel."""
    return filtered_history(run, spec, run.filtered(stored), request, name)


def point_curve(
    run: RunSource, spec: ChannelSpec, index: int, request: FigureRequest, name: str
) -> Curve:
    """The acceleration of one of the slab's points, as computed."""
    start, stop = _window(run, spec, request)
    return _curve(run, spec, name, start, run.slab_point(index, start, stop))


def filtered_history(
    run: RunSource, spec: ChannelSpec, values: Vector, request: FigureRequest, name: str
) -> Curve:
    """The window's part of a history that was filtered as a whole."""
    start, stop = _window(run, spec, request)
    return _curve(run, spec, name, start, values[start:stop])


def frame_curve(
    run: RunSource, spec: ChannelSpec, vertex: int, request: FigureRequest, name: str
) -> Curve:
    """The height of one vertex above where it rests, in every stored shape of the window.

    No more shapes are read than a curve has points.
    """
    chosen = frames_in(run, request, request.points)
    heights = run.heights(np.array([vertex]), chosen)[:, 0]
    time = np.asarray(chosen, dtype=np.float64) * (run.plan.frame_stride * run.plan.time_step)
    return Curve(name=name, spec=spec, time=time, values=heights * spec.unit.scale)


def frames_in(run: RunSource, request: FigureRequest, most: int) -> range:
    """Indices of the stored shapes in the window, every k-th where there are more than asked for.

    Args:
        run: The run.
        request: The window.
        most: How many indices at most.
    """
    interval, last = run.plan.frame_stride * run.plan.time_step, run.committed_frames
    first = 0
    if request.start is not None:
        first = int(np.clip(np.floor(request.start / interval), 0, last))
    if request.stop is not None:
        last = int(np.clip(np.ceil(request.stop / interval) + 1, first, last))
    return range(first, last, max(1, -(-(last - first) // most)))


def _window(run: RunSource, spec: ChannelSpec, request: FigureRequest) -> tuple[int, int]:
    """Sample indices of the window, one sample beyond each end so that lines reach the edge."""
    step, offset, last = run.plan.time_step, spec.time_offset, run.committed

    def index_of(time: float) -> int:
        return int(np.clip(np.floor((time - offset) / step), -1, last))

    start = 0 if request.start is None else max(index_of(request.start), 0)
    stop = last if request.stop is None else min(index_of(request.stop) + 2, last)
    return start, max(start, stop)


def _curve(run: RunSource, spec: ChannelSpec, name: str, start: int, values: Vector) -> Curve:
    steps = np.arange(start, start + values.size, dtype=np.float64)
    time = steps * run.plan.time_step + spec.time_offset
    return Curve(name=name, spec=spec, time=time, values=values * spec.unit.scale)


def _short(value: float) -> float | None:
    """Seven figures are more than a screen can show; JSON has no not-a-number."""
    return float(f"{value:.7g}") if np.isfinite(value) else None
