"""Solids of eight and twenty nodes against closed forms: patch, flexure, torsion, frequencies."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

from solver.arrays import Matrix, Vector
from solver.elements.gauss import CUBE_CORNERS
from solver.modal import modes
from tests.solver.element_meshes import (
    Mesh,
    equilibrium,
    face_load,
    hexahedra,
    orders,
    solid_mass,
    solid_stiffness,
    with_middle_nodes,
)

INNER = np.array([
    [0.249, 0.342, 0.192], [0.826, 0.288, 0.288], [0.850, 0.649, 0.263], [0.273, 0.750, 0.230],
    [0.320, 0.186, 0.643], [0.677, 0.305, 0.683], [0.788, 0.693, 0.644], [0.165, 0.745, 0.702],
])  # fmt: skip
"""Inner nodes of the patch of MacNeal and Harder (1985), figure 3."""


def _patch(nodes_each: int) -> Mesh:
    """A unit cube of seven distorted solids, one inside six."""
    sides = [[k, (k + 1) % 4, 8 + (k + 1) % 4, 8 + k] for k in range(4)]
    elements = [
        list(range(8, 16)),
        [0, 1, 2, 3, 8, 9, 10, 11],
        [12, 13, 14, 15, 4, 5, 6, 7],
        *([*side, *(node + 4 for node in side)] for side in sides),
    ]
    corners = np.vstack([(CUBE_CORNERS + 1.0) / 2.0, INNER])
    mesh = Mesh(nodes=corners, elements=np.array(elements))
    return mesh if nodes_each == 8 else with_middle_nodes(mesh)


def _curved(mesh: Mesh) -> Mesh:
    """The same twenty-node solids with every inner edge bent by some percent of its length."""
    outside = np.any(np.isclose(mesh.nodes, 0.0) | np.isclose(mesh.nodes, 1.0), axis=1)
    bend = 0.03 * np.random.default_rng(3).standard_normal(mesh.nodes.shape)
    return replace(mesh, nodes=mesh.nodes + np.where(outside, 0.0, 1.0)[:, None] * bend)


@pytest.mark.parametrize(
    "mesh",
    [_patch(8), _patch(20), _curved(_patch(20))],
    ids=["eight nodes", "twenty nodes", "twenty nodes, curved"],
)
def test_a_constant_strain_passes_through_a_distorted_patch(mesh: Mesh) -> None:
    """Displacements prescribed outside; those inside follow to machine precision."""
    strain = 1e-3 * np.array([[1.0, 0.5, 0.5], [0.5, 1.0, 0.5], [0.5, 0.5, 1.0]])
    exact = (mesh.nodes @ strain).ravel()
    outside = np.any(np.isclose(mesh.nodes, 0.0) | np.isclose(mesh.nodes, 1.0), axis=1)
    held = mesh.where(outside)
    stiffness = solid_stiffness(mesh, 1e6, 0.25)
    found = equilibrium(stiffness, np.zeros(mesh.count), held, exact[held])
    assert np.allclose(found, exact, rtol=0.0, atol=1e-13 * np.abs(exact).max())
    # Stresses of 2000 and 400 (MacNeal and Harder): energy of a unit cube.
    assert 0.5 * found @ stiffness @ found == pytest.approx(0.5 * (3 * 2000e-3 + 3 * 400e-3))


def _flexure(nodes_each: int, across: int) -> float:
    """Work of the loads of a cantilever with a tip load over that of elasticity theory.

    Both ends bear the tractions of Saint-Venant's flexure, which without Poisson's effect is the
    parabola of shear and the linear normal stress exactly; six freedoms only are held.
    """
    length, height, width = 4.0, 1.0, 0.5
    second_moment = width * height**3 / 12.0
    grids = (np.linspace(0.0, length, 4 * across + 1), np.array([0.0, width]))
    mesh = hexahedra(*grids, np.linspace(-0.5 * height, 0.5 * height, across + 1), nodes_each)
    x, y, z = mesh.nodes.T

    def shear(points: Matrix) -> Vector:
        return (0.25 * height**2 - points[..., 2] ** 2) / (2.0 * second_moment)

    def tip(points: Matrix) -> Matrix:
        nothing = np.zeros(points.shape[:-1])
        return np.stack([nothing, nothing, shear(points)], axis=-1)

    def root(points: Matrix) -> Matrix:
        normal = length * points[..., 2] / second_moment
        return np.stack([normal, np.zeros_like(normal), -shear(points)], axis=-1)

    load = face_load(mesh, 0, 1, length, tip) + face_load(mesh, 0, -1, 0.0, root)
    low, near = np.isclose(x, 0.0) & np.isclose(z, -0.5 * height), np.isclose(y, 0.0)
    held = np.concatenate([
        mesh.where(low & near, 0, 1, 2),
        mesh.where(low & ~near, 0, 2),
        mesh.where(np.isclose(x, 0.0) & near & np.isclose(z, 0.5 * height), 0),
    ])  # fmt: skip
    stiffness = solid_stiffness(mesh, 1.0, 0.0)
    found = equilibrium(stiffness, load, held)
    # The loads are in equilibrium: what holds the six freedoms carries nothing.
    assert np.abs((stiffness @ found - load)[held]).max() < 1e-9
    bending, shearing = length**3 / (3.0 * second_moment), 2.4 * length / (width * height)
    return float(found @ load) / (bending + shearing)


def test_a_cantilever_bends_and_shears_as_elasticity_says() -> None:
    """P L^3 / 3 E I + 6 P L / 5 G A; measured -0.27 and -0.0029 percent on these meshes."""
    assert _flexure(8, 4) == pytest.approx(1.0, abs=3e-3)
    assert _flexure(20, 4) == pytest.approx(1.0, abs=3.5e-5)
    errors = np.array([_flexure(20, across) - 1.0 for across in (1, 2, 4)])
    # Energy of second-degree elements: order four; the coarsest mesh is one element high.
    assert np.all(orders(np.array([1.0, 0.5, 0.25]), errors) > 3.9)


LEANING = {
    "rectangles": [0.0] * 5,
    "parallelograms": [0.1] * 5,
    "trapezoids": [0.1, -0.1] * 2 + [0.1],
}
"""How far the cuts between the six elements of MacNeal and Harder's beam lean, top and bottom."""


