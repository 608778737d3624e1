"""Builds the structure: the viaduct with its three-dimensional track, or a track alone.

The rails and their pads are not part of it: the coupling adds the pads as springs between the rails
and the seats that the model names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from solver.arrays import IntArray, IntVector, SparseMatrix, Vector
from solver.assembly.constraints import Combination, eliminate
from solver.assembly.faces import outer_faces
from solver.assembly.freedoms import Freedoms, number_freedoms
from solver.models.ballasted_track import TrackProperties, pad_stiffness, seat_positions
from solver.models.mesh_level import MeshLevel, mesh_density
from solver.models.section import PARTS, deck_section
from solver.models.structure_deck import DeckMesh, deck_mesh
from solver.models.structure_lines import (
    base_spans,
    estimate_unknowns,
    structure_lines,
    track_alone_lines,
)
from solver.models.structure_model import StructureModel
from solver.models.structure_parts import Part, deck_parts, summed, track_parts
from solver.models.structure_ties import (
    bearing_nodes,
    bearing_springs,
    bearing_ties,
    deck_ties,
    hanging_ties,
    interpolated_seats,
    seat_ties,
)
from solver.models.structure_track import TrackMesh, track_mesh
from solver.models.viaduct import ViaductProperties

__all__ = ["StructureModel", "build_structure", "build_track", "estimate_unknowns"]

_GRAVITY = 9.81


@dataclass(frozen=True, kw_only=True)
class _Reduced:
    """Matrices after elimination, and what is known of their unknowns."""

    mass: SparseMatrix
    stiffness: SparseMatrix
    damping: SparseMatrix
    weight: Vector
    seat_dofs: IntArray
    displacement_operator: SparseMatrix
    transformation: SparseMatrix


def build_structure(
    viaduct: ViaductProperties, track: TrackProperties, mesh_level: MeshLevel
) -> StructureModel:
    """Builds the viaduct with its three-dimensional track, embankment included.

    Args:
        viaduct: The viaduct.
        track: The track.
        mesh_level: How fine.

    Returns:
        The structure.

    Raises:
        InputError: Viaduct and track do not fit together.
    """
    density = mesh_density(mesh_level)
    lines, planes = structure_lines(viaduct, track, density)
    seats = seat_positions(track, viaduct.length)
    deck = deck_mesh(deck_section(viaduct, track, density), planes)
    solids = track_mesh(track, lines, seats, viaduct.slab_top, density, len(deck.coordinates))
    coordinates = np.vstack([deck.coordinates, solids.coordinates])
    freedoms = _numbered(len(deck.coordinates), solids)
    bearings = bearing_nodes(viaduct, deck)
    vertical, guided = bearing_springs(viaduct, bearings, freedoms)
    parts = [
        *deck_parts(viaduct, deck, freedoms),
        *track_parts(track, coordinates, solids, freedoms, viaduct),
        Part(stiffness=vertical),
        Part(stiffness=guided),
    ]
    spans = base_spans(viaduct, lines)
    ties = [
        *bearing_ties(viaduct, bearings, freedoms),
        *deck_ties(deck, solids.base, coordinates, spans, 0.5 * viaduct.slab_thickness, freedoms),
    ]
    on_ground = lines.along < 0.0
    held = [
        freedoms.index[solids.base[on_ground & ~lines.joint], :3].ravel(),
        freedoms.index[solids.ends[0], 0],
    ]
    reduced = _reduced(parts, held, ties, solids, freedoms)
    return StructureModel(
        mass=reduced.mass,
        stiffness=reduced.stiffness,
        damping=reduced.damping,
        mass_proportional=viaduct.mass_damping,
        stiffness_proportional=viaduct.stiffness_damping,
        weight=reduced.weight,
        seat_dofs=reduced.seat_dofs,
        seat_positions=seats,
        pad_stiffness=pad_stiffness(track, viaduct.length, seats),
        pad_damping=np.full(len(seats), track.pad_damping),
        node_coordinates=coordinates,
        displacement_operator=reduced.displacement_operator,
        surfaces={**_deck_surfaces(deck), **_track_surfaces(solids)},
        slab_nodes=deck.slab_nodes,
        span_of_slab_node=deck.span[deck.slab_nodes],
        bearing_positions=coordinates[bearings.nodes] * (1.0, 1.0, 0.0),
        bearing_span=bearings.span,
        bearing_stiffness=np.full(len(bearings.nodes), viaduct.bearing_stiffness),
        bearing_operator=reduced.transformation[freedoms.index[bearings.nodes, 2]],
        joints=viaduct.joints,
        part_names=(*PARTS, "ballast", "sleepers"),
    )


def build_track(track: TrackProperties, n_sleeper: int, mesh_level: MeshLevel) -> StructureModel:
    """Builds a track on a fixed base, its sleepers at 0, s, 2 s, ...; both end planes hold u.

    So held, the ends are planes of symmetry: under a load that repeats bay by bay the track is an
    infinite one.

    Args:
        track: The track; its transition and embankment are not used.
        n_sleeper: Number of sleepers, at least 2.
        mesh_level: How fine.

    Returns:
        The structure; its pads are all regular ones.

    Raises:
        InputError: Too few sleepers.
    """
    density = mesh_density(mesh_level)
    seats, lines = track_alone_lines(track, n_sleeper, density)
    solids = track_mesh(track, lines, seats, 0.0, density, 0)
    freedoms = _numbered(0, solids)
    parts = track_parts(track, solids.coordinates, solids, freedoms, None)
    held = [freedoms.index[solids.base, :3].ravel(), freedoms.index[np.concatenate(solids.ends), 0]]
    reduced = _reduced(parts, held, [], solids, freedoms)
    none = np.zeros(0, dtype=np.int64)
    return StructureModel(
        mass=reduced.mass,
        stiffness=reduced.stiffness,
        damping=reduced.damping,
        mass_proportional=track.mass_damping,
        stiffness_proportional=track.stiffness_damping,
        weight=reduced.weight,
        seat_dofs=reduced.seat_dofs,
        seat_positions=seats,
        pad_stiffness=np.full(len(seats), track.pad_stiffness),
        pad_damping=np.full(len(seats), track.pad_damping),
        node_coordinates=solids.coordinates,
        displacement_operator=reduced.displacement_operator,
        surfaces=_track_surfaces(solids),
        slab_nodes=none,
        span_of_slab_node=none,
        bearing_positions=np.zeros((0, 3)),
        bearing_span=none,
        bearing_stiffness=np.zeros(0),
        bearing_operator=csr_array((0, reduced.mass.shape[0])),
        joints=np.zeros(0),
        part_names=("ballast", "sleepers"),
    )


def _numbered(shell_nodes: int, solids: TrackMesh) -> Freedoms:
    """Six freedoms at the deck's nodes, three at the track's, two for each interpolated seat."""
    axes = np.concatenate([np.full(shell_nodes, 6), np.full(len(solids.coordinates), 3)])
    return number_freedoms(axes, generalised=4 * len(interpolated_seats(solids)))


def _reduced(
    parts: Sequence[Part],
    held: Sequence[IntVector],
    ties: Sequence[Combination],
    solids: TrackMesh,
    freedoms: Freedoms,
) -> _Reduced:
    """Sums the parts and eliminates supports and rigid connections."""
    seat_combinations, seat_freedoms = seat_ties(solids, freedoms)
    transformation = eliminate(
        freedoms.count,
        np.concatenate(held),
        [*ties, *hanging_ties(solids, freedoms), *seat_combinations],
    )
    full = summed(parts, freedoms.count)
    lifted = np.zeros(freedoms.count)
    lifted[freedoms.index[:, 2]] = 1.0
    return _Reduced(
        mass=transformation.reduce(full.mass),
        stiffness=transformation.reduce(full.stiffness),
        damping=transformation.reduce(full.damping),
        weight=-_GRAVITY * (transformation.matrix.T @ (full.mass @ lifted)),
        seat_dofs=transformation.position[seat_freedoms],
        displacement_operator=transformation.matrix[freedoms.index[:, :3].ravel()],
        transformation=transformation.matrix,
    )


def _deck_surfaces(deck: DeckMesh) -> dict[str, IntArray]:
    part = deck.section.part[deck.segment]
    return {name: deck.shells[part == number] for number, name in enumerate(PARTS)}


def _track_surfaces(solids: TrackMesh) -> dict[str, IntArray]:
    faces, owner = outer_faces(np.vstack([solids.ballast, solids.sleepers]))
    is_ballast = owner < len(solids.ballast)
    return {"ballast": faces[is_ballast], "sleepers": faces[~is_ballast]}
