"""The scene graph: the deformed surface by layers, the train, the forces.

Everything is created once; afterwards only arrays are replaced, so that a frame costs 12 bytes a
vertex. The whole of it is the same for all clients of a session.
"""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np
import viser
from numpy.typing import NDArray

from server.viewer.palette import Colour, Theme, palette
from server.viewer.picture import Picture
from server.viewer.rail_profile import with_rail_section
from server.viewer.shapes import Solid, axle, bogie_frame, carbody, unit_box, wheel
from server.viewer.surface import Surface, feature_edges, surface_of
from solver.arrays import FloatArray, Matrix
from solver.results import Geometry

__all__ = ["Scene", "available_layers"]

_BODIES = {"bogies": "bogie", "carbodies": "carbody"}
"""Layers of bodies, by the kind that they show."""

_OUTLINED = ("slab", "beam", "walls", "deck")
_PIER_DEPTH = 3.0
_AS_IS = ((1.0, 1.0, 1.0), (0.0, 0.0, 0.0))
_SHRUNK = ((1.0, 0.995, 1.0), (0.0, 0.0, 0.006))
"""Scale and position of the ballast, which else flickers through the walls that it touches."""


def available_layers(geometry: Geometry) -> tuple[str, ...]:
    """Names of everything that can be shown or hidden."""
    surfaces = (layer.name for layer in geometry.layers if len(layer.faces))
    kinds = {body.kind for body in geometry.bodies}
    bodies = (name for name, kind in _BODIES.items() if kind in kinds)
    return (*surfaces, "wheels", *bodies, "forces", "outline", "supports")


