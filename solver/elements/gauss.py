"""Gauss points of the square and the cube, two in each direction, with unit weights."""

from __future__ import annotations

import itertools
from math import sqrt

import numpy as np

from solver.arrays import Matrix

__all__ = ["CUBE_CORNERS", "CUBE_POINTS", "SQUARE_CORNERS", "SQUARE_POINTS"]

_ABSCISSA = 1.0 / sqrt(3.0)

SQUARE_CORNERS: Matrix = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
"""Natural coordinates of the four nodes, counter-clockwise."""
SQUARE_POINTS: Matrix = SQUARE_CORNERS * _ABSCISSA
"""The 2 x 2 points, exact to the third degree in each direction."""
CUBE_CORNERS: Matrix = np.vstack(
    [np.column_stack([SQUARE_CORNERS, np.full(4, level)]) for level in (-1.0, 1.0)]
)
"""Natural coordinates of the eight nodes: the lower face counter-clockwise, then the upper."""
CUBE_POINTS: Matrix = np.array(list(itertools.product((-_ABSCISSA, _ABSCISSA), repeat=3)))
"""The 2 x 2 x 2 points, exact to the third degree in each direction."""
