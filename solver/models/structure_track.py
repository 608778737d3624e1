"""Mesh of the track: one block of ballast and the sleepers that stand on it, in solids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import FloatArray, IntArray, IntVector, Matrix, Vector
from solver.models.ballasted_track import TrackProperties
from solver.models.mesh_level import MeshDensity
from solver.models.mesh_lines import TrackLines

__all__ = ["TrackMesh", "track_mesh"]


@dataclass(frozen=True, kw_only=True)
class TrackMesh:
    """Nodes and solids of ballast and sleepers, numbered within the whole structure.

    Attributes:
        coordinates: Shape (n_node, 3). [m]
        ballast: Shape (n_ballast, 8).
        sleepers: Shape (n_sleeper_element, 8).
        base: Nodes of the ballast's underside, shape (n_line, n_across).
        ends: Nodes of the ballast's two end planes above the underside.
        hanging: Nodes between the layers of coarser neighbours, shape (n_hanging,).
        neighbours: The nodes below and above each of them, shape (n_hanging, 2).
        share: Share of the upper neighbour, shape (n_hanging,).
        seats: Two nodes of a sleeper's top before and behind each rail seat (twice the same if one
            is there), shape (2, n_seat, 2): rail, seat, node.
        seat_share: Share of the second node, shape (n_seat,).
    """

    coordinates: Matrix
    ballast: IntArray
    sleepers: IntArray
    base: IntArray
    ends: tuple[IntVector, IntVector]
    hanging: IntVector
    neighbours: IntArray
    share: Vector
    seats: IntArray
    seat_share: Vector


def track_mesh(
    track: TrackProperties,
    lines: TrackLines,
    seats: Vector,
    base_level: float,
    density: MeshDensity,
    first_node: int,
) -> TrackMesh:
    """Makes the track's mesh.

    Args:
        track: The track.
        lines: Planes of nodes.
        seats: Positions of the sleepers, shape (n_seat,). [m]
        base_level: Height of the ballast's underside. [m]
        density: Numbers of elements.
        first_node: Number of the track's first node in the whole structure.

    Returns:
        The mesh.
    """
    levels = base_level + np.linspace(0.0, track.ballast_depth, density.joint_layers + 1)
    step = density.joint_layers // density.ballast_layers
    grid = np.stack(np.meshgrid(lines.along, lines.across, levels, indexing="ij"), axis=-1)
    regular = np.arange(len(levels)) % step == 0
    exists = np.broadcast_to(lines.layered[:, None, None] | regular, grid.shape[:3])
    numbers = np.where(exists, first_node + np.cumsum(exists).reshape(exists.shape) - 1, -1)
    top, top_coordinates = _sleeper_nodes(track, lines, seats, levels[-1], numbers, density)
    in_sleeper = lines.sleeper[lines.sleeper >= 0]
    before = np.flatnonzero(np.diff(in_sleeper) == 0)
    covered = lines.across[lines.sleeper_across]
    rows = [int(np.argmin(np.abs(covered - side * track.rail_position))) for side in (1.0, -1.0)]
    planes, share = _seat_planes(lines, seats)
    hanging, neighbours, upper_share = _hanging(numbers[lines.hanging], step)
    first_end, last_end = (numbers[plane, :, 1:].ravel() for plane in (0, -1))
    return TrackMesh(
        coordinates=np.vstack([grid[exists], top_coordinates]),
        ballast=_ballast(lines, numbers, step),
        sleepers=_hexahedra(top[before], top[before + 1]),
        base=numbers[:, :, 0],
        ends=(first_end[first_end >= 0], last_end[last_end >= 0]),
        hanging=hanging,
        neighbours=neighbours,
        share=upper_share,
        seats=np.stack([top[planes, row, -1] for row in rows]),
        seat_share=share,
    )


def _ballast(lines: TrackLines, numbers: IntArray, step: int) -> IntArray:
    """Solids of the ballast: all layers beside a joint, every ``step``-th elsewhere."""
    near, far = numbers[:-1], numbers[1:]
    layered = lines.layered[:-1] & lines.layered[1:]
    return np.vstack(
        [
            _hexahedra(near[~layered][:, :, ::step], far[~layered][:, :, ::step]),
            _hexahedra(near[layered], far[layered]),
        ]
    )


def _hanging(planes: IntArray, step: int) -> tuple[IntVector, IntArray, Vector]:
    """Nodes of these planes that the coarser neighbour lacks, with the two they lie between.

    Args:
        planes: Shape (n_plane, n_across, n_level).
        step: Levels for one of the neighbour.

    Returns:
        Nodes, neighbours below and above, share of the one above.
    """
    level = np.flatnonzero(np.arange(planes.shape[2]) % step)
    below = level // step * step
    pairs = np.stack([planes[:, :, below], planes[:, :, below + step]], axis=-1)
    share = np.broadcast_to((level - below) / step, pairs.shape[:-1])
    return planes[:, :, level].ravel(), pairs.reshape(-1, 2), share.ravel()


def _hexahedra(near: IntArray, far: IntArray) -> IntArray:
    """Solids between planes of nodes, each of shape (n_plane, n_across, n_level)."""
    corners = [
        near[:, :-1, :-1],
        far[:, :-1, :-1],
        far[:, 1:, :-1],
        near[:, 1:, :-1],
        near[:, :-1, 1:],
        far[:, :-1, 1:],
        far[:, 1:, 1:],
        near[:, 1:, 1:],
    ]
    return np.stack(corners, axis=-1).reshape(-1, 8)


def _sleeper_nodes(
    track: TrackProperties,
    lines: TrackLines,
    seats: Vector,
    ballast_top: float,
    ballast_numbers: IntArray,
    density: MeshDensity,
) -> tuple[IntArray, Matrix]:
    """Nodes of the sleepers: numbers (plane, across, level) and coordinates of the new ones.

    The lowest level is the ballast's top; sleepers taper upwards in width and in length.
    """
    planes = np.flatnonzero(lines.sleeper >= 0)
    y = lines.across[lines.sleeper_across]
    height = np.linspace(0.0, 1.0, density.sleeper_layers + 1)[1:]
    centre = seats[lines.sleeper[planes]]
    width = 1.0 + height * (track.sleeper_top_width / track.sleeper_width - 1.0)
    end = 0.5 * (track.sleeper_length + height * (track.sleeper_top_length - track.sleeper_length))
    shape = (len(planes), len(y), len(height))
    coordinates: FloatArray = np.empty((*shape, 3))
    coordinates[..., 0] = (centre[:, None] + (lines.along[planes] - centre)[:, None] * width)[
        :, None, :
    ]
    coordinates[..., 1] = np.clip(y[:, None], -end, end)
    coordinates[..., 2] = ballast_top + track.sleeper_height * height
    first_new = int(ballast_numbers.max()) + 1
    new = first_new + np.arange(np.prod(shape)).reshape(shape)
    shared = ballast_numbers[planes][:, lines.sleeper_across, -1]
    return np.concatenate([shared[:, :, None], new], axis=2), coordinates.reshape(-1, 3)


def _seat_planes(lines: TrackLines, seats: Vector) -> tuple[IntArray, Vector]:
    """Sleeper planes before and behind each seat, and the share of the second."""
    along = lines.along[lines.sleeper >= 0]
    behind = np.searchsorted(along, seats - 1e-9)
    exact = np.abs(along[behind] - seats) < 1e-6
    before = np.where(exact, behind, behind - 1)
    gap = np.where(exact, 1.0, along[behind] - along[before])
    share = np.where(exact, 0.0, (seats - along[before]) / gap)
    return np.column_stack([before, behind]), share
