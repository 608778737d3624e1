"""Eight-node solid with incompatible modes.

The nine internal modes (1 - xi^2, 1 - eta^2, 1 - zeta^2 for each displacement) let one element bend
exactly; they are condensed out of the stiffness. Taylor's correction evaluates their gradients with
the Jacobian of the element's centre, so that distorted elements still pass the patch test.

Bending needs rectangular elements: one slender trapezoid over the height, its ends at 45 degrees,
keeps 5 percent of the flexibility (MacNeal and Harder's beam); a parallelogram keeps 62.

References:
    Taylor, Beresford and Wilson (1976), A non-conforming element for stress analysis,
    International Journal for Numerical Methods in Engineering 10.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray, Matrix, Vector
from solver.elements.gauss import CUBE_CORNERS, CUBE_POINTS
from solver.errors import InputError

__all__ = ["mass", "stiffness"]


def stiffness(coordinates: FloatArray, young_modulus: float, poisson_ratio: float) -> FloatArray:
    """Stiffness of isotropic eight-node solids.

    Args:
        coordinates: Nodes, shape (n_element, 8, 3), lower face counter-clockwise, then upper. [m]
        young_modulus: Modulus of elasticity. [Pa]
        poisson_ratio: Poisson's ratio. [1]

    Returns:
        Shape (n_element, 24, 24), freedoms (u, v, w) node by node. [N/m]

    Raises:
        InputError: An element is inside out.
    """
    elasticity = _elasticity(young_modulus, poisson_ratio)
    count = len(coordinates)
    nodal = np.zeros((count, 24, 24))
    coupling = np.zeros((count, 9, 24))
    internal = np.zeros((count, 9, 9))
    centre = _gradient(np.zeros(3)) @ coordinates
    centre_inverse, centre_volume = np.linalg.inv(centre), np.linalg.det(centre)
    for point in CUBE_POINTS:
        gradients, volume = _physical_gradients(coordinates, point)
        correction = (centre_volume / volume)[:, None, None]
        modes = correction * (centre_inverse @ np.diag(-2.0 * point))
        strain, mode_strain = _strain(gradients), _strain(modes)
        stress = elasticity @ strain * volume[:, None, None]
        mode_stress = elasticity @ mode_strain * volume[:, None, None]
        nodal += strain.transpose(0, 2, 1) @ stress
        coupling += mode_strain.transpose(0, 2, 1) @ stress
        internal += mode_strain.transpose(0, 2, 1) @ mode_stress
    condensed = nodal - coupling.transpose(0, 2, 1) @ np.linalg.solve(internal, coupling)
    return 0.5 * (condensed + condensed.transpose(0, 2, 1))


def mass(coordinates: FloatArray, density: float) -> FloatArray:
    """Consistent mass of eight-node solids.

    Args:
        coordinates: Nodes, shape (n_element, 8, 3). [m]
        density: Density. [kg/m3]

    Returns:
        Shape (n_element, 24, 24). [kg]

    Raises:
        InputError: An element is inside out.
    """
    scalar = np.zeros((len(coordinates), 8, 8))
    for point in CUBE_POINTS:
        _, volume = _physical_gradients(coordinates, point)
        shape = _shape(point)
        scalar += density * volume[:, None, None] * np.outer(shape, shape)
    result = np.zeros((len(coordinates), 8, 3, 8, 3))
    for axis in range(3):
        result[:, :, axis, :, axis] = scalar
    return result.reshape(-1, 24, 24)


def _shape(point: Vector) -> Vector:
    return np.prod(1.0 + CUBE_CORNERS * point, axis=1) / 8.0


def _gradient(point: Vector) -> Matrix:
    """Derivatives of the shape functions by the natural coordinates, shape (3, 8)."""
    factors = 1.0 + CUBE_CORNERS * point
    columns = [
        CUBE_CORNERS[:, axis] * np.prod(np.delete(factors, axis, axis=1), axis=1) / 8.0
        for axis in range(3)
    ]
    return np.array(columns)


def _physical_gradients(coordinates: FloatArray, point: Vector) -> tuple[FloatArray, Vector]:
    natural = _gradient(point)
    jacobian = natural @ coordinates
    volume = np.linalg.det(jacobian)
    if np.any(volume <= 0.0):
        worst = int(np.argmin(volume))
        raise InputError(
            "coordinates",
            coordinates[worst].tolist(),
            f"solid element {worst} has no positive volume",
            "Check the order of its nodes and the dimensions that shape it.",
        )
    return np.linalg.solve(jacobian, np.broadcast_to(natural, (len(jacobian), 3, 8))), volume


def _strain(gradients: FloatArray) -> FloatArray:
    """Strains (xx, yy, zz, xy, yz, zx) of shape functions with these gradients.

    Args:
        gradients: Shape (n_element, 3, n_function). [1/m]

    Returns:
        Shape (n_element, 6, 3 n_function).
    """
    count, _, functions = gradients.shape
    strain = np.zeros((count, 6, functions, 3))
    for axis in range(3):
        strain[:, axis, :, axis] = gradients[:, axis]
    for row, (first, second) in enumerate(((0, 1), (1, 2), (2, 0)), start=3):
        strain[:, row, :, first] = gradients[:, second]
        strain[:, row, :, second] = gradients[:, first]
    return strain.reshape(count, 6, 3 * functions)


def _elasticity(young_modulus: float, poisson_ratio: float) -> Matrix:
    shear = young_modulus / (2.0 * (1.0 + poisson_ratio))
    lame = young_modulus * poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio))
    result = np.diag([2.0 * shear] * 3 + [shear] * 3)
    result[:3, :3] += lame
    return result
