"""Shells against closed forms: cantilevers, strips, plates, torsion, roof, cylinder, frequency."""

from __future__ import annotations

from math import pi, sqrt, tanh

import numpy as np
import pytest

from solver.arrays import Matrix
from solver.elements import shell
from solver.modal import modes
from tests.solver.element_meshes import (
    Mesh,
    equilibrium,
    navier_deflection,
    pressure,
    quadrilaterals,
    shell_stiffness,
    supported_quarter,
)

YOUNG, LENGTH = 1e7, 10.0


def _rigidities(thickness: float, poisson: float) -> tuple[float, float]:
    """Flexural rigidity of a plate [N m] and its shear stiffness [N/m]."""
    flexural = YOUNG * thickness**3 / (12.0 * (1.0 - poisson**2))
    return flexural, 5.0 / 6.0 * YOUNG * thickness / (2.0 * (1.0 + poisson))


def _strip(count: int) -> Mesh:
    """A strip of unit width, one element wide."""
    return quadrilaterals(np.linspace(0.0, LENGTH, count + 1), np.array([0.0, 1.0]))


@pytest.mark.parametrize("thickness", [0.01, 0.1, 2.0])
@pytest.mark.parametrize("count", [1, 4, 16])
def test_a_cantilever_strip_bends_and_shears(count: int, thickness: float) -> None:
    """Cylindrical bending by a tip load: P L^3 (1 - 1 / 4 n^2) / 3 D + P L / (G 5/6 t).

    The factor is what n elements of constant curvature make of a linear moment, at any thickness:
    neither bending nor shear locks.
    """
    mesh = _strip(count)
    x = mesh.nodes[:, 0]
    load = np.zeros(mesh.count)
    load[mesh.where(np.isclose(x, LENGTH), 2)] = 0.5
    held = np.union1d(mesh.where(np.isclose(x, 0.0)), mesh.where(x > -1.0, 1, 3, 5))
    found = equilibrium(shell_stiffness(mesh, thickness, YOUNG, 0.3), load, held)
    flexural, shear = _rigidities(thickness, 0.3)
    exact = LENGTH**3 * (1.0 - 0.25 / count**2) / (3.0 * flexural) + LENGTH / shear
    # Rounding grows with (length / thickness)^2 of 1e6.
    assert found.reshape(-1, 6)[-1, 2] == pytest.approx(exact, rel=1e-7)


@pytest.mark.parametrize("thickness", [0.1, 2.0])
@pytest.mark.parametrize("count", [4, 16])
def test_a_clamped_strip_bends_cylindrically(count: int, thickness: float) -> None:
    """Uniform load: q L^4 (1 - 4 / n^2) / 384 D + q L^2 / (8 G 5/6 t) at the middle."""
    mesh = _strip(count)
    x = mesh.nodes[:, 0]
    held = np.union1d(mesh.where(np.isclose(x % LENGTH, 0.0)), mesh.where(x > -1.0, 1, 3, 5))
    stiffness = shell_stiffness(mesh, thickness, YOUNG, 0.3)
    middle = equilibrium(stiffness, pressure(mesh, 1.0), held).reshape(-1, 6)[count, 2]
    flexural, shear = _rigidities(thickness, 0.3)
    exact = LENGTH**4 * (1.0 - 4.0 / count**2) / (384.0 * flexural) + LENGTH**2 / (8.0 * shear)
    assert middle == pytest.approx(exact, rel=1e-8)


