"""The block solvers of appendices A and B, on top of the sparse back end.

Contract of both. The first block, the large one, is factorised **once**, when the object is made.
The other blocks may touch it only in an *interface* B declared then: its flexibility there,
C = (A_11^-1)_BB, is formed once, a dense matrix of the interface's size. Whatever changes later
(the wheels' places, contact statuses, tangents) changes only the small blocks, and costs small
dense algebra alone. A solution takes one ``forward`` and one ``backward`` pass over the factor,
whatever the number of Newton iterations between them.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg as dense
from scipy.linalg import lapack

from solver.arrays import FloatArray, IntVector, Matrix, SparseMatrix, Vector
from solver.assembly.rows import Rows
from solver.errors import SingularSystemError
from solver.factorisation.dense import DenseCondensation
from solver.factorisation.positive import positive_inverse, positive_solve
from solver.factorisation.sparse import condense

__all__ = ["FirstBlock", "ThreeBlockFactorisation", "TwoBlockFactorisation"]

_SMALL = 300
"""Unknowns below which dense algebra is faster than any sparse factor."""


class FirstBlock:
    """A_11, factorised once, and its flexibility C on the interface.

    Attributes:
        n_dof: Unknowns.
        flexibility: C, shape (n_B, n_B).
        complement: Its inverse.
        free: The interface's displacement under the load of the last ``forward``.

    Args:
        matrix: A_11, symmetric positive definite, shape (n_1, n_1).
        interface: Unknowns of A_11 that the other blocks touch, distinct.
        part: Name of the part, for the error message.

    Raises:
        SingularSystemError: A_11 is not positive definite.
    """

    def __init__(self, matrix: SparseMatrix, interface: IntVector, part: str) -> None:
        small = matrix.shape[0] <= _SMALL or interface.size == matrix.shape[0]
        self._condensed = (
            DenseCondensation(matrix, interface, part)
            if small
            else condense(matrix, interface, part)
        )
        self.complement = self._condensed.complement
        self.flexibility = positive_inverse(self.complement, part)
        self.n_dof = int(matrix.shape[0])
        self._reduced = np.zeros(interface.size)
        self.free = np.zeros(interface.size)

    @property
    def memory_bytes(self) -> int:
        """Memory of the factor and of the flexibility. [B]"""
        return self._condensed.memory_bytes + 2 * self.flexibility.nbytes

    def forward(self, load: Vector) -> Vector:
        """First pass: the interface's displacement under ``load`` alone, shape (n_B,)."""
        self._reduced = np.array(self._condensed.forward(load))
        self.free = self.flexibility @ self._reduced
        return self.free

    @property
    def reduced(self) -> Vector:
        """The load of ``forward`` condensed on the interface, shape (n_B,)."""
        return self._reduced

    def backward(self, interface: Vector) -> Vector:
        """Second pass: all unknowns, shape (n_1,), from the interface's."""
        return self._condensed.backward(interface)


class TwoBlockFactorisation(FirstBlock):
    """Appendix A: [A_11 A_21'; A_21 A_22] with A_22 negative semidefinite.

    Factorised when: A_11 at construction; the complement of the second block at each ``border``.
    """

    def border(self, second: Rows, corner: Matrix) -> Matrix:
        """Takes new second blocks (A.5 to A.7).

        Args:
            second: A_21 on the interface, shape (n_2, n_B).
            corner: A_22, shape (n_2, n_2).

        Returns:
            A_21 A_11^-1 A_21' - A_22, positive definite, shape (n_2, n_2).
        """
        self._second = second
        # C is symmetric: its rows serve as its columns.
        self._rows = second.times(self.flexibility)
        complement = second.times_transposed(self._rows) - corner
        self.border_complement = 0.5 * (complement + complement.T)
        return self.border_complement

    def border_free(self) -> Vector:
        """A_21 A_11^-1 b_1 for the load of ``forward``, shape (n_2,)."""
        return self._second.dot(self.free)

    def interface(self, second: Vector) -> Vector:
        """x_1 on the interface, once x_2 is known, shape (n_B,)."""
        return self.free - second @ self._rows

    def solve(self, first_load: Vector, second_load: Vector) -> tuple[Vector, Vector]:
        """x_1 and x_2 for b_1 and b_2 (A.10 to A.13).

        Raises:
            SingularSystemError: The second block's rows depend on each other.
        """
        self.forward(first_load)
        right = self.border_free() - second_load
        second = positive_solve(self.border_complement, right, "the contact")
        return np.array(self.backward(self.interface(second))), second


