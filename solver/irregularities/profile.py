"""What an irregularity offers to the contact: elevation, slope and curvature along one rail."""

from __future__ import annotations

from typing import Protocol

from solver.arrays import FloatArray

__all__ = ["RailIrregularity"]


class RailIrregularity(Protocol):
    """Deviation r(x) of one rail's surface from its ideal line; r > 0 lifts the wheel.

    To add one, write a frozen dataclass with these three methods, vectorised over positions, and a
    dataclass of properties that ``rail_irregularities`` maps to it.
    """

    def elevation(self, position: FloatArray) -> FloatArray:
        """r at positions x of any shape. [m]"""
        ...

    def slope(self, position: FloatArray) -> FloatArray:
        """dr/dx at positions x of any shape. [1]"""
        ...

    def curvature(self, position: FloatArray) -> FloatArray:
        """d2r/dx2 at positions x of any shape. [1/m]"""
        ...
