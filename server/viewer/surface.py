"""Display surfaces: from layers of quadrilaterals to what a renderer takes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import FloatArray, IntArray, IntVector, Matrix
from solver.results import Layer

__all__ = ["BALLAST_SCALE", "BALLAST_SHIFT", "Surface", "feature_edges", "surface_of"]

BALLAST_SCALE = (1.0, 0.995, 1.0)
"""The ballast touches the walls, and would flicker through them as it is."""
BALLAST_SHIFT = (0.0, 0.0, 0.006)
"""As much it lies above what it touches below. [m]"""


@dataclass(frozen=True, kw_only=True)
class Surface:
    """One layer with its own, gapless numbering of vertices.

    Attributes:
        name: The layer's name.
        vertices: Indices into the geometry's vertices, shape (n_used,).
        offsets: Added to them at rest and deformed, shape (n_used, 3). [m]
        triangles: Indices into ``vertices``, shape (n_triangle, 3).
    """

    name: str
    vertices: IntVector
    offsets: Matrix
    triangles: IntArray

    def placed(self, vertices: Matrix) -> Matrix:
        """This layer's vertices among all of a picture, shape (n_used, 3). [m]"""
        own = vertices.take(self.vertices, axis=0)
        return own + self.offsets if self._shifted else own

    @cached_property
    def _shifted(self) -> bool:
        return bool(self.offsets.any())


def surface_of(layer: Layer) -> Surface:
    """Triangles of a layer over only the vertices that it uses.

    Quadrilaterals with two equal corners become one triangle.
    """
    faces = np.asarray(layer.faces, dtype=np.int64)
    used, compact = np.unique(faces, return_inverse=True)
    quads = compact.reshape(faces.shape)
    triangles = np.concatenate((quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]))
    a, b, c = triangles.T
    proper = (a != b) & (b != c) & (c != a)
    return Surface(
        name=layer.name,
        vertices=used,
        offsets=np.zeros((len(used), 3)),
        triangles=triangles[proper],
    )


def feature_edges(vertices: Matrix, faces: IntArray, sharpest: float = 0.9) -> FloatArray:
    """Edges that an engineer would draw: free edges, junctions of plates and sharp corners.

    Args:
        vertices: Shape (n_vertex, 3). [m]
        faces: Quadrilaterals, shape (n_face, 4).
        sharpest: An edge of two faces counts if the cosine between their normals is below this.

    Returns:
        Segments, shape (n_segment, 2, 3); straight chains are merged into one. [m]
    """
    faces = np.asarray(faces, dtype=np.int64)
    if len(faces) == 0:
        return np.empty((0, 2, 3))
    normals = _normals(vertices, faces)
    ends = np.sort(np.stack((faces, np.roll(faces, -1, axis=1)), axis=2), axis=2).reshape(-1, 2)
    owner = np.repeat(np.arange(len(faces)), 4)
    proper = ends[:, 0] != ends[:, 1]
    ends, owner = ends[proper], owner[proper]
    edges, index, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(index.reshape(-1), kind="stable")
    first = np.cumsum(count) - count
    one, other = owner[order[first]], owner[order[first + count - 1]]
    cosine = np.abs(np.sum(normals[one] * normals[other], axis=1))
    return _merged(vertices, edges[(count != 2) | (cosine < sharpest)])


def _normals(vertices: Matrix, faces: IntArray) -> Matrix:
    corners = vertices[faces]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return normal / np.where(length > 0.0, length, 1.0)


def _merged(vertices: Matrix, edges: IntArray) -> FloatArray:
    """Replaces collinear neighbours by one segment, which draws many times faster."""
    neighbours: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    segments: list[tuple[int, int]] = []
    seen: set[tuple[int, int]] = set()
    for a, b in edges.tolist():
        if (a, b) in seen:
            continue
        ends = (_walk(vertices, neighbours, a, b, seen), _walk(vertices, neighbours, b, a, seen))
        segments.append(ends)
    return vertices[np.array(segments, dtype=np.int64).reshape(-1, 2)]


def _walk(
    vertices: Matrix,
    neighbours: dict[int, list[int]],
    previous: int,
    current: int,
    seen: set[tuple[int, int]],
) -> int:
    """Follows a straight chain to its end and marks its edges as seen."""
    seen.add((min(previous, current), max(previous, current)))
    while True:
        along = vertices[current] - vertices[previous]
        along = along / np.linalg.norm(along)
        for candidate in neighbours[current]:
            onward = vertices[candidate] - vertices[current]
            length = float(np.linalg.norm(onward))
            edge = (min(current, candidate), max(current, candidate))
            if edge not in seen and float(along @ onward) > 0.9999 * length:
                seen.add(edge)
                previous, current = current, candidate
                break
        else:
            return current
