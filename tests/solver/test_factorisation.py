"""Both back ends keep one contract: the same answers, one forward and one backward pass."""

from __future__ import annotations

import os
from importlib.metadata import PackageNotFoundError

import numpy as np
import pytest
import scipy.sparse as sparse

from solver.errors import SingularSystemError
from solver.factorisation import mkl
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


def unsupported(n_dof: int) -> sparse.csr_array:
    """The same kind of chain, fixed nowhere; rounding hides it from the pivots."""
    links = sparse.diags_array([-np.ones(n_dof - 1), np.ones(n_dof)], offsets=[-1, 0]).tocsr()
    return (links[1:].T @ sparse.diags_array(np.linspace(0.1, 3.0, n_dof - 1)) @ links[1:]).tocsr()


def with_missing_diagonal() -> sparse.csr_array:
    """PARDISO would read beyond its arrays here, and end the process."""
    matrix = chain(30).tocoo()
    kept = (matrix.row != 5) | (matrix.col != 5)
    entries = (matrix.data[kept], (matrix.row[kept], matrix.col[kept]))
    return sparse.coo_array(entries, shape=(30, 30)).tocsr()


def with_a_value_that_is_no_number() -> sparse.csr_array:
    matrix = chain(30)
    matrix[4, 4] = np.nan
    return matrix


UNSOUND = {
    "singular": sparse.block_diag([chain(30), np.array([[1.0, -1.0], [-1.0, 1.0]])], format="csr"),
    "singular but for rounding": unsupported(60),
    "a free part beside a fixed one": sparse.block_diag([chain(30), unsupported(30)], format="csr"),
    "negative": -chain(30),
    "missing diagonal": with_missing_diagonal(),
    "not a number": with_a_value_that_is_no_number(),
}


@pytest.mark.parametrize("name", list(UNSOUND))
@pytest.mark.parametrize("back_end", FACTORISATIONS)
def test_an_unsupported_part_is_named(back_end: type, name: str) -> None:
    """No noise that looks like a result, no crash: an error with the part's name."""
    with pytest.raises(SingularSystemError, match="pier"):
        back_end(UNSOUND[name], "pier")


@pytest.mark.parametrize("name", list(UNSOUND))
@pytest.mark.parametrize("interface", [[1], [0, 2]], ids=["one", "two"])
@pytest.mark.parametrize("back_end", CONDENSATIONS)
def test_an_unsupported_part_is_named_when_condensed(
    back_end: type, interface: list[int], name: str
) -> None:
    with pytest.raises(SingularSystemError, match="pier"):
        back_end(UNSOUND[name], np.array(interface), "pier")


@pytest.mark.parametrize("back_end", CONDENSATIONS)
def test_a_fresh_condensation_carries_no_load(back_end: type) -> None:
    """Backward without a forward pass: the interface moved by hand, nothing else loaded."""
    matrix, interface = chain(40), np.array([7, 30])
    moved = back_end(matrix, interface, "chain").backward(np.array([1.0, -2.0]))
    load = matrix @ moved
    np.testing.assert_allclose(moved[interface], [1.0, -2.0])
    np.testing.assert_allclose(np.delete(load, interface), 0.0, atol=1e-12)


def test_a_load_of_another_length_is_refused() -> None:
    """PARDISO takes addresses: it would read, and write, beyond the array."""
    factor = pardiso.PardisoFactorisation(chain(20), "chain")
    with pytest.raises(ValueError, match="19 entries for 20 unknowns"):
        factor.solve(np.ones(19))
    condensed = pardiso.PardisoCondensation(chain(20), np.array([3]), "chain")
    with pytest.raises(ValueError, match="21 entries"):
        condensed.forward(np.ones(21))


def test_whole_numbers_are_loads_too() -> None:
    matrix = chain(20)
    factor = pardiso.PardisoFactorisation(matrix, "chain")
    np.testing.assert_allclose(matrix @ factor.solve(np.arange(20)), np.arange(20), atol=1e-12)


def test_mkl_is_taken_from_its_package_without_a_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """pypardiso's search through every folder of the environment takes longer than short runs."""

    def search(*arguments: object, **options: object) -> None:
        raise AssertionError("MKL was searched for")

    monkeypatch.delenv("PYPARDISO_MKL_RT", raising=False)
    monkeypatch.setattr("pypardiso.pardiso_wrapper.find_library", search)
    monkeypatch.setattr("pypardiso.pardiso_wrapper.glob.glob", search)
    assert mkl.load_mkl().pardiso


def test_mkl_that_came_without_a_package_is_pypardisos_to_find(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = mkl.load_mkl()._name

    def files(name: str) -> None:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(mkl, "files", files)
    monkeypatch.delenv("PYPARDISO_MKL_RT", raising=False)
    monkeypatch.setattr("pypardiso.pardiso_wrapper.find_library", lambda name: found)
    assert mkl.load_mkl()._name == found
    assert "PYPARDISO_MKL_RT" not in os.environ
