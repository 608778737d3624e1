"""The train: wheels on the rails, their forces, bogies and carbodies."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from server.viewer.palette import Colour, Palette
from server.viewer.picture import Picture
from server.viewer.scene_part import (
    Detail,
    Nodes,
    Part,
    add_batch,
    as_light,
    coloured,
    upright,
    wire,
)
from server.viewer.shapes import axle, bogie_frame, carbody, crossed_bars, wheel
from solver.arrays import Matrix
from solver.results import Geometry

__all__ = ["BODY_LAYERS", "CARBODY_OPACITY", "train_parts"]

BODY_LAYERS = {"bogies": "bogie", "carbodies": "carbody"}
"""Layers of bodies, by the kind that they show."""

CARBODY_OPACITY = 0.38
_MARK_ABOVE = 1.25
"""Of the mark of a lost contact over the foot of the wheel's arrow. [m]"""


def train_parts(
    server: viser.ViserServer, geometry: Geometry, first: Picture, colours: Palette
) -> list[Part]:
    """Everything of the train that a run has."""
    parts: list[Part] = []
    if geometry.wheels.names:
        parts.append(_Wheels(server, geometry, first, colours))
    if len(first.arrows):
        parts.append(_Forces(server, first, colours))
    shapes = {
        "bogies": (bogie_frame(), colours.bogie, None),
        "carbodies": (carbody(), colours.carbody, CARBODY_OPACITY),
    }
    for layer, (shape, colour, opacity) in shapes.items():
        index = [i for i, body in enumerate(geometry.bodies) if body.kind == BODY_LAYERS[layer]]
        if index:
            sizes = np.array([geometry.bodies[i].size for i in index])
            handle = add_batch(
                server,
                f"/{layer}",
                shape,
                first.body_centres[index],
                first.body_orientations[index],
                coloured(colour, len(index)),
                sizes,
                opacity,
            )
            parts.append(_Bodies(layer, handle, index))
    return parts


class _Wheels(Nodes):
    """Wheels and the axles between them; wheels without contact are red."""

    def __init__(
        self, server: viser.ViserServer, geometry: Geometry, first: Picture, colours: Palette
    ) -> None:
        wheels = geometry.wheels
        # The shape's flange is at y < 0, the inner side of a left wheel.
        left = wheels.lateral >= 0.0
        nothing = np.zeros((len(left), 2))
        turned = np.column_stack((left, nothing, ~left)).astype(float)
        self._rims = np.array([colours.wheel, colours.lost], dtype=np.uint8)
        self._wheels = add_batch(
            server, "/wheels", wheel(wheels.radius), first.wheels, turned, self._colours(first)
        )
        self._axles = _add_axles(server, first, colours.axle)
        super().__init__("wheels", self._wheels, *([self._axles] if self._axles else []))

    def show(self, picture: Picture, detail: Detail) -> None:
        """Moves wheels and axles."""
        self._wheels.batched_positions = wire(picture.wheels)
        self._wheels.batched_colors = as_light(self._colours(picture))
        if self._axles is not None:
            centres, orientations, _ = picture.axles
            self._axles.batched_positions = wire(centres)
            self._axles.batched_wxyzs = wire(orientations)

    def _colours(self, picture: Picture) -> NDArray[np.uint8]:
        return self._rims[picture.lost.astype(int)]


def _add_axles(
    server: viser.ViserServer, first: Picture, colour: Colour
) -> viser.BatchedMeshHandle | None:
    centres, orientations, lengths = first.axles
    if not len(centres):
        return None
    sizes = np.column_stack((np.ones(len(lengths)), lengths, np.ones(len(lengths))))
    colours = coloured(colour, len(centres))
    return add_batch(server, "/axles", axle(0.08), centres, orientations, colours, sizes)


class _Bodies(Nodes):
    """Bodies of one kind."""

    def __init__(self, layer: str, handle: viser.BatchedMeshHandle, index: list[int]) -> None:
        super().__init__(layer, handle)
        self._handle = handle
        self._index = index

    def show(self, picture: Picture, detail: Detail) -> None:
        """Moves them with their bounce, pitch and roll."""
        self._handle.batched_positions = wire(picture.body_centres[self._index])
        self._handle.batched_wxyzs = wire(picture.body_orientations[self._index])


class _Forces(Nodes):
    """Contact forces; a red cross where there is none, so that colour is not the only sign."""

    def __init__(self, server: viser.ViserServer, first: Picture, colours: Palette) -> None:
        n = len(first.arrows)
        self._tints = as_light(np.array([colours.force, colours.lost], dtype=np.uint8))
        self._arrows = server.scene.add_arrows(
            "/forces",
            first.arrows,
            self._tints[first.lost.astype(int)],
            shaft_radius=0.025,
            head_radius=0.07,
            head_length=0.18,
        )
        self._marks = add_batch(
            server,
            "/lost-contacts",
            crossed_bars(),
            _marked(first),
            upright(n),
            coloured(colours.lost, n),
            _sizes(first),
        )
        super().__init__("forces", self._arrows, self._marks)

    def show(self, picture: Picture, detail: Detail) -> None:
        """Draws the forces of a moment."""
        self._arrows.points = wire(picture.arrows)
        self._arrows.colors = self._tints[picture.lost.astype(int)]
        sizes = wire(_sizes(picture))
        if picture.lost.any():
            self._marks.batched_positions = wire(_marked(picture))
        self._marks.batched_scales = sizes


def _marked(picture: Picture) -> Matrix:
    """Places of the marks, over the feet of the arrows, shape (n_wheel, 3). [m]"""
    return picture.arrows[:, 1] + np.array([0.0, 0.0, _MARK_ABOVE])


def _sizes(picture: Picture) -> Matrix:
    """One where contact is lost, else nothing, shape (n_wheel, 3)."""
    return np.repeat(picture.lost.astype(float)[:, None], 3, axis=1)
