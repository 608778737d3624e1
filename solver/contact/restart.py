"""Restart of the rigid law after an event: impulse first, then accelerations and forces.

Rigid contact of a wheel that has mass is a constraint of index three: a kink of the path or a
change of status leaves a velocity that contradicts the constraint, and Newmark's method then
answers with a force that alternates for ever. So velocities jump by the impulses J that make the
gaps' rates admissible, and forces X follow from the gaps' second derivatives:

    0 <= J  perpendicular to  g' + A (J - s) >= 0,        0 <= X  perpendicular to  g'' + A X >= 0,

A the compliance of the masses alone, H M^-1 H', and s the impulses that the step has already
spent on its contact forces. Both are the complementarity problem of ``solve_contact``: a wheel
is let go only if it separates, or if its force still is tension once velocities are in order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import BoolVector, Matrix, Vector
from solver.contact.complementarity import contact_forces, solve_contact

__all__ = ["Impulses", "force_ripple", "restart_forces", "restart_impulses"]


@dataclass(frozen=True, kw_only=True)
class Impulses:
    """What makes the velocities admissible.

    Attributes:
        change: Impulses to apply now, J - s where the wheel touches, 0 elsewhere, shape
            (n_wheel,). [N s]
        total: J, shape (n_wheel,). [N s]
        closed: Which wheels touch after it.
        solves: Small solves.
    """

    change: Vector
    total: Vector
    closed: BoolVector
    solves: int


def force_ripple(compliance: Matrix, gap_acceleration: Matrix) -> Matrix:
    """Amplitude of the alternating force that a constraint out of line would leave behind.

    Args:
        compliance: A, shape (n, n). [1/kg]
        gap_acceleration: Alternating part of g'', shape (n, n_case); a rate g' out of line
            gives g' / (gamma dt). [m/s2]

    Returns:
        |A^-1 g''|, shape (n, n_case). [N]
    """
    return np.abs(np.linalg.solve(compliance, gap_acceleration))


def restart_impulses(
    compliance: Matrix, gap_rate: Vector, spent: Vector, unilateral: bool, time: float = 0.0
) -> Impulses:
    """Impulses that make the rates of the gaps admissible.

    Args:
        compliance: A between the wheels in question, shape (n, n). [1/kg]
        gap_rate: g' as the step left it, shape (n,). [m/s]
        spent: s, impulses of the step's contact forces, shape (n,). [N s]
        unilateral: Whether contact may open.
        time: For error messages. [s]

    Raises:
        SingularSystemError: The compliance is not positive definite.
        ConvergenceError: No admissible impulses.
    """
    touching = np.ones(gap_rate.size, dtype=bool)
    if touching.size == 0:
        nothing = np.zeros_like(gap_rate)
        return Impulses(change=nothing, total=nothing, closed=touching, solves=0)
    total, closed, solves = solve_contact(
        compliance, compliance @ spent - gap_rate, touching, unilateral, time
    )
    # A wheel that separates keeps its velocity: what the step spent on it is not taken back.
    change = contact_forces(compliance, -gap_rate, closed)
    return Impulses(change=change, total=total, closed=closed, solves=solves + 1)


def restart_forces(
    compliance: Matrix,
    gap_acceleration: Vector,
    candidates: BoolVector,
    unilateral: bool,
    time: float = 0.0,
) -> tuple[Vector, BoolVector, int]:
    """Contact forces from the second derivatives of the gaps.

    Args:
        compliance: A, shape (n, n). [1/kg]
        gap_acceleration: g'' without contact forces, shape (n,). [m/s2]
        candidates: Wheels whose gap and gap rate are zero, shape (n,).
        unilateral: Whether contact may open.
        time: For error messages. [s]

    Returns:
        Forces [N], which wheels touch, number of small solves.
    """
    forces, closed = np.zeros_like(gap_acceleration), np.zeros_like(candidates)
    index = np.flatnonzero(candidates)
    if index.size == 0:
        return forces, closed, 0
    forces[index], closed[index], solves = solve_contact(
        compliance[np.ix_(index, index)],
        -gap_acceleration[index],
        np.ones(index.size, dtype=bool),
        unilateral,
        time,
    )
    return forces, closed, solves
