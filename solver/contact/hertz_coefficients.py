"""Hertz's coefficients m, n and beta, exact by elliptic integrals.

The ellipse's axes ratio k = b/a follows from the auxiliary angle theta by

    tan^2(theta/2) = k^2 I1(k) / I2(k),                                              (3.58)

I0, I1, I2 the integrals of equations 3.53 to 3.55 with w = (b z)^2. They are Carlson's symmetric
integrals, which lose no digits at either end, neither for a circle (where the usual
(K - E) / (1 - k^2) is 0/0) nor for a long ellipse.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import elliprd

from solver.arrays import FloatArray
from solver.errors import InputError

__all__ = ["HertzCoefficients", "axes_ratio", "coefficients", "hertz_integrals"]

_SMALLEST_ANGLE = 1e-100
"""Below it the square underflows; the ellipse is a line long before. [rad]"""
_MOST_ITERATIONS = 20
"""Newton's method needs 6 at most over the whole range: only a defect could need more."""


class HertzCoefficients(NamedTuple):
    """Coefficients of ellipse and stiffness, each of the shape of theta.

    Attributes:
        m: Of the long semi-axis (3.60). [1]
        n: Of the short semi-axis (3.62). [1]
        beta: Of the stiffness (3.68); 1/pi for a circle. [1]
    """

    m: FloatArray
    n: FloatArray
    beta: FloatArray


def hertz_integrals(axes_ratio: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Integrals I0, I1 and I2 of equations 3.53 to 3.55.

    Args:
        axes_ratio: k = b/a, in (0, 1], any shape. [1]

    Returns:
        I0, I1 and I2, each of that shape, with I0 = I1 + I2. [1]

    References:
        Carlson (1995), Numerical computation of real or complex elliptic integrals, for R_D.
        With m = 1 - k^2: I0 = K(m), I1 = (K - E) / m, I2 = (E - k^2 K) / m.
    """
    k_squared = np.square(np.asarray(axes_ratio, float))
    I1 = elliprd(0.0, k_squared, 1.0) / 3.0
    I2 = elliprd(0.0, 1.0, k_squared) * k_squared / 3.0
    return I1 + I2, I1, I2


def axes_ratio(theta: ArrayLike) -> FloatArray:
    """Axes ratio k = b/a of the contact ellipse, the root of equation 3.58.

    Newton's method for ln k: the logarithm of the right-hand side has a slope between 3/2 (circle)
    and 2 (line), so that it converges from any start.

    Args:
        theta: Auxiliary angle, in (0, pi/2], any shape. [rad]

    Returns:
        Of that shape, in (0, 1]. [1]

    Raises:
        InputError: An angle is outside (0, pi/2].
    """
    angle = _checked(theta)
    target = 2.0 * np.log(np.tan(0.5 * angle))
    log_k = 0.5 * target  # from above: I1 >= I2
    for _ in range(_MOST_ITERATIONS):
        k_squared = np.exp(2.0 * log_k)
        _, I1, I2 = hertz_integrals(np.exp(log_k))
        residual = 2.0 * log_k + np.log(I1 / I2) - target
        step = residual / _slope(k_squared, I1 / I2)
        log_k = np.minimum(log_k - step, 0.0)
        if np.all(np.abs(step) <= 1e-9):  # quadratic: the next one would be of rounding size
            break
    return np.asarray(np.exp(log_k))


def _slope(k_squared: FloatArray, ratio: FloatArray) -> FloatArray:
    """Derivative of ln(k^2 I1/I2) by ln k, from the derivatives of K and E; ratio is I1/I2."""
    parameter = 1.0 - k_squared
    near_circle = parameter < 1e-6  # 0/0 at the circle, where the slope is 3/2
    safe = np.where(near_circle, 1.0, parameter)
    return np.where(near_circle, 1.5, 2.0 - (1.0 / ratio - k_squared * ratio) / safe)


def coefficients(theta: ArrayLike) -> HertzCoefficients:
    """Coefficients m, n and beta of Hertz's theory.

    Args:
        theta: Auxiliary angle, in (0, pi/2], any shape. [rad]

    Returns:
        Coefficients of that shape.

    Raises:
        InputError: An angle is outside (0, pi/2].

    References:
        Neves (2016), equations 3.58, 3.60, 3.62 and 3.68; tables 3.3 and 3.4.
    """
    half = 0.5 * _checked(theta)
    k = axes_ratio(theta)
    I0, I1, I2 = hertz_integrals(k)
    m = np.cbrt(2.0 * I1 / (np.pi * np.sin(half) ** 2))
    n = np.cbrt(2.0 * k * I2 / (np.pi * np.cos(half) ** 2))
    beta = (0.5 * np.pi * m / I0) ** 1.5 / np.pi
    return HertzCoefficients(np.asarray(m), np.asarray(n), np.asarray(beta))


def _checked(theta: ArrayLike) -> FloatArray:
    """The angles as an array, all of them in (0, pi/2]."""
    angle = np.asarray(theta, float)
    good = (angle >= _SMALLEST_ANGLE) & (angle <= 0.5 * np.pi)
    if not np.all(good):
        raise InputError(
            "theta",
            float(angle[~good].flat[0]),
            "the auxiliary angle lies above 0 (line contact) and at most pi/2 (circle)",
            "Give radians; take it from the relative curvature of two bodies that touch.",
        )
    return angle
