"""Exact elimination of supports and rigid connections: a = T a_free, K_free = T' K T.

A freedom is free, held at zero, or a combination of free ones. The transformation T is sparse, so
that the reduced matrices stay sparse; no penalty and no multiplier is left in the system.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from solver.arrays import FloatArray, IntArray, IntVector, SparseMatrix, Vector
from solver.errors import InputError

__all__ = ["Combination", "Transformation", "eliminate"]

_DOUBLINGS = 4
"""Doublings that resolve freedoms that follow freedoms; 2^4 links are more than any mesh has."""


@dataclass(frozen=True, kw_only=True)
class Combination:
    """Freedoms that follow others: a[dependent] = sum over k of weights[:, k] a[masters[:, k]].

    Attributes:
        dependent: Shape (n,).
        masters: Shape (n, m).
        weights: Shape (n, m); a master of weight zero is ignored.
    """

    dependent: IntVector
    masters: IntArray
    weights: FloatArray


@dataclass(frozen=True, kw_only=True)
class Transformation:
    """The elimination of dependent freedoms.

    Attributes:
        matrix: T, shape (n_full, n_dof).
        position: Free number of each full freedom, -1 if it is not free, shape (n_full,).
    """

    matrix: SparseMatrix
    position: IntVector

    def reduce(self, full: SparseMatrix) -> SparseMatrix:
        """T' A T, in compressed rows and symmetric to the last bit.

        Args:
            full: Symmetric matrix before elimination, shape (n_full, n_full).

        Returns:
            Shape (n_dof, n_dof).
        """
        product = (self.matrix.T @ full @ self.matrix).tocsr()
        symmetric = (0.5 * (product + product.T)).tocsr()
        symmetric.sum_duplicates()
        symmetric.sort_indices()
        return symmetric


def eliminate(count: int, held: IntVector, combinations: Sequence[Combination]) -> Transformation:
    """Builds the transformation from supports and combinations.

    A combination may follow freedoms that themselves follow others, or are held.

    Args:
        count: Freedoms before elimination.
        held: Freedoms that are zero.
        combinations: Freedoms that follow others.

    Returns:
        The transformation.

    Raises:
        InputError: A freedom is constrained twice, or follows itself.
    """
    dependent = np.concatenate([np.zeros(0, np.int64), *[c.dependent for c in combinations]])
    constrained = np.concatenate([np.unique(held), dependent])
    values, repeats = np.unique(constrained, return_counts=True)
    if np.any(repeats > 1):
        raise _conflict(values[repeats > 1], "is constrained twice")
    free = np.ones(count, dtype=np.bool_)
    free[constrained] = False
    step = _one_step(count, np.flatnonzero(free), combinations)
    for _ in range(_DOUBLINGS):
        if step[:, dependent].nnz == 0:
            break
        step = step @ step
    if step[:, dependent].nnz:
        raise _conflict(dependent[np.unique(step[:, dependent].nonzero()[1])], "follows itself")
    return Transformation(
        matrix=step[:, np.flatnonzero(free)].tocsr(),
        position=np.where(free, np.cumsum(free) - 1, -1),
    )


def _one_step(count: int, free: IntVector, combinations: Sequence[Combination]) -> SparseMatrix:
    """Each freedom by the ones it follows directly; a free one by itself, a held one by none."""
    rows, columns = [free], [free]
    values: list[Vector] = [np.ones(len(free))]
    for combination in combinations:
        used = combination.weights != 0.0
        rows.append(np.broadcast_to(combination.dependent[:, None], used.shape)[used])
        columns.append(combination.masters[used])
        values.append(combination.weights[used])
    indices = (np.concatenate(rows), np.concatenate(columns))
    return csr_array((np.concatenate(values), indices), shape=(count, count))


def _conflict(freedoms: IntVector, reason: str) -> InputError:
    return InputError(
        "constraints",
        int(freedoms[0]),
        f"freedom {int(freedoms[0])} {reason}",
        "Move the support or the connection to another node.",
    )