def _slender_beam(nodes_each: int, shape: str) -> tuple[float, float]:
    """Tip deflections over beam theory's, 0.1081 along z and 0.4321 along y; E 1e7, nu 0.3."""
    lean = np.array([0.0, *LEANING[shape], 0.0])
    mesh = hexahedra(np.arange(7.0), np.array([0.0, 0.1]), np.array([0.0, 0.2]))
    corners = mesh.nodes.copy()
    corners[:, 0] += np.where(corners[:, 2] > 0.0, 1.0, -1.0) * lean[corners[:, 0].astype(int)]
    mesh = replace(mesh, nodes=corners)
    mesh = mesh if nodes_each == 8 else with_middle_nodes(mesh)
    root, tip = (np.isclose(mesh.nodes[:, 0], end) for end in (0.0, 6.0))
    stiffness, results = solid_stiffness(mesh, 1e7, 0.3), []
    for axis, exact in ((2, 0.1081), (1, 0.4321)):
        pull = np.eye(3)[axis] / 0.02
        load = face_load(mesh, 0, 1, 6.0, lambda p, pull=pull: np.broadcast_to(pull, p.shape))
        found = equilibrium(stiffness, load, mesh.where(root)).reshape(-1, 3)
        results.append(float(found[tip, axis].mean()) / exact)
    return results[0], results[1]


@pytest.mark.parametrize(
    ("shape", "published"),
    [
        ("rectangles", (0.978, 0.973)),
        ("parallelograms", (0.624, 0.529)),
        ("trapezoids", (0.047, 0.030)),
    ],
)
def test_distorted_eight_node_solids_bend_as_another_program_says(
    shape: str, published: tuple[float, float]
) -> None:
    """MacNeal and Harder's slender beam: OptiStruct's HEX8, verification manual OS-V 0720.

    The figures are those of incompatible modes: rectangles bend, trapezoids of 45 degrees do not.
    """
    # One unit of the last digit printed (the beam theory's 0.4321 is itself rounded).
    assert _slender_beam(8, shape) == pytest.approx(published, abs=1e-3)


@pytest.mark.parametrize(
    ("shape", "least"),
    # Measured 0.970 and 0.961, 0.967 and 0.941, 0.886 and 0.920: full integration is stiff.
    [
        ("rectangles", (0.96, 0.95)),
        ("parallelograms", (0.96, 0.94)),
        ("trapezoids", (0.88, 0.91)),
    ],
)
def test_distorted_twenty_node_solids_still_bend(shape: str, least: tuple[float, float]) -> None:
    found = _slender_beam(20, shape)
    assert all(low < value < 1.0 for low, value in zip(least, found, strict=True))


def torsion_constant(wide: float, thin: float) -> float:
    """Saint-Venant's torsion constant of a rectangle (Timoshenko and Goodier, section 109)."""
    n = np.arange(1, 200, 2)
    series = np.sum(np.tanh(0.5 * pi * n * wide / thin) / n**5)
    return wide * thin**3 / 3.0 * (1.0 - 192.0 / pi**5 * thin / wide * series)


def _twisted(nodes_each: int, across: int) -> float:
    """Torsion constant of a bar of 2 x 1, whose ends turn and are free to warp."""
    grid = np.linspace(-0.5, 0.5, across + 1)
    mesh = hexahedra(np.array([0.0, 1.0]), 2.0 * grid, grid, nodes_each)
    x, y, z = mesh.nodes.T
    ends = np.isclose(x % 1.0, 0.0)
    corner = np.isclose(x, 0.0) & np.isclose(y, -1.0) & np.isclose(z, -0.5)
    held = np.concatenate([mesh.where(ends, 1), mesh.where(ends, 2), mesh.where(corner, 0)])
    values = np.concatenate([(-x * z)[ends], (x * y)[ends], [0.0]])
    stiffness = solid_stiffness(mesh, 2.6, 0.3)
    found = equilibrium(stiffness, np.zeros(mesh.count), held, values)
    return float(found @ stiffness @ found)


