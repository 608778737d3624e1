"""Flat shell: rigid motions, patch tests, plates, a strip, torsion, the Scordelis-Lo roof."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

from solver.arrays import FloatArray, IntArray, IntVector, Matrix, SparseMatrix
from solver.assembly.scatter import ElementMatrices, scatter
from solver.elements import shell
from solver.errors import InputError

YOUNG, NU, THICKNESS = 35.4e9, 0.2, 0.27
DISTORTED = np.array([[0.0, 0.0, 0.0], [1.1, 0.1, 0.0], [1.3, 0.9, 0.0], [-0.1, 1.2, 0.0]])
TURNS = [np.zeros(3), np.array([0.4, 0.0, 0.0]), np.array([0.3, -0.7, 1.1])]


def _turned(points: Matrix, angles: Matrix) -> Matrix:
    return points @ Rotation.from_euler("xyz", angles).as_matrix().T


def _whole(nodes: FloatArray, thickness: float = THICKNESS, young: float = YOUNG) -> FloatArray:
    t, e = np.full(len(nodes), thickness), np.full(len(nodes), young)
    return shell.stiffness(nodes, t, e, NU) + shell.drilling_stiffness(nodes, t, e, NU)


@pytest.mark.parametrize("angles", TURNS)
def test_a_shell_has_exactly_six_motions_without_strain(angles: Matrix) -> None:
    values = np.linalg.eigvalsh(_whole(_turned(DISTORTED, angles)[None])[0])
    assert np.all(np.abs(values[:6]) < 1e-12 * values[-1])
    assert values[6] > 1e-7 * values[-1]


@pytest.mark.parametrize("angles", TURNS)
def test_constant_membrane_strain_and_curvature_carry_their_exact_energy(angles: Matrix) -> None:
    turned = _turned(DISTORTED, angles)
    matrix = shell.stiffness(turned[None], np.array([THICKNESS]), np.array([YOUNG]), NU)[0]
    x, y = DISTORTED[:, 0], DISTORTED[:, 1]
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    a, b, c = 1e-4, -2e-4, 0.7e-4
    membrane, bending = np.zeros((4, 6)), np.zeros((4, 6))
    membrane[:, 0], membrane[:, 1] = a * x + 0.5 * c * y, b * y + 0.5 * c * x
    # w = -(a x2 + b y2 + c x y) / 2, slopes (ry, -rx) = -grad w.
    bending[:, 2] = -0.5 * (a * x**2 + b * y**2 + c * x * y)
    bending[:, 4], bending[:, 3] = a * x + 0.5 * c * y, -(b * y + 0.5 * c * x)
    quadratic = a**2 + b**2 + 2.0 * NU * a * b + 0.5 * (1.0 - NU) * c**2
    scale = 0.5 * YOUNG * area / (1.0 - NU**2) * quadratic
    for field, energy in ((membrane, scale * THICKNESS), (bending, scale * THICKNESS**3 / 12.0)):
        rotated = _turned(field.reshape(8, 3), angles).ravel()
        assert 0.5 * rotated @ matrix @ rotated == pytest.approx(energy, rel=1e-9)


def _grid(nx: int, ny: int) -> IntArray:
    numbers = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    corners = [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]
    return np.stack(corners, axis=-1).reshape(-1, 4)


def _assembled(nodes: Matrix, quads: IntArray, thickness: float, young: float) -> SparseMatrix:
    dofs = (6 * quads[:, :, None] + np.arange(6)).reshape(len(quads), 24)
    matrices = _whole(nodes[quads], thickness, young)
    return scatter([ElementMatrices(freedoms=dofs, matrices=matrices)], 6 * len(nodes))


def _solved(stiffness: SparseMatrix, load: Matrix, held: IntVector) -> Matrix:
    free = np.setdiff1d(np.arange(len(load)), held)
    result = np.zeros(len(load))
    result[free] = spsolve(stiffness[free][:, free].tocsc(), load[free])
    return result.reshape(-1, 6)


@pytest.mark.parametrize("thickness", [0.001, 0.1])
def test_a_thin_clamped_plate_does_not_lock(thickness: float) -> None:
    """Uniform load on a clamped square plate: 0.00126532 p L4 / D (Taylor and Govindjee, 2004)."""
    count = 16
    x = np.linspace(0.0, 10.0, count + 1)
    nodes = np.array([[a, b, 0.0] for a in x for b in x])
    quads = _grid(count, count)
    load = np.zeros((len(nodes), 6))
    np.add.at(load[:, 2], quads.ravel(), 0.25 * (10.0 / count) ** 2)
    rim = np.flatnonzero(np.any(np.isclose(nodes[:, :2] % 10.0, 0.0), axis=1))
    held = (6 * rim[:, None] + np.arange(6)).ravel()
    response = _solved(_assembled(nodes, quads, thickness, 1e7), load.ravel(), held)
    rigidity = 1e7 * thickness**3 / (12.0 * (1.0 - NU**2))
    # Sixteen elements a side: within half a percent; shear of the thicker one adds 0.02 percent.
    exact = 0.00126532 * 10.0**4 / rigidity
    assert response[:, 2].max() == pytest.approx(exact, rel=5e-3)


def test_a_web_one_element_high_bends_in_its_plane() -> None:
    """Tip load on a slender cantilever standing on edge: Timoshenko's deflection."""
    length, height, count = 10.0, 1.0, 20
    x = np.linspace(0.0, length, count + 1)
    nodes = np.array([[a, 0.0, z] for a in x for z in (0.0, height)])
    stiffness = _assembled(nodes, _grid(count, 1), 0.2, YOUNG)
    load = np.zeros((len(nodes), 6))
    load[-2:, 2] = 500.0
    deflection = _solved(stiffness, load.ravel(), np.arange(12))[-1, 2]
    inertia = 0.2 * height**3 / 12.0
    shear = 5.0 / 6.0 * 0.2 * height * YOUNG / (2.0 * (1.0 + NU))
    exact = 1e3 * (length**3 / (3.0 * YOUNG * inertia) + length / shear)
    # The clamp holds Poisson's strain and twenty elements leave (h/L)2 / 12: half a percent.
    assert deflection == pytest.approx(exact, rel=5e-3)


