"""Mesh of the deck: the cross-section drawn out along each span, spans apart from each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import FloatArray, IntArray, IntVector, Matrix, Vector
from solver.elements.rigid_link import offset_rows
from solver.models.section import DeckSection

__all__ = ["DeckMesh", "SurfacePoints", "deck_mesh", "points_on_plate"]


@dataclass(frozen=True, kw_only=True)
class DeckMesh:
    """Nodes and shells of all spans.

    Attributes:
        coordinates: Shape (n_node, 3). [m]
        shells: Shape (n_element, 4).
        segment: Segment of the section of each shell, shape (n_element,).
        edges: Sides of shells along the slab's two edges, shape (n_edge, 2).
        planes: Positions of the planes of nodes of each span. [m]
        first_node: First node of each span, shape (n_span,).
        span: Span of each node, shape (n_node,).
        section: The cross-section.
    """

    coordinates: Matrix
    shells: IntArray
    segment: IntVector
    edges: IntArray
    planes: tuple[Vector, ...]
    first_node: IntVector
    span: IntVector
    section: DeckSection

    def node(self, span: int, plane: IntVector | int, section_node: IntVector | int) -> IntVector:
        """Nodes by span, plane along and node of the section (broadcast)."""
        return self.first_node[span] + np.asarray(plane) * len(self.section.nodes) + section_node

    @property
    def slab_nodes(self) -> IntVector:
        """Nodes of the upper slab."""
        local = np.arange(len(self.coordinates)) % len(self.section.nodes)
        return np.flatnonzero(np.isin(local, self.section.slab))


@dataclass(frozen=True, kw_only=True)
class SurfacePoints:
    """Points rigidly offset from a plate, in terms of the plate's nodes.

    Attributes:
        nodes: Four nodes around each point, shape (n_point, 4).
        rows: Weights of each axis on the nodes' freedoms, shape (n_point, 3, 4, 6).
    """

    nodes: IntArray
    rows: FloatArray


def deck_mesh(section: DeckSection, planes: tuple[Vector, ...]) -> DeckMesh:
    """Draws the section out along the spans.

    Args:
        section: The cross-section.
        planes: Positions of the planes of nodes of each span. [m]

    Returns:
        The mesh; a joint's two planes have separate nodes.
    """
    per_plane = len(section.nodes)
    counts = np.array([len(line) for line in planes])
    first = np.concatenate([[0], np.cumsum(counts * per_plane)])
    coordinates, shells, edges = [], [], []
    a, b = section.segments.T
    for number, line in enumerate(planes):
        grid = np.empty((len(line), per_plane, 3))
        grid[:, :, 0] = line[:, None]
        grid[:, :, 1:] = section.nodes
        coordinates.append(grid.reshape(-1, 3))
        plane = first[number] + np.arange(len(line) - 1)[:, None] * per_plane
        far = plane + per_plane
        shells.append(np.stack([plane + a, far + a, far + b, plane + b], axis=2).reshape(-1, 4))
        for edge in (section.slab[0], section.slab[-1]):
            edges.append(np.column_stack([plane[:, 0] + edge, far[:, 0] + edge]))
    return DeckMesh(
        coordinates=np.vstack(coordinates),
        shells=np.vstack(shells),
        segment=np.tile(np.arange(len(a)), int(np.sum(counts - 1))),
        edges=np.vstack(edges),
        planes=planes,
        first_node=first[:-1],
        span=np.repeat(np.arange(len(planes)), counts * per_plane),
        section=section,
    )


def points_on_plate(
    deck: DeckMesh, span: int, plate: IntVector, points: Matrix, offset: float
) -> SurfacePoints:
    """Ties points to a horizontal plate of a span.

    The plate's own interpolation (bilinear displacements and rotations) carries the points; where a
    node lies under the point, it alone does.

    Args:
        deck: The deck's mesh.
        span: Number of the span.
        plate: Nodes of the plate in the section, y ascending.
        points: Positions (x, y), shape (n_point, 2). [m]
        offset: Height of the points above the plate's mid-plane. [m]

    Returns:
        The points' ties.
    """
    along, share_along = _cell(deck.planes[span], points[:, 0])
    across, share_across = _cell(deck.section.nodes[plate, 0], points[:, 1])
    nodes, weights = [], []
    for step_along in (0, 1):
        for step_across in (0, 1):
            nodes.append(deck.node(span, along + step_along, plate[across + step_across]))
            weight = share_along if step_along else 1.0 - share_along
            weights.append(weight * (share_across if step_across else 1.0 - share_across))
    rigid = offset_rows(np.tile([0.0, 0.0, offset], (len(points), 1)))
    rows = rigid[:, :, None, :] * np.column_stack(weights)[:, None, :, None]
    return SurfacePoints(nodes=np.column_stack(nodes), rows=rows)


def _cell(lines: Vector, values: Vector) -> tuple[IntVector, Vector]:
    """Interval of each value and its share of the way through it; shares at nodes are exact."""
    cell = np.clip(np.searchsorted(lines, values) - 1, 0, len(lines) - 2)
    share = (values - lines[cell]) / (lines[cell + 1] - lines[cell])
    share = np.where(np.abs(share) < 1e-9, 0.0, np.where(np.abs(share - 1.0) < 1e-9, 1.0, share))
    return cell, share
