"""Every element against its declaration: free motions, symmetry, rotation, mass and inertia."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import solver.elements
from solver.arrays import FloatArray, Matrix
from solver.assembly.constraints import Combination, eliminate
from solver.assembly.scatter import ElementMatrices, scatter
from solver.elements import (
    beam,
    line_mass,
    membrane,
    plate,
    shell,
    solid,
    solid20,
    spring_damper,
    truss,
)
from solver.elements.gauss import CUBE_CORNERS
from solver.elements.null_space import NULL_SPACES, SIX, TRANSLATIONS, NullSpace, rigid_motions
from solver.elements.rigid_link import rigid_arm

YOUNG, NU, DENSITY = 36e9, 0.2, 2500.0
QUADS = np.array([[[0.0, 0, 0], [1.1, 0.1, 0], [1.3, 0.9, 0], [-0.1, 1.2, 0]]])
QUADS = np.concatenate([QUADS, 0.5 * QUADS + [3.0, 1.0, 0.0]])
CUBES = CUBE_CORNERS + 0.2 * np.random.default_rng(1).standard_normal((2, 8, 3))
STRAIGHT = np.concatenate([CUBES, CUBES[:, np.array(solid20.EDGES)].mean(axis=2)], axis=1)
CURVED = STRAIGHT + 0.05 * np.random.default_rng(2).standard_normal((2, 20, 3))
LINES = np.array([[[0.3, -0.2, 0.5], [1.4, 0.7, 0.1]], [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]])
ARMS = np.array([[[0.1, -0.4, 0.3], [0.0, 0.2, -0.5]], [[0.0, 0.0, 0.2], [0.0, 0.3, 0.0]]])
ORIENTATION = np.array([0.2, -0.1, 1.0])
EULER = beam.BeamSection(
    area=0.08, second_moment_y=6e-4, second_moment_z=2e-4, torsion_constant=5e-4
)
TIMOSHENKO = beam.BeamSection(
    area=0.08, second_moment_y=6e-4, second_moment_z=2e-4, torsion_constant=5e-4,
    shear_area_y=0.05, shear_area_z=0.03,
)  # fmt: skip
AREA = np.array([0.01, 0.02])
THICKNESS, MODULUS = np.array([0.2, 0.3]), np.array([YOUNG, 0.8 * YOUNG])
COEFFICIENTS = np.array([3e6, 1e6, 7e6, 2e5, 4e5, 1e5])
POINTS = np.array([[0.9, -0.5, 1.3], [3.0, 0.1, 0.2]])
STILL = np.eye(3)

Builder = Callable[[FloatArray, Matrix], FloatArray]
"""Matrices from turned nodes and the turn, which turns the element's vectors as well."""


def _beam_stiffness(section: beam.BeamSection, offset: bool) -> Builder:
    return lambda nodes, turn: beam.stiffness(
        nodes, section, YOUNG, NU,
        orientation=turn @ ORIENTATION, offsets=ARMS @ turn.T if offset else None,
    )  # fmt: skip


def _shell_stiffness(offset: float) -> Builder:
    return lambda nodes, _: (
        shell.stiffness(nodes, THICKNESS, MODULUS, NU, offset)
        + shell.drilling_stiffness(nodes, THICKNESS, MODULUS, NU, offset)
    )


def _springs(nodes: FloatArray, turn: Matrix) -> FloatArray:
    return spring_damper.between(nodes, POINTS @ turn.T, COEFFICIENTS, turn.T)


STIFFNESSES: dict[str, tuple[str, FloatArray, Builder]] = {
    "beam, Euler-Bernoulli": ("beam", LINES, _beam_stiffness(EULER, offset=False)),
    "beam, Timoshenko": ("beam", LINES, _beam_stiffness(TIMOSHENKO, offset=False)),
    "beam with offsets": ("beam", LINES, _beam_stiffness(TIMOSHENKO, offset=True)),
    "truss": ("truss", LINES, lambda nodes, _: truss.stiffness(nodes, AREA, MODULUS)),
    "spring_damper": ("spring_damper", LINES, _springs),
    "shell": ("shell", QUADS, _shell_stiffness(0.0)),
    "shell with offset": ("shell", QUADS, _shell_stiffness(-0.4)),
    "solid": ("solid", CUBES, lambda nodes, _: solid.stiffness(nodes, YOUNG, NU)),
    "solid20": ("solid20", CURVED, lambda nodes, _: solid20.stiffness(nodes, YOUNG, NU)),
}
PLANE: dict[str, tuple[str, FloatArray, Builder]] = {
    "membrane": (
        "membrane",
        QUADS,
        lambda nodes, _: membrane.stiffness(nodes[:, :, :2], THICKNESS, MODULUS, NU),
    ),
    "plate": (
        "plate",
        QUADS,
        lambda nodes, _: plate.stiffness(nodes[:, :, :2], THICKNESS, MODULUS, NU),
    ),
}
EVERY = STIFFNESSES | PLANE


