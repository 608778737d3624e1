"""What each element lets move freely: the motions that its stiffness must not resist.

Every element with a stiffness declares here which freedoms its nodes have and how many independent
rigid motions they can show. No element may have another motion of zero energy (a mechanism), nor
resist one of these: one set of tests checks every declaration.

The declarations are for the whole element: ``shell`` with its drilling penalty, ``spring_damper``
between two nodes with all six coefficients. Each coefficient of zero adds one free motion there,
and without the penalty each drilling rotation is one. Springs to ground, whose declaration would be
empty, and elements that are mass alone have none.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from solver.arrays import FloatArray

__all__ = ["NULL_SPACES", "SIX", "TRANSLATIONS", "NullSpace", "rigid_motions"]

TRANSLATIONS = (0, 1, 2)
"""Freedoms (u, v, w)."""
SIX = (0, 1, 2, 3, 4, 5)
"""Freedoms (u, v, w) and the rotations about x, y, z."""


def rigid_motions(coordinates: FloatArray, freedoms: tuple[int, ...] = SIX) -> FloatArray:
    """Small rigid motions of sets of nodes: three translations, three rotations about the origin.

    Args:
        coordinates: Nodes, shape (n_element, n_node, 3). [m]
        freedoms: The nodes' freedoms, by their places among the six.

    Returns:
        Shape (n_element, n_node n_freedom, 6). Some columns may depend on others, or be zero:
        two nodes without rotations do not show the turn about their line.
    """
    count, nodes, _ = coordinates.shape
    motions = np.zeros((count, nodes, 6, 6))
    motions[:, :, :3, :3] = np.eye(3)
    motions[:, :, 3:, 3:] = np.eye(3)
    for axis in range(3):
        motions[:, :, :3, 3 + axis] = np.cross(np.eye(3)[axis], coordinates)
    return motions[:, :, list(freedoms)].reshape(count, -1, 6)


@dataclass(frozen=True, kw_only=True)
class NullSpace:
    """The free motions that an element declares.

    Attributes:
        nodes: Number of nodes.
        freedoms: The nodes' freedoms, by their places among the six.
        dimension: Number of independent rigid motions of these freedoms.
    """

    nodes: int
    freedoms: tuple[int, ...]
    dimension: int

    def basis(self, coordinates: FloatArray) -> FloatArray:
        """Orthonormal basis of the free motions.

        Args:
            coordinates: Nodes, shape (n_element, n_node, 3). [m]

        Returns:
            Shape (n_element, n_node n_freedom, dimension).
        """
        # About the centre: rotations about a far origin would nearly be translations.
        centred = coordinates - coordinates.mean(axis=1, keepdims=True)
        motions = rigid_motions(centred, self.freedoms)
        return np.linalg.svd(motions, full_matrices=False)[0][:, :, : self.dimension]


NULL_SPACES: Mapping[str, NullSpace] = MappingProxyType(
    {
        "beam": NullSpace(nodes=2, freedoms=SIX, dimension=6),
        "truss": NullSpace(nodes=2, freedoms=TRANSLATIONS, dimension=5),
        "spring_damper": NullSpace(nodes=2, freedoms=SIX, dimension=6),
        "membrane": NullSpace(nodes=4, freedoms=(0, 1), dimension=3),
        "plate": NullSpace(nodes=4, freedoms=(2, 3, 4), dimension=3),
        "shell": NullSpace(nodes=4, freedoms=SIX, dimension=6),
        "solid": NullSpace(nodes=8, freedoms=TRANSLATIONS, dimension=6),
        "solid20": NullSpace(nodes=20, freedoms=TRANSLATIONS, dimension=6),
    }
)
"""The declarations, by the name of the element's module."""
