"""Mass spread along an edge, without stiffness: parapets, safeguards, edge beams."""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray

__all__ = ["mass"]


def mass(coordinates: FloatArray, mass_per_length: float) -> FloatArray:
    """Consistent mass of two-node edges.

    Args:
        coordinates: Nodes, shape (n_element, 2, 3). [m]
        mass_per_length: Mass per length. [kg/m]

    Returns:
        Shape (n_element, 6, 6), freedoms (u, v, w) node by node. [kg]
    """
    length = np.linalg.norm(coordinates[:, 1] - coordinates[:, 0], axis=1)
    pattern = np.kron(np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0, np.eye(3))
    return (mass_per_length * length)[:, None, None] * pattern
