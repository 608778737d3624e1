"""What a click hits: viser gives the ray, the surface that is shown gives the point."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import viser

from server.viewer.rail_profile import with_rail_section
from server.viewer.surface import Surface, surface_of
from solver.arrays import BoolVector, IntArray, IntVector, Matrix, Vector
from solver.results import Geometry, SlabPoints

__all__ = ["Marker", "Picked", "Picker", "Ray", "crossings", "displayed_surfaces"]

SLAB_REACH = 2.5
"""Farther from every slab point than this, seen from above, there is none to tell of. [m]"""
_MARKER = (213, 94, 0)
"""Vermilion of the Okabe-Ito set."""
_MARKER_VIEW = 0.006
"""Radius of the marker over its distance from the eye: some five pixels."""
_MARKER_RADII = (0.03, 0.6)


@dataclass(frozen=True, kw_only=True)
class Ray:
    """A half line from the eye through a pixel.

    Attributes:
        origin: Where the eye is, shape (3,). [m]
        direction: Of unit length, shape (3,).
        begin: What is nearer is cut away: the distance along the ray at which it begins. [m]
    """

    origin: Vector
    direction: Vector
    begin: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Picked:
    """A vertex of the surface that somebody pointed at.

    Attributes:
        sequence: How many clicks there were: a new one is a new number.
        layer: On which layer.
        point: The vertex at rest, (x, y, z). [m]
        slab_point: The nearest slab point, seen from above; None where none is near.
        vertex: Index among the picker's vertices.
        distance: From the eye. [m]
    """

    sequence: int
    layer: str
    point: tuple[float, float, float]
    slab_point: int | None
    vertex: int
    distance: float


class Picker:
    """Finds the vertex nearest to where a ray meets the surface of a run.

    Args:
        geometry: Of the run.
        slab: Its slab points.
    """

    def __init__(self, geometry: Geometry, slab: SlabPoints) -> None:
        surfaces = displayed_surfaces(geometry)
        self._names = [surface.name for surface in surfaces]
        counts = [len(surface.vertices) for surface in surfaces]
        self._begins: IntVector = np.cumsum([0, *counts])[:-1]
        self._vertices: IntVector = np.concatenate(
            [np.empty(0, dtype=np.int64), *(surface.vertices for surface in surfaces)]
        )
        self._offsets: Matrix = np.concatenate(
            [np.empty((0, 3)), *(surface.offsets for surface in surfaces)]
        )
        numbered = zip(surfaces, self._begins, strict=True)
        self._triangles: IntArray = np.concatenate(
            [
                np.empty((0, 3), dtype=np.int64),
                *(surface.triangles + begin for surface, begin in numbered),
            ]
        )
        self._owner: IntVector = np.repeat(
            np.arange(len(surfaces)), [len(surface.triangles) for surface in surfaces]
        )
        self._rest = geometry.vertices
        self._slab = slab.coordinates

    def position(self, vertex: int, vertices: Matrix) -> Vector:
        """Where a picked vertex is among displayed ones, shape (3,). [m]"""
        return vertices[self._vertices[vertex]] + self._offsets[vertex]

    def pick(
        self, ray: Ray, vertices: Matrix, layers: Collection[str], sequence: int
    ) -> Picked | None:
        """The vertex that a ray points at; None where it meets nothing.

        Args:
            ray: From the eye.
            vertices: As displayed, shape (n_vertex, 3). [m]
            layers: Names of what is visible.
            sequence: Of this click.
        """
        visible = np.isin(self._owner, [i for i, n in enumerate(self._names) if n in layers])
        index = np.nonzero(visible)[0]
        corners = (vertices[self._vertices] + self._offsets)[self._triangles[index]]
        distance = crossings(ray, corners)
        if not len(distance) or not np.isfinite(nearest := float(distance.min())):
            return None
        first = int(np.argmin(distance))
        point = ray.origin + nearest * ray.direction
        aside = np.linalg.norm(corners[first] - point, axis=1)
        vertex = int(self._triangles[index[first], int(np.argmin(aside))])
        return self._picked(vertex, nearest, sequence)

    def nearest(self, point: Vector, eye: Vector, sequence: int) -> Picked | None:
        """The vertex nearest to a place at rest; None where there is no surface.

        Args:
            point: The place, shape (3,). [m]
            eye: From where it is seen, shape (3,). [m]
            sequence: Of the last click.
        """
        if not len(self._vertices):
            return None
        rest = self._rest[self._vertices] + self._offsets
        vertex = int(np.argmin(np.linalg.norm(rest - point, axis=1)))
        return self._picked(vertex, float(np.linalg.norm(rest[vertex] - eye)), sequence)

    def _picked(self, vertex: int, distance: float, sequence: int) -> Picked:
        x, y, z = self.position(vertex, self._rest).tolist()
        layer = int(np.searchsorted(self._begins, vertex, side="right")) - 1
        return Picked(
            sequence=sequence,
            layer=self._names[layer],
            point=(x, y, z),
            slab_point=self._nearest_slab_point(x, y),
            vertex=vertex,
            distance=distance,
        )

    def _nearest_slab_point(self, x: float, y: float) -> int | None:
        if not len(self._slab):
            return None
        away = np.hypot(self._slab[:, 0] - x, self._slab[:, 1] - y)
        nearest = int(np.argmin(away))
        return nearest if away[nearest] <= SLAB_REACH else None


class Marker:
    """A small ball on the picked vertex; all clients see it.

    Args:
        server: Whose scene it is part of.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._ball: viser.IcosphereHandle | None = None

    def show(self, picked: Picked | None, position: Vector | None, *, fresh: bool) -> None:
        """Puts the marker on the picked vertex, or takes it away.

        Args:
            picked: The vertex, or None.
            position: Where it is displayed, None to hide the marker.
            fresh: Whether the vertex is another than before.
        """
        if picked is None or position is None:
            self.remove()
            return
        if self._ball is None or fresh:
            self.remove()
            self._ball = self._server.scene.add_icosphere(
                "/picked",
                radius=float(np.clip(_MARKER_VIEW * picked.distance, *_MARKER_RADII)),
                color=_MARKER,
                position=position,
                cast_shadow=False,
                receive_shadow=False,
            )
            return
        self._ball.position = position

    def remove(self) -> None:
        """Takes the marker away."""
        if self._ball is not None:
            self._ball.remove()
            self._ball = None


