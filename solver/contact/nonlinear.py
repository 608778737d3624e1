"""The nonlinear Hertz contact of one step, F = K_h d^1.5 (equation 3.66).

Where the linear law leaves a linear complementarity problem, the nonlinear one leaves

    d + S F(d) = b,

d the compression of each contact (negative: the gap of an open one), S the effective compliance
between the contact points without the Hertz springs, b how far the wheels would enter the rail
without contact forces. F grows with d and S is symmetric positive semidefinite: there is exactly
one solution, so no status can chatter within a step and no step needs to be halved for it. It is
found by Newton's method with a line search on the residual; F has a continuous derivative, zero
where the contact opens, so the Jacobian I + S F' is never singular. The large factor is never
touched: an iteration is dense algebra of the number of wheels.

A contact that may pull (``unilateral`` false) follows the odd continuation F = K_h |d|^0.5 d.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import BoolVector, Matrix, Vector
from solver.contact.laws import NonlinearHertz
from solver.errors import ConvergenceError, SingularSystemError

__all__ = ["HertzSolution", "contact_force", "contact_stiffness", "solve_hertz"]

_FORCE_TOLERANCE = 1e-10
"""Residual of a wheel over its static load. The rules ask for 1e-4 of it, and 1e-6 of the whole
load (modelling decision "Contact"); Newton's last iteration gives the rest for nothing, and the
order of the time integration is then not hidden by it."""
_GAP_TOLERANCE = 1e-12
"""Residual of the compression; the rules ask for 1e-9. [m]"""
_ROUNDING = 1e-14
"""Relative residual below which only rounding is left."""
_MOST_ITERATIONS = 60
"""A touchdown from far away needs about ten."""
_MOST_HALVINGS = 40


@dataclass(frozen=True, kw_only=True)
class HertzSolution:
    """Contact at the end of a step.

    Attributes:
        forces: Shape (n_wheel,). [N]
        compression: d, negative where the contact is open, shape (n_wheel,). [m]
        closed: Which wheels touch, shape (n_wheel,).
        iterations: Newton iterations.
    """

    forces: Vector
    compression: Vector
    closed: BoolVector
    iterations: int


def contact_force(law: NonlinearHertz, compression: Vector, unilateral: bool) -> Vector:
    """F(d). [N]"""
    effective = np.maximum(compression, 0.0) if unilateral else compression
    return law.coefficient * np.sqrt(np.abs(effective)) * effective


def contact_stiffness(law: NonlinearHertz, compression: Vector, unilateral: bool) -> Vector:
    """dF/dd (equation 3.69). [N/m]"""
    effective = np.maximum(compression, 0.0) if unilateral else compression
    return 1.5 * law.coefficient * np.sqrt(np.abs(effective))


def solve_hertz(
    compliance: Matrix,
    approach: Vector,
    law: NonlinearHertz,
    compression: Vector,
    unilateral: bool,
    time: float = 0.0,
) -> HertzSolution:
    """Contact forces and compressions at the end of a step.

    Args:
        compliance: S, shape (n_wheel, n_wheel). [m/N]
        approach: b, shape (n_wheel,). [m]
        law: The contact law.
        compression: The last step's d, the first guess, shape (n_wheel,). [m]
        unilateral: Whether contact may open; if not, forces may be tension.
        time: At the end of the step, for the error message. [s]

    Raises:
        SingularSystemError: The compliance is not positive semidefinite, or no number.
        ConvergenceError: Newton's method did not settle, which only rounding can bring about.
    """
    d = np.array(compression)
    residual = _residual(compliance, approach, law, d, unilateral)
    open_before = d <= 0.0
    for iteration in range(1, _MOST_ITERATIONS + 1):
        d, residual = _newton_step(compliance, approach, law, d, residual, unilateral)
        is_open = d <= 0.0
        if _settled(law, d, residual, approach, unilateral) and (is_open == open_before).all():
            closed = ~is_open if unilateral else np.ones_like(is_open)
            forces = contact_force(law, d, unilateral)
            return HertzSolution(forces=forces, compression=d, closed=closed, iterations=iteration)
        open_before = is_open
    force_residual = contact_stiffness(law, d, unilateral) * np.abs(residual)
    wheel = int(np.argmax(force_residual))
    raise ConvergenceError(time, f"wheel {wheel + 1}", float(force_residual[wheel]))


def _residual(
    compliance: Matrix, approach: Vector, law: NonlinearHertz, d: Vector, unilateral: bool
) -> Vector:
    return d + compliance @ contact_force(law, d, unilateral) - approach


def _newton_step(
    compliance: Matrix,
    approach: Vector,
    law: NonlinearHertz,
    d: Vector,
    residual: Vector,
    unilateral: bool,
) -> tuple[Vector, Vector]:
    """The next compression and its residual, the step halved until the residual falls."""
    jacobian = compliance * contact_stiffness(law, d, unilateral)
    jacobian[np.diag_indices_from(jacobian)] += 1.0
    try:
        change = -np.linalg.solve(jacobian, residual)
    except np.linalg.LinAlgError as error:
        raise SingularSystemError("the contact", "its compliance is not positive") from error
    if not np.isfinite(change).all():
        raise SingularSystemError("the contact", "its compliance is not a finite number")
    norm = np.linalg.norm(residual)
    rounding = _ROUNDING * np.linalg.norm(approach)
    length = 1.0
    for _ in range(_MOST_HALVINGS):
        trial = d + length * change
        found = _residual(compliance, approach, law, trial, unilateral)
        # Newton's direction lowers the norm at first by the share of the step that is taken.
        if np.linalg.norm(found) <= (1.0 - 1e-4 * length) * norm + rounding:
            return trial, found
        length *= 0.5
    return d, residual


def _settled(
    law: NonlinearHertz, d: Vector, residual: Vector, approach: Vector, unilateral: bool
) -> bool:
    """Whether the residual is small as a force and as a length, or only rounding is left."""
    size = np.abs(residual)
    if size.max(initial=0.0) <= _ROUNDING * np.abs(approach).max(initial=0.0):
        return True
    force = contact_stiffness(law, d, unilateral) * size
    small_force = force.max(initial=0.0) <= _FORCE_TOLERANCE * law.reference_force
    return bool(small_force and size.max(initial=0.0) <= _GAP_TOLERANCE)
