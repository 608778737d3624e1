"""Numbering of the freedoms that exist: six at a shell's node, three at a solid's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import IntArray, IntVector

__all__ = ["Freedoms", "number_freedoms"]


@dataclass(frozen=True, kw_only=True)
class Freedoms:
    """The freedoms of a mesh before constraints.

    Attributes:
        index: Freedom of each node and axis (u, v, w, rotations), -1 where there is none,
            shape (n_node, 6).
        count: Freedoms in all, the generalised ones at the end included.
        generalised: Freedoms that belong to no node, at the end of the numbering.
    """

    index: IntArray
    count: int
    generalised: IntVector

    def of_elements(self, connectivity: IntArray, axes: int) -> IntArray:
        """Freedoms of elements, node by node.

        Args:
            connectivity: Nodes, shape (n_element, n).
            axes: 3 for solids and edges, 6 for shells.

        Returns:
            Shape (n_element, axes n).
        """
        return self.index[connectivity, :axes].reshape(len(connectivity), -1)


def number_freedoms(axes_of_node: IntVector, generalised: int = 0) -> Freedoms:
    """Numbers the freedoms in the nodes' order.

    Args:
        axes_of_node: 3 or 6 for each node, shape (n_node,).
        generalised: How many freedoms without a node to append.

    Returns:
        The numbering.
    """
    exists = np.arange(6) < axes_of_node[:, None]
    index = np.full(exists.shape, -1, dtype=np.int64)
    count = int(np.count_nonzero(exists))
    index[exists] = np.arange(count)
    return Freedoms(
        index=index,
        count=count + generalised,
        generalised=np.arange(count, count + generalised),
    )
