"""The chain of a beam line: its window table is the inverse itself."""

from __future__ import annotations

import numpy as np
import pytest

from solver.errors import SingularSystemError
from solver.factorisation.chain import Chain


def beam_on_bed(n_node: int, bed: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Blocks and full matrix of a unit beam (EI = 1, elements of length 1) on a bed."""
    element = np.array(
        [[12.0, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], dtype=float
    )
    full = np.zeros((2 * n_node, 2 * n_node))
    for i in range(n_node - 1):
        full[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += element
    full[np.arange(2 * n_node), np.arange(2 * n_node)] += bed
    blocks = full.reshape(n_node, 2, n_node, 2).transpose(0, 2, 1, 3)
    index = np.arange(n_node)
    return blocks[index, index].copy(), blocks[index[:-1], index[1:]].copy(), full


@pytest.mark.parametrize("bed", [0.05, 50.0])
def test_table_equals_the_dense_inverse(bed: float) -> None:
    diagonal, upper, full = beam_on_bed(60, bed)
    chain = Chain(diagonal, upper, "rail")
    assert chain.prepare_table(np.ones(60))
    generator = np.random.default_rng(3)
    node_a, node_b = generator.integers(0, 59, 300), generator.integers(0, 59, 300)
    rows_a, rows_b = generator.standard_normal((300, 4)), generator.standard_normal((300, 4))
    first, second = np.zeros((300, 120)), np.zeros((300, 120))
    for k in range(300):
        first[k, 2 * node_a[k] : 2 * node_a[k] + 4] = rows_a[k]
        second[k, 2 * node_b[k] : 2 * node_b[k] + 4] = rows_b[k]
    expected = np.einsum("ni,ij,nj->n", first, np.linalg.inv(full), second)
    found = chain.between(node_a, rows_a, node_b, rows_b)
    # Rounding of the dense inverse itself bounds the comparison.
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


def test_stiff_bed_needs_only_a_short_window() -> None:
    diagonal, upper, _ = beam_on_bed(400, 50.0)
    chain = Chain(diagonal, upper, "rail")
    chain.prepare_table(np.ones(400))
    assert chain.window < 60


def test_unsupported_chain_is_named() -> None:
    diagonal, upper, _ = beam_on_bed(5, 0.0)
    with pytest.raises(SingularSystemError, match="left rail"):
        Chain(diagonal, upper, "left rail")