class ThreeBlockFactorisation(FirstBlock):
    """Appendix B: blocks 1 (linear), 2 (nonlinear elements), 3 (contact: Y and X).

    Factorised when: A_11 at construction; A_22 less its share of block 1 (Cholesky) and A_33 less
    its shares of both (pivoted LU, indefinite) at each ``update``, without any large solve.
    """

    def __init__(
        self, matrix: SparseMatrix, interface: IntVector, coupling: Matrix, part: str
    ) -> None:
        """Takes A_11 and A_21, which never change (B.3, B.4).

        Args:
            matrix: A_11.
            interface: Unknowns of A_11 that the other blocks touch.
            coupling: A_21 on the interface, shape (n_2, n_B).
            part: Name of the part, for the error message.
        """
        super().__init__(matrix, interface, part)
        self._coupling = coupling
        self._second_rows = coupling @ self.flexibility
        self._second_share = self._second_rows @ coupling.T

    def update(self, a22: Matrix, a31: Rows, a32: Matrix, a33: Matrix) -> None:
        """Takes new small blocks (B.5 to B.10).

        Args:
            a22: Shape (n_2, n_2), symmetric.
            a31: One row for each unknown of block 3, over the interface.
            a32: Shape (n_3, n_2).
            a33: Shape (n_3, n_3).

        Raises:
            SingularSystemError: A nonlinear element, or the contact, moves without resistance.
        """
        self._a31 = a31
        self._third_rows = a31.times(self.flexibility)
        second = a22 - self._second_share
        factor, info = lapack.dpotrf(0.5 * (second + second.T), lower=1, clean=1)
        if info:
            raise SingularSystemError("a nonlinear element", "its stiffness is not positive")
        self._second = factor
        coupling = a32 - self._third_rows @ self._coupling.T
        self._third_second = _lower_solve(factor, coupling.T).T
        own = a31.times_transposed(self._third_rows)
        third = a33 - own - self._third_second @ self._third_second.T
        self._third = None
        if third.size:
            lower, pivots, info = lapack.dgetrf(third)
            if info:
                raise SingularSystemError("the contact", "its equations depend on each other")
            self._third = (lower, pivots)

    def solve_reduced(
        self, first: Vector, second: Vector, third: Vector
    ) -> tuple[Vector, Vector, Vector]:
        """x_1 on the interface, x_2 and x_3 for a load of block 1 on the interface only.

        Equations B.13 to B.18, without any large solve.

        Args:
            first: Load of block 1, condensed on the interface, shape (n_B,).
            second: b_2, shape (n_2,).
            third: b_3, shape (n_3,).
        """
        free = self.flexibility @ first
        y2 = _lower_solve(self._second, second - self._coupling @ free)
        x3 = third - self._a31.dot(free) - self._third_second @ y2
        if self._third is not None:
            x3 = lapack.dgetrs(*self._third, x3)[0]
        x2 = _lower_solve(self._second, y2 - self._third_second.T @ x3, transposed=True)
        return free - x2 @ self._second_rows - x3 @ self._third_rows, x2, x3

    def solve(self, first: Vector, second: Vector, third: Vector) -> tuple[Vector, Vector, Vector]:
        """x_1, x_2 and x_3 for b_1, b_2 and b_3: one forward and one backward pass."""
        self.forward(first)
        interface, x2, x3 = self.solve_reduced(self.reduced, second, third)
        return np.array(self.backward(interface)), x2, x3


def _lower_solve(factor: Matrix, load: FloatArray, transposed: bool = False) -> FloatArray:
    """L^-1 load, or L'^-1 load."""
    if load.size == 0:
        return load
    return dense.solve_triangular(
        factor, load, lower=True, trans=1 if transposed else 0, check_finite=False
    )
