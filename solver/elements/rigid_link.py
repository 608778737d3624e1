"""Displacement of a point that is rigidly offset from a node.

A rigid link is these rows as the weights of a combination that is eliminated exactly
(``assembly.constraints``), or as the arm of an element that does not end at its nodes: no stiff
beam and no penalty stands for it.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray

__all__ = ["offset_rows", "rigid_arm"]


def offset_rows(offset: FloatArray) -> FloatArray:
    """Rows that give u + rotation x offset from the node's six freedoms.

    Args:
        offset: From the node to the point, shape (n_point, 3). [m]

    Returns:
        Shape (n_point, 3, 6), columns (u, v, w, and the three rotations).
    """
    x, y, z = offset.T
    rows = np.zeros((len(offset), 3, 6))
    rows[:, :, :3] = np.eye(3)
    rows[:, 0, 4], rows[:, 0, 5] = z, -y
    rows[:, 1, 3], rows[:, 1, 5] = -z, x
    rows[:, 2, 3], rows[:, 2, 4] = y, -x
    return rows


def rigid_arm(offset: FloatArray) -> FloatArray:
    """Rows that give all six freedoms of a rigidly offset point: it turns as the node does.

    The transpose carries a force and a moment at the point back to the node, moment arm included.

    Args:
        offset: From the node to the point, shape (n_point, 3). [m]

    Returns:
        Shape (n_point, 6, 6), rows and columns (u, v, w, and the three rotations).
    """
    result = np.zeros((len(offset), 6, 6))
    result[:, :3] = offset_rows(offset)
    result[:, 3:, 3:] = np.eye(3)
    return result
