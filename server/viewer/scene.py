"""The scene graph: the deformed surface by layers, the train, the forces.

Everything is created once; afterwards only arrays are replaced, so that a frame costs 12 bytes a
vertex, and 3 more for its colour. The whole of it is the same for all clients of a session.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
import viser

from server.viewer.decimation import lightened
from server.viewer.palette import Theme, palette
from server.viewer.picture import Picture
from server.viewer.rail_profile import SECTION_POINTS, with_rail_section
from server.viewer.scene_part import Detail, Part
from server.viewer.scene_setting import (
    OUTLINED,
    add_outline,
    add_rigid_rails,
    add_supports,
    configure,
    light,
)
from server.viewer.scene_surface import SurfaceLayer
from server.viewer.scene_train import BODY_LAYERS, train_parts
from server.viewer.surface import Surface, surface_of
from solver.arrays import Matrix
from solver.results import Geometry, Layer

__all__ = ["Scene", "available_layers"]


def available_layers(geometry: Geometry, *, modal: bool = False) -> tuple[str, ...]:
    """Names of everything that can be shown or hidden.

    Args:
        geometry: What is drawn.
        modal: Whether it shows the shapes of modes, which have no contact forces.
    """
    surfaces = [layer.name for layer in geometry.layers if len(layer.faces)]
    if geometry.wheels.names and "rails" not in surfaces:
        surfaces.append("rails")
    kinds = {body.kind for body in geometry.bodies}
    wheels = ["wheels"] if geometry.wheels.names else []
    bodies = [name for name, kind in BODY_LAYERS.items() if kind in kinds]
    forces = ["forces"] if geometry.wheels.names and not modal else []
    outline = ["outline"] if any(name in OUTLINED for name in surfaces) else []
    supports = ["supports"] if len(geometry.spans) and len(geometry.vertices) else []
    return (*surfaces, *wheels, *bodies, *forces, *outline, *supports)


class Scene:
    """What one viser server shows of one run.

    Args:
        server: The session's server.
        geometry: The run's geometry.
        first: The picture to begin with.
        theme: Of the page around it.
        smooth: Colours per vertex; else per element, for a browser without the page's script.
        landmarks: Points whose vertices are drawn even while the time runs, shape (n, 3). [m]
    """

    def __init__(
        self,
        server: viser.ViserServer,
        geometry: Geometry,
        first: Picture,
        theme: Theme,
        *,
        smooth: bool = True,
        landmarks: Matrix | None = None,
    ) -> None:
        self._server = server
        self.theme: Theme = theme
        self._details = _details(geometry, np.empty((0, 3)) if landmarks is None else landmarks)
        with server.atomic():
            configure(server, theme)
            light(server)
            self._parts = self._made(geometry, first, smooth)
        self._layers = frozenset(part.layer for part in self._parts)

    @property
    def layers(self) -> frozenset[str]:
        """Names of what is visible."""
        return self._layers

    def show_layers(self, layers: Collection[str]) -> None:
        """Shows these layers and hides all others."""
        self._layers = frozenset(layers)
        for part in self._parts:
            part.reveal(part.layer in self._layers)

    def show(self, picture: Picture, detail: Detail = "paused") -> None:
        """Moves everything that is visible to one moment.

        Args:
            picture: The moment.
            detail: ``playing`` draws at most 20,000 vertices, ``paused`` all of them.
        """
        with self._server.atomic():
            for part in self._parts:
                if part.layer in self._layers:
                    part.show(picture, detail)

    def clear(self) -> None:
        """Takes everything off the server, before another run's scene is made."""
        with self._server.atomic():
            for part in self._parts:
                part.remove()
        self._parts = []

    def _made(self, geometry: Geometry, first: Picture, smooth: bool) -> list[Part]:
        parts: list[Part] = []
        for layer in geometry.layers:
            if len(layer.faces):
                surfaces: dict[Detail, Surface] = {
                    detail: layers[layer.name] for detail, layers in self._details.items()
                }
                colour = palette(self.theme).layer(layer.name)
                parts.append(
                    SurfaceLayer(self._server, layer, surfaces, first, colour, smooth=smooth)
                )
        for fixed in (
            add_outline(self._server, geometry, self.theme),
            add_supports(self._server, geometry, self.theme),
            add_rigid_rails(self._server, geometry, first.first_axle, self.theme),
        ):
            parts += [fixed] if fixed else []
        return parts + train_parts(self._server, geometry, first, palette(self.theme))


def _details(geometry: Geometry, kept: Matrix) -> dict[Detail, dict[str, Surface]]:
    """Surfaces by layer: light ones while the time runs, whole ones while it stands."""
    whole = {layer.name: _surface(layer, geometry) for layer in geometry.layers}
    thinned = {
        layer.name: whole[layer.name]
        if np.array_equal(layer.faces, original.faces)
        else _surface(layer, geometry)
        for layer, original in zip(
            lightened(geometry, {"rails": SECTION_POINTS}, kept), geometry.layers, strict=True
        )
    }
    return {"playing": thinned, "paused": whole}


def _surface(layer: Layer, geometry: Geometry) -> Surface:
    surface = surface_of(layer)
    return with_rail_section(surface, geometry.vertices) if layer.name == "rails" else surface
