"""What a run records: named points of the deck, slab points, wheels, cars, the drawn surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from solver.arrays import Matrix, SparseMatrix
from solver.models.train import Body, TrainModel
from solver.results import BodyGeometry, ChannelSpec, Geometry, SlabPoints, WheelGeometry
from solver.simulation import Observation
from solver.studies.deck import deck_of
from solver.studies.scene import Scene
from solver.studies.study import Study
from solver.units import Units

__all__ = ["Recording", "body_geometry", "body_rows", "drawn_bodies", "record", "wheel_geometry"]


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


def record(study: Study, scene: Scene, acceleration_offset: float) -> Recording:
    """Decides what a run records.

    Args:
        study: The study.
        scene: Its models.
        acceleration_offset: Added to the time of acceleration channels, alpha dt. [s]

    Returns:
        The recording.
    """
    deck, train = deck_of(study, scene), scene.train
    named = list(deck.slab.named)
    rows = deck.slab_rows[list(deck.slab.named.values())]
    cars = drawn_bodies(train)
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
        bodies=body_rows(cars),
        deck_part=deck.part,
    )
    first = train.wheel_names[0]
    decisive = _decisive(named)
    live = (f"{decisive}/acceleration", f"{decisive}/displacement", f"{first}/contact force")
    return Recording(
        channels=channels,
        slab=deck.slab,
        geometry=Geometry(
            vertices=deck.vertices,
            layers=deck.layers,
            wheels=wheel_geometry(train, deck.contact_height),
            bodies=body_geometry(cars),
            spans=deck.spans,
        ),
        observation=observation,
        live=live,
    )


def drawn_bodies(train: TrainModel) -> list[Body]:
    """Bodies that are drawn as boxes; wheelsets are drawn as wheels."""
    return [body for body in train.bodies if body.kind != "wheelset"]


def body_rows(bodies: list[Body]) -> SparseMatrix:
    """Bounce, roll, pitch of the bodies, shape (3 n_body, n_dof)."""
    return sparse.csr_array(np.concatenate([body.rows for body in bodies]))


def wheel_geometry(train: TrainModel, contact_height: float) -> WheelGeometry:
    """The wheels as they are drawn.

    Args:
        train: Their train.
        contact_height: z of the undeformed contact points. [m]
    """
    return WheelGeometry(
        names=train.wheel_names,
        offsets=train.wheel_offsets,
        lateral=train.wheel_lateral,
        contact_height=contact_height,
        radius=train.wheel_radius,
    )


def body_geometry(bodies: list[Body]) -> tuple[BodyGeometry, ...]:
    """The cars and bogies as boxes."""
    return tuple(
        BodyGeometry(
            name=body.name, kind=body.kind, offset=body.drawn_offset,
            size=(body.length, body.width, body.height), base=body.base_height,
        )
        for body in bodies
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
