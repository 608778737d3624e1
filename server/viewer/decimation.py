"""A surface that is light enough to move: fewer vertices, the same shape.

The bridge's own layers stay whole as long as they fit; ballast and rails have many more vertices
than their shape needs. Vertices are moved, for drawing only, to the nearest of some of the planes
on which the mesh lies, and those that meet there become one; sleepers become boxes. Corners,
joints and the point of the peak keep theirs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from solver.arrays import IntArray, IntVector, Matrix, Vector
from solver.results import Geometry, Layer

__all__ = ["MOST_VERTICES", "lightened", "snapped"]

MOST_VERTICES = 20_000
"""Drawn while the time runs."""

_TRACK = ("ballast", "sleepers", "rails")
_SPACINGS = ((0.3, 0.0), (0.6, 0.0), (0.6, 0.2), (0.6, 0.3), (0.9, 0.5), (1.5, 1.0), (3.0, 2.0))
"""Least distances between planes of the track and of the bridge, tried in this order. [m]"""
_BOX_VERTICES = 8


def lightened(
    geometry: Geometry,
    weights: dict[str, int],
    kept: Matrix,
    most: int = MOST_VERTICES,
) -> tuple[Layer, ...]:
    """The geometry's layers with at most so many vertices, if that can be.

    Args:
        geometry: The whole surface.
        weights: Vertices drawn for one of a layer, where that is not one.
        kept: Points whose vertices stay, shape (n, 3). [m]
        most: Vertices of all layers together.
    """

    def drawn(layers: Sequence[Layer]) -> int:
        return sum(weights.get(layer.name, 1) * len(np.unique(layer.faces)) for layer in layers)

    @cache
    def thinned(index: int, spacing: float) -> Layer:
        layer = geometry.layers[index]
        if layer.name == "sleepers":
            return replace(layer, faces=_boxes(layer.faces, geometry.vertices))
        return replace(layer, faces=snapped(layer.faces, geometry.vertices, spacing, kept))

    layers = geometry.layers
    for track, bridge in _SPACINGS:
        if drawn(layers) <= most:
            break
        spacings = [track if layer.name in _TRACK else bridge for layer in geometry.layers]
        layers = tuple(
            thinned(index, spacing) if spacing and len(geometry.layers[index].faces) else layer
            for index, (spacing, layer) in enumerate(zip(spacings, geometry.layers, strict=True))
        )
    return layers


@dataclass(frozen=True, kw_only=True)
class _Bodies:
    """Connected parts of a layer.

    Attributes:
        used: Its vertices, shape (n_used,).
        faces: Over these, shape (n_face, 4).
        label: The part of each used vertex, shape (n_used,).
    """

    used: IntVector
    faces: IntArray
    label: IntVector


def _bodies(faces: IntArray) -> _Bodies:
    used, compact = np.unique(faces, return_inverse=True)
    quads = compact.reshape(faces.shape)
    ends = np.roll(quads, -1, axis=1)
    n = len(used)
    links = sparse.coo_array((np.ones(quads.size), (quads.ravel(), ends.ravel())), shape=(n, n))
    _, label = connected_components(links, directed=False)
    return _Bodies(used=used, faces=quads, label=label)


def snapped(faces: IntArray, vertices: Matrix, spacing: float, kept: Matrix) -> IntArray:
    """Quadrilaterals between fewer planes of x and of y.

    Args:
        faces: Vertex indices, shape (n_face, 4).
        vertices: At rest, shape (n_vertex, 3). [m]
        spacing: Least distance between two planes. [m]
        kept: Points whose planes stay, shape (n, 3). [m]

    Returns:
        Vertex indices into the same vertices, shape (n_left, 4); triangles have two equal corners.
    """
    bodies = _bodies(np.asarray(faces, dtype=np.int64))
    at = vertices[bodies.used]
    moved = at.copy()
    for axis in (0, 1):
        for label in range(int(bodies.label.max(initial=-1)) + 1):
            own = bodies.label == label
            moved[own, axis] = _on_planes(at[own, axis], spacing, kept[:, axis])
    key = np.column_stack((bodies.label, np.round(moved / 1e-4))).astype(np.int64)
    _, group = np.unique(key, axis=0, return_inverse=True)
    nearest = _representatives(group.reshape(-1), np.linalg.norm(moved - at, axis=1))
    left = nearest[bodies.faces]
    return bodies.used[left[_areal(left)]]


def _on_planes(values: Vector, spacing: float, kept: Vector) -> Vector:
    """Each value's nearest plane: both ends, those kept, and as many others as may be."""
    planes = np.unique(np.round(values, 4))
    fixed = np.isin(planes, np.round(kept, 4))
    fixed[[0, -1]] = True
    chosen = [planes[0]]
    ahead = planes[fixed]
    for plane, stays in zip(planes[1:], fixed[1:], strict=True):
        following = ahead[np.searchsorted(ahead, plane)]
        roomy = plane - chosen[-1] >= spacing - 1e-9 and following - plane >= 0.5 * spacing
        if stays or roomy:
            chosen.append(plane)
    grid = np.array(chosen)
    after = np.clip(np.searchsorted(grid, values), 1, max(len(grid) - 1, 1))
    if len(grid) == 1:
        return np.full(len(values), grid[0])
    lower, upper = grid[after - 1], grid[after]
    return np.where(values - lower <= upper - values, lower, upper)


def _representatives(group: IntVector, distance: Vector) -> IntVector:
    """For each vertex the one of its group that moved least, shape (n_used,)."""
    order = np.lexsort((distance, group))
    first = np.unique(group[order], return_index=True)[1]
    return order[first][group]


def _areal(faces: IntArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Faces with at least three different corners."""
    ordered = np.sort(faces, axis=1)
    return np.count_nonzero(np.diff(ordered, axis=1), axis=1) >= 2


def _boxes(faces: IntArray, vertices: Matrix) -> IntArray:
    """Each connected part as the box of its eight outermost vertices."""
    if not len(faces):
        return faces
    bodies = _bodies(np.asarray(faces, dtype=np.int64))
    at = vertices[bodies.used]
    order = np.argsort(bodies.label, kind="stable")
    starts = np.unique(bodies.label[order], return_index=True)[1]
    boxes: list[IntArray] = []
    for own in np.split(order, starts[1:]):
        corners = _corners(at[own])
        if len(np.unique(corners)) < _BOX_VERTICES:
            mine = bodies.label[bodies.faces[:, 0]] == bodies.label[own[0]]
            boxes.append(bodies.used[bodies.faces[mine]])
        else:
            boxes.append(bodies.used[own[corners][_BOX_FACES]])
    return np.concatenate(boxes)


_BOX_FACES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)
"""Of corners numbered 4 x + 2 y + z, each 0 at the lower end."""


def _corners(points: Matrix) -> IntVector:
    """Indices of the points nearest to the corners of their bounding box, shape (8,)."""
    low, high = points.min(axis=0), points.max(axis=0)
    ends = np.stack(np.meshgrid(*zip(low, high, strict=True), indexing="ij"), axis=-1)
    far = np.linalg.norm(points[None, :, :] - ends.reshape(-1, 1, 3), axis=2)
    return np.argmin(far, axis=1)
