"""What a figure reads from a run, and no more.

``server.store.RunReader`` satisfies these protocols while the run is being written and after it; a
test satisfies them with arrays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from solver.arrays import Vector
from solver.results import ChannelSpec, SlabPoints

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
    def time_step(self) -> float:
        """Time between two samples. [s]"""
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
    def summary(self) -> Mapping[str, Any] | None:
        """Present once the run is finished; ``filtered`` lists the filtered histories."""
        ...

    def channel(self, name: str, start: int = 0, stop: int | None = None) -> Vector:
        """Samples ``start`` to ``stop`` of one channel, SI."""
        ...

    def filtered(self, name: str) -> Vector:
        """The whole low-pass filtered history of one channel, SI."""
        ...
