"""Small meshes of shells and solids, their assembly and their equilibrium, for tests only."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import BoolVector, FloatArray, IntArray, IntVector, Matrix, SparseMatrix, Vector
from solver.assembly.scatter import ElementMatrices, scatter
from solver.elements import shell, solid, solid20
from solver.elements.gauss import CUBE_CORNERS
from solver.factorisation import factorise

_ABSCISSAE, _WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """Nodes, shape (n_node, 3), and elements of one kind, shape (n_element, 4, 8 or 20)."""

    nodes: Matrix
    elements: IntArray

    @property
    def corners(self) -> FloatArray:
        """Coordinates of the elements' nodes."""
        return self.nodes[self.elements]

    @property
    def axes(self) -> int:
        """Freedoms a node."""
        return 6 if self.elements.shape[1] == 4 else 3

    @property
    def count(self) -> int:
        """Freedoms in all."""
        return self.axes * len(self.nodes)

    def moved(self, motion: Callable[[Matrix], Matrix]) -> Mesh:
        """The same elements with every node moved."""
        return replace(self, nodes=motion(self.nodes))

    def where(self, condition: BoolVector, *axes: int) -> IntVector:
        """Freedoms of these axes (all if none is named) at the nodes that fulfil a condition."""
        chosen = np.flatnonzero(condition)[:, None]
        return (self.axes * chosen + np.array(axes or range(self.axes))).ravel()

    def assembled(self, matrices: FloatArray) -> SparseMatrix:
        """Element matrices in one sparse matrix."""
        freedoms = self.axes * self.elements[:, :, None] + np.arange(self.axes)
        blocks = [ElementMatrices(freedoms=freedoms.reshape(len(matrices), -1), matrices=matrices)]
        return scatter(blocks, self.count)


def quadrilaterals(x: Vector, y: Vector) -> Mesh:
    """A grid of four-node shells in the plane z = 0; nodes run along y first."""
    nodes = np.array([[a, b, 0.0] for a in x for b in y])
    numbers = np.arange(len(nodes)).reshape(len(x), len(y))
    corners = [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]
    return Mesh(nodes=nodes, elements=np.stack(corners, axis=-1).reshape(-1, 4))


def hexahedra(x: Vector, y: Vector, z: Vector, nodes_each: int = 8) -> Mesh:
    """A block of eight- or twenty-node solids; nodes run along z first, then y."""
    nodes = np.array(list(itertools.product(x, y, z)))
    numbers = np.arange(len(nodes)).reshape(len(x), len(y), len(z))
    ends = {-1.0: slice(None, -1), 1.0: slice(1, None)}
    corners = [numbers[tuple(ends[float(side)] for side in corner)] for corner in CUBE_CORNERS]
    mesh = Mesh(nodes=nodes, elements=np.stack(corners, axis=-1).reshape(-1, 8))
    return mesh if nodes_each == 8 else with_middle_nodes(mesh)


def with_middle_nodes(mesh: Mesh) -> Mesh:
    """Twenty-node solids with straight edges on the corners of eight-node ones."""
    pairs = np.sort(mesh.elements[:, np.array(solid20.EDGES)].reshape(-1, 2), axis=1)
    edges, numbers = np.unique(pairs, axis=0, return_inverse=True)
    middles = len(mesh.nodes) + numbers.reshape(len(mesh.elements), 12)
    return Mesh(
        nodes=np.vstack([mesh.nodes, mesh.nodes[edges].mean(axis=1)]),
        elements=np.hstack([mesh.elements, middles]),
    )


def solid_stiffness(mesh: Mesh, young: float, poisson: float) -> SparseMatrix:
    """Stiffness of solids of either kind."""
    element = solid if mesh.elements.shape[1] == 8 else solid20
    return mesh.assembled(element.stiffness(mesh.corners, young, poisson))


def solid_mass(mesh: Mesh, density: float) -> SparseMatrix:
    """Mass of solids of either kind."""
    element = solid if mesh.elements.shape[1] == 8 else solid20
    return mesh.assembled(element.mass(mesh.corners, density))


def shell_stiffness(
    mesh: Mesh, thickness: float, young: float, poisson: float, offset: float = 0.0
) -> SparseMatrix:
    """Stiffness of shells of one thickness, drilling penalty included."""
    t, e = np.full(len(mesh.elements), thickness), np.full(len(mesh.elements), young)
    matrices = shell.stiffness(mesh.corners, t, e, poisson, offset)
    matrices += shell.drilling_stiffness(mesh.corners, t, e, poisson, offset)
    return mesh.assembled(matrices)


def pressure(mesh: Mesh, value: float) -> Vector:
    """Consistent load of a uniform pressure along z on a grid of shells."""
    t = np.ones(len(mesh.elements))
    up = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], len(mesh.nodes))
    return value * (mesh.assembled(shell.mass(mesh.corners, t, 1.0)) @ up)


