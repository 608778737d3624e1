"""From the dashboard's time to what is stored: a frame of a history, or the phase of a mode."""

from __future__ import annotations

import math

import numpy as np

from server.viewer.kinematics import nearest_frame
from server.viewer.source import FrameSource

__all__ = ["CYCLE", "Timeline"]

CYCLE = 1.0
"""A mode swings once in this time of the animation, whatever its frequency. [s]"""
_NOSE_BEYOND = 40.0
"""The opening moment has the train up to this far over the middle of the viaduct. [m]"""


class Timeline:
    """The times of one run, finished or still running.

    In a modal run frame k is the shape of mode k, and time only swings it, without end.

    Args:
        source: The run.
    """

    def __init__(self, source: FrameSource) -> None:
        self._source = source
        self.interval = source.plan.frame_stride * source.plan.time_step
        self.modal = source.plan.modal
        self._done = False

    @property
    def last(self) -> float:
        """Time of the last frame that can be shown, infinite for modes. [s]"""
        if self.modal:
            return math.inf
        return max(self._source.committed_frames - 1, 0) * self.interval

    @property
    def shown_last(self) -> float:
        """Where a slider ends: the last frame, or one cycle of a mode. [s]"""
        return CYCLE if self.modal else self.last

    @property
    def done(self) -> bool:
        """Whether no more frames will come; asked of the store until they do not."""
        self._done = self._done or self._source.done
        return self._done

    @property
    def modes(self) -> int:
        """How many modes can be shown; none in a history."""
        return self._source.committed_frames if self.modal else 0

    def frame(self, time: float, mode: int) -> tuple[int, float]:
        """What is shown at a time.

        Args:
            time: In the run, or of the animation. [s]
            mode: Counted from 0; without meaning in a history.

        Returns:
            The frame's index and what its shape is multiplied by: at time 0 a mode is fully
            deflected.
        """
        if self.modal:
            index = min(max(mode, 0), max(self.modes - 1, 0))
            return index, math.cos(2.0 * math.pi * math.fmod(time, CYCLE) / CYCLE)
        return nearest_frame(time, self.interval, self._source.committed_frames), 1.0

    def opening(self) -> float:
        """The train in the middle of the viaduct, if it has come that far. [s]"""
        plan, geometry = self._source.plan, self._source.plan.geometry
        if self.modal or not plan.speed:
            return 0.0
        centre = float(np.mean(geometry.spans)) if len(geometry.spans) else 0.0
        reach = min(_NOSE_BEYOND, float(-np.min(geometry.wheels.offsets, initial=0.0)))
        at = (centre + 0.5 * reach - plan.start_position) / plan.speed
        return min(max(at, 0.0), self.last)