def _nodal(turn: Matrix, declared: tuple[int, ...], nodes: int) -> Matrix:
    """Turns the freedoms of all nodes: triads of displacements and rotations."""
    return np.kron(np.eye(nodes * len(declared) // 3), turn)


def _turn(seed: int) -> Matrix:
    return Rotation.random(random_state=seed).as_matrix()


def _free_motions(matrix: Matrix) -> Matrix:
    """Orthonormal motions without energy, of a matrix made dimensionless by its diagonal."""
    scale = np.where(np.diag(matrix) > 0.0, np.sqrt(np.abs(np.diag(matrix))), 1.0)
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    # Rounding leaves 1e-15. The weakest true energy is the drilling penalty's, 1e-5.
    assert not np.any((np.abs(values) > 1e-12) & (values < 1e-7))
    motions = vectors[:, np.abs(values) <= 1e-12] / scale[:, None]
    return np.linalg.qr(motions)[0]


def test_every_element_with_a_stiffness_declares_its_free_motions() -> None:
    names = [entry.name for entry in pkgutil.iter_modules(solver.elements.__path__)]
    modules = {name: importlib.import_module(f"solver.elements.{name}") for name in names}
    stiff = {name for name, module in modules.items() if hasattr(module, "stiffness")}
    assert stiff | {"spring_damper"} == set(NULL_SPACES)
    assert {name for name, _, _ in EVERY.values()} == set(NULL_SPACES)


@pytest.mark.parametrize("name", EVERY)
def test_stiffness_is_symmetric(name: str) -> None:
    _, nodes, build = EVERY[name]
    matrices = build(nodes, STILL)
    bound = 1e-14 * np.abs(matrices).max(axis=(1, 2), keepdims=True)
    assert np.all(np.abs(matrices - matrices.transpose(0, 2, 1)) <= bound)


@pytest.mark.parametrize("name", EVERY)
def test_exactly_the_declared_motions_are_free(name: str) -> None:
    """No mechanism, no resistance to a rigid motion, and neither hides the other."""
    kind, nodes, build = EVERY[name]
    declared = NULL_SPACES[kind]
    motions = declared.basis(nodes)
    assert nodes.shape[1] == declared.nodes
    assert motions.shape[2] == declared.dimension
    for matrix, expected in zip(build(nodes, STILL), motions, strict=True):
        found = _free_motions(matrix)
        assert found.shape[1] == declared.dimension
        energies = np.einsum("im,ij,jm->m", expected, matrix, expected)
        assert np.all(np.abs(energies) < 1e-12 * np.abs(matrix).max())
        # The same space: projecting one basis onto the other loses nothing.
        assert np.allclose(found @ (found.T @ expected), expected, atol=1e-9)


@pytest.mark.parametrize("name", EVERY)
def test_the_declared_dimension_is_the_rank_of_the_rigid_motions(name: str) -> None:
    kind, nodes, _ = EVERY[name]
    motions = rigid_motions(nodes, NULL_SPACES[kind].freedoms)
    assert np.all(np.linalg.matrix_rank(motions, tol=1e-9) == NULL_SPACES[kind].dimension)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("name", STIFFNESSES)
def test_stiffness_turns_with_the_element(name: str, seed: int) -> None:
    kind, nodes, build = STIFFNESSES[name]
    turn = _turn(seed)
    blocks = _nodal(turn, NULL_SPACES[kind].freedoms, nodes.shape[1])
    turned = blocks @ build(nodes, STILL) @ blocks.T
    # Shells take their frame from coordinates: one part in 1e11 is rounding.
    assert np.allclose(build(nodes @ turn.T, turn), turned, rtol=0, atol=1e-11 * turned.max())


MASSES: dict[str, tuple[tuple[int, ...], FloatArray, Builder]] = {
    "beam, Euler-Bernoulli": (
        SIX,
        LINES,
        lambda nodes, turn: beam.mass(nodes, EULER, DENSITY, NU, orientation=turn @ ORIENTATION),
    ),
    "beam, Timoshenko, with offsets": (
        SIX,
        LINES,
        lambda nodes, turn: beam.mass(
            nodes, TIMOSHENKO, DENSITY, NU,
            orientation=turn @ ORIENTATION, offsets=ARMS @ turn.T,
        ),
    ),
    "truss": (TRANSLATIONS, LINES, lambda nodes, _: truss.mass(nodes, AREA, DENSITY)),
    "line_mass": (TRANSLATIONS, LINES, lambda nodes, _: line_mass.mass(nodes, 180.0)),
    "shell": (SIX, QUADS, lambda nodes, _: shell.mass(nodes, THICKNESS, DENSITY)),
    "shell with offset": (
        SIX,
        QUADS,
        lambda nodes, _: shell.mass(nodes, THICKNESS, DENSITY, -0.4),
    ),
    "solid": (TRANSLATIONS, CUBES, lambda nodes, _: solid.mass(nodes, DENSITY)),
    "solid20": (TRANSLATIONS, STRAIGHT, lambda nodes, _: solid20.mass(nodes, DENSITY)),
}  # fmt: skip


def _box(sides: tuple[float, float, float], mass: float) -> Matrix:
    squares = np.square(sides)
    return np.diag((squares.sum() - squares) * mass / 12.0)


def _inertia_about_origin(mass: float, centre: Matrix, about_centre: Matrix) -> Matrix:
    return about_centre + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))


