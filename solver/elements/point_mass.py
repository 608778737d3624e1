"""Rigid body at a node: mass, full rotary inertia and a centre of gravity that may lie apart."""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray, Vector
from solver.elements.rigid_link import rigid_arm
from solver.errors import InputError

__all__ = ["mass"]

_ROUND_OFF = 1e-9
"""Asymmetry, or negative principal inertia, over the greatest inertia that rounding explains."""


def mass(
    masses: Vector, inertia: FloatArray | None = None, offsets: FloatArray | None = None
) -> FloatArray:
    """Mass matrix of rigid bodies.

    The same matrix times (0, 0, -g, 0, 0, 0) is the weight with its moment about the node.

    Args:
        masses: Shape (n_element,). [kg]
        inertia: Inertia tensor about the centre of gravity in global axes, products of inertia
            with their minus sign, shape (n_element, 3, 3); by default none. [kg m2]
        offsets: From the node to the centre of gravity, shape (n_element, 3); by default none. [m]

    Returns:
        Shape (n_element, 6, 6), freedoms (u, v, w, and the three rotations). [kg, kg m, kg m2]

    Raises:
        InputError: A mass is negative, or an inertia tensor is not symmetric or has a negative
            principal inertia.
    """
    masses = np.asarray(masses, dtype=float)
    if not np.all((masses >= 0.0) & np.isfinite(masses)):
        worst = int(np.argmin((masses >= 0.0) & np.isfinite(masses)))
        raise InputError(
            "mass", float(masses[worst]), f"point mass {worst} is negative", "Use 0 or more."
        )
    result = np.zeros((len(masses), 6, 6))
    result[:, :3, :3] = masses[:, None, None] * np.eye(3)
    if inertia is not None:
        result[:, 3:, 3:] = _checked(inertia)
    if offsets is None:
        return result
    arm = rigid_arm(offsets)
    result = arm.transpose(0, 2, 1) @ result @ arm
    return 0.5 * (result + result.transpose(0, 2, 1))


def _checked(inertia: FloatArray) -> FloatArray:
    """The inertia tensors, made symmetric to the last bit."""
    symmetric = 0.5 * (inertia + inertia.transpose(0, 2, 1))
    allowed = _ROUND_OFF * np.abs(inertia).max(axis=(1, 2))
    skew = np.abs(inertia - symmetric).max(axis=(1, 2))
    least = np.linalg.eigvalsh(symmetric)[:, 0]
    for wrong, reason in (
        (skew > allowed, "is not symmetric"),
        (least < -allowed, "has a negative principal inertia"),
    ):
        if np.any(wrong):
            worst = int(np.argmax(wrong))
            raise InputError(
                "inertia",
                inertia[worst].tolist(),
                f"the inertia tensor of point mass {worst} {reason}",
                "Check its entries; off the diagonal stand minus the products of inertia.",
            )
    return symmetric