def test_a_pull_off_the_mid_surface_bends_a_cantilever() -> None:
    """Nodes an arm e from the mid-surface: u = N L / E A + N e^2 L / E I, w = N e L^2 / 2 E I."""
    arm, thickness, force = 0.3, 0.2, 1e3
    mesh = _strip(5)
    x = mesh.nodes[:, 0]
    load = np.zeros(mesh.count)
    load[mesh.where(np.isclose(x, LENGTH), 0)] = 0.5 * force
    stiffness = shell_stiffness(mesh, thickness, YOUNG, 0.0, arm)
    tip = equilibrium(stiffness, load, mesh.where(np.isclose(x, 0.0))).reshape(-1, 6)[-1]
    bending = YOUNG * thickness**3 / 12.0
    stretch = force * LENGTH / (YOUNG * thickness) + force * arm**2 * LENGTH / bending
    # The mid-surface lies above, the pull below it: the tip turns its end upwards.
    expected = [stretch, 0.0, force * arm * LENGTH**2 / (2.0 * bending), 0.0]
    expected += [-force * arm * LENGTH / bending, 0.0]
    assert tip == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_a_web_one_element_high_bends_in_its_plane() -> None:
    """Tip load on a slender cantilever standing on edge: Timoshenko's deflection."""
    height, count, poisson, young = 1.0, 20, 0.2, 35.4e9
    flat = quadrilaterals(np.linspace(0.0, LENGTH, count + 1), np.array([0.0, height]))
    mesh = flat.moved(lambda p: p[:, [0, 2, 1]])
    load = np.zeros(mesh.count)
    load[mesh.where(np.isclose(mesh.nodes[:, 0], LENGTH), 2)] = 500.0
    stiffness = shell_stiffness(mesh, 0.2, young, poisson)
    deflection = equilibrium(stiffness, load, np.arange(12)).reshape(-1, 6)[-1, 2]
    inertia = 0.2 * height**3 / 12.0
    shear = 5.0 / 6.0 * 0.2 * height * young / (2.0 * (1.0 + poisson))
    exact = 1e3 * (LENGTH**3 / (3.0 * young * inertia) + LENGTH / shear)
    # The clamp holds Poisson's strain and twenty elements leave (h/L)2 / 12: half a percent.
    assert deflection == pytest.approx(exact, rel=5e-3)


@pytest.mark.parametrize("thickness", [0.001, 0.1])
def test_a_thin_clamped_plate_does_not_lock(thickness: float) -> None:
    """Uniform load on a clamped square plate: 0.00126532 p L4 / D (Taylor and Govindjee, 2004)."""
    grid = np.linspace(0.0, LENGTH, 17)
    mesh = quadrilaterals(grid, grid)
    rim = np.any(np.isclose(mesh.nodes[:, :2] % LENGTH, 0.0), axis=1)
    stiffness = shell_stiffness(mesh, thickness, YOUNG, 0.2)
    response = equilibrium(stiffness, pressure(mesh, 1.0), mesh.where(rim)).reshape(-1, 6)
    # Sixteen elements a side: within half a percent; shear of the thicker one adds 0.02 percent.
    exact = 0.00126532 * LENGTH**4 / _rigidities(thickness, 0.2)[0]
    assert response[:, 2].max() == pytest.approx(exact, rel=5e-3)


@pytest.mark.parametrize(("thickness", "coefficient"), [(0.01, 0.00406), (1.0, 0.00427)])
def test_a_simply_supported_plate_deflects_as_the_tables_say(
    thickness: float, coefficient: float
) -> None:
    """w = 0.00406 q a^4 / D (Timoshenko and Woinowsky-Krieger, table 8); 0.00427 at a / t = 10."""
    mesh, held = supported_quarter(LENGTH, 16, distorted=False)
    stiffness = shell_stiffness(mesh, thickness, YOUNG, 0.3)
    centre = equilibrium(stiffness, pressure(mesh, 1.0), held).reshape(-1, 6)[-1, 2]
    # Half a unit of the table's last digit, and 0.03 percent of sixteen elements a half side.
    printed = LENGTH**4 / _rigidities(thickness, 0.3)[0]
    assert centre / printed == pytest.approx(coefficient, abs=6.5e-6)
    exact = navier_deflection(LENGTH, thickness, YOUNG, 0.3)
    assert centre == pytest.approx(exact, rel=3.5e-4)


