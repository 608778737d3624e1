"""Camera presets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import viser

from solver.arrays import Vector
from solver.results import Geometry

__all__ = ["Preset", "View", "follow", "move", "set_initial", "view"]

Preset: TypeAlias = Literal["overview", "side", "section", "follow", "free"]
"""``free`` leaves the cameras where their users put them."""

NEAR = 0.3
"""Usual distance of the clipping plane. [m]"""
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


def view(preset: Preset, geometry: Geometry, first_axle: float, aspect: float) -> View:
    """The camera of a preset.

    Args:
        preset: ``free`` gives the overview.
        geometry: Of the run.
        first_axle: x of the first axle. [m]
        aspect: Width over height of the picture.
    """
    if preset == "side":
        return _side(geometry, aspect)
    if preset == "section":
        return _section(geometry, aspect)
    if preset == "follow":
        return _bogie(geometry, first_axle)
    return _overview(geometry, aspect)


def set_initial(server: viser.ViserServer, first: View) -> None:
    """Where the camera of every new client begins."""
    camera = server.initial_camera
    camera.position, camera.look_at, camera.fov = first.position, first.target, first.field
    camera.near = first.near


def move(server: viser.ViserServer, preset: Preset, geometry: Geometry, first_axle: float) -> None:
    """Moves the cameras of all clients to a preset; for ``free`` only unclips them."""
    for client in server.get_clients().values():
        camera = client.camera
        aspect = camera.image_width / max(camera.image_height, 1) or 1.0
        wanted = view(preset, geometry, first_axle, aspect)
        with client.atomic():
            camera.near = wanted.near
            if preset != "free":
                camera.fov = wanted.field
                camera.position = wanted.position
                camera.look_at = wanted.target


def follow(server: viser.ViserServer, geometry: Geometry, first_axle: float) -> None:
    """Carries the cameras along with the first bogie; each keeps its own angle and distance."""
    target = _bogie(geometry, first_axle).target
    for client in server.get_clients().values():
        offset = client.camera.position - client.camera.look_at
        with client.atomic():
            client.camera.position = target + offset
            client.camera.look_at = target


def _overview(geometry: Geometry, aspect: float) -> View:
    """From the side and above, the middle span in the middle."""
    begin, end = _middle_span(geometry)
    middle, height = (begin + end) / 2.0, geometry.wheels.contact_height
    low, high = _extent(geometry)
    reach = min(max(0.42 * (high - low), 0.75 * (end - begin)), 1.1 * (end - begin))
    reach *= max(1.0, 1.3 / aspect)  # step back where the picture is upright
    return View(
        position=np.array([middle - 0.75 * reach, -1.75 * reach, height + 0.72 * reach]),
        target=np.array([middle - 0.05 * reach, 0.0, height - 0.02 * reach]),
    )


def _side(geometry: Geometry, aspect: float) -> View:
    """The whole viaduct as on an elevation."""
    low, high = _extent(geometry)
    field = float(np.radians(10.0))
    distance = 1.12 * (high - low) / (2.0 * aspect * np.tan(field / 2.0))
    centre, height = (low + high) / 2.0, geometry.wheels.contact_height
    return View(
        position=np.array([centre, -distance, height + 0.02 * distance]),
        target=np.array([centre, 0.0, height]),
        field=field,
    )


def _section(geometry: Geometry, aspect: float) -> View:
    """The middle of the middle span, cut and seen in the train's way."""
    begin, end = _middle_span(geometry)
    field, height = float(np.radians(16.0)), geometry.wheels.contact_height
    half_width = 1.25 * float(np.abs(geometry.vertices[:, 1]).max(initial=2.0))
    half_height = max(3.6, half_width / aspect)
    distance = half_height / np.tan(field / 2.0)
    middle = (begin + end) / 2.0
    return View(
        position=np.array([middle - distance, 0.0, height + 0.6]),
        target=np.array([middle, 0.0, height + 0.3]),
        field=field,
        near=distance,
    )


def _bogie(geometry: Geometry, first_axle: float) -> View:
    """The first bogie from the side, close."""
    height, centre = geometry.wheels.contact_height, first_axle - BOGIE_BEHIND
    return View(
        position=np.array([centre + 8.0, -9.5, height + 3.0]),
        target=np.array([centre, 0.0, height + 0.3]),
    )


def _middle_span(geometry: Geometry) -> tuple[float, float]:
    spans = geometry.spans
    if not len(spans):
        return _extent(geometry)
    begin, end = spans[len(spans) // 2]
    return float(begin), float(end)


def _extent(geometry: Geometry) -> tuple[float, float]:
    along = geometry.spans if len(geometry.spans) else geometry.vertices[:, 0]
    return float(along.min()), float(along.max())