def _rod(ends: Matrix, mass: float, section: Matrix) -> Matrix:
    """A straight rod about the origin, with its section's own inertia added."""
    span = ends[1] - ends[0]
    slender = mass / 12.0 * (span @ span * np.eye(3) - np.outer(span, span))
    return _inertia_about_origin(mass, ends.mean(axis=0), slender + section)


def _section_inertia(ends: Matrix, rotary: float) -> Matrix:
    length = np.linalg.norm(ends[1] - ends[0])
    axes = beam.local_frame(ends[None], ORIENTATION)[0][0]
    i_y, i_z = EULER.second_moment_y, EULER.second_moment_z
    return DENSITY * length * (axes.T @ np.diag([i_y + i_z, rotary * i_y, rotary * i_z]) @ axes)


def _volumes(nodes: FloatArray) -> FloatArray:
    """Of solids with straight edges, by integrals that do not use the elements' code."""
    points, weights = np.polynomial.legendre.leggauss(4)
    result = np.zeros(len(nodes))
    for index in np.ndindex(4, 4, 4):
        at = points[list(index)]
        factors = 1.0 + CUBE_CORNERS * at
        columns = [
            CUBE_CORNERS[:, a] * np.delete(factors, a, axis=1).prod(axis=1) / 8.0 for a in range(3)
        ]
        result += weights[list(index)].prod() * np.linalg.det(np.array(columns) @ nodes)
    return result


def _quad_area(nodes: FloatArray) -> FloatArray:
    x, y = nodes[:, :, 0], nodes[:, :, 1]
    return 0.5 * np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)


LENGTHS = np.linalg.norm(LINES[:, 1] - LINES[:, 0], axis=1)
ENDS = LINES + ARMS
TOTALS = {
    "beam, Euler-Bernoulli": DENSITY * EULER.area * LENGTHS,
    "beam, Timoshenko, with offsets": (
        DENSITY * EULER.area * np.linalg.norm(ENDS[:, 1] - ENDS[:, 0], axis=1)
    ),
    "truss": DENSITY * AREA * LENGTHS,
    "line_mass": 180.0 * LENGTHS,
    "shell": DENSITY * THICKNESS * _quad_area(QUADS),
    "shell with offset": DENSITY * THICKNESS * _quad_area(QUADS),
    "solid": DENSITY * _volumes(CUBES),
    "solid20": DENSITY * _volumes(CUBES),
}


@pytest.mark.parametrize("name", MASSES)
def test_translation_moves_the_whole_mass_along_every_axis(name: str) -> None:
    """Also: symmetric, positive semi-definite, and turning with the element."""
    freedoms, nodes, build = MASSES[name]
    matrices = build(nodes, STILL)
    motions = rigid_motions(nodes, freedoms)[:, :, :3]
    moved = motions.transpose(0, 2, 1) @ matrices @ motions
    assert np.allclose(moved, TOTALS[name][:, None, None] * np.eye(3), rtol=1e-12, atol=1e-9)
    assert np.allclose(matrices, matrices.transpose(0, 2, 1), rtol=0, atol=1e-14 * matrices.max())
    assert np.all(np.linalg.eigvalsh(matrices)[:, 0] > -1e-13 * matrices.max())
    turn = _turn(3)
    blocks = _nodal(turn, freedoms, nodes.shape[1])
    turned = blocks @ matrices @ blocks.T
    assert np.allclose(build(nodes @ turn.T, turn), turned, rtol=0, atol=1e-11 * turned.max())


RODS = {
    "beam, Euler-Bernoulli": (LINES, 1.0),
    "beam, Timoshenko, with offsets": (ENDS, 1.0),
    "truss": (LINES, 0.0),
    "line_mass": (LINES, 0.0),
}


