"""Gauss points of the square and the cube.

Two points in each direction have unit weights; three have 5/9, 8/9, 5/9.
"""

from __future__ import annotations

import itertools
from math import sqrt

import numpy as np

from solver.arrays import Matrix, Vector

__all__ = [
    "CUBE_CORNERS",
    "CUBE_POINTS",
    "CUBE_POINTS_27",
    "CUBE_WEIGHTS_27",
    "SQUARE_CORNERS",
    "SQUARE_POINTS",
]

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
_ABSCISSAE_3 = (-sqrt(0.6), 0.0, sqrt(0.6))
_WEIGHTS_3 = (5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0)
CUBE_POINTS_27: Matrix = np.array(list(itertools.product(_ABSCISSAE_3, repeat=3)))
"""The 3 x 3 x 3 points, exact to the fifth degree in each direction."""
CUBE_WEIGHTS_27: Vector = np.prod(np.array(list(itertools.product(_WEIGHTS_3, repeat=3))), axis=1)
"""Their weights, shape (27,)."""