def crossings(ray: Ray, corners: Matrix) -> Vector:
    """Distances at which a ray meets triangles, from either side.

    Args:
        ray: The ray.
        corners: Shape (n_triangle, 3, 3). [m]

    Returns:
        Shape (n_triangle,), infinite where the ray passes by. [m]

    References:
        Moller and Trumbore (1997), Fast, minimum storage ray/triangle intersection.
    """
    first = corners[:, 0]
    edge_1, edge_2 = corners[:, 1] - first, corners[:, 2] - first
    h = np.cross(ray.direction, edge_2)
    determinant = np.einsum("ij,ij->i", edge_1, h)
    level: BoolVector = np.abs(determinant) < 1e-14
    inverse = 1.0 / np.where(level, 1.0, determinant)
    s = ray.origin - first
    u = inverse * np.einsum("ij,ij->i", s, h)
    q = np.cross(s, edge_1)
    v = inverse * (q @ ray.direction)
    distance = inverse * np.einsum("ij,ij->i", edge_2, q)
    # A hair beyond the edges, so that no ray slips through between two triangles.
    slack = 1e-9
    hit = ~level & (u >= -slack) & (v >= -slack) & (u + v <= 1.0 + slack)
    return np.where(hit & (distance > ray.begin), distance, np.inf)


def displayed_surfaces(geometry: Geometry) -> list[Surface]:
    """All layers as they are shown: rails have a section though a run stores only their heads."""
    surfaces = [surface_of(layer) for layer in geometry.layers if len(layer.faces)]
    return [
        with_rail_section(surface, geometry.vertices) if surface.name == "rails" else surface
        for surface in surfaces
    ]
