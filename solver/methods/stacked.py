"""Structure and vehicle stacked, split into free (F) and prescribed (P) freedoms (4.4 to 4.6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from solver.arrays import IntVector, Matrix, SparseMatrix, Vector
from solver.integrators.hht import HHT
from solver.methods.problem import Problem
from solver.models.subsystem import NonlinearElements

__all__ = ["NonlinearPart", "Stacked"]


@dataclass(frozen=True, kw_only=True)
class NonlinearPart:
    """Nonlinear elements of one subsystem, by free freedoms of the stack.

    Attributes:
        freedoms: Shape (n,).
        elements: Their law.
    """

    freedoms: IntVector
    elements: NonlinearElements

    def force(self, free: Vector) -> Vector:
        """Internal force on ``freedoms`` for the displacements of all free freedoms."""
        return self.elements.force(free[self.freedoms])

    def tangent(self, free: Vector) -> Matrix:
        """Its derivative."""
        return self.elements.tangent(free[self.freedoms])


class Stacked:
    """One set of matrices for both subsystems.

    Attributes:
        n_structure: Freedoms of the structure; they come first.
        n_dof: Freedoms of both.
        free: F freedoms, ascending. prescribed: P freedoms, the structure's then the vehicle's.
        mass, damping, stiffness: Over all freedoms.
        mass_ff, damping_ff, stiffness_ff, mass_fp, damping_fp, stiffness_fp: Their parts.
        mass_p, damping_p, stiffness_p: Rows of the P freedoms, over all freedoms.
        nonlinear: Elements beyond the matrices.
    """

    def __init__(self, problem: Problem) -> None:
        structure, vehicle = problem.structure, problem.vehicle
        self.problem = problem
        self.n_structure = structure.n_dof
        self.n_dof = structure.n_dof + vehicle.n_dof
        self.prescribed = np.concatenate(
            [structure.prescribed, vehicle.prescribed + self.n_structure]
        ).astype(np.int64)
        is_free = np.ones(self.n_dof, dtype=bool)
        is_free[self.prescribed] = False
        self.free = np.flatnonzero(is_free)
        self._position = np.full(self.n_dof, -1)
        self._position[self.free] = np.arange(self.free.size)
        self.mass = _stack(structure.mass, vehicle.mass)
        self.damping = _stack(structure.damping, vehicle.damping)
        self.stiffness = _stack(structure.stiffness, vehicle.stiffness)
        self.mass_ff, self.mass_fp, self.mass_p = self._split(self.mass)
        self.damping_ff, self.damping_fp, self.damping_p = self._split(self.damping)
        self.stiffness_ff, self.stiffness_fp, self.stiffness_p = self._split(self.stiffness)
        self.nonlinear = [
            NonlinearPart(
                freedoms=self.free_position(part.nonlinear.freedoms + offset),
                elements=part.nonlinear,
            )
            for part, offset in ((structure, 0), (vehicle, self.n_structure))
            if part.nonlinear is not None
        ]

    def _split(self, matrix: SparseMatrix) -> tuple[SparseMatrix, SparseMatrix, SparseMatrix]:
        """Parts FF and FP, and the rows of P."""
        rows = matrix[self.free]
        return (
            sparse.csr_array(rows[:, self.free]),
            sparse.csr_array(rows[:, self.prescribed]),
            sparse.csr_array(matrix[self.prescribed]),
        )

    def free_position(self, freedoms: IntVector) -> IntVector:
        """Positions among the free freedoms, -1 for prescribed ones."""
        return self._position[freedoms]

    def load(self, time: float) -> tuple[Vector, Vector]:
        """External forces on F and on P at a time. [N]"""
        problem = self.problem
        both = np.concatenate([problem.structure.load_at(time), problem.vehicle.load_at(time)])
        return both[self.free], both[self.prescribed]

    def support_motion(self, time: float) -> tuple[Vector, Vector, Vector]:
        """Displacement, velocity, acceleration of P at a time."""
        parts = [
            part.support_motion_at(time) for part in (self.problem.structure, self.problem.vehicle)
        ]
        return (
            np.concatenate([part[0] for part in parts]),
            np.concatenate([part[1] for part in parts]),
            np.concatenate([part[2] for part in parts]),
        )

    @property
    def supports_move(self) -> bool:
        """Whether any prescribed freedom moves."""
        parts = (self.problem.structure, self.problem.vehicle)
        return any(part.support_motion is not None for part in parts)

    def whole(self, free: Vector, prescribed: Vector) -> Vector:
        """All freedoms from F and P."""
        values = np.empty(self.n_dof)
        values[self.free] = free
        values[self.prescribed] = prescribed
        return values

    def effective(self, method: HHT) -> SparseMatrix:
        """Effective matrix of a step over F (4.18)."""
        internal = method.a1 * self.damping_ff + self.stiffness_ff
        return sparse.csr_array(method.a0 * self.mass_ff + method.force_factor * internal)

    def nonlinear_force(self, free: Vector) -> Vector:
        """Forces of the nonlinear elements on F, shape (n_F,). [N]"""
        total = np.zeros(free.size)
        for part in self.nonlinear:
            total[part.freedoms] += part.force(free)
        return total

    def linearised(self, free: Vector) -> tuple[SparseMatrix, Vector]:
        """Tangent stiffness over F at a state, and the force that it leaves at zero."""
        stiffness, offset = self.stiffness_ff, np.zeros(free.size)
        for part in self.nonlinear:
            tangent = part.tangent(free)
            row, column = np.meshgrid(part.freedoms, part.freedoms, indexing="ij")
            entries = (tangent.ravel(), (row.ravel(), column.ravel()))
            stiffness = stiffness + sparse.coo_array(entries, shape=stiffness.shape).tocsr()
            offset[part.freedoms] += part.force(free) - tangent @ free[part.freedoms]
        return sparse.csr_array(stiffness), offset


def _stack(first: SparseMatrix, second: SparseMatrix) -> SparseMatrix:
    return sparse.csr_array(sparse.block_diag([first, second], format="csr"))
