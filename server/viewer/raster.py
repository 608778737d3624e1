"""A small software renderer: triangles and lines through a camera into pixels, with a depth buffer.

All of it is arrays over triangles or pixels. It needs no graphics card, so that stills can be
drawn where the browser offers no WebGL, and in reports.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from server.viewer.camera import View
from solver.arrays import FloatArray, IntVector, Matrix, Vector

__all__ = ["Lines", "Mesh", "rendered", "section_lines"]

_OVERSAMPLED = 2
"""Pixels drawn for one that is shown, along each side: smooths edges."""
_BLOCK = 3_000_000
"""Pixels tried at once: bounds the memory to some 150 MB."""
_LIFT = 1.0 + 1.5e-3
"""Lines lie on surfaces and must not sink into them: drawn this much nearer."""
_LAMPS = (((-0.3, -0.6, 0.8), 0.55), ((0.6, 0.4, 0.3), 0.25))
"""Directions from which light comes, and how much."""
_FROM_EVERYWHERE = 0.46


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """Triangles, each with its own corners.

    Attributes:
        corners: Shape (n_triangle, 3, 3). [m]
        colours: Of the corners, 0 to 1, shape (n_triangle, 3, 3).
        relief: How much shading darkens: 0 leaves the colours as they are, 1 does what light does.
        opacity: 1 hides what is behind.
    """

    corners: FloatArray
    colours: FloatArray
    relief: float = 1.0
    opacity: float = 1.0


@dataclass(frozen=True, kw_only=True)
class Lines:
    """Segments of one colour.

    Attributes:
        ends: Shape (n_segment, 2, 3). [m]
        colour: 0 to 1, shape (3,).
        width: In shown pixels.
    """

    ends: FloatArray
    colour: Vector
    width: float = 1.2


@dataclass(frozen=True, kw_only=True)
class _Eye:
    """A camera as numbers: view axes in rows, and pixels over tangents."""

    position: Vector
    axes: Matrix
    focus: float
    near: float
    width: int
    height: int

    def seen(self, points: FloatArray) -> FloatArray:
        """Right, down and forward of the eye, shape as of the points. [m]"""
        return (points - self.position) @ self.axes.T

    def placed(self, seen: FloatArray) -> FloatArray:
        """Pixels to the right and downwards, and one over the depth."""
        nearness = 1.0 / seen[..., 2:]
        centre = np.array([self.width / 2.0, self.height / 2.0])
        return np.concatenate((centre + self.focus * seen[..., :2] * nearness, nearness), axis=-1)


def rendered(
    view: View,
    meshes: tuple[Mesh, ...],
    lines: tuple[Lines, ...],
    background: Vector,
    size: tuple[int, int],
) -> NDArray[np.uint8]:
    """A picture.

    Args:
        view: The camera.
        meshes: Opaque ones hide each other by their depth; others are laid over them in order.
        lines: Hidden by what is nearer.
        background: Colour, 0 to 1, shape (3,).
        size: Width and height. [pixel]

    Returns:
        Shape (height, width, 3).
    """
    eye = _eye(view, size)
    image = np.tile(background, (eye.height * eye.width, 1))
    nearness = np.zeros(eye.height * eye.width)
    opaque = [_projected(eye, mesh) for mesh in meshes if mesh.opacity >= 1.0]
    opaque += [_stroked(eye, line) for line in lines]
    _paint(eye, *_joined(opaque), nearness, image, 1.0)
    for mesh in meshes:
        if mesh.opacity < 1.0:
            _paint(eye, *_projected(eye, mesh), nearness.copy(), image, mesh.opacity)
    k = _OVERSAMPLED
    blocks = image.reshape(eye.height // k, k, eye.width // k, k, 3)
    return np.rint(255.0 * np.clip(blocks.mean(axis=(1, 3)), 0.0, 1.0)).astype(np.uint8)


def section_lines(view: View, corners: FloatArray) -> FloatArray:
    """Where the clipping plane of a view cuts triangles, shape (n_segment, 2, 3). [m]"""
    axes = _axes(view)
    depth = (corners - view.position) @ axes[2] - view.near
    below = depth < 0.0
    cut = below.any(axis=1) & ~below.all(axis=1)
    corners, depth = corners[cut], depth[cut]
    lone = _lone(depth < 0.0)
    corners, depth = _rolled(corners, lone), _rolled(depth, lone)
    # A hair behind the plane, or clipping takes the lines away too.
    return np.stack([_between(corners, depth, 0, j) for j in (1, 2)], axis=1) + 1e-4 * axes[2]


def _eye(view: View, size: tuple[int, int]) -> _Eye:
    width, height = (_OVERSAMPLED * side for side in size)
    return _Eye(
        position=view.position,
        axes=_axes(view),
        focus=height / (2.0 * float(np.tan(view.field / 2.0))),
        near=view.near,
        width=width,
        height=height,
    )


def _axes(view: View) -> Matrix:
    """Right, down and forward, in rows."""
    forward = view.target - view.position
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right = right / np.linalg.norm(right)
    return np.array([right, np.cross(forward, right), forward])


_Drawn = tuple[FloatArray, FloatArray]
"""Corners in pixels and nearness, shape (n, 3, 3), and their colours, shape (n, 3, 3)."""


def _projected(eye: _Eye, mesh: Mesh) -> _Drawn:
    light = 1.0 - mesh.relief * (1.0 - _light(mesh.corners))
    colours = mesh.colours * light[:, None, None]
    seen, colours = _clipped(eye.seen(mesh.corners), colours, eye.near)
    return eye.placed(seen), colours


def _light(corners: FloatArray) -> Vector:
    """How bright each triangle is, from either side, up to about 1."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = normal / np.where(length > 0.0, length, 1.0)
    bright = np.full(len(corners), _FROM_EVERYWHERE)
    for direction, strength in _LAMPS:
        lamp = np.array(direction) / np.linalg.norm(direction)
        bright += strength * np.abs(normal @ lamp)
    return np.minimum(bright, 1.0)


