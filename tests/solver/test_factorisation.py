"""Both back ends keep one contract: the same answers, one forward and one backward pass."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sparse

from solver.errors import SingularSystemError
from solver.factorisation.superlu import SuperLUCondensation, SuperLUFactorisation

pardiso = pytest.importorskip(
    "solver.factorisation.pardiso", reason="pypardiso has no wheel for this platform"
)
FACTORISATIONS = [pardiso.PardisoFactorisation, SuperLUFactorisation]
CONDENSATIONS = [pardiso.PardisoCondensation, SuperLUCondensation]


def chain(n_dof: int) -> sparse.csr_array:
    """A chain of springs with a few long links, fixed at one end."""
    generator = np.random.default_rng(7)
    links = generator.integers(0, n_dof, size=(n_dof, 2))
    stiffness = sparse.diags_array(
        [-np.ones(n_dof - 1), np.full(n_dof, 2.0), -np.ones(n_dof - 1)], offsets=[-1, 0, 1]
    ).tolil()
    for first, second in links[links[:, 0] != links[:, 1]]:
        stiffness[first, first] += 0.3
        stiffness[second, second] += 0.3
        stiffness[first, second] -= 0.3
        stiffness[second, first] -= 0.3
    return stiffness.tocsr()


@pytest.mark.parametrize("back_end", FACTORISATIONS)
def test_solves_one_and_several_loads(back_end: type) -> None:
    matrix = chain(200)
    loads = np.random.default_rng(1).standard_normal((200, 3))
    factor = back_end(matrix, "chain")
    np.testing.assert_allclose(matrix @ factor.solve(loads), loads, atol=1e-10)
    np.testing.assert_allclose(matrix @ factor.solve(loads[:, 0]), loads[:, 0], atol=1e-10)


@pytest.mark.parametrize("back_end", CONDENSATIONS)
def test_condensation_is_one_solve_in_two_halves(back_end: type) -> None:
    matrix = chain(200)
    interface = np.array([17, 3, 150, 149])  # not sorted on purpose
    load = np.random.default_rng(2).standard_normal(200)
    condensed = back_end(matrix, interface, "chain")
    reduced = condensed.forward(load)
    solution = condensed.backward(np.linalg.solve(condensed.complement, reduced))
    np.testing.assert_allclose(matrix @ solution, load, atol=1e-10)


@pytest.mark.parametrize("back_end", CONDENSATIONS)
def test_complement_is_the_inverse_of_the_interface_compliance(back_end: type) -> None:
    matrix = chain(120)
    interface = np.array([60, 5, 99])
    compliance = np.linalg.inv(matrix.toarray())[np.ix_(interface, interface)]
    condensed = back_end(matrix, interface, "chain")
    np.testing.assert_allclose(np.linalg.inv(condensed.complement), compliance, rtol=1e-10)


@pytest.mark.parametrize("back_end", FACTORISATIONS)
def test_an_unsupported_part_is_named(back_end: type) -> None:
    matrix = sparse.csr_array(np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    with pytest.raises(SingularSystemError, match="pier"):
        back_end(matrix, "pier")
