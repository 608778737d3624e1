"""Twenty-node solid: the serendipity hexahedron of second degree.

Integrated with 3 x 3 x 3 Gauss points, stiffness and mass alike: both are then exact on every
parallelepiped, the stiffness has the six rigid motions and nothing else in its null space, and
the consistent mass is positive definite. Eight points would leave six more motions without strain;
the fourteen points of Irons are exact to the fifth degree together, where these need the sixth.

The order of convergence (four in energy) holds on meshes whose elements become parallelepipeds as
they are refined, as those of any smooth map do. Where every refinement keeps the same trapezoids
it falls (3.4 measured with slopes of 0.7; theory leaves two): keep distortion local.

References:
    Zienkiewicz and Taylor (2000), The Finite Element Method, volume 1, sections 8.7 and 9.12.
    Arnold, Boffi and Falk (2002), Approximation by quadrilateral finite elements, Mathematics of
    Computation 71.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray, Matrix
from solver.elements.gauss import CUBE_CORNERS, CUBE_POINTS_27, CUBE_WEIGHTS_27
from solver.errors import InputError

__all__ = ["EDGES", "NODES", "mass", "natural_gradients", "shape_functions", "stiffness"]

EDGES: tuple[tuple[int, int], ...] = (
    *((0, 1), (1, 2), (2, 3), (3, 0)),
    *((4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)
"""Corners at the ends of the edges on whose middles nodes 8 to 19 lie."""
NODES: Matrix = np.vstack(
    [CUBE_CORNERS, np.array([CUBE_CORNERS[list(edge)].mean(axis=0) for edge in EDGES])]
)
"""Natural coordinates of the nodes, shape (20, 3): corners as those of the eight-node solid, then
the middles of the lower face's edges, of the upper face's, and of the four that join them."""

_SIZE = 60
_PIECE = 2000
"""Elements treated at a time, so that work arrays stay below 0.2 GB."""


def stiffness(coordinates: FloatArray, young_modulus: float, poisson_ratio: float) -> FloatArray:
    """Stiffness of isotropic twenty-node solids.

    Args:
        coordinates: Nodes in the order of ``NODES``, shape (n_element, 20, 3). [m]
        young_modulus: Modulus of elasticity. [Pa]
        poisson_ratio: Poisson's ratio. [1]

    Returns:
        Shape (n_element, 60, 60), freedoms (u, v, w) node by node. [N/m]

    Raises:
        InputError: An element is inside out at one of its integration points.
    """
    shear = young_modulus / (2.0 * (1.0 + poisson_ratio))
    lame = young_modulus * poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio))
    count = len(coordinates)
    result = np.empty((count, 20, 3, 20, 3))
    for start in range(0, count, _PIECE):
        piece = slice(start, start + _PIECE)
        gradients, volume = _physical_gradients(coordinates[piece], start)
        rows = gradients.reshape(len(gradients), -1, _SIZE)
        weighted = rows * volume[:, :, None]
        # products[axis, node, other axis, other node] = integral of dN_node/daxis dN_other/dother
        products = (rows.transpose(0, 2, 1) @ weighted).reshape(-1, 3, 20, 3, 20)
        block = lame * products.transpose(0, 2, 1, 4, 3)
        block += shear * products.transpose(0, 2, 3, 4, 1)
        laplacian = shear * np.einsum("eiaib->eab", products)
        for axis in range(3):
            block[:, :, axis, :, axis] += laplacian
        result[piece] = block
    matrices = result.reshape(-1, _SIZE, _SIZE)
    return 0.5 * (matrices + matrices.transpose(0, 2, 1))


def mass(coordinates: FloatArray, density: float) -> FloatArray:
    """Consistent mass of twenty-node solids.

    Args:
        coordinates: Nodes in the order of ``NODES``, shape (n_element, 20, 3). [m]
        density: Density. [kg/m3]

    Returns:
        Shape (n_element, 60, 60). [kg]

    Raises:
        InputError: An element is inside out at one of its integration points.
    """
    count = len(coordinates)
    shape = shape_functions(CUBE_POINTS_27)
    result = np.zeros((count, 20, 3, 20, 3))
    for start in range(0, count, _PIECE):
        piece = slice(start, start + _PIECE)
        _, volume = _physical_gradients(coordinates[piece], start)
        scalar = density * (shape.T @ (volume[:, :, None] * shape))
        for axis in range(3):
            result[piece, :, axis, :, axis] = scalar
    return result.reshape(-1, _SIZE, _SIZE)


def shape_functions(points: Matrix) -> Matrix:
    """Shape functions at natural coordinates.

    Args:
        points: Shape (n_point, 3).

    Returns:
        Shape (n_point, 20).
    """
    product = np.prod(_factors(points), axis=2)
    product[:, :8] *= (points @ CUBE_CORNERS.T - 2.0) / 8.0
    product[:, 8:] /= 4.0
    return product


def natural_gradients(points: Matrix) -> FloatArray:
    """Derivatives of the shape functions by the natural coordinates.

    Args:
        points: Shape (n_point, 3).

    Returns:
        Shape (n_point, 3, 20).
    """
    factors = _factors(points)
    slopes = np.where(NODES == 0.0, -2.0 * points[:, None, :], NODES)
    result = np.empty((len(points), 3, 20))
    for axis in range(3):
        others = np.prod(np.delete(factors, axis, axis=2), axis=2)
        result[:, axis] = slopes[:, :, axis] * others
    result[:, :, :8] *= (points @ CUBE_CORNERS.T - 2.0)[:, None, :]
    result[:, :, :8] += np.prod(factors[:, :8], axis=2)[:, None, :] * CUBE_CORNERS.T
    result[:, :, :8] /= 8.0
    result[:, :, 8:] /= 4.0
    return result


def _factors(points: Matrix) -> FloatArray:
    """Factors of each node by direction: 1 - xi^2 along its own edge, otherwise 1 + xi_node xi."""
    coordinate = points[:, None, :]
    return np.where(NODES == 0.0, 1.0 - coordinate**2, 1.0 + NODES * coordinate)


def _physical_gradients(coordinates: FloatArray, first: int) -> tuple[FloatArray, Matrix]:
    """Gradients at the integration points and the volumes that the points stand for.

    Args:
        coordinates: Shape (n_element, 20, 3). [m]
        first: Number of the first of these elements, for the error's text.

    Returns:
        Gradients, shape (n_element, 27, 3, 20) [1/m], and volumes, shape (n_element, 27). [m3]
    """
    natural = natural_gradients(CUBE_POINTS_27)
    jacobian = np.einsum("pin,enj->epij", natural, coordinates, optimize=True)
    determinant = np.linalg.det(jacobian)
    if np.any(determinant <= 0.0):
        worst = int(np.argmin(determinant.min(axis=1)))
        raise InputError(
            "coordinates",
            coordinates[worst].tolist(),
            f"solid element {first + worst} has no positive volume at an integration point",
            "Check the order of its nodes and that middle nodes lie near the edges' middles.",
        )
    return np.linalg.inv(jacobian) @ natural, determinant * CUBE_WEIGHTS_27
