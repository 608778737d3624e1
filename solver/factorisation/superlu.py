"""SciPy's SuperLU: the back end where MKL is not to be had."""

from __future__ import annotations

import numpy as np
import scipy.sparse.linalg as sparse_linalg

from solver.arrays import FloatArray, IntVector, Matrix, SparseMatrix, Vector
from solver.errors import SingularSystemError
from solver.factorisation.soundness import (
    require_accuracy,
    require_positive_diagonal,
    solve_complement,
)

__all__ = ["SuperLUCondensation", "SuperLUFactorisation"]


class SuperLUFactorisation:
    """A factorised matrix; see ``solver.factorisation.sparse`` for the contract."""

    memory_bytes: int

    def __init__(self, matrix: SparseMatrix, part: str) -> None:
        require_positive_diagonal(matrix, part)
        try:
            # Symmetric mode keeps the fill close to that of a Cholesky factor.
            self._factor = sparse_linalg.splu(
                matrix.tocsc(),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:
            raise SingularSystemError(part, "its stiffness is singular") from error
        self.memory_bytes = 12 * int(self._factor.nnz)
        require_accuracy(matrix, self.solve, part)

    def solve(self, load: FloatArray) -> FloatArray:
        """Solution for one load (n_dof,) or several (n_dof, n_load)."""
        return self._factor.solve(np.asarray(load, dtype=np.float64))


class SuperLUCondensation:
    """A matrix condensed on its interface; ``forward`` and ``backward`` cost a solve each."""

    complement: Matrix
    memory_bytes: int

    def __init__(self, matrix: SparseMatrix, interface: IntVector, part: str) -> None:
        is_interior = np.ones(matrix.shape[0], dtype=bool)
        is_interior[interface] = False
        self._interface, self._part = interface, part
        self._interior = np.flatnonzero(is_interior)
        rows = matrix.tocsr()[self._interior]
        self._factor = SuperLUFactorisation(rows[:, self._interior], part)
        self._coupling = rows[:, interface].tocsr()
        response = self._factor.solve(self._coupling.toarray())
        complement = matrix.tocsr()[interface][:, interface].toarray()
        complement = complement - self._coupling.T @ response
        self.complement = 0.5 * (complement + complement.T)
        self.memory_bytes = self._factor.memory_bytes
        self._solution = np.zeros(matrix.shape[0])
        self._interior_load = np.zeros(self._interior.size)
        require_accuracy(matrix, self._solve, part)
        self._interior_load = np.zeros(self._interior.size)

    def forward(self, load: Vector) -> Vector:
        """Load condensed on the interface; see the contract."""
        self._interior_load = load[self._interior]
        free = self._factor.solve(self._interior_load)
        return load[self._interface] - self._coupling.T @ free

    def backward(self, interface: Vector) -> Vector:
        """All unknowns; the array returned is overwritten by the next call."""
        self._solution[self._interior] = self._factor.solve(
            self._interior_load - self._coupling @ interface
        )
        self._solution[self._interface] = interface
        return self._solution

    def stored(self) -> None:
        """SuperLU's factors cannot be rebuilt from arrays."""

    def _solve(self, load: Vector) -> Vector:
        """All unknowns under a load, the interface's from the complement."""
        return self.backward(solve_complement(self.complement, self.forward(load), self._part))
