"""MITC4: four-node Reissner-Mindlin plate in bending without shear locking.

The transverse shear is sampled on the middles of the edges, in natural components, and interpolated
across the element, so that thin plates bend as Kirchhoff's do.

References:
    Bathe and Dvorkin (1985), A four-node plate bending element based on Mindlin/Reissner plate
    theory and a mixed interpolation, International Journal for Numerical Methods in Engineering 21.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray, Matrix, Vector
from solver.elements.gauss import SQUARE_POINTS
from solver.elements.quadrilateral import (
    jacobian,
    natural_gradient,
    physical_gradients,
    shape_functions,
)

__all__ = ["stiffness"]

_SHEAR_FACTOR = 5.0 / 6.0


def stiffness(
    local: FloatArray, thickness: FloatArray, young_modulus: FloatArray, poisson_ratio: float
) -> FloatArray:
    """Stiffness in bending and transverse shear.

    Args:
        local: Nodes in the element's plane, shape (n_element, 4, 2). [m]
        thickness: Shape (n_element,). [m]
        young_modulus: Shape (n_element,). [Pa]
        poisson_ratio: Poisson's ratio. [1]

    Returns:
        Shape (n_element, 12, 12), freedoms (w, rotation about x, rotation about y) node by node.
    """
    nu = poisson_ratio
    curvature_law = np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])
    flexural = young_modulus * thickness**3 / (12.0 * (1.0 - nu**2))
    shear = _SHEAR_FACTOR * young_modulus * thickness / (2.0 * (1.0 + nu))
    samples = _edge_shear(local)
    result = np.zeros((len(local), 12, 12))
    for point in SQUARE_POINTS:
        gradients, area = physical_gradients(local, point)
        curvature = _curvature(gradients)
        strain = _interpolated_shear(local, samples, point)
        result += (flexural * area)[:, None, None] * (
            curvature.transpose(0, 2, 1) @ (curvature_law @ curvature)
        )
        result += (shear * area)[:, None, None] * (strain.transpose(0, 2, 1) @ strain)
    return result


def _curvature(gradients: FloatArray) -> FloatArray:
    """Curvatures (xx, yy, xy) with slopes (rotation about y, minus rotation about x)."""
    count = len(gradients)
    result = np.zeros((count, 3, 4, 3))
    result[:, 0, :, 2] = gradients[:, 0]
    result[:, 1, :, 1] = -gradients[:, 1]
    result[:, 2, :, 2] = gradients[:, 1]
    result[:, 2, :, 1] = -gradients[:, 0]
    return result.reshape(count, 3, 12)


def _natural_shear(local: FloatArray, point: Matrix, direction: int) -> FloatArray:
    """Natural shear dw/d(natural) + slope . dx/d(natural) at a point, shape (n_element, 12)."""
    shape = shape_functions(point)
    tangent = jacobian(local, point)[:, direction]
    result = np.zeros((len(local), 4, 3))
    result[:, :, 0] = natural_gradient(point)[direction]
    result[:, :, 1] = -tangent[:, 1, None] * shape
    result[:, :, 2] = tangent[:, 0, None] * shape
    return result.reshape(-1, 12)


def _edge_shear(local: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Shear along xi on the edges eta = -1, 1, then along eta on the edges xi = -1, 1."""
    return (
        _natural_shear(local, np.array([0.0, -1.0]), 0),
        _natural_shear(local, np.array([0.0, 1.0]), 0),
        _natural_shear(local, np.array([-1.0, 0.0]), 1),
        _natural_shear(local, np.array([1.0, 0.0]), 1),
    )


def _interpolated_shear(
    local: FloatArray,
    samples: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    point: Vector,
) -> FloatArray:
    """Shear strains (xz, yz) interpolated from the edges, shape (n_element, 2, 12)."""
    lower, upper, left, right = samples
    xi, eta = point
    natural = np.stack(
        [
            0.5 * (1.0 - eta) * lower + 0.5 * (1.0 + eta) * upper,
            0.5 * (1.0 - xi) * left + 0.5 * (1.0 + xi) * right,
        ],
        axis=1,
    )
    return np.linalg.solve(jacobian(local, point), natural)
