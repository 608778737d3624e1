"""The greatest accelerations of the slab's points, raw and filtered, from blocks of histories."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from solver.arrays import IntVector, Matrix, Vector
from solver.errors import InputError, UnstableError
from solver.results import SlabPeaks
from solver.standards.low_pass import low_pass

__all__ = ["slab_peaks"]


def slab_peaks(
    blocks: Iterable[tuple[IntVector, Matrix]],
    *,
    n_point: int,
    times: Vector,
    window_start: float,
    cut_off: float | None,
) -> SlabPeaks:
    """Filters block by block and keeps each point's peak inside the window.

    Args:
        blocks: Pairs of point indices, shape (n_block,), and their raw accelerations, shape
            (n_step, n_block) [m/s2]; together they hold every point once, in any order.
        n_point: Number of points.
        times: Shape (n_step,): of the samples, evenly spaced. [s]
        window_start: Peaks count from this time: the first axle's arrival. [s]
        cut_off: Of the low-pass filter; None leaves the filtered peaks out. [Hz]

    Returns:
        The peaks.

    Raises:
        InputError: The blocks do not hold every point once, or no sample lies in the window.
        UnstableError: A history holds something that is not a number.
    """
    time_step, first = _window(times, window_start)
    raw, filtered = np.zeros((2, n_point)), np.zeros((2, n_point))
    seen = np.zeros(n_point, dtype=np.int64)
    for indices, history in blocks:
        _check_finite(history, times)
        seen[indices] += 1
        raw[:, indices] = _greatest(history[first:], times[first:])
        if cut_off is not None:
            smooth = low_pass(history, time_step, cut_off)
            filtered[:, indices] = _greatest(smooth[first:], times[first:])
    if np.any(seen != 1):
        raise InputError(
            "blocks",
            int(np.flatnonzero(seen != 1)[0]),
            "this slab point's history is missing or comes twice",
            "Hand every point over in exactly one block.",
        )
    return SlabPeaks(
        raw=raw[0],
        raw_time=raw[1],
        filtered=None if cut_off is None else filtered[0],
        filtered_time=None if cut_off is None else filtered[1],
    )


def _window(times: Vector, window_start: float) -> tuple[float, int]:
    """Time step, and the first sample that counts."""
    # Half a step of slack: a window that starts on a sample includes it in spite of rounding.
    time_step = float(times[-1] - times[0]) / max(len(times) - 1, 1)
    first = int(np.searchsorted(times, window_start - 0.5 * time_step))
    if len(times) < 2 or first >= len(times):
        raise InputError(
            "window_start",
            window_start,
            f"no sample lies in the window: the run ends at t = {times[-1]:.4g} s",
            "Let the run last until the train has crossed.",
        )
    return time_step, first


def _greatest(histories: Matrix, times: Vector) -> Matrix:
    """Greatest magnitude of each column and its time, shape (2, n_block)."""
    magnitude = np.abs(histories)
    step = np.argmax(magnitude, axis=0)
    return np.array([magnitude[step, np.arange(step.size)], times[step]])


def _check_finite(history: Matrix, times: Vector) -> None:
    """A history with NaN has no peak: its verdict would read as within the limit."""
    finite = np.all(np.isfinite(history), axis=1)
    if not np.all(finite):
        raise UnstableError(float(times[int(np.argmin(finite))]), "the slab acceleration")