@pytest.mark.parametrize("name", RODS)
def test_rotation_shows_a_rods_moments_and_products_of_inertia(name: str) -> None:
    freedoms, nodes, build = MASSES[name]
    ends, share = RODS[name]
    motions = rigid_motions(nodes, freedoms)[:, :, 3:]
    inertia = motions.transpose(0, 2, 1) @ build(nodes, STILL) @ motions
    for element in range(2):
        section = share * _section_inertia(ends[element], rotary=1.0)
        exact = _rod(ends[element], float(TOTALS[name][element]), section)
        assert np.allclose(inertia[element], exact, rtol=1e-11, atol=1e-9)


def test_rotation_without_rotary_inertia_counts_the_axis_line_and_torsion_alone() -> None:
    matrix = beam.mass(
        LINES, TIMOSHENKO, DENSITY, NU, rotary_inertia=False, orientation=ORIENTATION
    )
    motions = rigid_motions(LINES)[:, :, 3:]
    inertia = motions.transpose(0, 2, 1) @ matrix @ motions
    for element in range(2):
        section = _section_inertia(LINES[element], rotary=0.0)
        exact = _rod(LINES[element], float(DENSITY * EULER.area * LENGTHS[element]), section)
        assert np.allclose(inertia[element], exact, rtol=1e-11)


def test_rotation_shows_the_moments_of_inertia_of_a_block_and_of_a_plate() -> None:
    sides = (1.2, 0.7, 0.4)
    block, block20 = 0.5 * CUBE_CORNERS[None] * sides, 0.5 * solid20.NODES[None] * sides
    exact = _box(sides, DENSITY * float(np.prod(sides)))
    for nodes, element in ((block, solid), (block20, solid20)):
        motions = rigid_motions(nodes, TRANSLATIONS)[0, :, 3:]
        assert np.allclose(
            motions.T @ element.mass(nodes, DENSITY)[0] @ motions, exact, rtol=1e-12, atol=1e-9
        )
    panel = np.array([[[-0.6, -0.35, 0], [0.6, -0.35, 0], [0.6, 0.35, 0], [-0.6, 0.35, 0]]])
    motions = rigid_motions(panel)[0, :, 3:]
    inertia = motions.T @ shell.mass(panel, np.array([0.4]), DENSITY)[0] @ motions
    # Turning about the normal needs no drilling inertia: the nodes' displacements carry it.
    assert np.allclose(inertia, exact, rtol=1e-12, atol=1e-9)


def test_a_shell_without_its_drilling_penalty_leaves_each_drilling_rotation_free() -> None:
    matrix = shell.stiffness(QUADS, THICKNESS, MODULUS, NU)[0]
    drilling = np.zeros((24, 4))
    drilling[5::6] = np.eye(4)
    found = _free_motions(matrix)
    expected = np.linalg.qr(np.hstack([NULL_SPACES["shell"].basis(QUADS)[0], drilling]))[0]
    assert found.shape[1] == 10
    assert np.allclose(found @ (found.T @ expected), expected, atol=1e-9)


def test_a_beam_on_a_rigid_link_keeps_exactly_six_free_motions() -> None:
    """Node 2 follows node 0 by elimination; the beam joins nodes 1 and 2."""
    nodes = np.array([[0.2, 1.1, -0.4], [3.0, 0.3, 0.8], [0.9, 0.1, 0.5]])
    element = ElementMatrices(
        freedoms=np.arange(6, 18)[None],
        matrices=beam.stiffness(nodes[None, 1:], TIMOSHENKO, YOUNG, NU),
    )
    link = Combination(
        dependent=np.arange(12, 18),
        masters=np.tile(np.arange(6), (6, 1)),
        weights=rigid_arm((nodes[2] - nodes[0])[None])[0],
    )
    transformation = eliminate(18, np.zeros(0, np.int64), [link])
    reduced = transformation.reduce(scatter([element], 18)).toarray()
    found = _free_motions(reduced)
    expected = np.linalg.qr(rigid_motions(nodes[None, :2])[0])[0]
    assert found.shape[1] == 6
    assert np.allclose(found @ (found.T @ expected), expected, atol=1e-10)
    motions = rigid_motions(nodes[None])[0]
    followed = transformation.matrix @ motions[:12]
    assert np.abs(followed - motions).max() < 1e-15


def test_a_far_origin_does_not_spoil_the_basis() -> None:
    """A viaduct 10 km from the origin: rigid motions centred on the element stay orthonormal."""
    declared = NullSpace(nodes=4, freedoms=SIX, dimension=6)
    basis = declared.basis(QUADS + np.array([1e4, 2e3, 300.0]))
    assert np.allclose(basis.transpose(0, 2, 1) @ basis, np.eye(6), atol=1e-12)
    assert np.allclose(
        basis @ basis.transpose(0, 2, 1),
        declared.basis(QUADS) @ declared.basis(QUADS).transpose(0, 2, 1),
        atol=1e-9,
    )