def test_a_strip_twists_as_saint_venant_says() -> None:
    """Torque on a thin strip: twist T / (G b t3 / 3 (1 - 0.63 t / b))."""
    length, width, thickness, count = 10.0, 1.0, 0.05, 20
    x, y = np.linspace(0.0, length, count + 1), np.linspace(-0.5, 0.5, 9)
    nodes = np.array([[a, b * width, 0.0] for a in x for b in y])
    stiffness = _assembled(nodes, _grid(count, 8), thickness, YOUNG)
    load = np.zeros((len(nodes), 6))
    load[-9, 2], load[-1, 2] = -1e3, 1e3
    axis = _solved(stiffness, load.ravel(), np.arange(54))[4::9, 3]
    twist = (axis[14] - axis[6]) / (x[14] - x[6])
    shear = YOUNG / (2.0 * (1.0 + NU))
    constant = width * thickness**3 / 3.0 * (1.0 - 0.63 * thickness / width)
    # Away from the ends. Eight elements across do not resolve the shear that turns round the
    # strip's edges within a thickness: within 2.5 percent, on the stiff side.
    assert twist == pytest.approx(1e3 * width / (shear * constant), rel=0.025)


def test_the_scordelis_lo_roof() -> None:
    """Vertical displacement of the free edge's middle: 0.3024 (MacNeal and Harder, 1985)."""
    count, radius, half_length = 16, 25.0, 25.0
    x = np.linspace(0.0, half_length, count + 1)
    angle = np.linspace(0.0, 40.0, count + 1) * pi / 180.0
    nodes = np.array([[a, radius * np.sin(t), radius * np.cos(t)] for a in x for t in angle])
    quads = _grid(count, count)
    load = np.zeros((len(nodes), 6))
    corners = nodes[quads]
    area = np.linalg.norm(
        np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1
    )
    np.add.at(load[:, 2], quads.ravel(), np.repeat(-90.0 * 0.125 * area, 4))
    grid = np.arange(len(nodes)).reshape(count + 1, count + 1)
    held = [
        *(6 * grid[-1][:, None] + [1, 2, 3]).ravel(),  # diaphragm
        *(6 * grid[0][:, None] + [0, 4, 5]).ravel(),  # plane of symmetry x = 0
        *(6 * grid[:, 0][:, None] + [1, 3, 5]).ravel(),  # crown, symmetry y = 0
    ]
    dofs = (6 * quads[:, :, None] + np.arange(6)).reshape(len(quads), 24)
    t, e = np.full(len(quads), 0.25), np.full(len(quads), 4.32e8)
    matrices = shell.stiffness(corners, t, e, 0.0) + shell.drilling_stiffness(corners, t, e, 0.0)
    stiffness = scatter([ElementMatrices(freedoms=dofs, matrices=matrices)], 6 * len(nodes))
    edge = _solved(stiffness, load.ravel(), np.array(held))[grid[0, -1], 2]
    assert edge == pytest.approx(-0.3024, rel=0.015)


def test_mass_counts_translation_once_and_drilling_never() -> None:
    turned = _turned(DISTORTED, TURNS[2])
    mass = shell.mass(turned[None], np.array([THICKNESS]), 2469.8)[0]
    x, y = DISTORTED[:, 0], DISTORTED[:, 1]
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    for axis in range(3):
        lifted = np.zeros((4, 6))
        lifted[:, axis] = 1.0
        assert lifted.ravel() @ mass @ lifted.ravel() == pytest.approx(2469.8 * area * THICKNESS)
    normal = Rotation.from_euler("xyz", TURNS[2]).as_matrix()[:, 2]
    drilling = np.zeros((4, 6))
    drilling[:, 3:] = normal
    assert np.allclose(mass @ drilling.ravel(), 0.0, atol=1e-10)


def test_a_warped_shell_is_refused() -> None:
    warped = DISTORTED.copy()
    warped[2, 2] = 0.1
    with pytest.raises(InputError, match="warped"):
        shell.mass(warped[None], np.array([0.1]), 1.0)
