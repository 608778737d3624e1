"""Spectral radius of the HHT-alpha method on one undamped or damped oscillator.

The state (a, dt a', dt^2 a'') of an oscillator of circular frequency omega advances by a constant
3 x 3 matrix; the method is unconditionally stable where no eigenvalue of it exceeds 1 in
magnitude, whatever omega dt.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Matrix, Vector
from solver.errors import InputError

__all__ = ["amplification_matrix", "require_unconditional_stability", "spectral_radius"]

_FREQUENCIES = np.concatenate([[0.0], np.logspace(-3, 6, 500)])
"""Values of omega dt that stand for all: a thousandth of a radian to far beyond any mesh."""
_ROUNDING = 1e-9
"""Room for rounding in an eigenvalue of a 3 x 3 matrix."""


def amplification_matrix(
    alpha: float, beta: float, gamma: float, omega_dt: float, damping_ratio: float = 0.0
) -> Matrix:
    """Matrix A of (a, dt a', dt^2 a'')(n+1) = A (a, dt a', dt^2 a'')(n), shape (3, 3).

    Args:
        alpha: HHT's parameter. [1]
        beta: Newmark's. [1]
        gamma: Newmark's. [1]
        omega_dt: Circular frequency times the time step. [rad]
        damping_ratio: Share of critical damping. [1]

    References:
        Hilber, Hughes and Taylor (1977), Improved numerical dissipation for time integration
        algorithms in structural dynamics, Earthquake Engineering and Structural Dynamics 5.
    """
    stiffness, viscosity, new = omega_dt**2, 2.0 * damping_ratio * omega_dt, 1.0 + alpha
    # Divided by 1 + stiffness, so that stiff modes keep their digits.
    scale = 1.0 / (1.0 + stiffness + viscosity)
    implicit = np.array(
        [[1.0, 0.0, -beta], [0.0, 1.0, -gamma],
         [new * stiffness * scale, new * viscosity * scale, scale]]
    )  # fmt: skip
    explicit = np.array(
        [[1.0, 1.0, 0.5 - beta], [0.0, 1.0, 1.0 - gamma],
         [alpha * stiffness * scale, alpha * viscosity * scale, 0.0]]
    )  # fmt: skip
    return np.linalg.solve(implicit, explicit)


def spectral_radius(
    alpha: float, beta: float, gamma: float, omega_dt: Vector, damping_ratio: float = 0.0
) -> Vector:
    """Greatest magnitude of an eigenvalue for each omega dt, shape (n,)."""
    matrices = [
        amplification_matrix(alpha, beta, gamma, float(value), damping_ratio) for value in omega_dt
    ]
    return np.abs(np.linalg.eigvals(np.array(matrices))).max(axis=1)


def require_unconditional_stability(alpha: float, beta: float, gamma: float) -> None:
    """Refuses parameters with which some frequency would grow.

    Raises:
        InputError: The method is not unconditionally stable; the message states its radius.
    """
    if not beta > 0.0 or not np.isfinite([beta, gamma]).all():
        raise InputError(
            "integration.newmark_beta", beta, "is not a positive number: the method is explicit",
            f"Leave beta and gamma out: {(1 - alpha) ** 2 / 4:g} and {0.5 - alpha:g} are stable.",
        )  # fmt: skip
    radius = spectral_radius(alpha, beta, gamma, _FREQUENCIES)
    worst = int(np.argmax(radius))
    if radius[worst] > 1.0 + _ROUNDING:
        raise InputError(
            "integration.newmark_beta", beta,
            f"with gamma = {gamma:g} and alpha = {alpha:g} is not unconditionally stable: the "
            f"spectral radius is {radius[worst]:.4g} at omega dt = {_FREQUENCIES[worst]:.3g}",
            f"Leave beta and gamma out: {(1 - alpha) ** 2 / 4:g} and {0.5 - alpha:g} are stable.",
        )  # fmt: skip
