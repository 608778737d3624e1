"""What a figure reads from a run, and no more.

``server.store.RunReader`` satisfies these protocols while the run is being written and after it; a
test satisfies them with arrays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from solver.arrays import IntVector, Matrix, Vector
from solver.results import ChannelSpec, Geometry, SlabPeaks, SlabPoints

__all__ = ["PlanSource", "RunSource"]


class PlanSource(Protocol):
    """What is known of a run before its first step."""

    @property
    def channels(self) -> Sequence[ChannelSpec]:
        """The recorded channels."""
        ...

    @property
    def slab(self) -> SlabPoints:
        """The judged points."""
        ...

    @property
    def geometry(self) -> Geometry:
        """What is drawn in three dimensions."""
        ...

    @property
    def modal(self) -> bool:
        """Whether samples are modes instead of instants: such a run has no histories."""
        ...

    @property
    def time_step(self) -> float:
        """Time between two samples. [s]"""
        ...

    @property
    def frame_stride(self) -> int:
        """Steps between two frames."""
        ...

    @property
    def n_sample(self) -> int:
        """Samples of the whole run, the static start included."""
        ...

    @property
    def speed(self) -> float:
        """Speed of the train. [m/s]"""
        ...

    @property
    def start_position(self) -> float:
        """x of the first axle at t = 0. [m]"""
        ...

    @property
    def window_start(self) -> float:
        """Time from which peaks count. [s]"""
        ...

    @property
    def facts(self) -> Mapping[str, Any]:
        """Plain facts of the run."""
        ...


class RunSource(Protocol):
    """A run as far as it has come."""

    @property
    def plan(self) -> PlanSource:
        """What is known before the first step."""
        ...

    @property
    def committed(self) -> int:
        """Samples that may be read."""
        ...

    @property
    def committed_frames(self) -> int:
        """Frames that may be read."""
        ...

    @property
    def summary(self) -> Mapping[str, Any] | None:
        """Present once the run is finished; ``filtered`` lists the filtered histories."""
        ...

    def channel(self, name: str, start: int = 0, stop: int | None = None) -> Vector:
        """Samples ``start`` to ``stop`` of one channel, SI."""
        ...

    def filtered(self, name: str) -> Vector:
        """The whole low-pass filtered history of one channel, SI."""
        ...

    def slab_point(self, index: int, start: int = 0, stop: int | None = None) -> Vector:
        """Samples ``start`` to ``stop`` of one slab point's acceleration. [m/s2]"""
        ...

    def slab_peaks(self) -> SlabPeaks | None:
        """Greatest accelerations of the slab's points, once they are known."""
        ...

    def heights(self, vertices: IntVector, frames: range) -> Matrix:
        """Upward displacements in some frames, shape (n_frame, n_vertex). [m]"""
        ...
