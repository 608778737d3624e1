"""The nonlinear Hertz contact of one step, against an independent search."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

import solver.contact.nonlinear as nonlinear
from solver.contact.complementarity import solve_contact
from solver.contact.laws import NonlinearHertz
from solver.contact.nonlinear import contact_force, contact_stiffness, solve_hertz
from solver.errors import ConvergenceError, SingularSystemError

LAW = NonlinearHertz(coefficient=7.958e10, reference_force=83385.0)
"""Neves (2016), section 3.4: S1002 on 60E1, 8.5 t a wheel."""


def compliance_matrix(generator: np.random.Generator, n_wheel: int, size: float) -> np.ndarray:
    """Symmetric positive definite, its stiffest and softest directions 100 apart."""
    rotation, _ = np.linalg.qr(generator.standard_normal((n_wheel, n_wheel)))
    return size * (rotation * np.geomspace(1.0, 1e-2, n_wheel)) @ rotation.T


def least_energy(compliance: np.ndarray, approach: np.ndarray) -> np.ndarray:
    """Contact forces that make the complementary energy least, found without its derivatives' law.

    The forces minimise F'SF/2 - b'F + 2/5 K^(-2/3) sum F^(5/3) over F >= 0, a convex problem.
    """
    unit, flexibility = 1e5, LAW.coefficient ** (-2.0 / 3.0)

    def energy(scaled: np.ndarray) -> tuple[float, np.ndarray]:
        forces = unit * scaled
        spring = 0.6 * flexibility * (forces ** (5.0 / 3.0)).sum()
        gradient = compliance @ forces - approach + flexibility * forces ** (2.0 / 3.0)
        value = 0.5 * forces @ compliance @ forces - approach @ forces + spring
        return 1e3 * value, 1e3 * unit * gradient

    bounds = [(0.0, None)] * approach.size
    options = {"ftol": 1e-16, "gtol": 1e-9, "maxiter": 5000, "maxfun": 50000}
    start = np.full(approach.size, 0.5)
    found = minimize(energy, start, jac=True, bounds=bounds, method="L-BFGS-B", options=options)
    return unit * found.x


@pytest.mark.parametrize("size", [1e-10, 1e-8])
@pytest.mark.parametrize("seed", range(8))
def test_forces_are_those_of_least_energy(seed: int, size: float) -> None:
    generator = np.random.default_rng(seed)
    n_wheel = int(generator.integers(1, 7))
    compliance = compliance_matrix(generator, n_wheel, size)
    approach = 2e-4 * generator.standard_normal(n_wheel)
    found = solve_hertz(compliance, approach, LAW, np.zeros(n_wheel), True)
    wanted = least_energy(compliance, approach)
    # What a quasi-Newton search over a function with roots of its variables leaves open.
    np.testing.assert_allclose(found.forces, wanted, atol=2e-4 * max(1.0, np.abs(wanted).max()))
    np.testing.assert_array_equal(found.closed, found.forces > 0.0)


@pytest.mark.parametrize("seed", range(10))
def test_a_whole_train_settles_in_few_iterations_from_anywhere(seed: int) -> None:
    """92 wheels, half of them off, from open, from deep and from the true contact."""
    generator = np.random.default_rng(seed)
    compliance = compliance_matrix(generator, 92, 6e-9)
    approach = 3e-4 * generator.standard_normal(92)
    for start in (np.full(92, -1e-2), np.full(92, 1e-2), np.full(92, LAW.reference_compression)):
        found = solve_hertz(compliance, approach, LAW, start, True)
        residual = found.compression + compliance @ found.forces - approach
        assert np.abs(residual).max() <= 1e-12  # the rule: 1e-9 m
        assert found.forces.min() >= 0.0
        assert np.all(found.forces[found.compression <= 0.0] == 0.0)
        assert found.iterations <= 25
    again = solve_hertz(compliance, approach, LAW, found.compression, True)
    assert again.iterations == 1
    assert found.closed.sum() not in (0, 92)


def test_a_small_change_follows_the_linear_law_of_the_tangent_stiffness() -> None:
    """Around the static load the law is linear with k_h = 1.5 K_h^(2/3) Q^(1/3)."""
    compliance = np.array([[3e-10, 1e-10], [1e-10, 2e-10]])
    static = np.full(2, LAW.reference_force)
    d = np.full(2, LAW.reference_compression)
    change = np.array([1e-8, -2e-8])
    found = solve_hertz(compliance, d + compliance @ static + change, LAW, d, True)
    spring = np.diag(1.0 / contact_stiffness(LAW, d, True))
    linear, _, _ = solve_contact(compliance + spring, change, np.ones(2, bool), False)
    # The law's curvature: d^2F / F is 3/4 (1e-8 / 1e-4)^2.
    np.testing.assert_allclose(found.forces - static, linear, rtol=2e-4)
    assert contact_stiffness(LAW, d, True)[0] == pytest.approx(1.2124e9, rel=1e-4)  # section 3.4


def test_contact_that_may_pull_is_odd() -> None:
    compliance, approach = np.diag([1e-9, 1e-9]), np.array([2e-4, -2e-4])
    found = solve_hertz(compliance, approach, LAW, np.zeros(2), False)
    assert found.forces[0] == pytest.approx(-found.forces[1], rel=1e-12)
    assert found.forces[0] > 0.0
    assert found.closed.all()
    np.testing.assert_allclose(found.forces, contact_force(LAW, found.compression, False))


def test_all_wheels_in_the_air_carry_nothing() -> None:
    found = solve_hertz(1e-9 * np.eye(3), -np.ones(3), LAW, np.ones(3), True)
    np.testing.assert_array_equal(found.forces, 0.0)
    np.testing.assert_allclose(found.compression, -1.0)
    assert not found.closed.any()


def test_a_wheel_without_any_compliance_below_it_is_pressed_by_its_approach() -> None:
    found = solve_hertz(np.zeros((1, 1)), np.array([1e-4]), LAW, np.zeros(1), True)
    assert found.forces[0] == pytest.approx(7.958e10 * 1e-6)


def test_what_is_no_number_is_refused() -> None:
    with pytest.raises(SingularSystemError, match="the contact"):
        solve_hertz(np.full((2, 2), np.nan), np.ones(2), LAW, np.ones(2), True)


def test_a_search_that_does_not_settle_says_when_and_at_which_wheel(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(nonlinear, "_MOST_ITERATIONS", 2)
    with pytest.raises(ConvergenceError, match=r"t = 0\.25 s \(wheel 2"):
        solve_hertz(1e-8 * np.eye(2), np.array([0.0, 1.0]), LAW, np.zeros(2), True, 0.25)
