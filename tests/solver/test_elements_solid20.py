"""Twenty-node solid: interpolation, rank, constant strain, pure bending, mass."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from solver.arrays import FloatArray, Matrix
from solver.elements import solid20
from solver.elements.gauss import CUBE_CORNERS
from solver.errors import InputError

YOUNG, NU, DENSITY = 36e9, 0.2, 2890.0
RANDOM = np.random.default_rng(1)


def _straight(corners: Matrix) -> Matrix:
    return np.vstack([corners, corners[np.array(solid20.EDGES)].mean(axis=1)])


def _turned(points: Matrix) -> Matrix:
    return points @ Rotation.from_euler("xyz", [0.3, -0.7, 1.1]).as_matrix().T + [5.0, -2.0, 1.0]


DISTORTED = _straight(CUBE_CORNERS + 0.2 * RANDOM.standard_normal((8, 3)))
CURVED = DISTORTED + 0.05 * RANDOM.standard_normal((20, 3))
SHEARED = np.array([[1.0, 0.3, -0.2], [0.0, 0.5, 0.1], [0.1, 0.0, 0.25]])
"""Edges of a parallelepiped, one a row."""
SHAPES = [solid20.NODES, _turned(solid20.NODES * [1.0, 0.1, 2.0]), _turned(DISTORTED), CURVED]


def _quadratics(points: Matrix) -> Matrix:
    """The twenty polynomials of the serendipity space, shape (n_point, 20)."""
    x, y, z = points.T
    linear = [np.ones_like(x), x, y, z, x * y, y * z, z * x, x * y * z]
    return np.stack([*linear, *(x**2 * p for p in (1, y, z, y * z))]
                    + [y**2 * p for p in (1, z, x, z * x)]
                    + [z**2 * p for p in (1, x, y, x * y)], axis=1)  # fmt: skip


def test_it_interpolates_its_twenty_polynomials_and_their_derivatives() -> None:
    points, step = RANDOM.uniform(-1.0, 1.0, (6, 3)), 1e-6
    nodal = _quadratics(solid20.NODES)
    assert np.allclose(solid20.shape_functions(solid20.NODES), np.eye(20), atol=1e-14)
    assert np.allclose(solid20.shape_functions(points) @ nodal, _quadratics(points), atol=1e-13)
    for axis, arm in enumerate(step * np.eye(3)):
        slope = (_quadratics(points + arm) - _quadratics(points - arm)) / (2.0 * step)
        # Central differences of quadratics are exact: what is left is rounding over the step.
        assert np.allclose(solid20.natural_gradients(points)[:, axis] @ nodal, slope, atol=1e-9)


@pytest.mark.parametrize("nodes", SHAPES)
def test_it_has_exactly_six_motions_without_strain(nodes: Matrix) -> None:
    matrix = solid20.stiffness(nodes[None], YOUNG, NU)[0]
    assert np.array_equal(matrix, matrix.T)
    values = np.linalg.eigvalsh(matrix)
    # Rounding, and a million times as much for the softest true motion, that of a plate 20 : 1.
    assert np.all(np.abs(values[:6]) < 1e-13 * values[-1])
    assert values[6] > 1e-7 * values[-1]


@pytest.mark.parametrize("nodes", SHAPES)
def test_any_constant_strain_carries_its_exact_energy(nodes: Matrix) -> None:
    """On curved elements too: the volume of the energy is the volume of the integration."""
    stiffness = solid20.stiffness(nodes[None], YOUNG, NU)[0]
    volume = solid20.mass(nodes[None], 1.0)[0][::3, ::3].sum()
    gradient = np.random.default_rng(2).standard_normal((3, 3)) * 1e-4
    strain = 0.5 * (gradient + gradient.T)
    field = (nodes @ gradient.T).ravel()
    shear = YOUNG / (2.0 * (1.0 + NU))
    lame = YOUNG * NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
    energy = volume * (shear * np.sum(strain**2) + 0.5 * lame * np.trace(strain) ** 2)
    assert 0.5 * field @ stiffness @ field == pytest.approx(energy, rel=1e-12)


def _bent(points: Matrix, radius: float) -> Matrix:
    """Displacement of a bar along x bent in the plane of x and z, with Poisson's effect."""
    x, y, z = points.T
    return np.column_stack(
        [-x * z, NU * y * z, 0.5 * (x**2 + NU * (z**2 - y**2))]
    ) / radius  # fmt: skip