def face_load(
    mesh: Mesh, axis: int, side: int, at: float, traction: Callable[[Matrix], Matrix]
) -> Vector:
    """Consistent load of a traction on the plane end face of a block of solids.

    Args:
        mesh: Solids.
        axis: Natural direction across the face.
        side: -1 or 1, the end of that direction.
        at: Coordinate of the face along the global axis of the same number. [m]
        traction: Force per area at points, shapes (n_point, 3). [Pa]

    Returns:
        Shape (n_dof,). [N]
    """
    on_face = np.isclose(solid20.NODES[: mesh.elements.shape[1], axis], side)
    chosen = np.all(np.isclose(mesh.corners[:, on_face, axis], at), axis=1)
    load = np.zeros((len(mesh.nodes), 3))
    for (a, u), (b, v) in itertools.product(zip(_ABSCISSAE, _WEIGHTS, strict=True), repeat=2):
        point = np.insert(np.array([a, b]), axis, float(side))[None]
        shape, gradient = _interpolation(mesh.elements.shape[1], point)
        tangents = np.delete(gradient, axis, axis=0) @ mesh.corners[chosen]
        area = np.linalg.norm(np.cross(tangents[:, 0], tangents[:, 1]), axis=1)
        force = traction(shape @ mesh.corners[chosen]) * (u * v * area)[:, None]
        np.add.at(load, mesh.elements[chosen], shape[:, None] * force[:, None, :])
    return load.ravel()


def body_load(mesh: Mesh, force: Callable[[Matrix], Matrix]) -> Vector:
    """Consistent load of a force per volume on solids, by 4 x 4 x 4 points. [N]"""
    load = np.zeros((len(mesh.nodes), 3))
    for number in itertools.product(range(4), repeat=3):
        shape, gradient = _interpolation(mesh.elements.shape[1], _ABSCISSAE[list(number)][None])
        volume = np.linalg.det(gradient @ mesh.corners) * np.prod(_WEIGHTS[list(number)])
        values = force(shape @ mesh.corners) * volume[:, None]
        np.add.at(load, mesh.elements, shape[:, None] * values[:, None, :])
    return load.ravel()


def _interpolation(size: int, point: Matrix) -> tuple[Vector, Matrix]:
    """Shape functions and their natural gradients at one point, shapes (size,) and (3, size)."""
    if size == 20:
        return solid20.shape_functions(point)[0], solid20.natural_gradients(point)[0]
    factors = 1.0 + CUBE_CORNERS * point
    others = [np.prod(np.delete(factors, axis, axis=1), axis=1) for axis in range(3)]
    return np.prod(factors, axis=1) / 8.0, CUBE_CORNERS.T * np.array(others) / 8.0


def equilibrium(
    stiffness: SparseMatrix, load: Vector, held: IntVector, values: Vector | float = 0.0
) -> Vector:
    """Displacements under a load with some freedoms prescribed."""
    result = np.zeros(len(load))
    result[held] = values
    free = np.setdiff1d(np.arange(len(load)), held)
    residual = (load - stiffness @ result)[free]
    result[free] = factorise(stiffness[free][:, free].tocsr(), "mesh").solve(residual)
    return result


def orders(sizes: Vector, errors: Vector) -> Vector:
    """Observed orders of convergence between neighbouring meshes."""
    return np.diff(np.log(np.abs(errors))) / np.diff(np.log(sizes))


def supported_quarter(side: float, divisions: int, distorted: bool) -> tuple[Mesh, IntVector]:
    """A quarter of a simply supported square plate of shells, and its held freedoms.

    The supports hold the deflection and the rotation of their normal (hard support), the other two
    edges are lines of symmetry; the last node is the plate's centre. ``distorted`` moves the inner
    nodes smoothly by half an element of eight.
    """
    half = 0.5 * side
    grid = np.linspace(0.0, half, divisions + 1)
    mesh = quadrilaterals(grid, grid)
    x, y, _ = mesh.nodes.T
    if distorted:
        bulge = np.sin(np.pi * x / half) * np.sin(np.pi * y / half)
        mesh = replace(mesh, nodes=mesh.nodes + np.outer(bulge, [0.06 * side, -0.042 * side, 0.0]))
    held = [
        mesh.where(np.isclose(x, 0.0), 2, 3),
        mesh.where(np.isclose(y, 0.0), 2, 4),
        mesh.where(np.isclose(x, half), 4),
        mesh.where(np.isclose(y, half), 3),
        mesh.where(x > -1.0, 0, 1, 5),
    ]
    return mesh, np.unique(np.concatenate(held))


def navier_deflection(side: float, thickness: float, young: float, poisson: float) -> float:
    """Centre of a simply supported square plate under unit pressure, with shear (5/6). [m]

    Navier's double series (Timoshenko and Woinowsky-Krieger, section 30), each term with the
    deflection by shear of its own load.
    """
    rigidity = young * thickness**3 / (12.0 * (1.0 - poisson**2))
    shear = 5.0 / 6.0 * young * thickness / (2.0 * (1.0 + poisson))
    odd = np.arange(1, 200, 2)
    m, n = np.meshgrid(odd, odd)
    wave = (m**2 + n**2) * (np.pi / side) ** 2
    load = 16.0 / (np.pi**2 * m * n) * np.sin(0.5 * np.pi * m) * np.sin(0.5 * np.pi * n)
    return float(np.sum(load / (rigidity * wave**2) * (1.0 + rigidity * wave / shear)))
