"""Camera presets, and where a camera is that somebody moved."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
import viser

from solver.arrays import Matrix, Vector
from solver.results import Geometry

__all__ = ["Mount", "Place", "Pose", "Preset", "View", "posed", "set_initial", "view"]

Preset: TypeAlias = Literal["overview", "side", "section", "follow", "free"]
"""``free`` leaves the cameras where their users put them."""

Place: TypeAlias = tuple[float, float, float]
"""x, y, z. [m]"""

NEAR = 0.3
"""Usual distance of the clipping plane. [m]"""
NEAREST = 0.01
"""Least distance between the eye and what it looks at. [m]"""
FARTHEST = 1000.0
"""Usual end of what is drawn. [m]"""
LONGEST = 100.0
"""More of a viaduct or train would be too thin a line to see it move. [m]"""
MARGIN = 1.06
SAG = 0.03
"""Exaggerated deflection over the span's length, as the proposed deformation scale gives it."""
BOGIE_BEHIND = 1.5
"""Middle of the first bogie behind the first axle, near enough to look at. [m]"""


@dataclass(frozen=True, kw_only=True)
class View:
    """A camera.

    Attributes:
        position: Shape (3,). [m]
        target: The point looked at, shape (3,). [m]
        field: Vertical field of view; narrow ones draw almost in parallel projection. [rad]
        near: Distance of the clipping plane, which cuts the section. [m]
    """

    position: Vector
    target: Vector
    field: float = float(np.radians(34.0))
    near: float = NEAR

    @property
    def far(self) -> float:
        """What is beyond is not drawn; side views stand far back. [m]"""
        return max(FARTHEST, 3.0 * float(np.linalg.norm(self.position - self.target)))


@dataclass(frozen=True, kw_only=True)
class Pose:
    """Where somebody moved a camera; up is always z.

    Attributes:
        position: Of the eye.
        look_at: What it looks at, and turns about.
        field: Vertical field of view, None for the preset's. [rad]
        time: When it was there, for one that follows the train; None for now. [s]
    """

    position: Place
    look_at: Place
    field: float | None = None
    time: float | None = None

    @property
    def looks(self) -> bool:
        """Whether it looks anywhere: viser's camera comes no nearer to what it turns about."""
        return float(np.linalg.norm(np.subtract(self.position, self.look_at))) >= NEAREST

    def shifted(self, by: Vector) -> Pose:
        """The same somewhere else.

        Args:
            by: Shape (3,). [m]
        """
        return Pose(
            position=_place(np.array(self.position) + by),
            look_at=_place(np.array(self.look_at) + by),
            field=self.field,
        )

    @classmethod
    def of(cls, position: Vector, look_at: Vector, field: float | None = None) -> Pose:
        """Of arrays, shape (3,). [m]"""
        return cls(position=_place(position), look_at=_place(look_at), field=field)


def _place(point: Vector) -> Place:
    x, y, z = point.tolist()
    return x, y, z


def view(preset: Preset, geometry: Geometry, first_axle: float, aspect: float) -> View:
    """The camera of a preset.

    Args:
        preset: ``free`` gives the overview.
        geometry: Of the run.
        first_axle: x of the first axle. [m]
        aspect: Width over height of the picture.
    """
    stage = _Stage.of(geometry, first_axle)
    if preset == "side":
        return _side(stage, aspect)
    if preset == "section":
        return _section(stage, aspect)
    if preset == "follow" and geometry.wheels.names:
        return _bogie(stage, aspect)
    return _overview(stage, aspect)


def posed(wanted: View, pose: Pose | None) -> View:
    """A preset's view from where somebody looked: its clipping plane stays, which cuts the section.

    Args:
        wanted: The preset's.
        pose: None for the preset's own place.
    """
    if pose is None:
        return wanted
    return replace(
        wanted,
        position=np.array(pose.position),
        target=np.array(pose.look_at),
        field=wanted.field if pose.field is None else pose.field,
    )


def set_initial(server: viser.ViserServer, first: View) -> None:
    """Where the camera of every new client begins."""
    camera = server.initial_camera
    camera.position, camera.look_at, camera.fov = first.position, first.target, first.field
    camera.near, camera.far = first.near, first.far


@dataclass(frozen=True, kw_only=True)
class Mount:
    """What the cameras stand on: the ground, or the bogie that they follow.

    Attributes:
        preset: From where one looks.
        geometry: Of the run.
        first_axle: x of the first axle. [m]
        modal: Whether the train stands, because a mode is shown.
    """

    preset: Preset
    geometry: Geometry
    first_axle: float
    modal: bool = False

    @property
    def rides(self) -> bool:
        """Whether the cameras are carried along; without wheels there is nothing to follow."""
        return self.preset == "follow" and bool(self.geometry.wheels.names) and not self.modal

    @property
    def origin(self) -> Vector:
        """What poses are told from: the first axle if one follows it, else x = 0. [m]"""
        return np.array([self.first_axle if self.rides else 0.0, 0.0, 0.0])

    def view(self, aspect: float) -> View:
        """The preset's own view for a picture of some width over height."""
        return view(self.preset, self.geometry, self.first_axle, aspect)


def _overview(stage: _Stage, aspect: float) -> View:
    """From the side and above, as much as can still be made out."""
    direction = np.array([-0.36, -0.83, 0.36])
    return _fitting(stage.shortened(), direction, float(np.radians(34.0)), aspect)