def test_one_parallelepiped_bends_exactly() -> None:
    """Pure bending is of second degree: energy E (integral of z^2) / (2 R^2), however skewed."""
    nodes = solid20.NODES @ SHEARED
    field = _bent(nodes, 50.0).ravel()
    energy = 0.5 * field @ solid20.stiffness(nodes[None], YOUNG, NU)[0] @ field
    # z = SHEARED[:, 2] . xi, and the mean of xi_i xi_j over the cube is 1/3 or 0.
    volume = 8.0 * np.linalg.det(SHEARED)
    second_moment = volume * np.sum(SHEARED[:, 2] ** 2) / 3.0
    assert energy == pytest.approx(0.5 * YOUNG * second_moment / 50.0**2, rel=1e-12)


@pytest.mark.parametrize("nodes", SHAPES)
def test_mass_is_positive_definite_and_counts_every_direction_once(nodes: Matrix) -> None:
    mass = solid20.mass(nodes[None], DENSITY)[0]
    assert np.linalg.eigvalsh(mass)[0] > 0.0
    blocks: FloatArray = mass.reshape(20, 3, 20, 3).sum(axis=(0, 2))
    assert np.allclose(blocks, blocks[0, 0] * np.eye(3), rtol=1e-12, atol=1e-9 * blocks[0, 0])


def test_mass_has_the_moments_of_its_volume() -> None:
    """Volume, centre, inertia and the integral of x^4: all exact on a parallelepiped."""
    nodes = solid20.NODES @ SHEARED + [0.7, -0.4, 0.2]
    scalar = solid20.mass(nodes[None], DENSITY)[0][::3, ::3]
    volume = 8.0 * np.linalg.det(SHEARED)
    assert scalar.sum() == pytest.approx(DENSITY * volume, rel=1e-12)
    assert scalar.sum(axis=0) @ nodes == pytest.approx(
        DENSITY * volume * np.array([0.7, -0.4, 0.2]), rel=1e-12
    )
    inertia = SHEARED.T @ SHEARED / 3.0 + np.outer([0.7, -0.4, 0.2], [0.7, -0.4, 0.2])
    assert nodes.T @ scalar @ nodes == pytest.approx(DENSITY * volume * inertia, rel=1e-12)
    square = (solid20.NODES[:, 0]) ** 2
    assert square @ scalar @ square == pytest.approx(DENSITY * volume / 5.0, rel=1e-12)


def test_elements_in_pieces_are_the_same_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    many = np.stack([CURVED * (1.0 + 0.1 * i) for i in range(5)])
    stiffness, mass = solid20.stiffness(many, YOUNG, NU), solid20.mass(many, DENSITY)
    monkeypatch.setattr("solver.elements.solid20._PIECE", 2)
    # Library products may round differently in another batch.
    assert np.allclose(solid20.stiffness(many, YOUNG, NU), stiffness, rtol=1e-12, atol=1e-2)
    assert np.allclose(solid20.mass(many, DENSITY), mass, rtol=1e-12, atol=1e-9)
    assert np.allclose(
        solid20.stiffness(CURVED[None], YOUNG, NU)[0], stiffness[0], rtol=1e-12, atol=1e-2
    )


def test_a_middle_node_beyond_its_corner_is_refused() -> None:
    folded = np.stack([solid20.NODES, solid20.NODES])
    folded[1, 8, 0] = 1.5
    with pytest.raises(InputError, match="solid element 1 has no positive volume"):
        solid20.stiffness(folded, YOUNG, NU)
    with pytest.raises(InputError, match="no positive volume"):
        solid20.mass(solid20.NODES[None] * [1.0, -1.0, 1.0], DENSITY)
