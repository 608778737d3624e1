"""Where things are drawn: pure functions from stored values to positions.

Only displacements are exaggerated; positions along the track never are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.arrays import FloatArray, IntArray, Matrix, Vector
from solver.results import BodyGeometry, WheelGeometry

__all__ = [
    "axle_poses",
    "body_poses",
    "deformed",
    "force_arrows",
    "nearest_frame",
    "pleasing_scale",
    "quaternions",
    "wheel_positions",
]

ARROW_ASIDE = 0.62
"""Of a force's arrow from its wheel, outside of the bogie's side beam. [m]"""


def nearest_frame(time: float, interval: float, n_frame: int) -> int:
    """Index of the stored frame nearest to a time.

    Args:
        time: From the static start. [s]
        interval: Time between frames; zero where only one is stored. [s]
        n_frame: Frames stored so far.
    """
    if interval <= 0.0:
        return 0
    return min(max(round(time / interval), 0), max(n_frame - 1, 0))


def deformed(vertices: Matrix, displacement: FloatArray, scale: float) -> Matrix:
    """Vertices of the exaggerated deformed surface.

    Args:
        vertices: At rest, shape (n_vertex, 3). [m]
        displacement: Shape (n_vertex, 3). [m]
        scale: Deformation scale.
    """
    return vertices + scale * displacement


def wheel_positions(
    wheels: WheelGeometry, first_axle: float, displacement: Vector, scale: float
) -> Matrix:
    """Centres of the wheels.

    Args:
        wheels: The wheels.
        first_axle: x of the first axle, start position + speed x time. [m]
        displacement: Upward displacement of each contact point, shape (n_wheel,). [m]
        scale: Deformation scale.

    Returns:
        Shape (n_wheel, 3). [m]
    """
    height = wheels.contact_height + wheels.radius + scale * displacement
    return np.column_stack((first_axle + wheels.offsets, wheels.lateral, height))


def axle_poses(positions: Matrix, pairs: IntArray) -> tuple[Matrix, Matrix, Vector]:
    """Axles between the wheels of a pair, tilted with them.

    Args:
        positions: Centres of the wheels, shape (n_wheel, 3). [m]
        pairs: Indices of the right and left wheel of each axle, shape (n_axle, 2).

    Returns:
        Centres (n_axle, 3) [m], unit quaternions (n_axle, 4) and lengths (n_axle,). [m]
    """
    right, left = positions[pairs[:, 0]], positions[pairs[:, 1]]
    across = left - right
    tilt = np.arctan2(across[:, 2], across[:, 1])
    zero = np.zeros(len(pairs))
    return (right + left) / 2.0, quaternions(tilt, zero), np.linalg.norm(across, axis=1)


def body_poses(
    bodies: Sequence[BodyGeometry],
    first_axle: float,
    rail_height: float,
    motion: FloatArray,
    scale: float,
) -> tuple[Matrix, Matrix]:
    """Centres and orientations of carbodies and bogies.

    Args:
        bodies: The bodies.
        first_axle: x of the first axle. [m]
        rail_height: z of the undeformed contact points. [m]
        motion: Bounce, roll, pitch since the static start, shape (n_body, 3). [m, rad, rad]
        scale: Deformation scale, for angles too.

    Returns:
        Centres (n_body, 3) [m] and unit quaternions (w, x, y, z), shape (n_body, 4).
    """
    offset = np.array([body.offset for body in bodies])
    middle = np.array([body.base + body.size[2] / 2.0 for body in bodies])
    centres = np.column_stack(
        (first_axle + offset, np.zeros(len(bodies)), rail_height + middle + scale * motion[:, 0])
    )
    return centres, quaternions(scale * motion[:, 1], scale * motion[:, 2])


def quaternions(roll: Vector, pitch: Vector) -> Matrix:
    """Unit quaternions (w, x, y, z) of a roll about x followed by a pitch about y.

    Args:
        roll: Shape (n,). [rad]
        pitch: Shape (n,). [rad]
    """
    cos_roll, sin_roll = np.cos(roll / 2.0), np.sin(roll / 2.0)
    cos_pitch, sin_pitch = np.cos(pitch / 2.0), np.sin(pitch / 2.0)
    return np.column_stack(
        (
            cos_pitch * cos_roll,
            cos_pitch * sin_roll,
            sin_pitch * cos_roll,
            -sin_pitch * sin_roll,
        )
    )


def force_arrows(
    positions: Matrix, lateral: Vector, radius: float, force: Vector, metres_per_newton: float
) -> FloatArray:
    """Arrows that press on the rails, beside the wheels so that these do not hide them.

    Args:
        positions: Centres of the wheels, shape (n_wheel, 3). [m]
        lateral: y of the wheels, whose sign says which side is the outer one. [m]
        radius: Of the wheels. [m]
        force: Contact forces, shape (n_wheel,). [N]
        metres_per_newton: Length of an arrow over its force. [m/N]

    Returns:
        Tails and heads, shape (n_wheel, 2, 3); of almost no length where there is no force. [m]
    """
    head = positions - np.array([0.0, 0.0, radius])
    head[:, 1] += np.where(lateral <= 0.0, -ARROW_ASIDE, ARROW_ASIDE)
    tail = head.copy()
    length = np.where(np.isfinite(force), force, 0.0) * metres_per_newton
    tail[:, 2] += np.maximum(length, 1e-3)
    return np.stack((tail, head), axis=1)


def pleasing_scale(peak: float, shown: float) -> float:
    """A round deformation scale (1, 2 or 5 times a power of ten).

    Args:
        peak: Greatest displacement. [m]
        shown: The size at which it should appear. [m]
    """
    if peak <= 0.0:
        return 1.0
    wanted = max(shown / peak, 1.0)
    decade = 10.0 ** np.floor(np.log10(wanted))
    steps = np.array([1.0, 2.0, 5.0, 10.0]) * decade
    return float(steps[steps <= wanted * (1.0 + 1e-9)][-1])
