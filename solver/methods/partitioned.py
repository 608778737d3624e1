"""What the iterative, penalty and condensation methods share.

All three are for bilateral contact, a linear contact law and a prescribed speed. The path is then
straight, so that the wheels' rows along its normal do not change, and the vehicle reduces once and
for all to a law between the elevation of the surface under its wheels and the contact forces.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg as dense
import scipy.sparse as sparse

from solver.arrays import FloatArray, IntVector, Matrix, SparseMatrix, Vector
from solver.assembly.rows import Rows
from solver.contact.laws import LinearHertz, NonlinearHertz
from solver.errors import InputError, SingularSystemError
from solver.factorisation import Factorisation, factorise
from solver.factorisation.positive import positive_inverse
from solver.integrators.hht import HHT
from solver.methods.border import Border, Borders
from solver.methods.problem import PrescribedSpeed, Problem
from solver.methods.stacked import Stacked
from solver.methods.step import StepEquations

__all__ = [
    "CondensedVehicle",
    "EffectiveParts",
    "contact_flexibility",
    "effective_factorisation",
    "known_elevation",
    "require_bilateral",
]

_SMALL = 300
"""Unknowns below which dense algebra is faster than any sparse factor."""


def require_bilateral(problem: Problem, method: str) -> None:
    """Refuses what only the direct method can do.

    Args:
        problem: The problem.
        method: Name of the method, for the message.

    Raises:
        InputError: Contact that may open, Hertz's nonlinear law, free drive, nonlinear elements.
    """
    refused: list[tuple[str, Any, str, bool]] = [
        ("unilateral", True, "lets wheels leave the path", problem.unilateral),
        ("law", type(problem.law).__name__, "is nonlinear", _is_nonlinear(problem)),
        ("drive", "free", "makes the wheels' places unknown",
         not isinstance(problem.drive, PrescribedSpeed)),
        ("nonlinear", True, "makes the stiffness depend on the displacements",
         any(part.nonlinear is not None for part in (problem.structure, problem.vehicle))),
    ]  # fmt: skip
    for field, value, reason, applies in refused:
        if applies:
            raise InputError(
                field, value, f"{reason}, which the {method} method cannot follow",
                "Use the direct method, or bilateral linear contact at a prescribed speed.",
            )  # fmt: skip


def _is_nonlinear(problem: Problem) -> bool:
    return isinstance(problem.law, NonlinearHertz)


def contact_flexibility(problem: Problem) -> float:
    """1 / k_h of the contact law, 0 for rigid contact. [m/N]"""
    return 1.0 / problem.law.stiffness if isinstance(problem.law, LinearHertz) else 0.0


def known_elevation(stacked: Stacked, border: Border, step: StepEquations) -> Vector:
    """r less what the prescribed freedoms contribute to H a, shape (n_wheel,). [m]"""
    if not stacked.supports_move:
        return border.elevation
    supports = stacked.whole(np.zeros(stacked.free.size), step.supports[0])
    return border.elevation - border.h.dot(supports)


class _DenseFactorisation:
    """Cholesky factor of a small matrix; see ``solver.factorisation.sparse`` for the contract."""

    def __init__(self, matrix: SparseMatrix, part: str) -> None:
        try:
            self._factor = dense.cho_factor(matrix.toarray())
        except dense.LinAlgError as error:
            raise SingularSystemError(part, "its stiffness is not positive definite") from error

    def solve(self, load: FloatArray) -> FloatArray:
        """Solution for one load or several."""
        return dense.cho_solve(self._factor, load)


def effective_factorisation(matrix: SparseMatrix, part: str) -> Factorisation:
    """Factorises an effective matrix, small ones densely.

    Raises:
        SingularSystemError: It is not positive definite.
    """
    kind = _DenseFactorisation if matrix.shape[0] <= _SMALL else factorise
    return kind(sparse.csr_array(matrix), part)


class EffectiveParts:
    """The effective matrix of (4.18), split into the structure's and the vehicle's.

    Attributes:
        factor: 1 + alpha, the weight of the contact forces.
        structure: Positions of the structure's freedoms in F. vehicle: Of the vehicle's.
        structure_matrix: Effective matrix of the structure.
        vehicle_matrix: Effective matrix of the vehicle.
    """

    def __init__(self, stacked: Stacked, method: HHT) -> None:
        self.factor = method.force_factor
        effective = stacked.effective(method)
        n_structure = int(np.count_nonzero(stacked.free < stacked.n_structure))
        self.structure: IntVector = np.arange(n_structure)
        self.vehicle: IntVector = np.arange(n_structure, stacked.free.size)
        self.structure_matrix = sparse.csr_array(effective[:n_structure, :n_structure])
        self.vehicle_matrix = sparse.csr_array(effective[n_structure:, n_structure:])
        on_free = stacked.free_position(np.arange(stacked.n_dof))
        self._on_structure = np.where(on_free < n_structure, on_free, -1)
        self._on_vehicle = np.where(on_free < n_structure, -1, on_free - n_structure)

    def path_rows(self, border: Border) -> Rows:
        """H^te over the structure's free freedoms, shape (n_wheel, n_structure)."""
        return border.rest.scaled(-1.0).renumbered(self._on_structure, self.structure.size)

    def wheel_rows(self, border: Border) -> Rows:
        """H^ce over the vehicle's free freedoms, shape (n_wheel, n_vehicle)."""
        return border.wheel.renumbered(self._on_vehicle, self.vehicle.size)


class CondensedVehicle:
    """The vehicle as its wheels feel it, all its freedoms condensed on the contact.

    Within a step, with u the deflection of the path and r its elevation under the wheels, the
    vehicle's effective equations and the constraint (a linear Hertz spring included) give

        X = S (u + r - b),   S = [(1 + alpha) H^ce K^-1 H^ce' + I / k_h]^-1,   b = H^ce K^-1 F,

    K and F the vehicle's effective matrix and load. Where the wheels' displacements are freedoms
    of the vehicle and contact is rigid, (1 + alpha) S is K_XX - K_XI K_II^-1 K_IX: equations 2.33
    and 2.34 in one.

    Args:
        stacked: Matrices.
        borders: Contact rows.
        parts: Effective matrices.

    Attributes:
        stiffness: S, shape (n_wheel, n_wheel). [N/m]

    Raises:
        SingularSystemError: The vehicle's effective matrix is singular, or two wheels share a
            freedom.
    """

    def __init__(self, stacked: Stacked, borders: Borders, parts: EffectiveParts) -> None:
        wheels = stacked.problem.wheels
        start = borders.at(0.0, np.zeros(stacked.n_dof), wheels.chainage)
        self._factor = parts.factor
        self._rows = parts.wheel_rows(start)
        solver = effective_factorisation(parts.vehicle_matrix, "the vehicle")
        self._solver = solver
        self._mobility: Matrix = solver.solve(np.ascontiguousarray(self._rows.dense().T))
        self.flexibility = parts.factor * self._rows.times(self._mobility)
        self.flexibility = 0.5 * (self.flexibility + self.flexibility.T)
        self.flexibility += contact_flexibility(stacked.problem) * np.eye(wheels.count)
        self.stiffness = positive_inverse(self.flexibility, "the contact")
        self._free = np.zeros(parts.vehicle.size)

    def begin(self, load: Vector) -> Vector:
        """b for a step's effective load of the vehicle, shape (n_wheel,). [m]"""
        self._free = self._solver.solve(load)
        return self._rows.dot(self._free)

    def finish(self, forces: Vector) -> Vector:
        """The vehicle's displacements for contact forces; follows ``begin``."""
        return self._free + self._factor * (self._mobility @ forces)
