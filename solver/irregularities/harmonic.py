"""A harmonic irregularity: one sine over a stretch of the rail."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.arrays import BoolVector, FloatArray
from solver.errors import InputError

__all__ = ["HarmonicIrregularity"]


@dataclass(frozen=True, kw_only=True)
class HarmonicIrregularity:
    """r(x) = a0 sin(2 pi x / wavelength) between two places, 0 outside them.

    At an end that is no zero of the sine the rail has a step, at any other a kink.

    Attributes:
        amplitude: a0. [m]
        wavelength: [m]
        start: x where it begins. [m]
        end: x where it ends. [m]

    Raises:
        InputError: The wavelength is not positive, or the end does not follow the start.

    References:
        Neves (2016), equation 4.66.
    """

    amplitude: float
    wavelength: float
    start: float = -np.inf
    end: float = np.inf

    def __post_init__(self) -> None:
        if not 0.0 < self.wavelength < np.inf:
            raise InputError("irregularity.wavelength", self.wavelength, "is not positive",
                             "Give a length in metres.")  # fmt: skip
        if not self.start < self.end:
            raise InputError("irregularity.end", self.end, f"does not follow {self.start:g} m",
                             "Let it end after it starts.")  # fmt: skip

    @property
    def wave_number(self) -> float:
        """2 pi / wavelength. [1/m]"""
        return 2.0 * np.pi / self.wavelength

    def elevation(self, position: FloatArray) -> NDArray[np.float64]:
        """r at positions x of any shape. [m]"""
        wave = np.sin(self.wave_number * np.asarray(position, dtype=np.float64))
        return self.amplitude * wave * self._inside(position)

    def slope(self, position: FloatArray) -> NDArray[np.float64]:
        """dr/dx at positions x of any shape. [1]"""
        wave = np.cos(self.wave_number * np.asarray(position, dtype=np.float64))
        return self.amplitude * self.wave_number * wave * self._inside(position)

    def curvature(self, position: FloatArray) -> NDArray[np.float64]:
        """d2r/dx2 at positions x of any shape. [1/m]"""
        return -(self.wave_number**2) * self.elevation(position)

    def _inside(self, position: FloatArray) -> BoolVector:
        place = np.asarray(position)
        return np.asarray((place >= self.start) & (place <= self.end))
