"""Condensation of the vehicle at the element level (section 2.4).

Each step condenses the vehicle's freedoms, its motion included, on the elements of the structure
that its wheels stand on: vehicle-bridge interaction elements,

    [K + (1 + alpha) H' S H] a = F - (1 + alpha) H' S (r - b),   X = S (H a + r - b),

H the path's rows, K and F the structure's effective matrix and load, S and b as in
``CondensedVehicle``. The sum has the structure's freedoms only, but changes as the wheels move: it
is factorised anew at every step. Nothing is iterated, and no wheel can leave the path.

References:
    Yang and Yau (1997); Yang and Wu (2001), for vehicles whose wheels are coupled: S is not
    diagonal then, and joins the elements under all wheels of a vehicle.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from solver.arrays import BoolVector
from solver.integrators.hht import HHT
from solver.methods.border import Borders
from solver.methods.contact_step import ContactSolution
from solver.methods.partitioned import (
    CondensedVehicle,
    EffectiveParts,
    effective_factorisation,
    known_elevation,
    require_bilateral,
)
from solver.methods.settings import StepState
from solver.methods.stacked import Stacked
from solver.methods.step import StepEquations

__all__ = ["CondensationContactSolver"]


class CondensationContactSolver:
    """Solves a step by condensation; a ``ContactSolver``.

    Args:
        stacked: Matrices.
        borders: Contact rows.
        method: The time integration with its step length.

    Raises:
        InputError: Contact that may open, a nonlinear law or free drive.
        SingularSystemError: The vehicle's effective matrix is singular.
    """

    def __init__(self, stacked: Stacked, borders: Borders, method: HHT) -> None:
        require_bilateral(stacked.problem, "condensation")
        self._stacked, self._borders = stacked, borders
        self._parts = EffectiveParts(stacked, method)
        self._vehicle = CondensedVehicle(stacked, borders, self._parts)
        # Exact zeros between wheels that no vehicle joins drop out here.
        self._spring = sparse.csr_array(self._vehicle.stiffness)

    def solve(
        self, step: StepEquations, state: StepState, keep_closed: BoolVector | None = None
    ) -> ContactSolution:
        """See ``ContactSolver``; one factorisation, no iterations."""
        parts, factor = self._parts, self._parts.factor
        whole = np.zeros(self._stacked.n_dof)
        border = self._borders.at(step.time, whole, state.chainage)
        rows = parts.path_rows(border)
        free = self._vehicle.begin(step.load[parts.vehicle])
        offset = known_elevation(self._stacked, border, step) - free
        added = rows.sparse()
        matrix = parts.structure_matrix + factor * (added.T @ self._spring @ added)
        solver = effective_factorisation(matrix, "the structure with the vehicle condensed")
        load = step.load[parts.structure] - factor * rows.transposed_dot(self._spring @ offset)
        structure = solver.solve(load)
        forces = self._spring @ (rows.dot(structure) + offset)
        displacement = np.concatenate([structure, self._vehicle.finish(forces)])
        return ContactSolution(
            displacement=displacement, forces=forces, closed=np.ones(forces.size, dtype=bool),
            border=border, iterations=1,
        )  # fmt: skip