@pytest.mark.parametrize(
    ("nodes_each", "divisions", "order", "error"),
    # Measured: 1.86 to 1.96 and 0.37 percent; 3.54 to 3.61 and 0.018 percent. The stress has a
    # logarithm at the corners of the section, which keeps the twenty-node solid below order four.
    [(8, (4, 8, 16), 1.85, 4e-3), (20, (4, 6, 8), 3.5, 2e-4)],
)
def test_a_bar_twists_as_saint_venant_says(
    nodes_each: int, divisions: tuple[int, ...], order: float, error: float
) -> None:
    exact = torsion_constant(2.0, 1.0)
    errors = np.array([_twisted(nodes_each, n) / exact - 1.0 for n in divisions])
    assert np.all(errors > 0.0)  # warping is restrained, never exaggerated
    assert np.all(orders(1.0 / np.array(divisions), errors) > order)
    assert errors[-1] < error


SPAN, DEPTH, WIDTH, YOUNG, DENSITY = 10.0, 1.0, 0.5, 36e9, 2500.0


def _timoshenko_frequency(number: int, poisson: float) -> float:
    """Frequency of a simply supported Timoshenko beam. [Hz]

    Shear coefficient 5 (1 + nu) / (6 + 5 nu) of Kaneko (1975), Journal of Physics D 8, which
    measurements and elasticity bear out for depths above the width; Cowper's is 1.4 percent off.
    """
    k, area, second = number * pi / SPAN, WIDTH * DEPTH, WIDTH * DEPTH**3 / 12.0
    coefficient = 5.0 * (1.0 + poisson) / (6.0 + 5.0 * poisson)
    shear = coefficient * YOUNG / (2.0 * (1.0 + poisson))
    a = DENSITY**2 * second / shear
    b = DENSITY * area + k**2 * DENSITY * second * (1.0 + YOUNG / shear)
    c = YOUNG * second * k**4
    return sqrt((b - sqrt(b**2 - 4.0 * a * c)) / (2.0 * a)) / (2.0 * pi)


def _solid_frequencies(nodes_each: int, along: int, across: int, poisson: float) -> Vector:
    """The same beam of solids: a quarter of the section, ends held vertically. [Hz]"""
    mesh = hexahedra(
        np.linspace(0.0, SPAN, along + 1),
        np.array([0.0, 0.5 * WIDTH]),
        np.linspace(0.0, 0.5 * DEPTH, across + 1),
        nodes_each,
    )
    x, y, z = mesh.nodes.T
    held = [
        mesh.where(np.isclose(x % SPAN, 0.0), 2),
        mesh.where(np.isclose(y, 0.0), 1),
        mesh.where(np.isclose(z, 0.0), 0, 1),
    ]
    free = np.setdiff1d(np.arange(mesh.count), np.concatenate(held))
    stiffness = solid_stiffness(mesh, YOUNG, poisson)[free][:, free].tocsr()
    return modes(stiffness, solid_mass(mesh, DENSITY)[free][:, free].tocsr(), 3)[0]


@pytest.mark.parametrize("poisson", [0.0, 0.2])
def test_a_beam_of_eight_node_solids_vibrates_as_timoshenko_says(poisson: float) -> None:
    """Without shear locking the error of mode n is (k h)^2 / 8 along, and (dz)^2 across.

    (k h)^2 / 8 is that of a Timoshenko beam of two-node elements sampled at their middles, with
    consistent mass: 1/6 from the mass and 1/12 from the curvature, halved for the frequency.
    """
    exact = np.array([_timoshenko_frequency(n, poisson) for n in (1, 2, 3)])
    meshes = ((20, 1), (40, 2), (80, 4))
    errors = np.array([_solid_frequencies(8, *mesh, poisson) / exact - 1.0 for mesh in meshes])
    # Measured for modes 1 to 3: 0.032, 0.12 and 0.25 percent.
    assert np.all(errors[-1] < [3.5e-4, 1.3e-3, 2.7e-3])
    slopes = np.array([orders(np.array([1.0, 0.5, 0.25]), error) for error in errors.T])
    assert np.all(slopes > 1.85)
    predicted = (np.arange(1, 4) * pi / 40) ** 2 / 8.0
    # What is left is the parabola of shear across, four eighths of a depth of one value each.
    assert np.all(_solid_frequencies(8, 40, 4, poisson) / exact - 1.0 < 1.4 * predicted)


def test_a_beam_of_twenty_node_solids_vibrates_as_timoshenko_says() -> None:
    """Measured 0.0033, 0.016 and 0.044 percent: what remains is Timoshenko's own error."""
    exact = np.array([_timoshenko_frequency(n, 0.2) for n in (1, 2, 3)])
    found = _solid_frequencies(20, 20, 2, 0.2)
    assert np.all(np.abs(found / exact - 1.0) < [5e-5, 2e-4, 5e-4])