def _clipped(seen: FloatArray, colours: FloatArray, near: float) -> _Drawn:
    """Cuts away what is nearer than the clipping plane: one triangle leaves none, one or two."""
    depth = seen[:, :, 2] - near
    behind = depth < 0.0
    count = behind.sum(axis=1)
    whole, cut = count == 0, (count == 1) | (count == 2)
    parts, paints = [seen[whole]], [colours[whole]]
    lone = _lone(behind[cut])
    corners, depth = _rolled(seen[cut], lone), _rolled(depth[cut], lone)
    paint = _rolled(colours[cut], lone)
    one, two = (_between(corners, depth, 0, j) for j in (1, 2))
    colour_one, colour_two = (_between(paint, depth, 0, j) for j in (1, 2))
    tip = depth[:, 0] > 0.0
    for values, ends, kept in (
        (corners, (one, two), parts),
        (paint, (colour_one, colour_two), paints),
    ):
        kept.append(np.stack((values[:, 0], ends[0], ends[1]), axis=1)[tip])
        kept.append(np.stack((ends[0], values[:, 1], values[:, 2]), axis=1)[~tip])
        kept.append(np.stack((ends[0], values[:, 2], ends[1]), axis=1)[~tip])
    return np.concatenate(parts), np.concatenate(paints)


def _lone(behind: NDArray[np.bool_]) -> IntVector:
    """The corner that is alone on its side of the plane, shape (n,)."""
    few = behind.sum(axis=1) == 1
    return np.argmax(np.where(few[:, None], behind, ~behind), axis=1)


def _rolled(values: FloatArray, first: IntVector) -> FloatArray:
    """Triangles whose corners begin at another one."""
    order = (first[:, None] + np.arange(3)) % 3
    return values[np.arange(len(values))[:, None], order]


def _between(corners: FloatArray, depth: Matrix, i: int, j: int) -> FloatArray:
    """Where the edge from i to j crosses the plane of depth zero."""
    part = depth[:, i] / (depth[:, i] - depth[:, j])
    return corners[:, i] + part[:, None] * (corners[:, j] - corners[:, i])


def _stroked(eye: _Eye, lines: Lines) -> _Drawn:
    """Segments as flat strips in the picture, two triangles each."""
    seen = eye.seen(lines.ends)
    depth = seen[:, :, 2] - eye.near
    seen = seen[(depth > 0.0).any(axis=1)]
    depth = seen[:, :, 2] - eye.near
    for i, j in ((0, 1), (1, 0)):
        cut = depth[:, i] < 0.0
        seen[cut, i] = _between(seen[cut], depth[cut], i, j)
    placed = eye.placed(seen)
    placed[:, :, 2] *= _LIFT
    along = placed[:, 1, :2] - placed[:, 0, :2]
    length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    half = 0.5 * _OVERSAMPLED * lines.width
    aside = half * np.column_stack((-along[:, 1], along[:, 0])) / length
    wide = np.column_stack((aside, np.zeros(len(aside))))
    a, b, c, d = placed[:, 0] + wide, placed[:, 0] - wide, placed[:, 1] - wide, placed[:, 1] + wide
    strips = np.concatenate((np.stack((a, b, c), axis=1), np.stack((a, c, d), axis=1)))
    return strips, np.broadcast_to(lines.colour, strips.shape)


def _joined(drawn: list[_Drawn]) -> _Drawn:
    none = np.empty((0, 3, 3))
    return (
        np.concatenate([none, *(corners for corners, _ in drawn)]),
        np.concatenate([none, *(colours for _, colours in drawn)]),
    )


