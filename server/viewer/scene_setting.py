"""What does not move: light, the outline at rest, supports."""

from __future__ import annotations

import numpy as np
import viser

from server.viewer.palette import Theme, palette
from server.viewer.scene_part import Nodes, add_batch, as_light, coloured, upright
from server.viewer.scenery import piers, rigid_rails
from server.viewer.shapes import unit_box
from server.viewer.surface import feature_edges
from solver.results import Geometry

__all__ = ["OUTLINED", "add_outline", "add_rigid_rails", "add_supports", "configure", "light"]

OUTLINED = ("slab", "beam", "walls", "deck")
"""Layers whose undeformed edges are drawn."""

_RAIL = (0.072, 0.172)
"""Width of the head and height of a rail 60E1. [m]"""


def configure(server: viser.ViserServer, theme: Theme) -> None:
    """A bare page without viser's own controls."""
    server.gui.configure_theme(
        dark_mode=theme == "dark", show_logo=False, show_share_button=False, control_width="small"
    )
    server.gui.main_panel.minimize()
    server.scene.world_axes.visible = False


def light(server: viser.ViserServer) -> None:
    """An even sky and two lamps, under which an upward face shows just about its own colour.

    They are the same in both themes, so that colours match their bar in both. Image-based lighting
    costs a software renderer half its frames.
    """
    scene = server.scene
    scene.configure_environment_map(None)
    scene.configure_default_lights(enabled=False)
    scene.add_light_hemisphere(
        "/lights/sky",
        sky_color=(255, 255, 255),
        ground_color=(206, 210, 216),
        intensity=1.5,
    )
    for name, place, strength in (("key", (-30, -60, 80), 2.25), ("fill", (60, 40, 30), 0.7)):
        scene.add_light_directional(
            f"/lights/{name}", position=place, intensity=strength, cast_shadow=False
        )


def add_outline(server: viser.ViserServer, geometry: Geometry, theme: Theme) -> Nodes | None:
    """Edges of the undeformed bridge."""
    faces = [layer.faces for layer in geometry.layers if layer.name in OUTLINED]
    if not sum(map(len, faces)):
        return None
    handle = server.scene.add_line_segments(
        "/outline",
        feature_edges(geometry.vertices, np.concatenate(faces)),
        as_light(np.array(palette(theme).outline, dtype=np.uint8)),
        thickness=1.5,
        thickness_units="screen",
    )
    return Nodes("outline", handle)


def add_supports(server: viser.ViserServer, geometry: Geometry, theme: Theme) -> Nodes | None:
    """Piers, for the eye only, under the ends of the spans."""
    centres, sizes = piers(geometry)
    n = len(centres)
    if not n:
        return None
    colours = coloured(palette(theme).support, n)
    handle = add_batch(server, "/supports", unit_box(), centres, upright(n), colours, sizes)
    return Nodes("supports", handle)


def add_rigid_rails(
    server: viser.ViserServer, geometry: Geometry, first_axle: float, theme: Theme
) -> Nodes | None:
    """Rails before and behind what is modelled, or below a train that stands alone.

    Args:
        server: The session's server.
        geometry: The run's geometry.
        first_axle: x of the first axle. [m]
        theme: Of the page around the view.
    """
    ends = rigid_rails(geometry, first_axle)
    n = len(ends)
    if not n:
        return None
    width, height = _RAIL
    centres = ends.mean(axis=1) - np.array([0.0, 0.0, height / 2.0])
    lengths = ends[:, 1, 0] - ends[:, 0, 0]
    sizes = np.column_stack((lengths, np.full(n, width), np.full(n, height)))
    colours = coloured(palette(theme).layer("rails"), n)
    handle = add_batch(server, "/rigid-rails", unit_box(), centres, upright(n), colours, sizes)
    return Nodes("rails", handle)
