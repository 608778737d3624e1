"""The unilateral contact of one step against an exhaustive search over all sets of wheels."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

import solver.contact.complementarity as complementarity
from solver.contact.complementarity import solve_contact
from solver.errors import ConvergenceError, SingularSystemError


def compliance_matrix(generator: np.random.Generator, n_wheel: int, spread: float) -> np.ndarray:
    """Symmetric positive definite, its stiffest and softest directions ``spread`` apart."""
    rotation, _ = np.linalg.qr(generator.standard_normal((n_wheel, n_wheel)))
    return 1e-9 * (rotation * np.geomspace(1.0, spread, n_wheel)) @ rotation.T


def exhaustive(compliance: np.ndarray, approach: np.ndarray) -> np.ndarray:
    """The one set of touching wheels without tension and without penetration."""
    for choice in product((False, True), repeat=approach.size):
        touching = np.flatnonzero(choice)
        forces = np.zeros(approach.size)
        if touching.size:
            forces[touching] = np.linalg.solve(
                compliance[np.ix_(touching, touching)], approach[touching]
            )
        gaps = compliance @ forces - approach
        gaps[touching] = 0.0
        if forces.min() >= 0.0 and gaps.min() >= 0.0:
            return forces
    raise AssertionError("a positive definite matrix always has a solution")


@pytest.mark.parametrize("spread", [1.0, 1e2, 1e5])
@pytest.mark.parametrize("seed", range(15))
def test_equals_the_exhaustive_search(seed: int, spread: float) -> None:
    generator = np.random.default_rng(seed)
    n_wheel = int(generator.integers(1, 8))
    compliance = compliance_matrix(generator, n_wheel, spread)
    approach = 1e-4 * generator.standard_normal(n_wheel)
    closed = generator.random(n_wheel) < 0.5
    guess = closed.copy()
    forces, touching, _ = solve_contact(compliance, approach, closed, True)
    wanted = exhaustive(compliance, approach)
    # Rounding grows with the spread of the compliances.
    np.testing.assert_allclose(forces, wanted, atol=1e-14 * spread * np.abs(wanted).max(initial=1))
    assert np.all(forces[~touching] == 0.0)
    np.testing.assert_array_equal(closed, guess)  # the last step's statuses are the caller's


@pytest.mark.parametrize("seed", range(30))
def test_a_whole_train_settles_without_false_tension(seed: int) -> None:
    """92 wheels, as many of them off as on: few small solves, no tension, no penetration."""
    generator = np.random.default_rng(100 + seed)
    compliance = compliance_matrix(generator, 92, 1e3)
    approach = 1e-4 * generator.standard_normal(92)
    forces, touching, solves = solve_contact(compliance, approach, np.ones(92, bool), True)
    gaps = compliance @ forces - approach
    assert forces.min() >= -1e-12 * forces.max()
    assert gaps[~touching].min() >= -1e-12 * np.abs(approach).max()
    assert np.abs(gaps[touching]).max() <= 1e-12 * np.abs(approach).max()
    assert solves < 50


def test_opposed_wheels_end_by_murtys_rule(monkeypatch: pytest.MonkeyPatch) -> None:
    """With no block flips allowed the search is Murty's alone, and finds the same."""
    generator = np.random.default_rng(5)
    compliance = compliance_matrix(generator, 7, 1e4)
    approach = 1e-4 * generator.standard_normal(7)
    wanted, _, _ = solve_contact(compliance, approach, np.ones(7, bool), True)
    monkeypatch.setattr(complementarity, "_BLOCK_TRIES", 0)
    found, _, _ = solve_contact(compliance, approach, np.ones(7, bool), True)
    np.testing.assert_allclose(found, wanted, rtol=1e-8)


def test_all_wheels_in_the_air_carry_nothing() -> None:
    forces, touching, _ = solve_contact(np.eye(3), -np.ones(3), np.ones(3, bool), True)
    np.testing.assert_array_equal(forces, 0.0)
    assert not touching.any()


def test_bilateral_contact_pulls() -> None:
    forces, touching, solves = solve_contact(
        np.eye(2), np.array([1.0, -2.0]), np.ones(2, bool), False
    )
    np.testing.assert_allclose(forces, [1.0, -2.0])
    assert touching.all()
    assert solves == 1


def test_a_compliance_that_is_not_positive_is_refused() -> None:
    with pytest.raises(SingularSystemError, match="the contact"):
        solve_contact(-np.eye(2), np.ones(2), np.ones(2, bool), True)
    with pytest.raises(SingularSystemError, match="the contact"):
        solve_contact(np.full((2, 2), np.nan), np.ones(2), np.ones(2, bool), True)


def test_a_search_without_end_says_when_and_at_which_wheel(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(complementarity, "_MOST_SOLVES", 3)
    monkeypatch.setattr(complementarity, "_wrong", lambda *_: np.array([False, True]))
    with pytest.raises(ConvergenceError, match=r"t = 0\.25 s \(wheel 2"):
        solve_contact(np.eye(2), np.ones(2), np.ones(2, bool), True, 0.25)
