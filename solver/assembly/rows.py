"""A few short rows over many columns, kept as small dense arrays.

Contact rows change at every step and every iteration and touch a handful of freedoms each: general
sparse matrices would spend more time on their bookkeeping than on the numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from solver.arrays import BoolVector, FloatArray, IntArray, IntVector, Matrix, SparseMatrix, Vector

__all__ = ["Rows"]


@dataclass(frozen=True)
class Rows:
    """Rows with equally many entries each; an entry of value 0 stands for none.

    Attributes:
        columns: Shape (n, n_entry). A column may occur twice in a row: its values add up.
        values: Shape (n, n_entry).
        n_column: Columns in all.
    """

    columns: IntArray
    values: FloatArray
    n_column: int

    @classmethod
    def from_sparse(cls, matrix: SparseMatrix) -> Rows:
        """The rows of a sparse matrix, padded to the longest of them."""
        matrix = sparse.csr_array(matrix)
        lengths = np.diff(matrix.indptr)
        longest = int(lengths.max(initial=0))
        place = np.arange(longest) < lengths[:, None]
        columns = np.zeros(place.shape, dtype=np.int64)
        values = np.zeros(place.shape)
        columns[place], values[place] = matrix.indices, matrix.data
        return cls(columns, values, int(matrix.shape[1]))

    @property
    def count(self) -> int:
        """Number of rows."""
        return len(self.columns)

    def dot(self, vector: Vector) -> Vector:
        """Rows times a vector, shape (n,)."""
        if self.n_column == 0:
            return np.zeros(self.count)
        return np.einsum("nk,nk->n", self.values, vector[self.columns])

    def times(self, matrix: Matrix) -> Matrix:
        """Rows times a dense matrix (n_column, m), shape (n, m)."""
        if self.n_column == 0:
            return np.zeros((self.count, matrix.shape[1]))
        return np.einsum("nk,nkm->nm", self.values, matrix[self.columns])

    def times_transposed(self, matrix: Matrix) -> Matrix:
        """A dense matrix (m, n_column) times the rows transposed, shape (m, n)."""
        if self.n_column == 0:
            return np.zeros((matrix.shape[0], self.count))
        return np.einsum("nk,mnk->mn", self.values, matrix[:, self.columns])

    def add(self, forces: Vector, total: Vector) -> None:
        """Adds the rows transposed times ``forces`` to ``total``, in place."""
        if self.n_column:
            np.add.at(total, self.columns, self.values * forces[:, None])

    def transposed_dot(self, forces: Vector) -> Vector:
        """Rows transposed times forces, shape (n_column,)."""
        total = np.zeros(self.n_column)
        self.add(forces, total)
        return total

    def take(self, index: IntVector | BoolVector) -> Rows:
        """Some of the rows."""
        return Rows(self.columns[index], self.values[index], self.n_column)

    def scaled(self, factor: float | Vector) -> Rows:
        """Rows times one factor, or a factor each."""
        factors = np.broadcast_to(np.asarray(factor, dtype=float), (self.count,))
        return Rows(self.columns, self.values * factors[:, None], self.n_column)

    def renumbered(self, position: IntVector, n_column: int) -> Rows:
        """Rows over other columns.

        Args:
            position: New column of each old one, -1 where it is dropped.
            n_column: New columns in all.
        """
        columns = position[self.columns]
        values = np.where(columns >= 0, self.values, 0.0)
        return Rows(np.maximum(columns, 0), values, n_column)

    def joined(self, other: Rows) -> Rows:
        """Row by row the sum of two, over the same columns."""
        return Rows(
            np.concatenate([self.columns, other.columns], axis=1),
            np.concatenate([self.values, other.values], axis=1),
            self.n_column,
        )

    def dense(self) -> Matrix:
        """Shape (n, n_column)."""
        matrix = np.zeros((self.count, self.n_column))
        if self.n_column:
            np.add.at(matrix, (np.arange(self.count)[:, None], self.columns), self.values)
        return matrix

    def sparse(self) -> SparseMatrix:
        """As compressed rows."""
        row = np.broadcast_to(np.arange(self.count)[:, None], self.columns.shape)
        entries = (self.values.ravel(), (row.ravel(), self.columns.ravel()))
        matrix = sparse.coo_array(entries, shape=(self.count, self.n_column)).tocsr()
        matrix.eliminate_zeros()
        return matrix
