"""Integrates a crossing between the instants at which something enters or leaves a span.

At these instants the equations have kinks; a Runge-Kutta method of order 8 keeps its order only if
it starts afresh there.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solver.errors import ConvergenceError

__all__ = ["crossing_instants", "integrate", "piece_edges"]

_Array = NDArray[np.float64]

RELATIVE_TOLERANCE = 1e-10
ABSOLUTE_TOLERANCE = 1e-13


def crossing_instants(offsets: _Array, joints: _Array, speed: float, start: float) -> _Array:
    """When each load passes each end of a span.

    Args:
        offsets: Shape (n_load,): x of each load minus x of the first. [m]
        joints: Shape (n_span + 1,): ends of the spans. [m]
        speed: [m/s]
        start: x of the first load at t = 0. [m]

    Returns:
        Sorted instants, each once. [s]
    """
    return np.unique((joints[:, None] - start - offsets[None, :]).ravel() / speed)


def piece_edges(times: _Array, instants: _Array) -> _Array:
    """Ends of the smooth pieces: the first and last time and the instants between.

    Args:
        times: Shape (n_step,): ascending. [s]
        instants: Sorted instants of the kinks. [s]

    Returns:
        Shape (n_piece + 1,). [s]
    """
    inner = instants[(instants > times[0]) & (instants < times[-1])]
    return np.concatenate([times[:1], inner, times[-1:]])


def integrate(
    rate: Callable[[float, float, _Array], _Array],
    initial: _Array,
    times: _Array,
    instants: _Array,
    max_step: float,
) -> _Array:
    """Solves y' = f(t, y) with DOP853, piece by piece.

    Args:
        rate: Called with t, an instant inside the present piece, and y. The second tells on which
            side of a kink t = instant stands.
        initial: Shape (n_state,): y at the first of the times.
        times: Shape (n_step,): ascending, at which y is returned. [s]
        instants: Sorted instants of the kinks. [s]
        max_step: So short that no irregularity is stepped over. [s]

    Returns:
        Shape (n_step, n_state). At a kink, y is continuous.

    Raises:
        ConvergenceError: The integrator gave up.
    """
    edges = piece_edges(times, instants)
    states = np.empty((len(times), len(initial)))
    states[0] = state = initial
    for begin, end in pairwise(edges):
        wanted = (times > begin) & (times <= end)
        middle = 0.5 * (begin + end)
        solution: Any = solve_ivp(
            lambda t, y, middle=middle: rate(t, middle, y),
            (begin, end),
            state,
            method="DOP853",
            t_eval=np.append(times[wanted & (times < end)], end),
            rtol=RELATIVE_TOLERANCE,
            atol=ABSOLUTE_TOLERANCE,
            max_step=max_step,
        )
        if not solution.success:
            raise ConvergenceError(float(solution.t[-1]), "reference solution", float("nan"))
        state = solution.y[:, -1]
        found = solution.y.T if times[wanted][-1:] == [end] else solution.y.T[:-1]
        states[wanted] = found
    return states