def _paint(
    eye: _Eye,
    corners: FloatArray,
    colours: FloatArray,
    nearness: Vector,
    image: Matrix,
    opacity: float,
) -> None:
    """Draws triangles where they are nearer than what is there.

    Args:
        eye: The camera.
        corners: In pixels and nearness, shape (n, 3, 3).
        colours: Of the corners, shape (n, 3, 3).
        nearness: Of every pixel; written.
        image: Colour of every pixel, shape (n_pixel, 3); written.
        opacity: 1 replaces what is there.
    """
    owner = np.full(len(nearness), -1, dtype=np.int64)
    for pixel, triangle, near in _covered(eye, corners):
        np.maximum.at(nearness, pixel, near)
        won = near == nearness[pixel]
        owner[pixel[won]] = triangle[won]
    drawn = np.nonzero(owner >= 0)[0]
    triangle = owner[drawn]
    weights = _weights(corners[triangle], drawn % eye.width + 0.5, drawn // eye.width + 0.5)
    colour = np.einsum("ij,ijk->ik", weights, colours[triangle])
    image[drawn] += opacity * (colour - image[drawn])


def _covered(eye: _Eye, corners: FloatArray) -> Iterator[tuple[IntVector, IntVector, Vector]]:
    """Pixels whose centres lie in triangles, with their triangle and nearness, in blocks."""
    row, triangle, low, high = _spans(eye, corners)
    length = np.maximum(high - low, 0)
    index = np.nonzero(length)[0]
    block = np.cumsum(length[index]) // _BLOCK
    slopes = _slopes(corners)
    for part in np.split(index, np.nonzero(np.diff(block))[0] + 1):
        run = length[part]
        x = np.arange(int(run.sum())) - np.repeat(np.cumsum(run) - run - low[part], run)
        y, owner = np.repeat(row[part], run), np.repeat(triangle[part], run)
        yield y * eye.width + x, owner, _nearness(corners, slopes, owner, x + 0.5, y + 0.5)


def _spans(eye: _Eye, corners: FloatArray) -> tuple[IntVector, IntVector, IntVector, IntVector]:
    """Rows of pixels in triangles: row, triangle, first pixel, one beyond the last.

    A centre on an edge belongs to one of the two triangles: nothing is drawn twice or left out.
    """
    first = _border(corners[:, :, 1].min(axis=1), eye.height)
    count = np.maximum(_border(corners[:, :, 1].max(axis=1), eye.height) - first, 0)
    triangle = np.repeat(np.arange(len(corners)), count)
    row = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count - first, count)
    y = row + 0.5
    low, high = np.full(len(row), np.inf), np.full(len(row), -np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        (ax, ay), (bx, by) = corners[triangle, i, :2].T, corners[triangle, j, :2].T
        crosses = (ay <= y) != (by <= y)
        x = ax + (y - ay) * (bx - ax) / np.where(crosses, by - ay, 1.0)
        low = np.where(crosses, np.minimum(low, x), low)
        high = np.where(crosses, np.maximum(high, x), high)
    return row, triangle, _border(low, eye.width), _border(high, eye.width)


def _border(value: Vector, last: int) -> IntVector:
    """The first pixel whose centre is at or beyond a value, within the picture."""
    return np.clip(np.ceil(value - 0.5), 0, last).astype(np.int64)


def _slopes(corners: FloatArray) -> Matrix:
    """Change of the nearness over a pixel to the right and downwards, shape (n_triangle, 2)."""
    (ax, ay, az), (bx, by, bz) = (
        (corners[:, 1] - corners[:, 0]).T,
        (corners[:, 2] - corners[:, 0]).T,
    )
    double = ax * by - bx * ay
    scale = 1.0 / np.where(np.abs(double) < 1e-12, np.inf, double)
    return np.column_stack(((az * by - bz * ay) * scale, (ax * bz - bx * az) * scale))


def _nearness(
    corners: FloatArray, slopes: Matrix, owner: IntVector, x: Vector, y: Vector
) -> Vector:
    """One over the depth of pixels of triangles; slivers do not go beyond their corners."""
    begin, corner = corners[:, 0], corners[:, :, 2]
    base = begin[:, 2] - slopes[:, 0] * begin[:, 0] - slopes[:, 1] * begin[:, 1]
    near = base[owner] + slopes[owner, 0] * x + slopes[owner, 1] * y
    return np.clip(near, corner.min(axis=1)[owner], corner.max(axis=1)[owner])


def _weights(corners: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
    """Barycentric coordinates of points in triangles of the picture, shape (n, 3)."""
    (ax, ay), (bx, by), (cx, cy) = (corners[:, i, :2].T for i in range(3))
    double = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    scale = 1.0 / np.where(np.abs(double) < 1e-12, np.inf, double)
    b = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) * scale
    c = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) * scale
    return np.clip(np.column_stack((1.0 - b - c, b, c)), 0.0, 1.0)
