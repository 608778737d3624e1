"""Flat four-node shell: MITC4 plate, membrane with incompatible modes, drilling penalty.

Six freedoms a node, in global axes. The rotation about the normal (drilling) has neither mass nor
a physical stiffness: a weak penalty ties it to the membrane's mean rotation. It is a function of
its own because it must not be damped.

The mid-surface may lie off the nodes, by ``offset`` along each element's normal (towards the side
from which its nodes run counter-clockwise). The arms are rigid and exact: displacement of the
mid-surface = displacement of the node + rotation x arm. Elements that meet at an angle keep their
own arms.

References:
    Hughes and Brezzi (1989), On drilling degrees of freedom, Computer Methods in Applied Mechanics
    and Engineering 72.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray, IntVector
from solver.elements import membrane, plate
from solver.elements.gauss import SQUARE_POINTS
from solver.elements.quadrilateral import local_frame, physical_gradients, shape_functions

__all__ = ["drilling_stiffness", "mass", "stiffness"]

_MEMBRANE: IntVector = np.array([6 * node + axis for node in range(4) for axis in (0, 1)])
_PLATE: IntVector = np.array([6 * node + axis for node in range(4) for axis in (2, 3, 4)])

DRILLING_FACTOR = 1e-3
"""Penalty over the shear modulus: large enough to be regular, too small to stiffen a bent web."""


def stiffness(
    coordinates: FloatArray,
    thickness: FloatArray,
    young_modulus: FloatArray,
    poisson_ratio: float,
    offset: FloatArray | float = 0.0,
) -> FloatArray:
    """Stiffness of membrane, bending and transverse shear, without drilling.

    Args:
        coordinates: Nodes, counter-clockwise, shape (n_element, 4, 3). [m]
        thickness: Shape (n_element,). [m]
        young_modulus: Shape (n_element,). [Pa]
        poisson_ratio: Poisson's ratio. [1]
        offset: From the nodes to the mid-surface along the normal, one number or shape
            (n_element,). [m]

    Returns:
        Shape (n_element, 24, 24), freedoms (u, v, w, and the three rotations) node by node.

    Raises:
        InputError: An element is warped or inside out.
    """
    rotation, local = local_frame(coordinates)
    result = np.zeros((len(coordinates), 24, 24))
    result[:, _MEMBRANE[:, None], _MEMBRANE] = membrane.stiffness(
        local, thickness, young_modulus, poisson_ratio
    )
    result[:, _PLATE[:, None], _PLATE] = plate.stiffness(
        local, thickness, young_modulus, poisson_ratio
    )
    return _to_global(result, rotation, offset)


def drilling_stiffness(
    coordinates: FloatArray,
    thickness: FloatArray,
    young_modulus: FloatArray,
    poisson_ratio: float,
    offset: FloatArray | float = 0.0,
) -> FloatArray:
    """Penalty on the drilling rotation's difference from the membrane's mean rotation.

    Args:
        coordinates: Nodes, shape (n_element, 4, 3). [m]
        thickness: Shape (n_element,). [m]
        young_modulus: Shape (n_element,). [Pa]
        poisson_ratio: Poisson's ratio. [1]
        offset: From the nodes to the mid-surface along the normal, one number or shape
            (n_element,). [m]

    Returns:
        Shape (n_element, 24, 24).
    """
    rotation, local = local_frame(coordinates)
    penalty = DRILLING_FACTOR * young_modulus * thickness / (2.0 * (1.0 + poisson_ratio))
    result = np.zeros((len(coordinates), 24, 24))
    for point in SQUARE_POINTS:
        gradients, area = physical_gradients(local, point)
        row = np.zeros((len(coordinates), 4, 6))
        row[:, :, 0] = 0.5 * gradients[:, 1]
        row[:, :, 1] = -0.5 * gradients[:, 0]
        row[:, :, 5] = shape_functions(point)
        flat = row.reshape(-1, 24)
        result += (penalty * area)[:, None, None] * flat[:, :, None] * flat[:, None, :]
    return _to_global(result, rotation, offset)


def mass(
    coordinates: FloatArray,
    thickness: FloatArray,
    density: float,
    offset: FloatArray | float = 0.0,
) -> FloatArray:
    """Consistent mass with rotary inertia of the two bending rotations; none in drilling.

    Args:
        coordinates: Nodes, shape (n_element, 4, 3). [m]
        thickness: Shape (n_element,). [m]
        density: Density. [kg/m3]
        offset: From the nodes to the mid-surface along the normal, one number or shape
            (n_element,). [m]

    Returns:
        Shape (n_element, 24, 24).
    """
    rotation, local = local_frame(coordinates)
    scalar = np.zeros((len(coordinates), 4, 4))
    for point in SQUARE_POINTS:
        _, area = physical_gradients(local, point)
        shape = shape_functions(point)
        scalar += density * area[:, None, None] * np.outer(shape, shape)
    result = np.zeros((len(coordinates), 4, 6, 4, 6))
    for axis in range(3):
        result[:, :, axis, :, axis] = thickness[:, None, None] * scalar
    for axis in (3, 4):
        result[:, :, axis, :, axis] = (thickness**3 / 12.0)[:, None, None] * scalar
    return _to_global(result.reshape(-1, 24, 24), rotation, offset)


def _to_global(
    matrices: FloatArray, rotation: FloatArray, offset: FloatArray | float
) -> FloatArray:
    """Takes element matrices from local axes at the mid-surface to global axes at the nodes."""
    transform = np.zeros((len(matrices), 8, 3, 8, 3))
    for triad in range(8):
        transform[:, triad, :, triad, :] = rotation
    arm = np.broadcast_to(np.asarray(offset, dtype=np.float64), (len(matrices),))[:, None]
    for node in range(4):
        # rotation x (0, 0, arm) = (arm rotation_y, -arm rotation_x, 0), in local axes.
        transform[:, 2 * node, 0, 2 * node + 1] = arm * rotation[:, 1]
        transform[:, 2 * node, 1, 2 * node + 1] = -arm * rotation[:, 0]
    transform = transform.reshape(-1, 24, 24)
    return transform.transpose(0, 2, 1) @ matrices @ transform
