"""The scene as loose triangles and lines, for pictures that no browser draws."""

from __future__ import annotations

import numpy as np

from server.viewer.camera import View
from server.viewer.palette import Colour, Palette, Theme, palette
from server.viewer.picking import displayed_surfaces
from server.viewer.picture import Picture
from server.viewer.raster import Lines, Mesh, section_lines
from server.viewer.scene_setting import OUTLINED
from server.viewer.scene_train import CARBODY_OPACITY
from server.viewer.scenery import piers, rigid_rails
from server.viewer.shapes import Solid, axle, bogie_frame, carbody, unit_box, wheel
from server.viewer.surface import BALLAST_SCALE, BALLAST_SHIFT, feature_edges
from solver.arrays import FloatArray, Matrix, Vector
from solver.results import Geometry

__all__ = ["drawn_lines", "drawn_meshes"]

_COLOURED_RELIEF = 0.5
"""Coloured surfaces are hardly shaded, so that their colours are those of the bar."""
_CROSS_ABOVE, _CROSS_HALF = 0.45, 0.22
"""Height over the wheel's foot and half the size of the mark of a lost contact. [m]"""
_ARROW_HEAD = 0.16
"""Length of an arrow's head. [m]"""


def drawn_meshes(geometry: Geometry, picture: Picture, theme: Theme) -> tuple[Mesh, ...]:
    """Everything that has faces.

    Args:
        geometry: Of the run.
        picture: The moment.
        theme: Of the palette.
    """
    paints = palette(theme)
    meshes = [*_surfaces(geometry, picture, paints), *_piers(geometry, paints)]
    meshes += _wheels(geometry, picture, paints) + _bodies(geometry, picture, paints)
    return tuple(meshes)


def drawn_lines(
    geometry: Geometry, picture: Picture, theme: Theme, view: View, section: bool
) -> tuple[Lines, ...]:
    """The undeformed outline, the forces and, where there is a cut, what it cuts.

    Args:
        geometry: Of the run.
        picture: The moment.
        theme: Of the palette.
        view: The camera, whose clipping plane cuts.
        section: Whether the cut is what the picture is about.
    """
    paints = palette(theme)
    faces = [layer.faces for layer in geometry.layers if layer.name in OUTLINED]
    lines: list[Lines] = []
    if faces:
        edges = feature_edges(geometry.vertices, np.concatenate(faces))
        lines.append(Lines(ends=edges, colour=_paint(paints.outline)))
    if section:
        for surface in displayed_surfaces(geometry):
            corners = surface.placed(picture.vertices)[surface.triangles]
            dark = 0.55 * _paint(paints.layer(surface.name)) + (0.3 if theme == "dark" else 0.0)
            lines.append(Lines(ends=section_lines(view, corners), colour=dark, width=2.6))
    return (*lines, *_rigid_rails(geometry, picture, paints), *_forces(picture, paints))


