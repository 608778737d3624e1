"""Which wheels touch: the unilateral contact problem of one step.

With a linear contact law the step's contact is a linear complementarity problem in the small
compliance matrix of the contact points,

    X >= 0,   s = S X - b >= 0,   X's = 0,

X the contact forces, s the gaps (zero where there is contact). S is symmetric positive definite,
hence there is exactly one solution: no status can chatter, and the large factor is never touched.
Block principal pivoting (Judice and Pires, 1994) flips all wrong pairs at once; where that stops
making progress, Murty's rule (only the last wrong pair) is certain to end.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import BoolVector, Matrix, Vector
from solver.errors import ConvergenceError
from solver.factorisation.positive import positive_solve

__all__ = ["contact_forces", "solve_contact"]

_BLOCK_TRIES = 10
"""Blocks flipped without progress before Murty's rule takes over."""
_MOST_SOLVES = 10_000
"""Far beyond what any order of flips needs: only rounding could keep the search from ending."""


def solve_contact(
    compliance: Matrix,
    approach: Vector,
    closed: BoolVector,
    unilateral: bool,
    time: float = 0.0,
) -> tuple[Vector, BoolVector, int]:
    """Contact forces and statuses at the end of a step.

    Args:
        compliance: S, the effective compliance between contact points, shape
            (n_wheel, n_wheel). [m/N]
        approach: b, how far the wheels would enter the rail without contact forces, shape
            (n_wheel,). [m]
        closed: Which wheels touched at the last step, the first guess, shape (n_wheel,).
        unilateral: Whether contact may open; if not, forces may be tension.
        time: At the end of the step, for the error message. [s]

    Returns:
        Contact forces [N], which wheels touch, number of small solves.

    Raises:
        SingularSystemError: The compliance is not positive definite.
        ConvergenceError: No set of touching wheels fits, which only rounding can bring about.
    """
    if not unilateral:
        everywhere = np.ones_like(closed)
        return contact_forces(compliance, approach, everywhere), everywhere, 1
    closed = closed.copy()
    fewest_wrong, tries, solves = approach.size + 1, _BLOCK_TRIES, 0
    while True:
        forces = contact_forces(compliance, approach, closed)
        solves += 1
        wrong = _wrong(compliance, approach, forces, closed)
        if solves >= _MOST_SOLVES:
            wheel = int(np.argmax(wrong))
            raise ConvergenceError(time, f"wheel {wheel + 1}", float(forces[wheel]))
        n_wrong = int(np.count_nonzero(wrong))
        if n_wrong == 0:
            return forces, closed, solves
        if n_wrong < fewest_wrong:
            fewest_wrong, tries = n_wrong, _BLOCK_TRIES
            closed ^= wrong
        elif tries > 0:
            tries -= 1
            closed ^= wrong
        else:
            last = np.flatnonzero(wrong)[-1]
            closed[last] = not closed[last]


def _wrong(compliance: Matrix, approach: Vector, forces: Vector, closed: BoolVector) -> BoolVector:
    """Touching wheels in tension and open wheels inside the rail, beyond rounding."""
    wrong = closed & (forces < -1e-12 * np.abs(forces).max(initial=0.0))
    if not closed.all():
        gaps = compliance @ forces - approach
        wrong |= ~closed & (gaps < -1e-13 * np.abs(approach).max(initial=0.0))
    return wrong


def contact_forces(compliance: Matrix, approach: Vector, closed: BoolVector) -> Vector:
    """Forces with the given wheels touching.

    Raises:
        SingularSystemError: The compliance is not positive definite: rigid wheels share a load
            in a way that nothing decides.
    """
    forces = np.zeros_like(approach)
    index = np.flatnonzero(closed)
    inner = compliance if closed.all() else compliance[np.ix_(index, index)]
    forces[index] = positive_solve(
        inner, approach[index], "the contact (rigid wheels under one rigid body need a spring)"
    )
    return forces
