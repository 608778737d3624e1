"""One colour an element: what is shown where a browser cannot colour vertices."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from server.viewer.scene_part import as_light, upright, wire
from solver.arrays import FloatArray, Matrix
from solver.results import Layer

__all__ = ["ELEMENTS", "Elements", "element_poses"]

ELEMENTS = "-elements"
"""After a layer's name, that of its elements."""

_SQUARE = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]])
_TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


class Elements:
    """The elements of a layer as squares that are stretched, turned and coloured."""

    def __init__(self, server: viser.ViserServer, layer: Layer) -> None:
        _, compact = np.unique(layer.faces, return_inverse=True)
        self._faces = np.asarray(layer.faces, dtype=np.int64)
        self._rows = compact.reshape(layer.faces.shape)
        n = len(self._faces)
        self.node = server.scene.add_batched_meshes_simple(
            f"/{layer.name}{ELEMENTS}",
            _SQUARE,
            _TRIANGLES,
            upright(n),
            np.zeros((n, 3)),
            batched_scales=np.ones((n, 3)),
            batched_colors=np.zeros((n, 3), dtype=np.uint8),
            lod="off",
            flat_shading=True,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )

    def show(self, vertices: Matrix, colours: NDArray[np.uint8]) -> None:
        """Moves and colours them.

        Args:
            vertices: Of the whole picture, shape (n_vertex, 3). [m]
            colours: Of the layer's own vertices, shape (n_used, 3).
        """
        centres, orientations, sizes = element_poses(vertices[self._faces])
        self.node.batched_positions = wire(centres)
        self.node.batched_wxyzs = wire(orientations)
        self.node.batched_scales = wire(sizes)
        self.node.batched_colors = as_light(colours[self._rows].mean(axis=1))


def element_poses(corners: FloatArray) -> tuple[Matrix, Matrix, Matrix]:
    """Squares that cover quadrilaterals best.

    Args:
        corners: Shape (n, 4, 3). [m]

    Returns:
        Centres (n, 3) [m], unit quaternions (w, x, y, z) that turn x along the first edge and z
        to the normal, shape (n, 4), and sizes along x, y, z, shape (n, 3). [m]
    """
    ahead = (corners[:, 1] + corners[:, 2] - corners[:, 0] - corners[:, 3]) / 2.0
    aside = (corners[:, 3] + corners[:, 2] - corners[:, 0] - corners[:, 1]) / 2.0
    x = _unit(ahead)
    z = _unit(np.cross(ahead, aside))
    sizes = np.column_stack(
        (
            np.linalg.norm(ahead, axis=1),
            np.linalg.norm(aside, axis=1),
            np.ones(len(corners)),
        )
    )
    return corners.mean(axis=1), _quaternions(x, np.cross(z, x), z), sizes


def _unit(vectors: Matrix) -> Matrix:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0.0, length, 1.0)


def _quaternions(x: Matrix, y: Matrix, z: Matrix) -> Matrix:
    """Of right-handed frames, by the largest of w, x, y, z (Shepperd 1978)."""
    trace = x[:, 0] + y[:, 1] + z[:, 2]
    w2 = np.column_stack((trace, x[:, 0], y[:, 1], z[:, 2]))
    symmetric = np.column_stack((x[:, 1] + y[:, 0], z[:, 0] + x[:, 2], y[:, 2] + z[:, 1]))
    skew = np.column_stack((y[:, 2] - z[:, 1], z[:, 0] - x[:, 2], x[:, 1] - y[:, 0]))
    xy, zx, yz = symmetric.T
    rows = np.stack(
        (
            np.column_stack((1.0 + trace, skew)),
            np.column_stack((skew[:, 0], 1.0 + 2.0 * x[:, 0] - trace, xy, zx)),
            np.column_stack((skew[:, 1], xy, 1.0 + 2.0 * y[:, 1] - trace, yz)),
            np.column_stack((skew[:, 2], zx, yz, 1.0 + 2.0 * z[:, 2] - trace)),
        ),
        axis=1,
    )
    return _unit(rows[np.arange(len(x)), np.argmax(w2, axis=1)])
