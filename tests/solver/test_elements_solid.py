"""Eight-node solid: rigid motions, patch test, bending, mass."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from solver.arrays import Matrix
from solver.elements import solid
from solver.elements.gauss import CUBE_CORNERS
from solver.errors import InputError

YOUNG, NU, DENSITY = 36e9, 0.2, 2890.0
DISTORTED = CUBE_CORNERS + 0.2 * np.random.default_rng(1).standard_normal((8, 3))


def _turned(points: Matrix) -> Matrix:
    return points @ Rotation.from_euler("xyz", [0.3, -0.7, 1.1]).as_matrix().T + [5.0, -2.0, 1.0]


@pytest.mark.parametrize("nodes", [CUBE_CORNERS, DISTORTED, _turned(DISTORTED)])
def test_a_solid_has_exactly_six_motions_without_strain(nodes: Matrix) -> None:
    values = np.linalg.eigvalsh(solid.stiffness(nodes[None], YOUNG, NU)[0])
    assert np.all(np.abs(values[:6]) < 1e-9 * values[-1])
    assert values[6] > 1e-4 * values[-1]


def test_any_constant_strain_passes_through_a_distorted_solid() -> None:
    """The nodal forces of a linear displacement field do the exact work on any other field."""
    nodes = _turned(DISTORTED)
    stiffness = solid.stiffness(nodes[None], YOUNG, NU)[0]
    volume = solid.mass(nodes[None], 1.0)[0][::3, ::3].sum()
    gradient = np.random.default_rng(2).standard_normal((3, 3)) * 1e-4
    strain = 0.5 * (gradient + gradient.T)
    field = (nodes @ gradient.T).ravel()
    shear = YOUNG / (2.0 * (1.0 + NU))
    lame = YOUNG * NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
    energy = volume * (shear * np.sum(strain**2) + 0.5 * lame * np.trace(strain) ** 2)
    assert 0.5 * field @ stiffness @ field == pytest.approx(energy, rel=1e-10)


def test_one_row_of_solids_bends_as_a_beam() -> None:
    """Pure bending of a 10:1 cantilever, one element high: exact with incompatible modes."""
    length, height, width, count = 2.0, 0.2, 0.1, 8
    x = np.linspace(0.0, length, count + 1)
    face = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * [width, height]
    nodes = np.array([[[a, *corner] for corner in face] for a in x])
    dofs = np.arange((count + 1) * 12).reshape(count + 1, 4, 3)
    order = [(0, 0), (1, 0), (1, 1), (0, 1), (0, 3), (1, 3), (1, 2), (0, 2)]
    elements = np.array([[nodes[e + i, k] for i, k in order] for e in range(count)])
    stiffness = np.zeros((dofs.size, dofs.size))
    for e, matrix in enumerate(solid.stiffness(elements, YOUNG, 0.0)):
        index = np.concatenate([dofs[e + i, k] for i, k in order])
        stiffness[np.ix_(index, index)] += matrix
    moment = 1e3
    load = np.zeros(dofs.size)
    load[dofs[-1, :, 0]] = np.array([1.0, 1.0, -1.0, -1.0]) * moment / (2.0 * height)
    free = dofs[1:].ravel()
    tip = np.linalg.solve(stiffness[np.ix_(free, free)], load[free])
    deflection = tip.reshape(count, 4, 3)[-1, :, 2].mean()
    exact = moment * length**2 / (2.0 * YOUNG * width * height**3 / 12.0)
    # The clamped face holds all displacements, which changes nothing without Poisson's effect.
    assert deflection == pytest.approx(exact, rel=1e-6)


def test_mass_is_volume_times_density_and_its_centre_is_right() -> None:
    sleeper = CUBE_CORNERS * [0.1, 1.3, 0.115]
    sleeper[4:, 0] *= 0.75
    sleeper[4:, 1] *= 1.275 / 1.3
    mass = solid.mass(sleeper[None], DENSITY)[0]
    # Neves (2016), section 6.3.2: "each sleeper has a mass of 300 kg".
    assert mass[::3, ::3].sum() == pytest.approx(299.7, abs=0.05)
    assert np.allclose(mass[::3, 1::3], 0.0)


def test_an_element_inside_out_is_refused() -> None:
    with pytest.raises(InputError, match="no positive volume"):
        solid.stiffness(CUBE_CORNERS[None] * [1.0, -1.0, 1.0], YOUNG, NU)
