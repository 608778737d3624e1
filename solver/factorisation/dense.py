"""Condensation of small matrices, where a sparse factor would cost more than it saves."""

from __future__ import annotations

import numpy as np
import scipy.linalg as dense

from solver.arrays import FloatArray, IntVector, Matrix, SparseMatrix, Vector
from solver.errors import SingularSystemError

__all__ = ["DenseCondensation"]


class DenseCondensation:
    """A small matrix condensed on its interface; see ``solver.factorisation.sparse``.

    Raises:
        SingularSystemError: The matrix is not positive definite.
    """

    complement: Matrix
    memory_bytes: int

    def __init__(self, matrix: SparseMatrix, interface: IntVector, part: str) -> None:
        full = matrix.toarray()
        inside = np.setdiff1d(np.arange(full.shape[0]), interface)
        self._interface, self._inside = interface, inside
        self._coupling = full[np.ix_(inside, interface)]
        try:
            self._factor = dense.cho_factor(full[np.ix_(inside, inside)]) if inside.size else None
        except dense.LinAlgError as error:
            raise SingularSystemError(part, "its stiffness is not positive definite") from error
        complement = full[np.ix_(interface, interface)]
        if self._factor is not None:
            complement = complement - self._coupling.T @ self._inner(self._coupling)
        self.complement = 0.5 * (complement + complement.T)
        self.memory_bytes = full.nbytes
        self._load = np.zeros(inside.size)

    def _inner(self, load: FloatArray) -> FloatArray:
        if self._factor is None:
            return load
        return dense.cho_solve(self._factor, load, check_finite=False)

    def forward(self, load: Vector) -> Vector:
        """Load condensed on the interface; see the contract."""
        self._load = self._inner(load[self._inside])
        return load[self._interface] - self._coupling.T @ self._load

    def backward(self, interface: Vector) -> Vector:
        """All unknowns, once the interface's are known."""
        solution = np.empty(interface.size + self._inside.size)
        solution[self._interface] = interface
        solution[self._inside] = self._load - self._inner(self._coupling @ interface)
        return solution
