"""An isolated defect: one smooth hump or dip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Ge, Gt, Le

from solver.arrays import FloatArray
from solver.units import Units

__all__ = ["BellShapedDefect", "IsolatedDefect"]


@dataclass(frozen=True, kw_only=True)
class IsolatedDefect:
    """A bell-shaped defect r(x) = A exp(-(k (x - x0))^2 / 2).

    References:
        Neves (2016), equation 7.3.
    """

    __pydantic_config__: ClassVar[dict[str, Any]] = {
        "extra": "forbid",
        "use_attribute_docstrings": True,
    }

    type: Literal["isolated"] = "isolated"
    """Kind of irregularity."""
    amplitude: Annotated[float, Units.small_length, Ge(-0.05), Le(0.05)] = 0.010
    """Greatest elevation A; positive lifts the wheel, negative is a dip."""
    wave_number: Annotated[float, Units.wave_number, Gt(0), Le(20)] = 0.9
    """Wave number k: the larger, the shorter the defect (6.7 m from end to end at 0.9 1/m)."""
    position: Annotated[float, Units.length, Ge(-1e4), Le(1e4)] = 27.0
    """Place x0 of the greatest elevation; the first span starts at x = 0."""
    rail: Literal["left", "right", "both"] = "right"
    """The rail or rails that have the defect."""


@dataclass(frozen=True, kw_only=True)
class BellShapedDefect:
    """r(x) = A exp(-(k (x - x0))^2 / 2) on one rail.

    Attributes:
        amplitude: A. [m]
        wave_number: k. [1/m]
        centre: x0. [m]

    References:
        Neves (2016), equation 7.3.
    """

    amplitude: float
    wave_number: float
    centre: float

    def elevation(self, position: FloatArray) -> FloatArray:
        """r at positions x of any shape. [m]"""
        scaled = self.wave_number * (np.asarray(position, dtype=np.float64) - self.centre)
        return np.asarray(self.amplitude * np.exp(-0.5 * scaled**2))

    def slope(self, position: FloatArray) -> FloatArray:
        """dr/dx = -k s r with s = k (x - x0). [1]"""
        scaled = self.wave_number * (np.asarray(position, dtype=np.float64) - self.centre)
        return -self.wave_number * scaled * self.elevation(position)

    def curvature(self, position: FloatArray) -> FloatArray:
        """d2r/dx2 = k^2 (s^2 - 1) r with s = k (x - x0). [1/m]"""
        scaled = self.wave_number * (np.asarray(position, dtype=np.float64) - self.centre)
        return self.wave_number**2 * (scaled**2 - 1.0) * self.elevation(position)
