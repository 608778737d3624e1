"""Geometry of flat four-node quadrilaterals: local frame, shape functions, Jacobian."""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray, Matrix, Vector
from solver.elements.gauss import SQUARE_CORNERS
from solver.errors import InputError

__all__ = ["jacobian", "local_frame", "natural_gradient", "physical_gradients", "shape_functions"]

_FLATNESS = 1e-6
"""Greatest distance of a node from the mean plane, over the diagonal, that counts as flat."""


def shape_functions(point: Vector) -> Vector:
    """Bilinear shape functions at natural coordinates, shape (4,)."""
    return np.prod(1.0 + SQUARE_CORNERS * point, axis=1) / 4.0


def natural_gradient(point: Vector) -> Matrix:
    """Derivatives of the shape functions by xi (row 0) and eta (row 1), shape (2, 4)."""
    factors = 1.0 + SQUARE_CORNERS * point
    return SQUARE_CORNERS.T * factors.T[::-1] / 4.0


def jacobian(local: FloatArray, point: Vector) -> FloatArray:
    """Jacobian d(x, y)/d(xi, eta), shape (n_element, 2, 2). [m]"""
    return natural_gradient(point) @ local


def physical_gradients(local: FloatArray, point: Vector) -> tuple[FloatArray, Vector]:
    """Derivatives by the local coordinates and the area of the natural square's unit.

    Args:
        local: Nodes in the element's plane, shape (n_element, 4, 2). [m]
        point: Natural coordinates, shape (2,).

    Returns:
        Gradients, shape (n_element, 2, 4) [1/m], and areas, shape (n_element,) [m2].

    Raises:
        InputError: An element is inside out.
    """
    matrix = jacobian(local, point)
    area = np.linalg.det(matrix)
    if np.any(area <= 0.0):
        worst = int(np.argmin(area))
        raise InputError(
            "coordinates",
            local[worst].tolist(),
            f"shell element {worst} has no positive area",
            "Check the order of its nodes and the dimensions that shape it.",
        )
    gradient = np.broadcast_to(natural_gradient(point), (len(local), 2, 4))
    return np.linalg.solve(matrix, gradient), area


def local_frame(coordinates: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Local axes and in-plane coordinates of flat quadrilaterals in space.

    Args:
        coordinates: Nodes, shape (n_element, 4, 3). [m]

    Returns:
        Rotation, shape (n_element, 3, 3), whose rows are the local axes in global coordinates
        (the third is the normal), and local coordinates, shape (n_element, 4, 2). [m]

    Raises:
        InputError: An element is not flat.
    """
    centred = coordinates - coordinates.mean(axis=1, keepdims=True)
    first = coordinates[:, 1] + coordinates[:, 2] - coordinates[:, 0] - coordinates[:, 3]
    diagonal = coordinates[:, 2] - coordinates[:, 0]
    normal = np.cross(diagonal, coordinates[:, 3] - coordinates[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    first -= np.sum(first * normal, axis=1, keepdims=True) * normal
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    rotation = np.stack([first, np.cross(normal, first), normal], axis=1)
    local = centred @ rotation.transpose(0, 2, 1)
    warp = np.abs(local[:, :, 2]).max(axis=1) / np.linalg.norm(diagonal, axis=1)
    if np.any(warp > _FLATNESS):
        worst = int(np.argmax(warp))
        raise InputError(
            "coordinates",
            coordinates[worst].tolist(),
            f"shell element {worst} is warped by {warp[worst]:.1e} of its diagonal",
            "Use flat quadrilaterals.",
        )
    return rotation, local[:, :, :2]