def _side(stage: _Stage, aspect: float) -> View:
    """A bridge or track as on an elevation; of a train alone as much as can be made out."""
    shown = stage.shortened() if stage.train_alone else stage
    return _fitting(shown, np.array([0.0, -1.0, 0.02]), float(np.radians(10.0)), aspect)


def _section(stage: _Stage, aspect: float) -> View:
    """The middle of the middle span, cut and seen in the train's way."""
    field = float(np.radians(16.0))
    middle, height = stage.cut, (stage.bottom + stage.top) / 2.0
    half_height = 1.1 * max((stage.top - stage.bottom) / 2.0, stage.half_width / aspect)
    distance = half_height / float(np.tan(field / 2.0))
    return View(
        position=np.array([middle - distance, 0.0, height + 0.3]),
        target=np.array([middle, 0.0, height]),
        field=field,
        near=distance,
    )


def _bogie(stage: _Stage, aspect: float) -> View:
    """The first bogie from the side, close."""
    centre, back = stage.bogie, max(1.0, 1.5 / aspect)
    return View(
        position=np.array([centre + 8.0 * back, -9.5 * back, stage.rail + 3.0 * back]),
        target=np.array([centre, 0.0, stage.rail + 0.3]),
    )


def _fitting(stage: _Stage, direction: Vector, field: float, aspect: float) -> View:
    """As near as the whole stage can be seen.

    Args:
        stage: What has to be seen.
        direction: From the target to the eye.
        field: Vertical field of view. [rad]
        aspect: Width over height of the picture.
    """
    target = np.array([(stage.low + stage.high) / 2.0, 0.0, (stage.bottom + stage.top) / 2.0])
    back = direction / np.linalg.norm(direction)
    right = np.cross(-back, [0.0, 0.0, 1.0])
    right = right / np.linalg.norm(right)
    axes = np.array([right, np.cross(right, -back), back])
    across, up, towards = axes @ (stage.corners() - target).T
    # A corner is seen if its offset is within the tangent of half the field times its depth.
    tangent = float(np.tan(field / 2.0))
    needed = np.maximum(np.abs(across) / aspect, np.abs(up)) / tangent + towards
    return View(position=target + MARGIN * needed.max() * back, target=target, field=field)


@dataclass(frozen=True, kw_only=True)
class _Stage:
    """What there is to look at.

    Attributes:
        low: x at which it begins. [m]
        high: x at which it ends. [m]
        half_width: [m]
        bottom: Lowest z. [m]
        top: Highest z, the train's roof if there is one. [m]
        rail: z of the rails. [m]
        cut: x of the section. [m]
        bogie: x of the middle of the first bogie. [m]
        train_alone: Whether there is neither bridge nor track.
    """

    low: float
    high: float
    half_width: float
    bottom: float
    top: float
    rail: float
    cut: float
    bogie: float
    train_alone: bool

    @classmethod
    def of(cls, geometry: Geometry, first_axle: float) -> _Stage:
        """The bridge, or the track, or the train alone."""
        wheels, vertices, rail = geometry.wheels, geometry.vertices, geometry.wheels.contact_height
        low, high = _extent(geometry, first_axle)
        begin, end = low, high
        if len(geometry.spans):
            begin, end = geometry.spans[len(geometry.spans) // 2].tolist()
        sag = SAG * max((geometry.spans[:, 1] - geometry.spans[:, 0]).tolist(), default=0.0)
        roofs = [body.base + body.size[2] for body in geometry.bodies]
        height = max(roofs, default=2.0 * wheels.radius if wheels.names else 0.5)
        return cls(
            low=low,
            high=high,
            half_width=max(1.8, float(np.abs(vertices[:, 1]).max(initial=0.0))),
            bottom=float(vertices[:, 2].min(initial=rail)) - 0.3 - sag,
            top=max(rail + height, float(vertices[:, 2].max(initial=rail))),
            rail=rail,
            cut=(begin + end) / 2.0,
            bogie=first_axle - BOGIE_BEHIND,
            train_alone=not len(vertices),
        )

    def shortened(self) -> _Stage:
        """Its middle, if it is too long."""
        middle, half = (self.low + self.high) / 2.0, min(self.high - self.low, LONGEST) / 2.0
        return replace(self, low=middle - half, high=middle + half)

    def corners(self) -> Matrix:
        """Of the box around it, shape (8, 3). [m]"""
        sides = (
            (self.low, self.high),
            (-self.half_width, self.half_width),
            (self.bottom, self.top),
        )
        return np.array([(x, y, z) for x in sides[0] for y in sides[1] for z in sides[2]])


def _extent(geometry: Geometry, first_axle: float) -> tuple[float, float]:
    """Where it begins and ends along the track: spans, else the surface, else the train. [m]"""
    if len(geometry.spans):
        return float(geometry.spans.min()), float(geometry.spans.max())
    if len(geometry.vertices):
        return float(geometry.vertices[:, 0].min()), float(geometry.vertices[:, 0].max())
    ends = [body.offset + side * body.size[0] / 2.0 for body in geometry.bodies for side in (-1, 1)]
    ends = [0.0, *geometry.wheels.offsets.tolist(), *ends]
    return first_axle + min(ends), first_axle + max(ends)
