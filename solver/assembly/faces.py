"""Outer faces of blocks of solids, for drawing."""

from __future__ import annotations

import numpy as np

from solver.arrays import IntArray

__all__ = ["outer_faces"]

_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def outer_faces(connectivity: IntArray) -> tuple[IntArray, IntArray]:
    """Faces that belong to one element only.

    Args:
        connectivity: Eight-node solids, shape (n_element, 8).

    Returns:
        Faces seen counter-clockwise from outside, shape (n_face, 4), and the element of each,
        shape (n_face,).
    """
    faces = connectivity[:, np.array(_FACES)].reshape(-1, 4)
    owner = np.repeat(np.arange(len(connectivity)), len(_FACES))
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    chosen = np.sort(first[count == 1])
    return faces[chosen], owner[chosen]
