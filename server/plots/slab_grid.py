"""The slab's points as the grid that a map draws."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import BoolVector, IntVector, Matrix, Vector
from solver.results import SlabPoints

__all__ = ["SlabGrid", "greatest_index"]

_SAME = 1e-6
"""Points nearer than this to one another lie on one line of the grid. [m]"""


@dataclass(frozen=True, kw_only=True)
class SlabGrid:
    """Lines across and along the slab, and what lies where they meet.

    Attributes:
        x: Of the lines across the slab, ascending, shape (n_x,). [m]
        y: Of the lines along it, ascending, shape (n_y,). [m]
        row: Index into ``y`` of each point, shape (n_point,).
        column: Index into ``x`` of each point, shape (n_point,).
    """

    x: Vector
    y: Vector
    row: IntVector
    column: IntVector

    @classmethod
    def of(cls, slab: SlabPoints) -> SlabGrid:
        """The grid on which the points of a slab lie."""
        x, column = _lines(slab.coordinates[:, 0])
        y, row = _lines(slab.coordinates[:, 1])
        return cls(x=x, y=y, row=row, column=column)

    def points(self, sizes: Vector) -> IntVector:
        """The point that each cell shows, shape (n_y, n_x), -1 where there is none.

        Where spans meet, two points lie in one place: the one with the greater size is shown.

        Args:
            sizes: Shape (n_point,).
        """
        shown = np.full((self.y.size, self.x.size), -1, dtype=np.int64)
        for point in np.argsort(np.nan_to_num(sizes, nan=-1.0), kind="stable").tolist():
            shown[self.row[point], self.column[point]] = point
        return shown

    def values(self, of_points: Vector, shown: IntVector) -> Matrix:
        """Values of the points shown, not a number where there is none, shape (n_y, n_x)."""
        return np.where(shown >= 0, of_points[np.maximum(shown, 0)], np.nan)


def greatest_index(values: Vector, among: BoolVector) -> int | None:
    """Index of the greatest value among some points; None where none of them has a value.

    Args:
        values: Shape (n_point,).
        among: Whether a point counts, shape (n_point,).
    """
    counted = np.where(among & np.isfinite(values), values, -np.inf)
    index = int(np.argmax(counted)) if counted.size else 0
    return index if counted.size and np.isfinite(counted[index]) else None


def _lines(values: Vector) -> tuple[Vector, IntVector]:
    """Distinct values, ascending, and the index of each."""
    order = np.argsort(values, kind="stable")
    begins = np.diff(values[order], prepend=-np.inf) > _SAME
    line = np.empty(values.size, dtype=np.int64)
    line[order] = np.cumsum(begins) - 1
    return values[order][begins], line
