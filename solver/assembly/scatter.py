"""Element matrices into one sparse matrix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array

from solver.arrays import FloatArray, IntArray, SparseMatrix

__all__ = ["ElementMatrices", "scatter"]

_PIECE = 2_300_000
"""Matrix entries scattered at a time: 4,000 eight-node solids."""


@dataclass(frozen=True, kw_only=True)
class ElementMatrices:
    """Matrices of elements of one kind.

    Attributes:
        freedoms: Freedoms of each element, shape (n_element, n).
        matrices: Shape (n_element, n, n).
    """

    freedoms: IntArray
    matrices: FloatArray

    def scaled(self, factors: FloatArray | float) -> ElementMatrices:
        """The same elements, each matrix times its factor (one number or shape (n_element,))."""
        weights = np.broadcast_to(np.asarray(factors, dtype=float), (len(self.matrices),))
        return ElementMatrices(
            freedoms=self.freedoms, matrices=self.matrices * weights[:, None, None]
        )


def scatter(blocks: Sequence[ElementMatrices], count: int) -> SparseMatrix:
    """Sums element matrices into a sparse matrix.

    Args:
        blocks: Elements, kind by kind.
        count: Freedoms in all.

    Returns:
        Compressed rows, shape (count, count).
    """
    total = csr_array((count, count))
    for block in blocks:
        size = block.freedoms.shape[1]
        # In pieces: the triplets of all elements at once would take ten times the matrix's memory.
        piece_length = max(1, _PIECE // size**2)
        for start in range(0, len(block.freedoms), piece_length):
            freedoms = block.freedoms[start : start + piece_length].astype(np.int32)
            rows = np.repeat(freedoms, size, axis=1).ravel()
            columns = np.tile(freedoms, (1, size)).ravel()
            values = block.matrices[start : start + piece_length].ravel()
            piece = coo_array((values, (rows, columns)), shape=(count, count))
            total = total + piece.tocsr()
    total.eliminate_zeros()
    return total
