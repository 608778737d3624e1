"""Short rows against the sparse matrices that they stand for."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sparse

from solver.assembly.rows import Rows


def _both(n_row: int, n_column: int) -> tuple[Rows, np.ndarray]:
    rng = np.random.default_rng(3)
    matrix = sparse.random_array((n_row, n_column), density=0.4, rng=rng, format="csr")
    return Rows.from_sparse(matrix), matrix.toarray()


@pytest.mark.parametrize("shape", [(4, 9), (3, 0), (0, 5)])
def test_rows_multiply_like_the_matrix(shape: tuple[int, int]) -> None:
    rows, matrix = _both(*shape)
    rng = np.random.default_rng(4)
    vector, forces = rng.normal(size=shape[1]), rng.normal(size=shape[0])
    dense = rng.normal(size=(shape[1], 6))
    np.testing.assert_allclose(rows.dot(vector), matrix @ vector)
    np.testing.assert_allclose(rows.transposed_dot(forces), matrix.T @ forces)
    np.testing.assert_allclose(rows.times(dense), matrix @ dense)
    np.testing.assert_allclose(rows.times_transposed(dense.T), dense.T @ matrix.T)
    np.testing.assert_allclose(rows.dense(), matrix)
    np.testing.assert_allclose(rows.sparse().toarray(), matrix)


def test_rows_are_taken_scaled_joined_and_renumbered() -> None:
    rows, matrix = _both(4, 9)
    np.testing.assert_allclose(rows.take(np.array([2, 0])).dense(), matrix[[2, 0]])
    factors = np.array([1.0, -2.0, 0.5, 3.0])
    np.testing.assert_allclose(rows.scaled(factors).dense(), factors[:, None] * matrix)
    np.testing.assert_allclose(rows.joined(rows.scaled(-0.5)).dense(), 0.5 * matrix)
    place = np.array([-1, 0, -1, 1, 2, -1, -1, 3, -1])
    np.testing.assert_allclose(rows.renumbered(place, 4).dense(), matrix[:, [1, 3, 4, 7]])
