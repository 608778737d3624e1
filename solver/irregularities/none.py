"""A perfect rail."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from solver.arrays import FloatArray

__all__ = ["NoIrregularity", "PerfectRail"]


@dataclass(frozen=True, kw_only=True)
class NoIrregularity:
    """Both rails are perfect."""

    __pydantic_config__: ClassVar[dict[str, Any]] = {
        "extra": "forbid",
        "use_attribute_docstrings": True,
    }

    type: Literal["none"] = "none"
    """Kind of irregularity."""


@dataclass(frozen=True, kw_only=True)
class PerfectRail:
    """r(x) = 0."""

    def elevation(self, position: FloatArray) -> FloatArray:
        """Zero, in the shape of the positions. [m]"""
        return np.zeros(np.shape(position))

    def slope(self, position: FloatArray) -> FloatArray:
        """Zero, in the shape of the positions. [1]"""
        return np.zeros(np.shape(position))

    def curvature(self, position: FloatArray) -> FloatArray:
        """Zero, in the shape of the positions. [1/m]"""
        return np.zeros(np.shape(position))
