"""Spectral radius of HHT-alpha, and parameters by hand that are refused."""

from __future__ import annotations

import numpy as np
import pytest

from solver.errors import InputError
from solver.integrators.hht import HHT
from solver.integrators.stability import spectral_radius

ALPHAS = (0.0, -0.05, -0.1, -0.3, -1.0 / 3.0)
OMEGA_DT = np.logspace(-2, 5, 200)


def _radius(alpha: float, omega_dt: np.ndarray) -> np.ndarray:
    method = HHT(alpha, 1.0)
    return spectral_radius(alpha, method.beta, method.gamma, omega_dt)


@pytest.mark.parametrize("alpha", ALPHAS)
def test_no_frequency_grows(alpha: float) -> None:
    # Rounding of the eigenvalues of a 3 x 3 matrix.
    assert _radius(alpha, OMEGA_DT).max() <= 1.0 + 1e-12


@pytest.mark.parametrize("alpha", ALPHAS)
def test_stiff_modes_decay_by_the_closed_form(alpha: float) -> None:
    """For omega dt to infinity the radius is (1 + alpha) / (1 - alpha)."""
    # omega dt is finite; at alpha = -1/3 the root is double, and that shows as its square root.
    tolerance = 1e-3 if alpha < -0.32 else 1e-7
    stiff = float(_radius(alpha, np.array([1e5]))[0])
    assert stiff == pytest.approx((1.0 + alpha) / (1.0 - alpha), abs=tolerance)


def test_low_modes_are_kept_and_high_ones_damped_monotonically() -> None:
    radius = _radius(-0.1, OMEGA_DT)
    assert radius[0] == pytest.approx(1.0, abs=1e-6)
    assert np.all(np.diff(radius) <= 1e-12)


def test_the_thesis_as_printed_is_unstable() -> None:
    """Sections 6.4.3 and 7.3 print beta = 9/20 and gamma = 9025/40000 for alpha = -0.05."""
    with pytest.raises(InputError, match=r"spectral radius is 1\.269"):
        HHT(-0.05, 1e-3, newmark_beta=9 / 20, newmark_gamma=9025 / 40000)
    with pytest.raises(InputError, match=r"spectral radius is 1\.105"):
        HHT(-0.05, 1e-3, newmark_beta=9025 / 40000, newmark_gamma=9 / 20)


@pytest.mark.parametrize(("beta", "gamma"), [(1 / 6, 0.5), (0.25, 0.4), (0.0, 0.5), (np.nan, 0.5)])
def test_sets_that_are_not_unconditionally_stable_are_refused(beta: float, gamma: float) -> None:
    with pytest.raises(InputError) as caught:
        HHT(0.0, 1e-3, newmark_beta=beta, newmark_gamma=gamma)
    assert caught.value.field == "integration.newmark_beta"
    assert "0.25 and 0.5" in caught.value.remedy


def test_a_stable_set_by_hand_is_taken() -> None:
    method = HHT(0.0, 1e-3, newmark_beta=0.3025, newmark_gamma=0.6)
    assert (method.beta, method.gamma) == (0.3025, 0.6)


@pytest.mark.parametrize("alpha", [-0.34, 0.01])
def test_alpha_outside_its_range_is_refused(alpha: float) -> None:
    with pytest.raises(InputError, match="alpha"):
        HHT(alpha, 1e-3)
