"""A chain of nodes, each joined to its neighbours only: factorised for ever, queried anywhere.

The effective matrix of a beam line is block tridiagonal with blocks of two (deflection, slope).
Wheels move along it, so each step asks for the compliance between a few dozen new places. Two
exact ways serve that:

* a *window table*: the blocks of the inverse near its diagonal. In a time step the compliance of a
  rail dies out within some metres, and entries below the rounding error of the diagonal are zero
  in double precision: the table then holds the inverse itself, at tens of megabytes;
* direct solves, where nothing dies out (statics) or the chain is so short that it does not matter.

The table follows from the two block eliminations, from the left and from the right
(Z_ii = (L_i + U_i - D_i)^-1, Z_{i+1,j} = R_{i+1} Z_{i,j} for i >= j), which are stable for
symmetric positive definite matrices.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack

from solver.arrays import FloatArray, IntVector, Matrix, Vector
from solver.errors import SingularSystemError

__all__ = ["Chain"]

_NEGLIGIBLE = 1e-17
"""Entries this small beside the diagonal are below its rounding error."""
_TABLE_LIMIT = 200_000_000
"""Largest window table. [B]"""


class Chain:
    """A factorised symmetric positive definite block tridiagonal matrix.

    Args:
        diagonal: Diagonal blocks, shape (n_node, 2, 2).
        upper: Blocks (i, i + 1), shape (n_node - 1, 2, 2).
        part: Name of the part, for the error message.

    Raises:
        SingularSystemError: The chain can move without resistance.
    """

    def __init__(self, diagonal: FloatArray, upper: FloatArray, part: str) -> None:
        self.n_node = diagonal.shape[0]
        self._diagonal = diagonal
        self._upper = upper
        self._factor, info = lapack.dpbtrf(_banded(diagonal, upper))
        if info != 0:
            raise SingularSystemError(part, f"node {(info - 1) // 2} can move freely")
        self._table: FloatArray | None = None

    def solve(self, load: FloatArray) -> FloatArray:
        """Solution for loads of shape (2 n_node,) or (2 n_node, n_load)."""
        solution, _ = lapack.dpbtrs(self._factor, load)
        return solution

    def prepare_table(self, lengths: Vector) -> bool:
        """Builds the window table, if the compliance dies out within its memory limit.

        Args:
            lengths: Typical length that makes slopes comparable to deflections, shape (n_node,).

        Returns:
            Whether the table was built.
        """
        right, self_compliance = self._eliminations()
        limit = max(2, _TABLE_LIMIT // (32 * self.n_node))
        blocks = [self_compliance]
        scale = _magnitude(self_compliance, lengths)
        while len(blocks) < self.n_node:
            offset = len(blocks)
            blocks.append(np.zeros_like(self_compliance))
            blocks[-1][:-offset] = right[offset:] @ blocks[-2][:-offset]
            if np.all(_magnitude(blocks[-1], lengths) <= _NEGLIGIBLE * scale):
                break
            if offset >= limit:
                return False
        self._table = np.stack(blocks)
        return True

    @property
    def has_table(self) -> bool:
        """Whether ``between`` can be asked."""
        return self._table is not None

    @property
    def window(self) -> int:
        """Number of nodes over which the compliance dies out."""
        return self.n_node if self._table is None else self._table.shape[0]

    def between(
        self, node_a: IntVector, rows_a: FloatArray, node_b: IntVector, rows_b: FloatArray
    ) -> Vector:
        """Compliance between pairs of places, from the window table.

        Args:
            node_a: Left node of each first place, shape (n_pair,).
            rows_a: Its weights on (w1, w1', w2, w2'), shape (n_pair, 4).
            node_b: Likewise for the second place.
            rows_b: Likewise.

        Returns:
            rows_a K^-1 rows_b', shape (n_pair,). [m/N]
        """
        assert self._table is not None
        total = np.zeros(node_a.size)
        for p in (0, 1):
            for q in (0, 1):
                first, second = node_a + p, node_b + q
                blocks = self._blocks(first, second)
                total += np.einsum(
                    "ni,nij,nj->n",
                    rows_a[:, 2 * p : 2 * p + 2],
                    blocks,
                    rows_b[:, 2 * q : 2 * q + 2],
                )
        return total

    def _blocks(self, first: IntVector, second: IntVector) -> FloatArray:
        """Blocks (first, second) of the inverse, zero beyond the window."""
        assert self._table is not None
        offset = first - second
        distance = np.abs(offset)
        inside = distance < self._table.shape[0]
        blocks = self._table[np.where(inside, distance, 0), np.minimum(first, second)]
        blocks = np.where((offset < 0)[:, None, None], blocks.transpose(0, 2, 1), blocks)
        return blocks * inside[:, None, None]

    def _eliminations(self) -> tuple[FloatArray, FloatArray]:
        """Transfer blocks R and diagonal blocks of the inverse, each (n_node, 2, 2)."""
        n = self.n_node
        left, right = self._diagonal.copy(), self._diagonal.copy()
        transfer = np.zeros_like(self._diagonal)
        for i in range(1, n):
            left[i] -= self._upper[i - 1].T @ _inverse(left[i - 1]) @ self._upper[i - 1]
        for i in range(n - 1, 0, -1):
            inverse = _inverse(right[i])
            transfer[i] = -inverse @ self._upper[i - 1].T
            right[i - 1] -= self._upper[i - 1] @ inverse @ self._upper[i - 1].T
        return transfer, np.linalg.inv(left + right - self._diagonal)


def _inverse(block: Matrix) -> Matrix:
    """Inverse of one 2 x 2 block; numpy's own costs ten times as much."""
    (a, b), (c, d) = block.tolist()
    determinant = a * d - b * c
    return np.array([[d / determinant, -b / determinant], [-c / determinant, a / determinant]])


def _magnitude(blocks: FloatArray, lengths: Vector) -> Vector:
    """Greatest entry of each block, slopes counted over the typical length."""
    scaled = np.abs(blocks)
    scaled[:, 1, :] *= lengths[:, None]
    scaled[:, :, 1] *= lengths[:, None]
    return scaled.max(axis=(1, 2))


def _banded(diagonal: FloatArray, upper: FloatArray) -> Matrix:
    """LAPACK's upper banded form, shape (4, 2 n_node)."""
    n = diagonal.shape[0]
    banded = np.zeros((4, 2 * n))
    banded[3, 0::2] = diagonal[:, 0, 0]
    banded[3, 1::2] = diagonal[:, 1, 1]
    banded[2, 1::2] = diagonal[:, 0, 1]
    banded[2, 2::2] = upper[:, 1, 0]
    banded[1, 2::2] = upper[:, 0, 0]
    banded[1, 3::2] = upper[:, 1, 1]
    banded[0, 3::2] = upper[:, 0, 1]
    return banded
