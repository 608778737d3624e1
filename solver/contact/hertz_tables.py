"""Hertz's coefficients as others printed them, for comparison with the exact ones.

Table 3.1 is Hertz's own (1882), tables 3.3 and 3.4 were computed by Neves with Maple, and the
closed forms with the constants of table 3.2 are those of Shabana et al. (2001), in error by up to
8 percent. None of them enters a simulation.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import FloatArray, Vector
from solver.data import load

__all__ = [
    "EllipseTable",
    "StiffnessTable",
    "hertz_1882",
    "neves_ellipse",
    "neves_stiffness",
    "shabana_2001",
]


class EllipseTable(NamedTuple):
    """Printed coefficients of the ellipse, each of shape (n_row,).

    Attributes:
        theta: Auxiliary angle. [rad]
        m: Of the long semi-axis. [1]
        n: Of the short semi-axis. [1]
        last_digit: One unit of the last digit printed. [1]
    """

    theta: Vector
    m: Vector
    n: Vector
    last_digit: float


class StiffnessTable(NamedTuple):
    """Printed coefficient of the stiffness, each of shape (n_row,).

    Attributes:
        theta: Auxiliary angle. [rad]
        beta: Coefficient of K_h. [1]
        last_digit: One unit of the last digit printed. [1]
    """

    theta: Vector
    beta: Vector
    last_digit: float


def hertz_1882() -> EllipseTable:
    """Hertz's coefficients from 10 to 90 degrees (table 3.1 of Neves, 2016).

    Five of its values are wrong in the third figure: m and n at 70 degrees (by 0.1 and 0.2
    percent) and at 20 degrees (1.0 percent each), n at 10 degrees (2.4 percent).
    """
    return _ellipse_table("hertz_1882")


def neves_ellipse() -> EllipseTable:
    """Coefficients m and n from 2 to 90 degrees (table 3.3 of Neves, 2016)."""
    return _ellipse_table("neves_ellipse")


def neves_stiffness() -> StiffnessTable:
    """Coefficient beta from 2 to 90 degrees (table 3.4 of Neves, 2016)."""
    table = load("hertz_coefficients")["neves_stiffness"]
    return StiffnessTable(
        np.radians(table["theta"]), np.array(table["beta"]), 10.0 ** -table["decimals"]
    )


def shabana_2001(theta: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Coefficients m and n by the closed forms of Shabana et al. (2001).

    Args:
        theta: Auxiliary angle, in (0, pi/2), any shape. [rad]

    Returns:
        m (3.63) and n (3.64), each of that shape. [1]
    """
    angle = np.asarray(theta, float)
    constants = load("hertz_coefficients")["shabana_2001"]
    of_m, of_n = constants["m"], constants["n"]
    tangent = np.tan(angle - 0.5 * np.pi)
    m = of_m["A"] * tangent + of_m["B"] / angle ** of_m["C"] + of_m["D"]
    n = (
        1.0 / (of_n["A"] * tangent + 1.0)
        + of_n["B"] * angle ** of_n["C"]
        + of_n["D"] * np.sin(angle)
    )
    return m, n


def _ellipse_table(name: str) -> EllipseTable:
    table = load("hertz_coefficients")[name]
    return EllipseTable(
        np.radians(table["theta"]),
        np.array(table["m"]),
        np.array(table["n"]),
        10.0 ** -table["decimals"],
    )
