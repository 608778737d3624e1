"""What the viewer reads of a run: a protocol that ``server.store.RunReader`` fulfils."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Collection, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from server.store.reader import Motion, RunReader
from solver.arrays import Matrix, Vector
from solver.results import Frame, RunPlan, SlabPeaks

__all__ = ["FrameSource", "StoppedRun", "WheelHistory"]


class FrameSource(Protocol):
    """Committed samples and frames of one run, finished or still running."""

    @property
    def identity(self) -> str:
        """Differs between attempts at a run."""
        ...

    @property
    def plan(self) -> RunPlan:
        """What was known before the first step."""
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
    def done(self) -> bool:
        """Whether no more frames will come."""
        ...

    @property
    def summary(self) -> Mapping[str, Any] | None:
        """Once the run has ended; names the modes of a modal one."""
        ...

    def frame(self, index: int, *, motion: Collection[Motion] = ...) -> Frame:
        """Displaced state of one frame, with those of velocity and acceleration that are asked."""
        ...

    def channel_rows(self, names: Sequence[str], start: int, stop: int) -> Matrix:
        """Samples ``start`` to ``stop`` of some channels, shape (n_sample, n_name)."""
        ...

    def slab_peaks(self) -> SlabPeaks | None:
        """Greatest |acceleration| of every slab point, once the run has ended."""
        ...


class StoppedRun(RunReader):
    """What a run left that failed, was cancelled or ran out of time: no more will come."""

    @property
    def identity(self) -> str:
        """Not that of the same attempt while it computed."""
        return f"{super().identity} stopped"

    @property
    def done(self) -> bool:
        """Always."""
        return True


class WheelHistory:
    """Displacements and contact forces of the wheels at the frames' steps.

    Channels lie on disk in long chunks, so that one row costs as much as a block of rows. Blocks
    are read once and only their rows at frames are kept; the last one grows with a running run.
    """

    BLOCK = 2000
    """Samples read at once: one chunk of the store."""
    KEPT = 64
    """Blocks kept; with a frame every 16 steps and 92 wheels about 12 MB."""

    def __init__(self, source: FrameSource) -> None:
        self._source = source
        wheels = source.plan.geometry.wheels
        recorded = {channel.name for channel in source.plan.channels}
        self._n_wheel = len(wheels.names)
        self._displacements = _recorded(wheels.names, "displacement", recorded)
        self._forces = _recorded(wheels.names, "contact force", recorded)
        self._frames_per_block = max(1, self.BLOCK // source.plan.frame_stride)
        self._blocks: OrderedDict[int, Matrix] = OrderedDict()

    def at_step(self, step: int) -> tuple[Vector, Vector]:
        """The wheels at one step.

        Args:
            step: A committed time step at which a frame is stored.

        Returns:
            Upward displacements of the contact points, shape (n_wheel,) [m], and contact forces,
            shape (n_wheel,), infinite where no force is recorded. [N]
        """
        displacement = np.zeros(self._n_wheel)
        force = np.full(self._n_wheel, np.inf)
        names = [*self._displacements.values(), *self._forces.values()]
        if names:
            row = self._row(names, step)
            displacement[list(self._displacements)] = row[: len(self._displacements)]
            force[list(self._forces)] = row[len(self._displacements) :]
        return displacement, force

    def _row(self, names: Sequence[str], step: int) -> Vector:
        every = self._source.plan.frame_stride
        index, row = divmod(step // every, self._frames_per_block)
        rows = self._blocks.get(index, np.empty((0, len(names))))
        if row >= len(rows):
            first = (index * self._frames_per_block + len(rows)) * every
            last = min((index + 1) * self._frames_per_block * every, self._source.committed)
            fresh = self._source.channel_rows(names, first, last)[::every]
            rows = self._blocks[index] = np.concatenate((rows, fresh))
            if len(self._blocks) > self.KEPT:
                self._blocks.popitem(last=False)
        self._blocks.move_to_end(index)
        return rows[row]


def _recorded(wheels: Sequence[str], quantity: str, recorded: set[str]) -> dict[int, str]:
    """Index of each wheel whose quantity is recorded, to the channel's name."""
    names = {index: f"{wheel}/{quantity}" for index, wheel in enumerate(wheels)}
    return {index: name for index, name in names.items() if name in recorded}
