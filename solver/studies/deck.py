"""The deck that a run records and draws: the slab of a viaduct with its rails, or plain beams."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from solver.arrays import IntArray, IntVector, Matrix, SparseMatrix, Vector
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.beam_line import BeamLine
from solver.models.viaduct import ViaductProperties
from solver.results import Layer, SlabPoints
from solver.simulation import LINES, STRUCTURE
from solver.standards.deck_acceleration import under_ballast
from solver.studies.scene import Scene
from solver.studies.study import Study

__all__ = ["Deck", "beam_deck", "deck_of", "rail_strips", "selection"]

_RAIL_HEIGHT = 0.172
_RAIL_HALF_WIDTH = 0.036


@dataclass(frozen=True, kw_only=True)
class Deck:
    """The deck of either kind of viaduct, with the rows that read its motions.

    Attributes:
        slab: The points whose accelerations are recorded.
        slab_rows: Their vertical displacement, from the freedoms of ``part``.
        vertices: Of the drawn surface, shape (n_vertex, 3): the structure's, then the rails'. [m]
        layers: Surfaces over the vertices.
        surface: Displacement of the structure's vertices, from the freedoms of ``part``.
        rail_rows: Vertical displacement of the rails' vertices, from the lines' freedoms flattened.
        contact_height: z of the undeformed contact points. [m]
        spans: x of the beginning and end of each span, shape (n_span, 2). [m]
        bearings: Tension in the bearings, from the freedoms of ``part``. [N/m]
        bearing_places: Shape (n_bearing, 3). [m]
        part: Index of the motions that the deck's rows read: the structure's, or the lines'.
    """

    slab: SlabPoints
    slab_rows: SparseMatrix
    vertices: Matrix
    layers: tuple[Layer, ...]
    surface: SparseMatrix
    rail_rows: SparseMatrix
    contact_height: float
    spans: Matrix
    bearings: SparseMatrix
    bearing_places: Matrix
    part: int


def deck_of(study: Study, scene: Scene) -> Deck:
    """The deck of a study whose parts go together."""
    bridge = study.viaduct
    if isinstance(bridge, BeamBridge):
        return beam_deck(bridge, scene.system.line)
    assert isinstance(study.track, TrackProperties)
    return _slab_deck(bridge, study.track, scene)


# -- the U-girder deck ---------------------------------------------------------------------------


def _slab_deck(viaduct: ViaductProperties, track: TrackProperties, scene: Scene) -> Deck:
    """Slab nodes under the ballast, the outer faces of all parts, the rails on top."""
    structure = scene.structure
    assert structure is not None
    slab_coordinates = structure.node_coordinates[structure.slab_nodes]
    below = under_ballast(slab_coordinates, 0.5 * track.ballast_width)
    nodes, span = structure.slab_nodes[below], structure.span_of_slab_node[below]
    coordinates = structure.node_coordinates[nodes]
    spans = np.column_stack([structure.joints[:-1], structure.joints[1:]])
    slab = SlabPoints(
        coordinates=coordinates,
        span=span,
        judged_spans=_judged(len(spans)),
        named=_named_points(coordinates, span, spans, track.rail_position),
    )
    vertices, layers = _compact(structure.surfaces)
    height = viaduct.slab_top + track.ballast_depth + track.sleeper_height + _RAIL_HEIGHT
    rail_vertices, rail_faces, rail_rows = _rails(track.rail_position, height, scene)
    faces = Layer(name="rails", faces=rail_faces + vertices.size)
    operator = structure.displacement_operator
    return Deck(
        slab=slab,
        slab_rows=sparse.csr_array(operator[3 * nodes + 2]),
        vertices=np.concatenate([structure.node_coordinates[vertices], rail_vertices]),
        layers=(*layers, faces),
        surface=sparse.csr_array(operator[(3 * vertices[:, None] + np.arange(3)).ravel()]),
        rail_rows=rail_rows,
        contact_height=height,
        spans=spans,
        bearings=sparse.csr_array(
            sparse.diags_array(structure.bearing_stiffness) @ structure.bearing_operator
        ),
        bearing_places=structure.bearing_positions,
        part=STRUCTURE,
    )


def _judged(n_span: int) -> tuple[int, ...]:
    """Spans whose neighbours are modelled; a lone span is judged as it stands."""
    return tuple(range(1, n_span - 1)) if n_span > 2 else tuple(range(n_span))


def _named_points(
    coordinates: Matrix, span: IntVector, spans: Matrix, rail: float
) -> dict[str, int]:
    """Mid-span points on the axis and under the rails, at the nodes nearest to them."""
    named: dict[str, int] = {}
    for index, (left, right) in enumerate(spans):
        own = np.flatnonzero(span == index)
        for name, y in (("axis", 0.0), ("left rail", rail), ("right rail", -rail)):
            target = np.array([0.5 * (left + right), y])
            distance = np.linalg.norm(coordinates[own, :2] - target, axis=1)
            named[f"mid-span {index + 1}, {name}"] = int(own[np.argmin(distance)])
    return named


def _compact(surfaces: dict[str, IntArray]) -> tuple[IntVector, tuple[Layer, ...]]:
    """Vertices that the surfaces use, and the layers over them."""
    used = np.unique(np.concatenate([faces.ravel() for faces in surfaces.values()]))
    return used, tuple(
        Layer(name=name, faces=np.searchsorted(used, faces)) for name, faces in surfaces.items()
    )


def _rails(lateral: float, height: float, scene: Scene) -> tuple[Matrix, IntArray, SparseMatrix]:
    """Top faces of both rails over the structure: vertices, faces, rows on the flattened lines."""
    line, seats = scene.system.line, scene.system.seat_nodes
    nodes = np.arange(seats[0], seats[-1] + 1)
    vertices, faces = rail_strips(line.positions[nodes], lateral, height)
    # Each rail has two edges, and both follow its own line.
    columns = [2 * nodes * line.n_line + number for number in (0, 0, 1, 1)]
    return vertices, faces, selection(np.concatenate(columns), line.n_dof * line.n_line)


def rail_strips(x: Vector, lateral: float, height: float) -> tuple[Matrix, IntArray]:
    """Top faces of both rails.

    Args:
        x: Of the rails' nodes, shape (n_node,). [m]
        lateral: Distance of each rail from the axis. [m]
        height: Of the top of rail. [m]

    Returns:
        Vertices, edge by edge of the left rail, then of the right one, shape (4 n_node, 3), and
        faces, shape (2 n_node - 2, 4).
    """
    vertices, faces = [], []
    for number, side in enumerate((lateral, -lateral)):
        for edge in (-_RAIL_HALF_WIDTH, _RAIL_HALF_WIDTH):
            place = (np.full_like(x, side + edge), np.full_like(x, height))
            vertices.append(np.column_stack([x, *place]))
        start = 2 * number * x.size + np.arange(x.size - 1)
        other = start + x.size
        faces.append(np.column_stack([start, start + 1, other + 1, other]))
    return np.concatenate(vertices), np.concatenate(faces)


def selection(columns: IntVector, n_column: int) -> SparseMatrix:
    """Rows that each pick one of so many freedoms."""
    rows = np.arange(columns.size)
    return sparse.coo_array(
        (np.ones(columns.size), (rows, columns)), shape=(columns.size, n_column)
    ).tocsr()


# -- plain beams ---------------------------------------------------------------------------------


def beam_deck(bridge: BeamBridge, line: BeamLine) -> Deck:
    """Nodes of plain beams; drawn as a strip of the beam's width."""
    nodes = np.arange(2, line.n_node - 2)
    x = line.positions[nodes]
    per_span = bridge.elements_per_span + 1
    span = np.repeat(np.arange(len(bridge.spans)), per_span)
    spans = np.column_stack([bridge.joints[:-1], bridge.joints[1:]])
    coordinates = np.column_stack([x, np.zeros_like(x), np.zeros_like(x)])
    named = {
        f"mid-span {k + 1}": int(
            np.argmin(np.where(span == k, np.abs(x - spans[k].mean()), np.inf))
        )
        for k in range(len(bridge.spans))
    }
    columns = 2 * nodes
    heights = selection(columns, line.n_dof)
    vertices, faces, operator = _strip(bridge, x, span, columns, line.n_dof)
    return Deck(
        slab=SlabPoints(coordinates=coordinates, span=span, judged_spans=(), named=named),
        slab_rows=heights,
        vertices=vertices,
        layers=(Layer(name="deck", faces=faces),),
        surface=operator,
        rail_rows=selection(np.zeros(0, dtype=np.int64), line.n_dof),
        contact_height=0.0,
        spans=spans,
        bearings=selection(np.zeros(0, dtype=np.int64), line.n_dof),
        bearing_places=np.zeros((0, 3)),
        part=LINES,
    )


def _strip(
    bridge: BeamBridge, x: Vector, span: IntVector, columns: IntVector, n_dof: int
) -> tuple[Matrix, IntArray, SparseMatrix]:
    """The beams as flat strips: vertices, faces, and rows of their three displacements."""
    n = x.size
    left = np.column_stack([x, np.full(n, 0.5 * bridge.width), np.zeros(n)])
    right = left * (1.0, -1.0, 1.0)
    first = np.flatnonzero(span[:-1] == span[1:])
    faces = np.column_stack([first, first + 1, first + 1 + n, first + n])
    rows = 3 * np.arange(2 * n) + 2
    operator = sparse.coo_array(
        (np.ones(2 * n), (rows, np.tile(columns, 2))), shape=(6 * n, n_dof)
    ).tocsr()
    return np.concatenate([left, right]), faces, operator
