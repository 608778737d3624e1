"""Mesh lines of a whole structure, and the number of unknowns that follows from them."""

from __future__ import annotations

import numpy as np

from solver.arrays import IntVector, Vector
from solver.errors import InputError
from solver.models.ballasted_track import TrackProperties, seat_positions, track_ends
from solver.models.mesh_level import MeshDensity, MeshLevel, mesh_density
from solver.models.mesh_lines import TrackLines, deck_lines, track_lines
from solver.models.section import section_node_count
from solver.models.viaduct import ViaductProperties

__all__ = ["base_spans", "estimate_unknowns", "structure_lines", "track_alone_lines"]


def structure_lines(
    viaduct: ViaductProperties, track: TrackProperties, density: MeshDensity
) -> tuple[TrackLines, tuple[Vector, ...]]:
    """Planes of nodes of the track, and of each span.

    Raises:
        InputError: The ballast is wider than the trough between the walls.
    """
    if 0.5 * track.ballast_width > viaduct.wall_position + 1e-9:
        raise InputError(
            "track.ballast_width",
            track.ballast_width,
            f"the walls leave {2.0 * viaduct.wall_position:.3g} m for the ballast",
            "Narrow the ballast or move the walls apart.",
        )
    seats = seat_positions(track, viaduct.length)
    ends = track_ends(track, viaduct.length)
    lines = track_lines(track, seats, ends, viaduct.joints[:-1], density)
    planes = tuple(deck_lines(viaduct, span, density) for span in range(len(viaduct.spans)))
    return lines, planes


def track_alone_lines(
    track: TrackProperties, n_sleeper: int, density: MeshDensity
) -> tuple[Vector, TrackLines]:
    """Seats and planes of nodes of a track without viaduct.

    Raises:
        InputError: Fewer than two sleepers.
    """
    if n_sleeper < 2:
        raise InputError("n_sleeper", n_sleeper, "must be at least 2", "Use more sleepers.")
    seats = track.sleeper_spacing * np.arange(n_sleeper)
    half_bay = 0.5 * track.sleeper_spacing
    ends = (-half_bay, float(seats[-1]) + half_bay)
    return seats, track_lines(track, seats, ends, np.zeros(0), density)


def base_spans(viaduct: ViaductProperties, lines: TrackLines) -> IntVector:
    """Span under each plane of the track, -1 on the embankment and in a joint's plane."""
    span = np.searchsorted(viaduct.joints, lines.along) - 1
    span = np.minimum(span, len(viaduct.spans) - 1)
    return np.where(lines.joint | (lines.along < 0.0), -1, span)


def estimate_unknowns(
    viaduct: ViaductProperties, track: TrackProperties, mesh_level: MeshLevel
) -> int:
    """Number of unknowns of ``build_structure``, exactly, from one-dimensional counts alone.

    Args:
        viaduct: The viaduct.
        track: The track.
        mesh_level: How fine.

    Returns:
        ``StructureModel.n_dof``.

    Raises:
        InputError: Viaduct and track do not fit together.
    """
    density = mesh_density(mesh_level)
    lines, planes = structure_lines(viaduct, track, density)
    shells = section_node_count(viaduct, track, density) * sum(len(line) for line in planes)
    held_by_bearings = 6 * len(viaduct.spans)
    across = len(lines.across)
    layers = density.ballast_layers
    extra_layers = int(np.count_nonzero(lines.layered & ~lines.hanging))
    planes_of_nodes = (
        len(lines.along) * layers
        + extra_layers * (density.joint_layers - layers)
        + int(np.count_nonzero(lines.joint))
    )
    ballast = 3 * across * planes_of_nodes
    sleeper_planes = int(np.count_nonzero(lines.sleeper >= 0))
    sleepers = 3 * sleeper_planes * len(lines.sleeper_across) * density.sleeper_layers
    end_plane = across * layers
    return 6 * shells - held_by_bearings + ballast + sleepers - end_plane
