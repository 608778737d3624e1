"""Displacement of a point that is rigidly offset from a node."""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray

__all__ = ["offset_rows"]


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