class Scene:
    """What one viser server shows of one run.

    Args:
        server: The session's server.
        geometry: The run's geometry.
        first: The picture to begin with.
        theme: Of the page around it.
    """

    def __init__(
        self, server: viser.ViserServer, geometry: Geometry, first: Picture, theme: Theme
    ) -> None:
        self._server = server
        self._geometry = geometry
        self._layers: frozenset[str] = frozenset(available_layers(geometry))
        self._updates: dict[str, Callable[[Picture], None]] = {}
        self._nodes: dict[str, list[viser.SceneNodeHandle]] = {}
        self._surfaces: dict[str, tuple[Surface, viser.MeshHandle]] = {}
        self.theme: Theme = theme
        with server.atomic():
            self._configure()
            self._add_surfaces(first)
            self._add_outline()
            self._add_supports()
            self._add_wheels(first)
            self._add_bodies(first)
            self._add_forces(first)

    @property
    def layers(self) -> frozenset[str]:
        """Names of what is visible."""
        return self._layers

    def show_layers(self, layers: Collection[str]) -> None:
        """Shows these layers and hides all others."""
        self._layers = frozenset(layers)
        for name, nodes in self._nodes.items():
            for node in nodes:
                node.visible = name in self._layers

    def show(self, picture: Picture) -> None:
        """Moves everything that is visible to one moment."""
        with self._server.atomic():
            for name, update in self._updates.items():
                if name in self._layers:
                    update(picture)

    def _configure(self) -> None:
        colours, dark = palette(self.theme), self.theme == "dark"
        scene = self._server.scene
        self._server.gui.configure_theme(
            dark_mode=dark, show_logo=False, show_share_button=False, control_width="small"
        )
        self._server.gui.main_panel.minimize()
        scene.set_up_direction("+z")
        scene.world_axes.visible = False
        # Image-based lighting costs a software renderer half its frames; three lamps do not.
        scene.configure_environment_map(None)
        scene.configure_default_lights(enabled=False)
        scene.add_light_hemisphere(
            "/lights/sky", sky_color=(255, 255, 255), ground_color=colours.support, intensity=1.5
        )
        for name, place, strength in (("key", (-30, -60, 80), 2.0), ("fill", (60, 40, 30), 0.7)):
            scene.add_light_directional(
                f"/lights/{name}", position=place, intensity=strength, cast_shadow=False
            )

    def _add_surfaces(self, first: Picture) -> None:
        for layer in self._geometry.layers:
            if not len(layer.faces):
                continue
            surface = surface_of(layer)
            if layer.name == "rails":
                surface = with_rail_section(surface, self._geometry.vertices)
            scale, position = _SHRUNK if layer.name == "ballast" else _AS_IS
            handle = self._server.scene.add_mesh_simple(
                f"/{layer.name}",
                surface.placed(first.vertices),
                surface.triangles,
                color=palette(self.theme).layer(layer.name),
                flat_shading=True,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
                scale=scale,
                position=position,
            )
            self._register(layer.name, handle)
            self._updates[layer.name] = _vertex_update(handle, surface)

    def _add_outline(self) -> None:
        geometry = self._geometry
        faces = [layer.faces for layer in geometry.layers if layer.name in _OUTLINED]
        if not faces:
            return
        segments = feature_edges(geometry.vertices, np.concatenate(faces))
        handle = self._server.scene.add_line_segments(
            "/outline",
            segments,
            palette(self.theme).outline,
            thickness=1.5,
            thickness_units="screen",
        )
        self._register("outline", handle)

    def _add_supports(self) -> None:
        """Piers, for the eye only, under the ends of the spans."""
        geometry = self._geometry
        if not len(geometry.spans):
            return
        ends = np.unique(np.round(geometry.spans, 3))
        within = _between(geometry.vertices, geometry.spans)
        top, width = float(within[:, 2].min()), float(np.ptp(within[:, 1]))
        n = len(ends)
        centres = np.column_stack((ends, np.zeros(n), np.full(n, top - _PIER_DEPTH / 2 - 0.25)))
        sizes = np.tile([1.0, max(0.6 * width, 1.0), _PIER_DEPTH], (n, 1))
        handle = self._batch("/supports", unit_box(), centres, _upright(n), sizes)
        handle.batched_colors = _coloured(palette(self.theme).support, n)
        self._register("supports", handle)

    def _add_wheels(self, first: Picture) -> None:
        wheels, colours = self._geometry.wheels, palette(self.theme)
        shape = wheel(wheels.radius)
        # The shape's flange is at y < 0, the inner side of a left wheel.
        mirrored = np.where(wheels.lateral < 0.0, -1.0, 1.0)
        turned = np.column_stack((mirrored > 0, np.zeros((len(mirrored), 2)), mirrored < 0)).astype(
            float
        )
        handle = self._batch("/wheels", shape, first.wheels, turned, None)
        self._register("wheels", handle)
        rims = np.array([colours.wheel, colours.lost], dtype=np.uint8)
        handle.batched_colors = rims[first.lost.astype(int)]
        bar = self._add_axles(first)

        def update(picture: Picture) -> None:
            handle.batched_positions = _wire(picture.wheels)
            handle.batched_colors = rims[picture.lost.astype(int)]
            if bar is not None:
                centres, orientations, _ = picture.axles
                bar.batched_positions, bar.batched_wxyzs = _wire(centres), _wire(orientations)

        self._updates["wheels"] = update

    def _add_axles(self, first: Picture) -> viser.BatchedMeshHandle | None:
        centres, orientations, lengths = first.axles
        if not len(centres):
            return None
        sizes = np.column_stack((np.ones(len(lengths)), lengths, np.ones(len(lengths))))
        bar = self._batch("/axles", axle(0.08), centres, orientations, sizes)
        bar.batched_colors = _coloured(palette(self.theme).axle, len(centres))
        self._register("wheels", bar)
        return bar

    def _add_bodies(self, first: Picture) -> None:
        colours = palette(self.theme)
        self._add_kind("bogies", first, bogie_frame(), colours.bogie, None)
        self._add_kind("carbodies", first, carbody(), colours.carbody, 0.38)

    def _add_kind(
        self,
        name: str,
        first: Picture,
        shape: Solid,
        colour: Colour,
        opacity: float | None,
    ) -> None:
        bodies = self._geometry.bodies
        index = [i for i, body in enumerate(bodies) if body.kind == _BODIES[name]]
        if not index:
            return
        sizes = np.array([bodies[i].size for i in index])
        handle = self._batch(
            f"/{name}",
            shape,
            first.body_centres[index],
            first.body_orientations[index],
            sizes,
            opacity,
        )
        handle.batched_colors = _coloured(colour, len(index))
        self._register(name, handle)

        def update(picture: Picture) -> None:
            handle.batched_positions = _wire(picture.body_centres[index])
            handle.batched_wxyzs = _wire(picture.body_orientations[index])

        self._updates[name] = update

    def _add_forces(self, first: Picture) -> None:
        handle = self._server.scene.add_arrows(
            "/forces",
            first.arrows,
            palette(self.theme).force,
            shaft_radius=0.025,
            head_radius=0.07,
            head_length=0.18,
        )
        self._register("forces", handle)

        def update(picture: Picture) -> None:
            handle.points = _wire(picture.arrows)

        self._updates["forces"] = update

    def _batch(
        self,
        name: str,
        shape: Solid,
        positions: Matrix,
        orientations: Matrix,
        sizes: Matrix | None,
        opacity: float | None = None,
    ) -> viser.BatchedMeshHandle:
        return self._server.scene.add_batched_meshes_simple(
            name,
            shape.vertices,
            shape.triangles,
            orientations,
            positions,
            batched_scales=sizes,
            batched_colors=np.zeros((len(positions), 3), dtype=np.uint8),
            lod="off",
            flat_shading=True,
            opacity=opacity,
            cast_shadow=False,
            receive_shadow=False,
        )

    def _register(self, name: str, node: viser.SceneNodeHandle) -> None:
        self._nodes.setdefault(name, []).append(node)


def _vertex_update(handle: viser.MeshHandle, surface: Surface) -> Callable[[Picture], None]:
    def update(picture: Picture) -> None:
        handle.vertices = _wire(surface.placed(picture.vertices))

    return update


def _between(vertices: Matrix, spans: Matrix) -> Matrix:
    """Vertices on the spans, without embankments."""
    inside = (vertices[:, 0] >= spans.min() - 1e-6) & (vertices[:, 0] <= spans.max() + 1e-6)
    return vertices[inside] if inside.any() else vertices


def _coloured(colour: Colour, n: int) -> NDArray[np.uint8]:
    return np.tile(np.array(colour, dtype=np.uint8), (n, 1))


def _wire(values: FloatArray) -> NDArray[np.float32]:
    return values.astype(np.float32)


def _upright(n: int) -> Matrix:
    return np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
