"""Supports and rigid connections of deck and track, as constraints to eliminate.

- The ballast's underside follows the upper slab's mid-plane through a rigid offset of half the
  slab's thickness; on the embankment it is held. In the plane of a joint it is free.
- The track's first end plane is held along the track, as in the half model of section 6.3.6; the
  last one, over the end of the last span, is free.
- A bearing stands under the bottom plate: y held, x held at the near end of a span.
- Where a rail seat lies between two planes of nodes, their displacements w1, w2 are expressed by
  the seat's own displacement and a difference, so that every rail seat is one unknown.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import IntArray, IntVector, Matrix
from solver.assembly.constraints import Combination
from solver.assembly.freedoms import Freedoms
from solver.assembly.scatter import ElementMatrices
from solver.models.structure_deck import DeckMesh, points_on_plate
from solver.models.structure_track import TrackMesh
from solver.models.viaduct import ViaductProperties

__all__ = [
    "Bearings",
    "bearing_nodes",
    "bearing_springs",
    "bearing_ties",
    "deck_ties",
    "hanging_ties",
    "interpolated_seats",
    "seat_ties",
]


@dataclass(frozen=True, kw_only=True)
class Bearings:
    """Bearings at nodes of the bottom plate.

    Attributes:
        nodes: Shape (n_bearing,).
        span: Shape (n_bearing,).
        fixed: Whether a bearing holds the deck along the track, shape (n_bearing,).
    """

    nodes: IntVector
    span: IntVector
    fixed: IntVector


def bearing_nodes(viaduct: ViaductProperties, deck: DeckMesh) -> Bearings:
    """Finds the node of each bearing: two at each end of each span, the fixed ones first."""
    bottom_y = deck.section.nodes[deck.section.bottom, 0]
    nodes, span, fixed = [], [], []
    for number, planes in enumerate(deck.planes):
        ends = (planes[0] + viaduct.bearing_inset, planes[-1] - viaduct.bearing_inset)
        for is_fixed, position in zip((1, 0), ends, strict=True):
            plane = int(np.argmin(np.abs(planes - position)))
            for side in (1.0, -1.0):
                place = int(np.argmin(np.abs(bottom_y - side * viaduct.bearing_position)))
                nodes.append(int(deck.node(number, plane, deck.section.bottom[place])))
                span.append(number)
                fixed.append(is_fixed)
    return Bearings(nodes=np.array(nodes), span=np.array(span), fixed=np.array(fixed))


def bearing_ties(
    viaduct: ViaductProperties, bearings: Bearings, freedoms: Freedoms
) -> list[Combination]:
    """Holds the plate's underside at the bearings: v = z rx and, where fixed, u = -z ry."""
    drop = -0.5 * viaduct.bottom_thickness
    index = freedoms.index[bearings.nodes]
    fixed = bearings.fixed == 1
    return [
        _follows(index[:, 1], index[:, 3], drop),
        _follows(index[fixed, 0], index[fixed, 4], -drop),
    ]


def bearing_springs(
    viaduct: ViaductProperties, bearings: Bearings, freedoms: Freedoms
) -> tuple[ElementMatrices, ElementMatrices]:
    """Springs of the bearings: upwards, and along the track at the underside of guided ones."""
    vertical = freedoms.index[bearings.nodes, 2:3]
    guided = freedoms.index[bearings.nodes[bearings.fixed == 0]][:, [0, 4]]
    row = np.array([1.0, -0.5 * viaduct.bottom_thickness])
    return (
        ElementMatrices(
            freedoms=vertical, matrices=np.full((len(vertical), 1, 1), viaduct.bearing_stiffness)
        ),
        ElementMatrices(
            freedoms=guided,
            matrices=np.tile(viaduct.guided_stiffness * np.outer(row, row), (len(guided), 1, 1)),
        ),
    )


def _follows(dependent: IntVector, master: IntVector, weight: float) -> Combination:
    return Combination(
        dependent=dependent,
        masters=master[:, None],
        weights=np.full((len(master), 1), weight),
    )


def deck_ties(
    deck: DeckMesh,
    base: IntArray,
    coordinates: Matrix,
    spans: IntVector,
    offset: float,
    freedoms: Freedoms,
) -> list[Combination]:
    """Ties the ballast's underside to the slabs it lies on.

    Args:
        deck: The deck's mesh, its nodes the first of the structure.
        base: Nodes of the underside, shape (n_line, n_across).
        coordinates: Nodes of the whole structure, shape (n_node, 3). [m]
        spans: Span under each plane of the track, -1 for none, shape (n_line,).
        offset: Half the slab's thickness. [m]
        freedoms: Numbering of the whole structure.

    Returns:
        One combination for each span and axis.
    """
    ties: list[Combination] = []
    for span in range(len(deck.planes)):
        nodes = base[spans == span].ravel()
        points = points_on_plate(deck, span, deck.section.slab, coordinates[nodes, :2], offset)
        masters = freedoms.index[points.nodes].reshape(len(nodes), -1)
        ties.extend(
            Combination(
                dependent=freedoms.index[nodes, axis],
                masters=masters,
                weights=points.rows[:, axis].reshape(masters.shape),
            )
            for axis in range(3)
        )
    return ties


def hanging_ties(track: TrackMesh, freedoms: Freedoms) -> list[Combination]:
    """Keeps nodes between the layers of a coarser neighbour on its edges."""
    weights = np.column_stack([1.0 - track.share, track.share])
    return [
        Combination(
            dependent=freedoms.index[track.hanging, axis],
            masters=freedoms.index[track.neighbours, axis],
            weights=weights,
        )
        for axis in range(3)
    ]


def interpolated_seats(track: TrackMesh) -> IntVector:
    """Seats that lie between two planes of nodes."""
    return np.flatnonzero(track.seat_share > 0.0)


def seat_ties(track: TrackMesh, freedoms: Freedoms) -> tuple[list[Combination], IntArray]:
    """Gives every rail seat one freedom.

    With the share s of the second node, w1 = seat - s d and w2 = seat + (1 - s) d, where d is their
    difference: an exact change of unknowns.

    Returns:
        The combinations, and the full freedom of each seat, shape (2, n_seat).
    """
    vertical = freedoms.index[track.seats, 2]
    seat_freedoms = vertical[:, :, 0].copy()
    between = interpolated_seats(track)
    if not len(between):
        return [], seat_freedoms
    own = freedoms.generalised.reshape(2, 2, len(between))
    seat_freedoms[:, between] = own[:, 0]
    share = np.tile(track.seat_share[between], 2)
    masters = np.column_stack([own[:, 0].ravel(), own[:, 1].ravel()])
    ones = np.ones(len(share))
    return [
        Combination(
            dependent=vertical[:, between, side].ravel(),
            masters=masters,
            weights=np.column_stack([ones, factor]),
        )
        for side, factor in ((0, -share), (1, 1.0 - share))
    ], seat_freedoms
