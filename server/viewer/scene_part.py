"""What the scene is made of: parts that are created once and then only moved."""

from __future__ import annotations

from typing import Literal, Protocol, TypeAlias

import numpy as np
import viser
from numpy.typing import NDArray

from server.viewer.palette import Colour
from server.viewer.picture import Picture
from server.viewer.shapes import Solid
from solver.arrays import FloatArray, Matrix

__all__ = ["Detail", "Nodes", "Part", "add_batch", "as_light", "coloured", "upright", "wire"]

Detail: TypeAlias = Literal["playing", "paused"]
"""``playing`` shows a surface that is light enough to move, ``paused`` all of it."""


class Part(Protocol):
    """Something that can be shown or hidden by its layer's name.

    Attributes:
        layer: What people call it.
    """

    layer: str

    def show(self, picture: Picture, detail: Detail) -> None:
        """Moves it to a moment."""
        ...

    def reveal(self, visible: bool) -> None:
        """Shows or hides it."""
        ...

    def remove(self) -> None:
        """Takes it off the server."""
        ...


class Nodes:
    """Scene nodes that are shown, hidden and removed together, and do not move by themselves.

    Args:
        layer: What people call them.
        nodes: The nodes.
    """

    def __init__(self, layer: str, *nodes: viser.SceneNodeHandle) -> None:
        self.layer = layer
        self._nodes = nodes

    def show(self, picture: Picture, detail: Detail) -> None:
        """Stands still."""

    def reveal(self, visible: bool) -> None:
        """Shows or hides them."""
        for node in self._nodes:
            node.visible = visible

    def remove(self) -> None:
        """Takes them off the server."""
        for node in self._nodes:
            node.remove()


def add_batch(
    server: viser.ViserServer,
    name: str,
    shape: Solid,
    positions: Matrix,
    orientations: Matrix,
    colours: NDArray[np.uint8],
    sizes: FloatArray | None = None,
    opacity: float | None = None,
) -> viser.BatchedMeshHandle:
    """Draws one shape many times.

    Args:
        server: The session's server.
        name: Of the scene node.
        shape: What is drawn.
        positions: Shape (n, 3). [m]
        orientations: Unit quaternions (w, x, y, z), shape (n, 4).
        colours: sRGB, shape (n, 3).
        sizes: Scales along x, y, z, shape (n, 3).
        opacity: None is opaque.
    """
    return server.scene.add_batched_meshes_simple(
        name,
        shape.vertices,
        shape.triangles,
        orientations,
        positions,
        batched_scales=sizes,
        batched_colors=as_light(colours),
        lod="off",
        flat_shading=True,
        opacity=opacity,
        cast_shadow=False,
        receive_shadow=False,
    )


def as_light(colours: NDArray[np.uint8] | FloatArray) -> NDArray[np.uint8]:
    """sRGB as the linear light that viser's page takes the colours of batches and lines for.

    Args:
        colours: Shape (n, 3).
    """
    value = colours / 255.0
    light = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return np.round(255.0 * light).astype(np.uint8)


def coloured(colour: Colour, n: int) -> NDArray[np.uint8]:
    """One colour for many, shape (n, 3)."""
    return np.tile(np.array(colour, dtype=np.uint8), (n, 1))


def upright(n: int) -> Matrix:
    """Quaternions of no rotation, shape (n, 4)."""
    return np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))


def wire(values: FloatArray) -> NDArray[np.float32]:
    """Values as they travel."""
    return values.astype(np.float32)
