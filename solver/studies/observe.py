"""What a run records: named points of the deck, slab points, wheels, cars, the drawn surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from solver.arrays import IntArray, IntVector, Matrix, SparseMatrix, Vector
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.beam_line import BeamLine
from solver.models.train import Body, TrainModel
from solver.models.viaduct import ViaductProperties
from solver.results import (
    BodyGeometry,
    ChannelSpec,
    Geometry,
    Layer,
    SlabPoints,
    WheelGeometry,
)
from solver.simulation import LINES, STRUCTURE, Observation
from solver.standards.deck_acceleration import under_ballast
from solver.studies.scene import Scene
from solver.studies.study import Study
from solver.units import Units

__all__ = ["Recording", "record"]

_RAIL_HEIGHT = 0.172
_RAIL_HALF_WIDTH = 0.036


@dataclass(frozen=True, kw_only=True)
class Recording:
    """Channels, slab points and drawing, with the rows that read them.

    Attributes:
        channels: In the order of ``Sample.channels``.
        slab: Points of ``Sample.slab``.
        geometry: What is drawn.
        observation: Rows that read the motions.
        live: Names of the channels that are drawn while the run goes on.
    """

    channels: tuple[ChannelSpec, ...]
    slab: SlabPoints
    geometry: Geometry
    observation: Observation
    live: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class _Deck:
    """The deck of either kind of viaduct."""

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


def record(study: Study, scene: Scene, acceleration_offset: float) -> Recording:
    """Decides what a run records.

    Args:
        study: The study.
        scene: Its models.
        acceleration_offset: Added to the time of acceleration channels, alpha dt. [s]

    Returns:
        The recording.
    """
    bridge = study.viaduct
    if isinstance(bridge, BeamBridge):
        deck = _beam_deck(bridge, scene.system.line)
    else:
        assert isinstance(study.track, TrackProperties)
        deck = _slab_deck(bridge, study.track, scene)
    train = scene.train
    named = list(deck.slab.named)
    rows = deck.slab_rows[list(deck.slab.named.values())]
    cars = [body for body in train.bodies if body.kind != "wheelset"]
    channels = (
        *_deck_channels(deck.slab, named, acceleration_offset),
        *_wheel_channels(train),
        *_car_channels([body.name for body in cars], acceleration_offset),
        *_bearing_channels(deck.bearing_places),
    )
    observation = Observation(
        deck=rows,
        slab=deck.slab_rows,
        surface=deck.surface,
        rails=deck.rail_rows,
        bearings=deck.bearings,
        cars=sparse.csr_array(np.array([body.rows[0] for body in cars])),
        bodies=sparse.csr_array(np.concatenate([body.rows for body in cars])),
        deck_part=deck.part,
    )
    first = train.wheel_names[0]
    decisive = _decisive(named)
    live = (f"{decisive}/acceleration", f"{decisive}/displacement", f"{first}/contact force")
    return Recording(
        channels=channels,
        slab=deck.slab,
        geometry=_geometry(deck, train, cars),
        observation=observation,
        live=live,
    )


def _geometry(deck: _Deck, train: TrainModel, cars: list[Body]) -> Geometry:
    """What is drawn: the deck's surface, the wheels, the cars and bogies."""
    return Geometry(
        vertices=deck.vertices,
        layers=deck.layers,
        wheels=WheelGeometry(
            names=train.wheel_names,
            offsets=train.wheel_offsets,
            lateral=train.wheel_lateral,
            contact_height=deck.contact_height,
            radius=train.wheel_radius,
        ),
        bodies=tuple(
            BodyGeometry(
                name=body.name, kind=body.kind, offset=body.drawn_offset,
                size=(body.length, body.width, body.height), base=body.base_height,
            )
            for body in cars
        ),
        spans=deck.spans,
    )  # fmt: skip


