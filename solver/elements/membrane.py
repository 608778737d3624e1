"""Four-node membrane with incompatible modes, in its own plane.

The plane-stress twin of the solid: four internal modes (1 - xi^2, 1 - eta^2 for each displacement)
give exact bending in the plane, so that a web one element high carries a girder's moment. That
holds for rectangles; slender trapezoids at 45 degrees keep 5 percent of the flexibility.

References:
    Taylor, Beresford and Wilson (1976).
"""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray, Matrix
from solver.elements.gauss import SQUARE_POINTS
from solver.elements.quadrilateral import jacobian, physical_gradients

__all__ = ["stiffness"]


def stiffness(
    local: FloatArray, thickness: FloatArray, young_modulus: FloatArray, poisson_ratio: float
) -> FloatArray:
    """Plane-stress stiffness.

    Args:
        local: Nodes in the element's plane, shape (n_element, 4, 2). [m]
        thickness: Shape (n_element,). [m]
        young_modulus: Shape (n_element,). [Pa]
        poisson_ratio: Poisson's ratio. [1]

    Returns:
        Shape (n_element, 8, 8), freedoms (u, v) node by node. [N/m]
    """
    elasticity = _plane_stress(poisson_ratio)
    count = len(local)
    nodal = np.zeros((count, 8, 8))
    coupling = np.zeros((count, 4, 8))
    internal = np.zeros((count, 4, 4))
    centre = jacobian(local, np.zeros(2))
    centre_inverse, centre_area = np.linalg.inv(centre), np.linalg.det(centre)
    for point in SQUARE_POINTS:
        gradients, area = physical_gradients(local, point)
        correction = (centre_area / area)[:, None, None]
        modes = correction * (centre_inverse @ np.diag(-2.0 * point))
        strain, mode_strain = _strain(gradients), _strain(modes)
        stress = elasticity @ strain * area[:, None, None]
        mode_stress = elasticity @ mode_strain * area[:, None, None]
        nodal += strain.transpose(0, 2, 1) @ stress
        coupling += mode_strain.transpose(0, 2, 1) @ stress
        internal += mode_strain.transpose(0, 2, 1) @ mode_stress
    condensed = nodal - coupling.transpose(0, 2, 1) @ np.linalg.solve(internal, coupling)
    condensed *= (thickness * young_modulus)[:, None, None]
    return 0.5 * (condensed + condensed.transpose(0, 2, 1))


def _strain(gradients: FloatArray) -> FloatArray:
    """Strains (xx, yy, xy), shape (n_element, 3, 2 n_function)."""
    count, _, functions = gradients.shape
    strain = np.zeros((count, 3, functions, 2))
    strain[:, 0, :, 0] = gradients[:, 0]
    strain[:, 1, :, 1] = gradients[:, 1]
    strain[:, 2, :, 0] = gradients[:, 1]
    strain[:, 2, :, 1] = gradients[:, 0]
    return strain.reshape(count, 3, 2 * functions)


def _plane_stress(poisson_ratio: float) -> Matrix:
    """Plane-stress elasticity over the modulus of elasticity."""
    nu = poisson_ratio
    return np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]]) / (1.0 - nu**2)