def _graded(count: int, width: float) -> Matrix:
    """Points across a strip, closer towards its edges."""
    return 0.5 * width * np.sin(0.5 * pi * np.linspace(-1.0, 1.0, count + 1))


@pytest.mark.parametrize("thickness", [0.05, 0.2, 0.5])
def test_a_strip_twists_as_saint_venant_says(thickness: float) -> None:
    """Torsion constant of a strip of unit width, ends turned and free to warp.

    Plate theory with shear gives b t^3 / 3 (1 - tanh(k) / k), k = b sqrt(10) / 2 t, within 0.7
    percent of Saint-Venant's series; the shear that turns round the edges within a thickness
    needs elements as small as that.
    """
    mesh = quadrilaterals(np.array([0.0, 1.0]), _graded(32, 1.0))
    x, y, _ = mesh.nodes.T
    held = np.concatenate([mesh.where(x > -1.0, axis) for axis in (2, 3, 0, 1, 5)])
    values = np.concatenate([x * y, x, np.zeros(3 * len(x))])
    stiffness = shell_stiffness(mesh, thickness, 2.6, 0.3)
    found = equilibrium(stiffness, np.zeros(mesh.count), held, values)
    k = 0.5 * sqrt(10.0) / thickness
    plate = thickness**3 / 3.0 * (1.0 - tanh(k) / k)
    # Measured 0.040 to 0.046 percent, falling with the square of the elements' width.
    assert found @ stiffness @ found == pytest.approx(plate, rel=6e-4)
    n = np.arange(1, 200, 2)
    series = float(np.sum(np.tanh(0.5 * pi * n / thickness) / n**5))
    saint_venant = thickness**3 / 3.0 * (1.0 - 192.0 / pi**5 * thickness * series)
    assert found @ stiffness @ found == pytest.approx(saint_venant, rel=7e-3)


def test_a_square_tube_twists_as_bredt_says() -> None:
    """Closed section: a^3 t + 4 a t^3 / 3, and the sections do not warp."""
    side, thickness, along, each = 1.0, 0.02, 2, 2
    way = np.linspace(0.0, 1.0, each + 1)[:-1]
    corners = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * side
    steps = np.roll(corners, -1, axis=0) - corners
    section = (corners[:, None] + way[:, None] * steps[:, None]).reshape(-1, 2)
    size = len(section)
    nodes = np.array([[x, *p] for x in np.linspace(0.0, 4.0, along + 1) for p in section])
    elements = [
        [size * i + j, size * (i + 1) + j, size * (i + 1) + k, size * i + k]
        for i in range(along)
        for j, k in zip(range(size), np.roll(np.arange(size), -1), strict=True)
    ]
    mesh = Mesh(nodes=nodes, elements=np.array(elements))
    x, y, z = nodes.T
    ends = np.isclose(x % 4.0, 0.0)
    held = np.concatenate([mesh.where(ends, axis) for axis in (1, 2, 3)] + [np.array([0])])
    angle = x[ends] / 4.0
    values = np.concatenate([-angle * z[ends], angle * y[ends], angle, [0.0]])
    stiffness = shell_stiffness(mesh, thickness, 2.6, 0.3)
    found = equilibrium(stiffness, np.zeros(mesh.count), held, values)
    exact = side**3 * thickness + 4.0 * side * thickness**3 / 3.0
    # Measured 6e-5; the walls' own twist is 5e-4 of the whole, so it counts.
    assert 4.0 * found @ stiffness @ found == pytest.approx(exact, rel=1e-4)


def _panel(length: float, radius: float, angle: float, count: int) -> Mesh:
    """Part of a cylinder along x from its crown, ``angle`` wide; nodes run along the arc first."""
    flat = quadrilaterals(np.linspace(0.0, length, count + 1), np.linspace(0.0, angle, count + 1))
    x, turn, _ = flat.nodes.T
    return flat.moved(lambda _: np.column_stack([x, radius * np.sin(turn), radius * np.cos(turn)]))


