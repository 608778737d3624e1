"""Mesh lines of track and deck: where the planes of nodes stand along and across the track."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.arrays import BoolVector, IntVector, Vector
from solver.models.ballasted_track import TrackProperties
from solver.models.mesh_level import MeshDensity
from solver.models.viaduct import ViaductProperties

__all__ = ["TrackLines", "across_lines", "deck_lines", "mirrored", "track_lines"]

_CLOSE = 0.01
"""Lines nearer to each other than this are one line. [m]"""
_JOINT_STRIP = 0.19
"""No plane in a crib is nearer to a joint: the strip of ballast between the two slabs' last ties
is as long on every mesh, otherwise its stiffness would grow with refinement without limit. [m]"""
_LAYERED_ZONE = 0.45
"""Reach of the joint's layers on both sides. [m]"""


@dataclass(frozen=True, kw_only=True)
class TrackLines:
    """Planes of nodes of the track.

    Attributes:
        along: Positions along the track, shape (n_line,). [m]
        sleeper: Sleeper that a plane belongs to, -1 in a crib, shape (n_line,).
        joint: Whether a plane is that of a joint, shape (n_line,).
        layered: Whether a plane has the nodes of the joint's layers, shape (n_line,).
        hanging: Whether these nodes have no layers on one side, shape (n_line,).
        across: Positions across the ballast, shape (n_across,). [m]
        sleeper_across: Numbers of the positions across that a sleeper covers, shape (n_covered,).
    """

    along: Vector
    sleeper: IntVector
    joint: BoolVector
    layered: BoolVector
    hanging: BoolVector
    across: Vector
    sleeper_across: IntVector


def mirrored(half: Vector) -> Vector:
    """Positions on both sides of the axis from those at y >= 0, the axis included."""
    return np.concatenate([-half[:0:-1], half])


def across_lines(track: TrackProperties, density: MeshDensity) -> Vector:
    """Positions of the ballast's nodes: rails, sleeper's ends, ballast's sides, and between. [m]"""
    rail, end, side = track.rail_position, 0.5 * track.sleeper_length, 0.5 * track.ballast_width
    sizes = np.where(np.arange(density.shoulder) == 0, density.edge_ratio, 1.0)
    shoulder = end + (side - end) * np.cumsum(sizes) / np.sum(sizes)
    outside = np.concatenate([subdivided((rail, end), (density.outside_rails,)), shoulder])
    inside = np.linspace(-rail, rail, density.between_rails + 1)[1:-1]
    return np.concatenate([-outside[::-1], inside, outside])


def track_lines(
    track: TrackProperties,
    seats: Vector,
    ends: tuple[float, float],
    joints: Vector,
    density: MeshDensity,
) -> TrackLines:
    """Planes of the track's nodes.

    Args:
        track: The track.
        seats: Positions of the sleepers, shape (n_seat,). [m]
        ends: Start and end of the ballast. [m]
        joints: Positions of joints under the ballast, shape (n_joint,). [m]
        density: Numbers of elements.

    Returns:
        The planes along and across.
    """
    half = 0.5 * track.sleeper_width
    gaps = np.column_stack([seats[:-1] + half, seats[1:] - half])
    sizes = np.ones(density.crib)
    sizes[[0, -1]] = density.edge_ratio
    inner = (np.cumsum(sizes) / np.sum(sizes))[:-1]
    cribs = gaps[:, :1] + (gaps[:, 1:] - gaps[:, :1]) * inner
    cribs = cribs[_distance(joints, cribs.ravel()).reshape(cribs.shape) > _JOINT_STRIP]
    at_ends = max(1, density.crib // 2)
    regular = np.concatenate(
        [
            (seats[:, None] + np.linspace(-half, half, density.sleeper + 1)).ravel(),
            cribs,
            np.linspace(ends[0], seats[0] - half, at_ends + 1)[:-1],
            np.linspace(seats[-1] + half, ends[1], at_ends + 1)[1:],
        ]
    )
    along = merged(joints, np.sort(regular), keep_regular=True)
    to_joint = _distance(joints, along)
    layered = to_joint < _LAYERED_ZONE
    bounds = np.concatenate([[True], layered, [True]])
    distance = along - seats[_nearest(seats, along)]
    across = across_lines(track, density)
    return TrackLines(
        along=along,
        sleeper=np.where(np.abs(distance) < half + 1e-6, _nearest(seats, along), -1),
        joint=to_joint < _CLOSE,
        layered=layered,
        hanging=layered & ~(bounds[:-2] & bounds[2:]),
        across=across,
        sleeper_across=np.flatnonzero(np.abs(across) < 0.5 * track.sleeper_length + 1e-6),
    )


def deck_lines(viaduct: ViaductProperties, span: int, density: MeshDensity) -> Vector:
    """Planes of a span's nodes: its ends, middle and bearings, and even ones between.

    They need not be the track's: the ballast's underside follows the slab's own interpolation.

    Args:
        viaduct: The viaduct.
        span: Number of the span.
        density: Numbers of elements.

    Returns:
        Positions along the track, shape (n_plane,). [m]
    """
    start, end = viaduct.joints[span], viaduct.joints[span + 1]
    inset = viaduct.bearing_inset
    # A plane close behind the bearings: the shear changes sign there.
    from_start = start + inset * np.array([0.0, 1.0, 1.5])
    from_end = end - inset * np.array([0.0, 1.0, 1.5])
    breaks = np.unique([*from_start, 0.5 * (start + end), *from_end])
    counts = np.ceil(np.diff(breaks) / density.deck_length - 1e-9).astype(int)
    return subdivided(breaks, counts.tolist())


def subdivided(breaks: Sequence[float] | Vector, counts: Sequence[int]) -> Vector:
    """Evenly divides each interval between breaks into its number of parts."""
    parts = [
        np.linspace(breaks[i], breaks[i + 1], count + 1)[:-1] for i, count in enumerate(counts)
    ]
    return np.concatenate([*parts, [breaks[-1]]])


def merged(fixed: Vector, regular: Vector, *, keep_regular: bool) -> Vector:
    """Union of two sets of lines, in which lines that nearly coincide become one.

    Args:
        fixed: Lines that must be there, shape (n,). [m]
        regular: Sorted lines of the regular pattern, shape (m,). [m]
        keep_regular: Of two that nearly coincide, keep the regular one; otherwise the fixed one.

    Returns:
        Sorted lines. [m]
    """
    if not len(fixed):
        return regular
    kept, added = (regular, fixed) if keep_regular else (fixed, regular)
    clear = np.abs(added - kept[_nearest(kept, added)]) > _CLOSE
    return np.sort(np.concatenate([kept, added[clear]]))


def _distance(joints: Vector, points: Vector) -> Vector:
    """Distance of each point from the nearest joint; infinite without joints."""
    if not len(joints):
        return np.full(len(points), np.inf)
    return np.abs(points - joints[_nearest(joints, points)])


def _nearest(sorted_values: Vector, points: Vector) -> IntVector:
    """Number of the nearest of the sorted values to each point."""
    if len(sorted_values) == 1:
        return np.zeros(len(points), dtype=np.int64)
    middles = 0.5 * (sorted_values[1:] + sorted_values[:-1])
    return np.searchsorted(middles, points)
