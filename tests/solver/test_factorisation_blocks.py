"""The block solvers of appendices A and B against dense solutions of the whole matrix."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sparse

from solver.assembly.rows import Rows
from solver.errors import SingularSystemError
from solver.factorisation.blocks import (
    FirstBlock,
    ThreeBlockFactorisation,
    TwoBlockFactorisation,
)

SIZES = (7, 40, 500)
"""All in the interface, dense, sparse back end."""


def _first(size: int, rng: np.random.Generator) -> tuple[sparse.csr_array, np.ndarray]:
    """A chain of springs to ground, and an interface of seven scattered unknowns."""
    stiffness = rng.uniform(1.0, 2.0, size + 1)
    diagonal = stiffness[:-1] + stiffness[1:] + 0.1
    matrix = sparse.diags_array(
        [-stiffness[1:-1], diagonal, -stiffness[1:-1]], offsets=[-1, 0, 1], format="csr"
    )
    return sparse.csr_array(matrix), rng.permutation(size)[:7]


def _rows(rng: np.random.Generator, count: int) -> Rows:
    matrix = sparse.random_array((count, 7), density=0.6, rng=rng) + sparse.eye_array(count, 7)
    return Rows.from_sparse(sparse.csr_array(matrix))


def _whole(first: sparse.csr_array, interface: np.ndarray, others: np.ndarray) -> np.ndarray:
    """The dense matrix with the small blocks' rows over all unknowns of block 1."""
    size, n_other = first.shape[0], others.shape[0]
    matrix = np.zeros((size + n_other, size + n_other))
    matrix[:size, :size] = first.toarray()
    matrix[size:, interface] = others[:, :7]
    matrix[:size, size:] = matrix[size:, :size].T
    matrix[size:, size:] = others[:, 7:]
    return matrix


@pytest.mark.parametrize("size", SIZES)
def test_two_blocks_equal_the_whole(size: int) -> None:
    rng = np.random.default_rng(size)
    first, interface = _first(size, rng)
    blocks = TwoBlockFactorisation(first, interface, "test")
    for _ in range(3):
        second, corner = _rows(rng, 3), -np.diag(rng.uniform(0.0, 1.0, 3))
        complement = blocks.border(second, corner)
        assert np.linalg.eigvalsh(complement).min() > 0.0
        b1, b2 = rng.normal(size=size), rng.normal(size=3)
        x1, x2 = blocks.solve(b1, b2)
        whole = _whole(first, interface, np.hstack([second.dense(), corner]))
        expected = np.linalg.solve(whole, np.concatenate([b1, b2]))
        np.testing.assert_allclose(np.concatenate([x1, x2]), expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("n_third", [0, 4])
def test_three_blocks_equal_the_whole(size: int, n_third: int) -> None:
    rng = np.random.default_rng(size)
    first, interface = _first(size, rng)
    coupling = rng.normal(size=(2, 7))
    blocks = ThreeBlockFactorisation(first, interface, coupling, "test")
    a22 = 60.0 * np.eye(2)
    a31, a32 = _rows(rng, n_third), rng.normal(size=(n_third, 2))
    a33 = rng.normal(size=(n_third, n_third))
    a33 = a33 + a33.T
    blocks.update(a22, a31, a32, a33)
    b1, b2, b3 = rng.normal(size=size), rng.normal(size=2), rng.normal(size=n_third)
    found = np.concatenate(blocks.solve(b1, b2, b3))
    others = np.block([[coupling, a22, a32.T], [a31.dense(), a32, a33]])
    expected = np.linalg.solve(_whole(first, interface, others), np.concatenate([b1, b2, b3]))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)


def test_new_small_blocks_cost_no_large_solve(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(0)
    first, interface = _first(500, rng)
    blocks = ThreeBlockFactorisation(first, interface, rng.normal(size=(2, 7)), "test")
    blocks.forward(rng.normal(size=500))
    calls: list[str] = []
    monkeypatch.setattr(FirstBlock, "forward", lambda *_: calls.append("forward"))
    monkeypatch.setattr(FirstBlock, "backward", lambda *_: calls.append("backward"))
    for _ in range(5):
        blocks.update(60.0 * np.eye(2), _rows(rng, 3), rng.normal(size=(3, 2)), np.eye(3))
        blocks.solve_reduced(blocks.reduced, np.ones(2), np.ones(3))
    assert calls == []


def test_rows_that_repeat_each_other_are_refused() -> None:
    first, interface = _first(40, np.random.default_rng(0))
    blocks = TwoBlockFactorisation(first, interface, "test")
    same = Rows.from_sparse(sparse.csr_array(np.ones((2, 7))))
    blocks.border(same, np.zeros((2, 2)))
    with pytest.raises(SingularSystemError, match="contact"):
        blocks.solve(np.ones(40), np.ones(2))


def test_a_first_block_that_moves_freely_is_refused() -> None:
    free = sparse.csr_array(np.array([[1.0, -1.0], [-1.0, 1.0]]))
    with pytest.raises(SingularSystemError):
        FirstBlock(free, np.array([0, 1]), "the structure")
