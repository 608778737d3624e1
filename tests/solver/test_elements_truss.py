"""Truss: stretch, a three-bar frame, frequencies, mass, bad input."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
from scipy.linalg import eigh

from solver.elements import line_mass, truss
from solver.errors import InputError

YOUNG, DENSITY = 210e9, 7850.0


def test_a_bar_answers_to_stretch_alone() -> None:
    """E A / L times the stretch along the bar, in any direction; nothing across it."""
    nodes = np.array([[[1.0, 2.0, 3.0], [3.0, 3.0, 5.0]]])
    matrix = truss.stiffness(nodes, np.array([0.02]), np.array([YOUNG]))[0]
    along, across = np.array([2.0, 1.0, 2.0]) / 3.0, np.array([1.0, 0.0, -1.0])
    force = YOUNG * 0.02 / 3.0 * 1e-4
    still = np.zeros(3)
    assert matrix @ [*still, *(1e-4 * along)] == pytest.approx(
        [*(-force * along), *(force * along)]
    )
    assert np.abs(matrix @ [*still, *across]).max() < 1e-15 * np.abs(matrix).max()


def test_a_bracket_of_three_bars() -> None:
    """Bars at 0 and +-45 degrees meet at a point: K = E A / L diag(1 + 2 c3, 2 c3)."""
    corner = np.array([[[1.0, 0, 0], [0, 0, 0]], [[1, 0, 1], [0, 0, 0]], [[1, 0, -1], [0, 0, 0]]])
    matrices = truss.stiffness(corner, np.full(3, 1e-3), np.full(3, YOUNG))
    whole = matrices[:, 3:, 3:].sum(axis=0)[np.ix_([0, 2], [0, 2])]
    cube = sqrt(0.5) ** 3
    assert whole == pytest.approx(YOUNG * 1e-3 * np.diag([1.0 + 2.0 * cube, 2.0 * cube]))


def test_a_fixed_rods_frequency_converges_at_order_two() -> None:
    """omega = (pi / 2 L) sqrt(E / rho); linear elements with consistent mass err (k h)^2 / 24."""
    length, errors = 3.0, []
    exact = pi / (2.0 * length) * sqrt(YOUNG / DENSITY)
    for count in (8, 16):
        x = np.linspace(0.0, length, count + 1)
        nodes = np.zeros((count, 2, 3))
        nodes[:, 0, 0], nodes[:, 1, 0] = x[:-1], x[1:]
        area = np.full(count, 0.01)
        stiffness, mass = np.zeros((2, count + 1, count + 1))
        for whole, matrices in (
            (stiffness, truss.stiffness(nodes, area, np.full(count, YOUNG))),
            (mass, truss.mass(nodes, area, DENSITY)),
        ):
            for element in range(count):
                whole[element : element + 2, element : element + 2] += matrices[element, ::3, ::3]
        omega = sqrt(eigh(stiffness[1:, 1:], mass[1:, 1:], eigvals_only=True)[0])
        errors.append(omega / exact - 1.0)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.02)
    assert errors[1] == pytest.approx((pi / 32.0) ** 2 / 24.0, rel=0.01)


def test_mass_is_that_of_the_line_it_covers() -> None:
    nodes = np.random.default_rng(0).standard_normal((2, 2, 3))
    matrices = truss.mass(nodes, np.array([0.01, 0.03]), DENSITY)
    assert matrices[1] == pytest.approx(line_mass.mass(nodes[1:], 0.03 * DENSITY)[0])


def test_a_bar_without_length_is_refused() -> None:
    nodes = np.array([[[0.0, 0, 0], [1, 0, 0]], [[2, 0, 0], [2, 0, 0]]])
    with pytest.raises(InputError, match="truss element 1 has no length"):
        truss.stiffness(nodes, np.ones(2), np.ones(2))