def _decisive(named: list[str]) -> str:
    """The named point of the middle span, on the axis."""
    axes = [name for name in named if name.endswith("axis")] or named
    return axes[len(axes) // 2] if len(axes) % 2 else axes[len(axes) // 2 - 1]


# -- channels ------------------------------------------------------------------------------------


def _deck_channels(slab: SlabPoints, named: list[str], offset: float) -> list[ChannelSpec]:
    places = [
        (float(x), float(y), float(z)) for x, y, z in slab.coordinates[list(slab.named.values())]
    ]
    accelerations = [
        ChannelSpec(
            name=f"{name}/acceleration", unit=Units.acceleration, group="deck", place=place,
            title=f"Vertical acceleration, {name}", time_offset=offset,
        )
        for name, place in zip(named, places, strict=True)
    ]  # fmt: skip
    displacements = [
        ChannelSpec(
            name=f"{name}/displacement", unit=Units.small_length, group="deck", place=place,
            title=f"Vertical displacement, {name}",
        )
        for name, place in zip(named, places, strict=True)
    ]  # fmt: skip
    return [*accelerations, *displacements]


def _wheel_channels(train: TrainModel) -> list[ChannelSpec]:
    forces = [
        ChannelSpec(
            name=f"{name}/contact force", unit=Units.force, group="wheel",
            title=f"Contact force, {name}",
        )
        for name in train.wheel_names
    ]  # fmt: skip
    displacements = [
        ChannelSpec(
            name=f"{name}/displacement", unit=Units.small_length, group="wheel",
            title=f"Vertical displacement of the contact point, {name}",
        )
        for name in train.wheel_names
    ]  # fmt: skip
    return [*forces, *displacements]


def _car_channels(names: list[str], offset: float) -> list[ChannelSpec]:
    accelerations = [
        ChannelSpec(
            name=f"{name}/acceleration", unit=Units.acceleration, group="vehicle",
            title=f"Vertical acceleration, {name}", time_offset=offset,
        )
        for name in names
    ]  # fmt: skip
    displacements = [
        ChannelSpec(
            name=f"{name}/displacement", unit=Units.small_length, group="vehicle",
            title=f"Vertical displacement from the static start, {name}",
        )
        for name in names
    ]  # fmt: skip
    return [*accelerations, *displacements]


def _bearing_channels(places: Matrix) -> list[ChannelSpec]:
    return [
        ChannelSpec(
            name=f"bearing {number:02d}/tension", unit=Units.force, group="bearing",
            place=(float(x), float(y), float(z)),
            title=f"Tension in bearing {number} at x = {x:.2f} m, y = {y:.2f} m, with dead load",
        )
        for number, (x, y, z) in enumerate(places, start=1)
    ]  # fmt: skip


# -- the U-girder deck ---------------------------------------------------------------------------


def _slab_deck(viaduct: ViaductProperties, track: TrackProperties, scene: Scene) -> _Deck:
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
    return _Deck(
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
    structure, line = scene.structure, scene.system.line
    assert structure is not None
    first, last = scene.system.seat_nodes[0], scene.system.seat_nodes[-1]
    nodes = np.arange(first, last + 1)
    vertices, faces, columns = [], [], []
    for number, side in enumerate((lateral, -lateral)):
        for edge in (-_RAIL_HALF_WIDTH, _RAIL_HALF_WIDTH):
            strip = np.zeros((nodes.size, 3))
            strip[:, 0], strip[:, 1], strip[:, 2] = line.positions[nodes], side + edge, height
            vertices.append(strip)
            columns.append(2 * nodes * line.n_line + number)
        start = 2 * number * nodes.size + np.arange(nodes.size - 1)
        other = start + nodes.size
        faces.append(np.column_stack([start, start + 1, other + 1, other]))
    return (
        np.concatenate(vertices),
        np.concatenate(faces),
        _selection(np.concatenate(columns), line.n_dof * line.n_line),
    )


def _selection(columns: IntVector, n_column: int) -> SparseMatrix:
    rows = np.arange(columns.size)
    return sparse.coo_array(
        (np.ones(columns.size), (rows, columns)), shape=(columns.size, n_column)
    ).tocsr()


# -- plain beams ---------------------------------------------------------------------------------


def _beam_deck(bridge: BeamBridge, line: BeamLine) -> _Deck:
    """Nodes of the beams; drawn as a strip of the beam's width."""
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
    heights = _selection(columns, line.n_dof)
    vertices, faces, operator = _strip(bridge, x, span, columns, line.n_dof)
    return _Deck(
        slab=SlabPoints(coordinates=coordinates, span=span, judged_spans=(), named=named),
        slab_rows=heights,
        vertices=vertices,
        layers=(Layer(name="deck", faces=faces),),
        surface=operator,
        rail_rows=_selection(np.zeros(0, dtype=np.int64), line.n_dof),
        contact_height=0.0,
        spans=spans,
        bearings=_selection(np.zeros(0, dtype=np.int64), line.n_dof),
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
