"""Springs and dampers between two nodes, or from a node to the ground; six freedoms a node.

The forces act at one declared point, to which each node is joined by a rigid arm. So nodes that lie
apart carry the moments of their arms, and a rigid motion of both strains nothing, whatever their
distance. Coefficients of stiffness give a stiffness matrix, those of damping a damping matrix.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray
from solver.elements.rigid_link import rigid_arm
from solver.errors import InputError

__all__ = ["between", "to_ground"]

_ORTHONORMAL = 1e-9
"""Greatest error of the local axes' scalar products."""


def between(
    coordinates: FloatArray,
    points: FloatArray,
    coefficients: FloatArray,
    axes: FloatArray | None = None,
) -> FloatArray:
    """Matrix of springs, or of dampers, that join two nodes at a point.

    Args:
        coordinates: Nodes, shape (n_element, 2, 3). [m]
        points: Where the forces act, shape (n_element, 3); for a strut, anywhere on its line. [m]
        coefficients: Along and about each local axis, shape (6,) or (n_element, 6).
            [N/m and N m/rad, or N s/m and N m s/rad]
        axes: Rows are the local axes in global coordinates, shape (3, 3) or (n_element, 3, 3),
            for example those of ``beam.local_frame``; by default the global axes.

    Returns:
        Shape (n_element, 12, 12), freedoms (u, v, w, and the three rotations) node by node.

    Raises:
        InputError: A coefficient is negative, or the axes are not orthonormal.
    """
    arms = points[:, None] - coordinates
    first, second = (_local_motion(arms[:, node], axes) for node in range(2))
    return _quadratic(np.concatenate([-first, second], axis=2), coefficients)


def to_ground(
    coordinates: FloatArray,
    points: FloatArray,
    coefficients: FloatArray,
    axes: FloatArray | None = None,
) -> FloatArray:
    """Matrix of springs, or of dampers, that join a node to the ground at a point.

    Args:
        coordinates: Nodes, shape (n_element, 3). [m]
        points: Where the forces act, shape (n_element, 3). [m]
        coefficients: Along and about each local axis, shape (6,) or (n_element, 6).
            [N/m and N m/rad, or N s/m and N m s/rad]
        axes: As for ``between``.

    Returns:
        Shape (n_element, 6, 6), freedoms (u, v, w, and the three rotations).

    Raises:
        InputError: A coefficient is negative, or the axes are not orthonormal.
    """
    return _quadratic(_local_motion(points - coordinates, axes), coefficients)


def _local_motion(arms: FloatArray, axes: FloatArray | None) -> FloatArray:
    """Rows that give the point's motion in local axes, shape (n_element, 6, 6)."""
    rows = rigid_arm(arms)
    if axes is None:
        return rows
    error = np.abs(axes @ np.swapaxes(axes, -1, -2) - np.eye(3))
    if not np.all(error <= _ORTHONORMAL):
        raise InputError(
            "axes",
            np.asarray(axes).tolist(),
            "the local axes are not perpendicular unit vectors",
            "Give three perpendicular unit vectors as rows, or one of beam.local_frame.",
        )
    turned = np.broadcast_to(axes, (len(arms), 3, 3))[:, None] @ rows.reshape(-1, 2, 3, 6)
    return turned.reshape(-1, 6, 6)


def _quadratic(rows: FloatArray, coefficients: FloatArray) -> FloatArray:
    """Sum over the six directions of coefficient times (row' row)."""
    factors = np.broadcast_to(np.asarray(coefficients, dtype=float), (len(rows), 6))
    if not np.all((factors >= 0.0) & np.isfinite(factors)):
        worst = np.argwhere(~((factors >= 0.0) & np.isfinite(factors)))[0]
        raise InputError(
            "coefficients",
            float(factors[tuple(worst)]),
            f"coefficient {int(worst[1])} of spring-damper {int(worst[0])} must not be negative",
            "Use 0 or more; 0 leaves the direction free.",
        )
    result = rows.transpose(0, 2, 1) @ (factors[:, :, None] * rows)
    return 0.5 * (result + result.transpose(0, 2, 1))
