"""The deformed surface of one layer, with its material or with colours.

Viser's meshes have one colour and vertices that can be replaced. Colours per vertex therefore
travel as those of a hidden point cloud under the mesh, and the page's script
(``client/colours.mjs``) copies them into the mesh before it is drawn: 12 + 3 bytes a vertex. Where
a browser cannot run it, each element is a square of its own colour.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import viser
from numpy.typing import NDArray

from server.viewer.palette import Colour
from server.viewer.picture import Picture
from server.viewer.scene_elements import ELEMENTS, Elements
from server.viewer.scene_part import Detail, wire
from server.viewer.surface import BALLAST_SCALE, BALLAST_SHIFT, Surface
from solver.results import Layer

__all__ = ["CARRIER", "SurfaceLayer"]

CARRIER = "/colours"
"""After its mesh's name, that of the hidden point cloud; the page's script looks for it."""

_VEIL = 0.12
"""Opacity of what lies over the map of the peaks."""
_WHITE: Colour = (255, 255, 255)
_AS_IS = ((1.0, 1.0, 1.0), (0.0, 0.0, 0.0))


class SurfaceLayer:
    """One layer on one server.

    Args:
        server: The session's server.
        layer: The layer.
        surfaces: How it is drawn while the time runs, and while it stands.
        first: The picture to begin with.
        material: Its colour where it shows no quantity.
        smooth: Colours per vertex; else per element.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        layer: Layer,
        surfaces: Mapping[Detail, Surface],
        first: Picture,
        material: Colour,
        smooth: bool,
    ) -> None:
        self.layer = layer.name
        self._material = material
        self._surfaces = surfaces
        used = np.unique(layer.faces)
        self._rows = {
            detail: np.searchsorted(used, surface.vertices) for detail, surface in surfaces.items()
        }
        self._detail: Detail = "paused"
        surface = surfaces[self._detail]
        self._mesh = _add_mesh(server, layer.name, surface, first, material)
        # What an earlier scene coloured in the other way.
        server.scene.remove_by_name(f"/{layer.name}{ELEMENTS if smooth else CARRIER}")
        self._carrier = _add_carrier(server, layer.name) if smooth else None
        self._elements = None if smooth else Elements(server, layer)
        self._visible = True
        self._by_element = False
        self.show(first, self._detail)

    def show(self, picture: Picture, detail: Detail) -> None:
        """Deforms and colours the surface."""
        colours = picture.colours.get(self.layer)
        if self._elements is not None:
            self._by_element = colours is not None
            if colours is not None:
                self._elements.show(picture.vertices, colours)
            self.reveal(self._visible)
        surface = self._surfaces[detail]
        if surface is not self._surfaces[self._detail]:
            self._mesh.faces = surface.triangles.astype(np.uint32)
        self._detail = detail
        self._mesh.vertices = wire(surface.placed(picture.vertices))
        self._mesh.opacity = _VEIL if self.layer in picture.veiled else None
        if self._carrier is not None:
            self._colour(self._carrier, None if colours is None else colours[self._rows[detail]])

    def reveal(self, visible: bool) -> None:
        """Shows or hides the layer."""
        self._visible = visible
        self._mesh.visible = visible and not self._by_element
        if self._elements is not None:
            self._elements.node.visible = visible and self._by_element

    def remove(self) -> None:
        """Takes the layer off the server."""
        self._mesh.remove()  # and its carrier, which lies below it
        if self._elements is not None:
            self._elements.node.remove()

    def _colour(self, carrier: viser.PointCloudHandle, colours: NDArray[np.uint8] | None) -> None:
        if colours is None:
            carrier.colors, self._mesh.color = np.array(self._material, np.uint8), self._material
        else:
            # The material's colour multiplies those of the vertices.
            carrier.colors, self._mesh.color = colours, _WHITE


def _add_mesh(
    server: viser.ViserServer, name: str, surface: Surface, first: Picture, colour: Colour
) -> viser.MeshHandle:
    scale, position = (BALLAST_SCALE, BALLAST_SHIFT) if name == "ballast" else _AS_IS
    return server.scene.add_mesh_simple(
        f"/{name}",
        surface.placed(first.vertices),
        surface.triangles,
        color=colour,
        flat_shading=True,
        side="double",
        cast_shadow=False,
        receive_shadow=False,
        scale=scale,
        position=position,
    )


def _add_carrier(server: viser.ViserServer, name: str) -> viser.PointCloudHandle:
    """A point that is never drawn; its colours are those of the mesh's vertices."""
    return server.scene.add_point_cloud(
        f"/{name}{CARRIER}", np.zeros((1, 3)), _WHITE, visible=False
    )