def test_the_scordelis_lo_roof() -> None:
    """Vertical displacement of the free edge's middle: 0.3024 (MacNeal and Harder, 1985)."""
    count, angle = 16, 40.0 * pi / 180.0
    mesh = _panel(25.0, 25.0, angle, count)
    x, y, _ = mesh.nodes.T
    held = [
        mesh.where(np.isclose(x, 25.0), 1, 2, 3),  # diaphragm
        mesh.where(np.isclose(x, 0.0), 0, 4, 5),  # plane of symmetry x = 0
        mesh.where(np.isclose(y, 0.0), 1, 3, 5),  # crown, symmetry y = 0
    ]
    stiffness = shell_stiffness(mesh, 0.25, 4.32e8, 0.0)
    found = equilibrium(stiffness, pressure(mesh, -90.0), np.unique(np.concatenate(held)))
    # Measured 0.30431, 0.30231, 0.30200 on 8, 16, 32 elements a side: 0.03 percent here.
    edge = found.reshape(-1, 6)[count, 2]
    assert edge == pytest.approx(-0.3024, rel=1e-3)


def test_the_pinched_cylinder_with_diaphragms() -> None:
    """Deflection under two opposite forces: 1.8248e-5 (Belytschko et al., 1985; MacNeal, 1985).

    Measured 75, 93.2, 97.4, 99.0 and 100.2 percent on 8, 16, 24, 32 and 48 elements a side. The
    reference is that of thin shells; with transverse shear the point force adds a little more for
    ever.
    """
    count = 32
    mesh = _panel(300.0, 300.0, 0.5 * pi, count)
    x, y, z = mesh.nodes.T
    load = np.zeros(mesh.count)
    load[mesh.where(np.isclose(x, 0.0) & np.isclose(y, 0.0), 2)] = -0.25
    held = [
        mesh.where(np.isclose(x, 300.0), 1, 2),  # diaphragm
        mesh.where(np.isclose(x, 0.0), 0, 4, 5),  # symmetry x = 0
        mesh.where(np.isclose(y, 0.0), 1, 3, 5),  # symmetry y = 0
        mesh.where(np.isclose(z, 0.0, atol=1e-9), 2, 3, 4),  # symmetry z = 0
    ]
    stiffness = shell_stiffness(mesh, 3.0, 3e6, 0.3)
    found = equilibrium(stiffness, load, np.unique(np.concatenate(held))).reshape(-1, 6)
    assert found[0, 2] == pytest.approx(-1.8248e-5, rel=0.012)


@pytest.mark.parametrize("thickness", [0.1, 1.0])
def test_a_simply_supported_plate_vibrates_as_mindlin_says(thickness: float) -> None:
    """First frequency with shear and rotary inertia, of a thin and of a thick plate (a / t = 10).

    (G k t p - rho t w2)(D p + G k t - rho t^3 w2 / 12) = (G k t)^2 p with p = 2 pi^2 / a^2.
    """
    density, poisson, count = 2500.0, 0.3, 16
    mesh, held = supported_quarter(LENGTH, count, distorted=False)
    matrices = shell.mass(mesh.corners, np.full(count**2, thickness), density)
    free = np.setdiff1d(np.arange(mesh.count), held)
    stiffness = shell_stiffness(mesh, thickness, YOUNG, poisson)[free][:, free].tocsr()
    found = modes(stiffness, mesh.assembled(matrices)[free][:, free].tocsr(), 1)[0][0]
    flexural, shear = _rigidities(thickness, poisson)
    p, line, turn = 2.0 * (pi / LENGTH) ** 2, density * thickness, density * thickness**3 / 12.0
    b = line * (flexural * p + shear) + turn * shear * p
    square = (b - sqrt(b**2 - 4.0 * line * turn * shear * flexural * p**2)) / (2.0 * line * turn)
    # The quarter has sixteen elements: (k h)^2 / 8 = 0.12 percent, as for a beam.
    assert found == pytest.approx(sqrt(square) / (2.0 * pi), rel=1.4e-3)
