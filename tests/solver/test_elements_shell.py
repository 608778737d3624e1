"""Flat shell: rigid motions, patch tests, offset of the mid-surface, mass."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from solver.arrays import FloatArray, Matrix
from solver.elements import shell
from solver.elements.rigid_link import offset_rows
from solver.errors import InputError
from tests.solver.element_meshes import Mesh, equilibrium, shell_stiffness

YOUNG, NU, THICKNESS = 35.4e9, 0.2, 0.27
DISTORTED = np.array([[0.0, 0.0, 0.0], [1.1, 0.1, 0.0], [1.3, 0.9, 0.0], [-0.1, 1.2, 0.0]])
TURNS = [np.zeros(3), np.array([0.4, 0.0, 0.0]), np.array([0.3, -0.7, 1.1])]
OFFSETS = [0.0, 0.2, -0.35]


def _turned(points: Matrix, angles: Matrix) -> Matrix:
    return points @ Rotation.from_euler("xyz", angles).as_matrix().T


def _area(nodes: Matrix) -> float:
    x, y = nodes[:, 0], nodes[:, 1]
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))


def _whole(nodes: FloatArray, offset: float = 0.0) -> FloatArray:
    t, e = np.full(len(nodes), THICKNESS), np.full(len(nodes), YOUNG)
    drilling = shell.drilling_stiffness(nodes, t, e, NU, offset)
    return shell.stiffness(nodes, t, e, NU, offset) + drilling


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("angles", TURNS)
def test_a_shell_has_exactly_six_motions_without_strain(angles: Matrix, offset: float) -> None:
    values = np.linalg.eigvalsh(_whole(_turned(DISTORTED, angles)[None], offset)[0])
    assert np.all(np.abs(values[:6]) < 1e-12 * values[-1])
    assert values[6] > 1e-7 * values[-1]


@pytest.mark.parametrize("angles", TURNS)
def test_constant_strains_carry_their_exact_energy(angles: Matrix) -> None:
    """Membrane strain, curvature and transverse shear of one distorted element."""
    turned = _turned(DISTORTED, angles)
    matrix = shell.stiffness(turned[None], np.array([THICKNESS]), np.array([YOUNG]), NU)[0]
    x, y = DISTORTED[:, 0], DISTORTED[:, 1]
    a, b, c = 1e-4, -2e-4, 0.7e-4
    membrane, bending, shear = np.zeros((3, 4, 6))
    membrane[:, 0], membrane[:, 1] = a * x + 0.5 * c * y, b * y + 0.5 * c * x
    # w = -(a x2 + b y2 + c x y) / 2, slopes (ry, -rx) = -grad w.
    bending[:, 2] = -0.5 * (a * x**2 + b * y**2 + c * x * y)
    bending[:, 4], bending[:, 3] = a * x + 0.5 * c * y, -(b * y + 0.5 * c * x)
    shear[:, 2] = a * x + b * y
    quadratic = a**2 + b**2 + 2.0 * NU * a * b + 0.5 * (1.0 - NU) * c**2
    scale = 0.5 * YOUNG * _area(DISTORTED) / (1.0 - NU**2) * quadratic
    slope = 0.5 * _area(DISTORTED) * YOUNG / (2.0 * (1.0 + NU)) * (a**2 + b**2)
    cases = (
        (membrane, scale * THICKNESS),
        (bending, scale * THICKNESS**3 / 12.0),
        (shear, slope * 5.0 / 6.0 * THICKNESS),
    )
    for field, energy in cases:
        rotated = _turned(field.reshape(8, 3), angles).ravel()
        assert 0.5 * rotated @ matrix @ rotated == pytest.approx(energy, rel=1e-9)


def _patch(angles: Matrix) -> Mesh:
    """The five distorted elements of MacNeal and Harder (1985), figure 2, turned in space."""
    plane = [[0, 0], [0.24, 0], [0.24, 0.12], [0, 0.12]]
    plane += [[0.04, 0.02], [0.18, 0.03], [0.16, 0.08], [0.08, 0.08]]
    sides = [[k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k] for k in range(4)]
    nodes = np.column_stack([np.array(plane), np.zeros(8)])
    return Mesh(nodes=_turned(nodes, angles), elements=np.array([*sides, [4, 5, 6, 7]]))


def _patch_field(kind: str, offset: float) -> Matrix:
    """Nodal field of a constant strain of the mid-surface, which lies off the nodes."""
    x, y, _ = _patch(np.zeros(3)).nodes.T
    field = np.zeros((8, 6))
    if kind == "membrane":  # with a rotation in the plane, which the drilling follows
        field[:, 0], field[:, 1] = 1e-3 * (x + 0.5 * y), 1e-3 * (y + x)
        field[:, 5] = 0.25e-3
    else:  # bending and twist
        field[:, 2] = 0.5e-3 * (x**2 + x * y + y**2)
        field[:, 3], field[:, 4] = 1e-3 * (y + 0.5 * x), -1e-3 * (x + 0.5 * y)
    field[:, 0] -= field[:, 4] * offset
    field[:, 1] += field[:, 3] * offset
    return field


@pytest.mark.parametrize("offset", [0.0, 0.01])
@pytest.mark.parametrize("angles", [TURNS[0], TURNS[2]])
@pytest.mark.parametrize("kind", ["membrane", "bending"])
def test_a_constant_strain_passes_through_a_distorted_patch(
    kind: str, angles: Matrix, offset: float
) -> None:
    """E 1e6, nu 0.25, t 1e-3: displacements prescribed outside, those inside follow."""
    mesh, field = _patch(angles), _patch_field(kind, offset)
    exact = _turned(field.reshape(-1, 3), angles).ravel()
    stiffness = shell_stiffness(mesh, 1e-3, 1e6, 0.25, offset)
    held = np.arange(24)
    found = equilibrium(stiffness, np.zeros(mesh.count), held, exact[held])
    # A plate 240 times as long as thick loses five digits of sixteen to its membrane stiffness.
    assert np.allclose(found, exact, rtol=0.0, atol=1e-9 * np.abs(exact).max())
    modulus = 0.5 * 0.24 * 0.12 * 1e6 * 1e-3 / (1.0 - 0.25**2)
    membrane = modulus * (2.0 + 2.0 * 0.25 + 0.375 * 1.5**2) * 1e-6
    bending = modulus * 1e-6 / 12.0 * (2.0 + 2.0 * 0.25 + 0.375) * 1e-6
    energy = 0.5 * found @ stiffness @ found
    assert energy == pytest.approx({"membrane": membrane, "bending": bending}[kind], rel=1e-8)


def test_constant_shear_crosses_a_distorted_patch_without_forces_inside() -> None:
    """w linear, no rotations: only couples hold it, equal to the shear force over the area.

    MITC4 shares the couples among the nodes otherwise than the shape functions do (by 0.5 to 1.6
    inside this patch): their sum is exact, and so are the forces and the energy.
    """
    mesh, shear = _patch(TURNS[0]), 5.0 / 6.0 * 1e6 * 1e-3 / 2.5
    field = np.zeros((8, 6))
    field[:, 2] = 2e-3 * mesh.nodes[:, 0] - 1e-3 * mesh.nodes[:, 1]
    force = shell_stiffness(mesh, 1e-3, 1e6, 0.25) @ field.ravel()
    forces = force.reshape(8, 6)
    assert np.allclose(forces[4:, 2], 0.0, atol=1e-15 * shear)
    area = 0.24 * 0.12
    couples = np.array([1e-3, 2e-3]) * shear * area
    assert forces[:, 3:5].sum(axis=0) == pytest.approx(couples, rel=1e-12)
    assert 0.5 * field.ravel() @ force == pytest.approx(0.5 * shear * area * 5e-6, rel=1e-12)


@pytest.mark.parametrize("angles", TURNS)
@pytest.mark.parametrize("matrix", ["stiffness", "drilling", "mass"])
def test_an_offset_is_a_rigid_arm_along_the_normal(matrix: str, angles: Matrix) -> None:
    """The same as the element at the mid-surface, moved to the nodes by rigid links."""
    nodes = _turned(DISTORTED, angles)
    arm = 0.35 * _turned(np.array([[0.0, 0.0, 1.0]]), angles)[0]
    t, e = np.array([THICKNESS]), np.array([YOUNG])

    def element(points: Matrix, offset: float) -> Matrix:
        if matrix == "mass":
            return shell.mass(points[None], t, 2500.0, offset)[0]
        build = shell.stiffness if matrix == "stiffness" else shell.drilling_stiffness
        return build(points[None], t, e, NU, offset)[0]

    link = np.eye(6)
    link[:3] = offset_rows(arm[None])[0]
    links = np.kron(np.eye(4), link)
    expected = links.T @ element(nodes + arm, 0.0) @ links
    found = element(nodes, 0.35)
    assert np.allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_two_halves_off_the_nodes_are_the_whole_plate() -> None:
    """Layers of half the thickness at a quarter each side: Steiner's theorem, mass and bending."""
    nodes, t, e = DISTORTED[None], np.array([THICKNESS]), np.array([YOUNG])
    quarter = 0.25 * THICKNESS
    layers = [shell.mass(nodes, 0.5 * t, 2500.0, arm)[0] for arm in (-quarter, quarter)]
    whole = shell.mass(nodes, t, 2500.0)[0]
    assert np.allclose(sum(layers), whole, rtol=0.0, atol=1e-12 * np.abs(whole).max())
    x, y, _ = DISTORTED.T
    bent = np.zeros((4, 6))
    bent[:, 2] = 0.5e-4 * (x**2 - 2.0 * y**2 + 0.7 * x * y)
    bent[:, 3], bent[:, 4] = 1e-4 * (-2.0 * y + 0.35 * x), -1e-4 * (x + 0.35 * y)
    energies = [
        bent.ravel() @ shell.stiffness(nodes, thickness, e, NU, arm)[0] @ bent.ravel()
        for thickness, arm in ((0.5 * t, -quarter), (0.5 * t, quarter), (t, 0.0))
    ]
    assert energies[0] + energies[1] == pytest.approx(energies[2], rel=1e-12)


def test_each_element_has_its_own_offset() -> None:
    nodes, t, e = np.stack([DISTORTED] * 2), np.full(2, THICKNESS), np.full(2, YOUNG)
    both = shell.stiffness(nodes, t, e, NU, np.array([0.1, -0.2]))
    for index, offset in enumerate((0.1, -0.2)):
        single = shell.stiffness(nodes[:1], t[:1], e[:1], NU, offset)[0]
        assert np.allclose(both[index], single, rtol=0.0, atol=1e-12 * np.abs(single).max())


def test_mass_counts_translation_once_and_drilling_never() -> None:
    turned = _turned(DISTORTED, TURNS[2])
    mass = shell.mass(turned[None], np.array([THICKNESS]), 2469.8)[0]
    area = _area(DISTORTED)
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