def _surfaces(geometry: Geometry, picture: Picture, paints: Palette) -> list[Mesh]:
    meshes: list[Mesh] = []
    for surface in displayed_surfaces(geometry):
        corners = surface.placed(picture.vertices)[surface.triangles]
        if surface.name == "ballast":
            corners = corners * np.array(BALLAST_SCALE) + np.array(BALLAST_SHIFT)
        chosen = picture.colours.get(surface.name)
        if chosen is None:
            meshes.append(_plain(corners, paints.layer(surface.name)))
            continue
        # A rail's section repeats its ribbon's vertices, in their order.
        every = np.tile(chosen, (len(surface.vertices) // len(chosen), 1)) / 255.0
        meshes.append(
            Mesh(corners=corners, colours=every[surface.triangles], relief=_COLOURED_RELIEF)
        )
    return meshes


def _piers(geometry: Geometry, paints: Palette) -> list[Mesh]:
    centres, sizes = piers(geometry)
    return [_plain(_placed(unit_box(), centres, None, sizes), paints.support)]


def _wheels(geometry: Geometry, picture: Picture, paints: Palette) -> list[Mesh]:
    if not len(picture.wheels):
        return []
    # The shape's flange is at y < 0, the inner side of a left wheel: right ones are mirrored.
    mirrored = np.where(geometry.wheels.lateral < 0.0, -1.0, 1.0)
    sizes = np.column_stack((np.ones(len(mirrored)), mirrored, np.ones(len(mirrored))))
    solid = wheel(geometry.wheels.radius, segments=18)
    corners = _placed(solid, picture.wheels, None, sizes)
    rims = np.array([_paint(paints.wheel), _paint(paints.lost)])[picture.lost.astype(int)]
    colours = np.repeat(rims, len(solid.triangles), axis=0)
    meshes = [Mesh(corners=corners, colours=np.repeat(colours[:, None], 3, axis=1))]
    centres, turned, lengths = picture.axles
    if len(centres):
        sizes = np.column_stack((np.ones(len(lengths)), lengths, np.ones(len(lengths))))
        meshes.append(_plain(_placed(axle(0.08), centres, turned, sizes), paints.axle))
    return meshes


def _bodies(geometry: Geometry, picture: Picture, paints: Palette) -> list[Mesh]:
    meshes: list[Mesh] = []
    for kind, solid, colour, opacity in (
        ("bogie", bogie_frame(), paints.bogie, 1.0),
        ("carbody", carbody(), paints.carbody, CARBODY_OPACITY),
    ):
        index = [i for i, body in enumerate(geometry.bodies) if body.kind == kind]
        if index:
            sizes = np.array([geometry.bodies[i].size for i in index])
            centres, turned = picture.body_centres[index], picture.body_orientations[index]
            corners = _placed(solid, centres, turned, sizes)
            meshes.append(_plain(corners, colour, opacity))
    return meshes


def _placed(solid: Solid, centres: Matrix, turned: Matrix | None, sizes: Matrix) -> FloatArray:
    """Triangles of many equal solids, shape (n_solid n_triangle, 3, 3). [m]"""
    points = solid.vertices[None] * sizes[:, None]
    if turned is not None:
        points = np.einsum("nij,nkj->nki", _rotations(turned), points)
    points = points + centres[:, None]
    return points[:, solid.triangles].reshape(-1, 3, 3)


def _rotations(quaternions: Matrix) -> FloatArray:
    """Rotation matrices of unit quaternions (w, x, y, z), shape (n, 3, 3)."""
    w, x, y, z = quaternions.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _rigid_rails(geometry: Geometry, picture: Picture, paints: Palette) -> list[Lines]:
    ends = rigid_rails(geometry, picture.first_axle)
    return [Lines(ends=ends, colour=_paint(paints.layer("rails")), width=1.6)]


def _forces(picture: Picture, paints: Palette) -> list[Lines]:
    """Arrows of contact forces, crosses where contact is lost; modes have neither."""
    if not len(picture.arrows):
        return []
    felt = picture.arrows[~picture.lost]
    crosses = _crosses(picture.arrows[picture.lost, 1])
    return [
        Lines(ends=_arrows(felt), colour=_paint(paints.force), width=2.0),
        Lines(ends=crosses, colour=_paint(paints.lost), width=2.6),
    ]


def _arrows(arrows: FloatArray) -> FloatArray:
    """Shafts and two barbs at each head, shape (3 n, 2, 3). [m]"""
    head = arrows[:, 1]
    barbs = [head + np.array([side * 0.5 * _ARROW_HEAD, 0.0, _ARROW_HEAD]) for side in (-1, 1)]
    return np.concatenate([arrows, *(np.stack((barb, head), axis=1) for barb in barbs)])


def _crosses(feet: Matrix) -> FloatArray:
    """Marks of lost contacts, so that colour is not the only sign, shape (2 n, 2, 3). [m]"""
    centres = feet + np.array([0.0, 0.0, _CROSS_ABOVE])
    arms = [np.array([_CROSS_HALF, 0.0, side * _CROSS_HALF]) for side in (-1.0, 1.0)]
    return np.concatenate([np.stack((centres - arm, centres + arm), axis=1) for arm in arms])


def _plain(corners: FloatArray, colour: Colour, opacity: float = 1.0) -> Mesh:
    colours = np.broadcast_to(_paint(colour), corners.shape)
    return Mesh(corners=corners, colours=colours, opacity=opacity)


def _paint(colour: Colour) -> Vector:
    return np.array(colour) / 255.0
