"""Straight two-node bar that carries tension and compression only; three freedoms a node."""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray, Vector
from solver.elements import line_mass
from solver.errors import InputError

__all__ = ["mass", "stiffness"]


def stiffness(coordinates: FloatArray, area: Vector, young_modulus: Vector) -> FloatArray:
    """Axial stiffness E A / L along the bar, none across it.

    Args:
        coordinates: Nodes, shape (n_element, 2, 3). [m]
        area: Shape (n_element,). [m2]
        young_modulus: Shape (n_element,). [Pa]

    Returns:
        Shape (n_element, 6, 6), freedoms (u, v, w) node by node. [N/m]

    Raises:
        InputError: An element has no length.
    """
    span = coordinates[:, 1] - coordinates[:, 0]
    length = np.linalg.norm(span, axis=1)
    if not np.all(length > 0.0):
        worst = int(np.argmin(length))
        raise InputError(
            "coordinates",
            coordinates[worst].tolist(),
            f"truss element {worst} has no length",
            "Check its nodes.",
        )
    stretch = np.hstack([-span, span]) / length[:, None]
    axial = young_modulus * area / length
    return axial[:, None, None] * stretch[:, :, None] * stretch[:, None, :]


def mass(coordinates: FloatArray, area: Vector, density: float) -> FloatArray:
    """Consistent mass, the same along the bar and across it.

    Args:
        coordinates: Nodes, shape (n_element, 2, 3). [m]
        area: Shape (n_element,). [m2]
        density: Density. [kg/m3]

    Returns:
        Shape (n_element, 6, 6). [kg]
    """
    return (density * area)[:, None, None] * line_mass.mass(coordinates, 1.0)
