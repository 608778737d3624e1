"""Simply supported Euler-Bernoulli spans in modal coordinates, for the semi-analytical solutions.

Upwards is positive everywhere (the thesis writes these equations positive downwards). Displacements
of beams count from dead load, those of sprung masses from their static place on a perfect rail.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from solver.errors import InputError

__all__ = ["PerfectSurface", "SimplySupportedBeam", "Surface"]

_Array = NDArray[np.float64]


class Surface(Protocol):
    """Elevation r(x) of the rail above its ideal line; r > 0 lifts the wheel."""

    def elevation(self, position: _Array) -> _Array:
        """r. [m]"""
        ...

    def slope(self, position: _Array) -> _Array:
        """dr/dx. [1]"""
        ...

    def curvature(self, position: _Array) -> _Array:
        """d2r/dx2. [1/m]"""
        ...


@dataclass(frozen=True, kw_only=True)
class PerfectSurface:
    """r(x) = 0."""

    def elevation(self, position: _Array) -> _Array:
        """Zero. [m]"""
        return np.zeros(np.shape(position))

    def slope(self, position: _Array) -> _Array:
        """Zero. [1]"""
        return np.zeros(np.shape(position))

    def curvature(self, position: _Array) -> _Array:
        """Zero. [1/m]"""
        return np.zeros(np.shape(position))


@dataclass(frozen=True, kw_only=True)
class SimplySupportedBeam:
    """One or more equal simply supported spans in a row, rigid ground before and after.

    Attributes:
        length: Of one span. [m]
        rigidity: Flexural rigidity EI. [N m2]
        mass_per_length: [kg/m]
        damping_ratio: Of every mode, relative to critical. [1]
        n_mode: Modes of each span.
        n_span: Spans in a row, the first from x = 0.

    References:
        Neves (2016), equations 4.44 and 4.45.
    """

    length: float
    rigidity: float
    mass_per_length: float
    damping_ratio: float = 0.0
    n_mode: int = 20
    n_span: int = 1

    def __post_init__(self) -> None:
        for field in ("length", "rigidity", "mass_per_length", "n_mode", "n_span"):
            if not getattr(self, field) > 0:
                value = getattr(self, field)
                raise InputError(f"beam.{field}", value, "it must be positive", "Use more than 0.")

    @property
    def joints(self) -> _Array:
        """Shape (n_span + 1,): ends of the spans. [m]"""
        return np.asarray(self.length * np.arange(self.n_span + 1), dtype=np.float64)

    @property
    def modal_mass(self) -> float:
        """M_n = m L / 2, the same for every mode. [kg]"""
        return self.mass_per_length * self.length / 2

    @cached_property
    def wave_numbers(self) -> _Array:
        """Shape (n_mode,): n pi / L. [1/m]"""
        return np.asarray(np.pi * np.arange(1, self.n_mode + 1) / self.length, dtype=np.float64)

    @cached_property
    def angular_frequencies(self) -> _Array:
        """Shape (n_span n_mode,): of every mode, span by span. [rad/s]"""
        one_span = self.wave_numbers**2 * np.sqrt(self.rigidity / self.mass_per_length)
        return np.tile(one_span, self.n_span)

    def span_at(self, position: _Array) -> NDArray[np.int64]:
        """Index of the span over which each position lies, -1 on the ground.

        Args:
            position: Shape (n_point,). [m]

        Returns:
            Shape (n_point,). A joint belongs to the span after it, the last joint to the last span.
        """
        x = np.asarray(position, dtype=np.float64)
        span = np.minimum(np.floor(x / self.length), self.n_span - 1).astype(np.int64)
        return np.where((x < 0) | (x > self.joints[-1]), -1, span)

    def shapes(
        self, position: _Array, span: NDArray[np.int64], derivative: int = 0
    ) -> NDArray[np.float64]:
        """Modal shapes sin(n pi x / L), or their derivatives, at points of given spans.

        Args:
            position: Shape (n_point,). [m]
            span: Shape (n_point,): the span each point lies on, -1 for the ground.
            derivative: 0, 1 or 2.

        Returns:
            Shape (n_point, n_span n_mode); zero for the modes of other spans. [1, 1/m, 1/m2]
        """
        wave = self.wave_numbers
        angle = (position - self.length * span)[:, None] * wave
        if derivative == 0:
            value = np.sin(angle)
        elif derivative == 1:
            value = wave * np.cos(angle)
        else:
            value = -(wave**2) * np.sin(angle)
        own = np.arange(self.n_span) == span[:, None]
        return (own[:, :, None] * value[:, None, :]).reshape(len(span), -1)
