"""A measured profile: elevations of both rails, sampled along the track."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Ge, Le, Len
from numpy.polynomial import Polynomial

from solver.arrays import FloatArray, Vector
from solver.errors import InputError
from solver.units import Units

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline, PPoly

__all__ = ["MeasuredProfile", "ProfileSample", "SampledProfile", "disorder"]

_STRICT: dict[str, Any] = {"extra": "forbid", "use_attribute_docstrings": True}

_MOST = 2000
"""500 m at samples every 0.25 m: the page's table of 6000 cells still takes a pasted block in a
second, and the library an entry. Resample what is longer or denser."""
_CLOSEST = 1e-3
"""Samples nearer to each other would make slopes of their rounding. [m]"""
_MOST_SAID = 10
"""Rows out of order that are named; more of them have one cause."""
_FALL = Polynomial([1.0, 0.0, 0.0, -10.0, 15.0, -6.0])
"""S(t): from 1 at t = 0 to 0 at t = 1, level and straight at both."""
_ROUNDING = 3.0
"""A slope r' that goes over a length l adds a curvature of about 3 r' / l."""
_BULGE = 4.0
"""A slope r' that goes over a length l adds a bulge of about r' l / 4."""
_WIDTH = 8
"""Coefficients of the longest piece: (d + d^2) S(d) has degree seven."""

Elevation = Annotated[float, Units.small_length, Ge(-0.05), Le(0.05)]
"""Elevation of a rail; positive lifts the wheel. [m]"""


@dataclass(frozen=True, kw_only=True)
class ProfileSample:
    """Both rails at one place."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    position: Annotated[float, Units.length, Ge(-1e4), Le(1e4)]
    """Place x along the track; the first span starts at x = 0."""
    left: Elevation
    """Elevation of the left rail; positive lifts the wheel. Plain beams read this one only."""
    right: Elevation
    """Elevation of the right rail; positive lifts the wheel."""


def _level(*positions: float) -> tuple[ProfileSample, ...]:
    return tuple(ProfileSample(position=x, left=0.0, right=0.0) for x in positions)


@dataclass(frozen=True, kw_only=True)
class MeasuredProfile:
    """Measured elevations of both rails: cubic splines through the samples, zero far away."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    type: Literal["measured"] = "measured"
    """Kind of irregularity."""
    samples: Annotated[tuple[ProfileSample, ...], Len(4, _MOST)] = _level(0.0, 10.0, 20.0, 30.0)
    """Elevations of both rails from place to place, x increasing."""
    fade: Annotated[float, Units.length, Ge(0.5), Le(1000.0)] = 10.0
    """Length beyond either end of the samples over which the rails come back to zero."""

    @property
    def positions(self) -> Vector:
        """x of every sample, shape (n,). [m]"""
        return np.array([sample.position for sample in self.samples], dtype=np.float64)

    @property
    def elevations(self) -> FloatArray:
        """r of left and right rail, shape (2, n). [m]"""
        pairs = [(sample.left, sample.right) for sample in self.samples]
        return np.array(pairs, dtype=np.float64).T

    @property
    def is_level(self) -> bool:
        """Whether every sample is zero."""
        return all(sample.left == 0.0 == sample.right for sample in self.samples)


def disorder(positions: Sequence[float]) -> Iterator[InputError]:
    """Samples that do not follow the one before them.

    Args:
        positions: x of every sample. [m]

    Yields:
        What is wrong with a row, the first ten of them; one for a profile that runs backwards.
    """
    wrong = [row for row, (x, y) in enumerate(pairwise(positions), 1) if not y - x >= _CLOSEST]
    backwards = len(wrong) > 1 and len(wrong) == len(positions) - 1
    for row in wrong[: 1 if backwards else _MOST_SAID]:
        before, here = positions[row - 1], positions[row]
        yield InputError(
            f"irregularity.samples.{row}.position",
            here,
            f"does not follow the {before:.6g} m of row {row} by {1e3 * _CLOSEST:g} mm or more",
            "Turn the samples round: x increases in the train's way."
            if backwards
            else "Put the samples in order of x, each place once.",
        )


@dataclass(frozen=True, kw_only=True)
class SampledProfile:
    """r(x) of one rail through samples, with continuous slope and curvature everywhere.

    Between the samples a cubic spline, not-a-knot at its ends: of order four up to the last
    sample, where a natural spline (no curvature there) has order two. A spline that is held level
    at its ends would turn the rail's slope off within one spacing: 2 mm/m at samples every 0.25 m
    would strike a wheel at 100 m/s with 280 m/s2.

    Beyond an end the elevation falls to zero over ``fade``. The slope and the curvature that the
    spline has there are rounded off on the way, as short as adds no sharper bend than the samples
    have themselves: a longer way would make a bulge that nobody measured, a shorter one a blow.

    Attributes:
        positions: x of the samples, increasing, shape (n,) with n of four or more. [m]
        elevations: r there, shape (n,). [m]
        fade: Length beyond either end over which r falls to zero. [m]

    Raises:
        InputError: Too few samples, or one that does not follow the one before it.
    """

    positions: Vector
    elevations: Vector
    fade: float

    def __post_init__(self) -> None:
        if len(self.positions) < 4:
            raise InputError("irregularity.samples", len(self.positions), "has too few samples",
                             "Give four or more.")  # fmt: skip
        for error in disorder(self.positions.tolist()):
            raise error

    def elevation(self, position: FloatArray) -> FloatArray:
        """r at positions x of any shape. [m]"""
        return self._derivative(position, 0)

    def slope(self, position: FloatArray) -> FloatArray:
        """dr/dx at positions x of any shape. [1]"""
        return self._derivative(position, 1)

    def curvature(self, position: FloatArray) -> FloatArray:
        """d2r/dx2 at positions x of any shape. [1/m]"""
        return self._derivative(position, 2)

    def _derivative(self, position: FloatArray, order: int) -> FloatArray:
        x = np.asarray(position, dtype=np.float64)
        pieces = self._pieces
        first, last = pieces.x[0], pieces.x[-1]
        inside = (x > first) & (x < last)
        return np.where(inside, pieces(np.clip(x, first, last), order), 0.0)

    @cached_property
    def _pieces(self) -> PPoly:
        """Fade, spline and fade as one piecewise polynomial."""
        # Imported here: it takes 20 MB that a server which only checks studies does not need.
        from scipy.interpolate import CubicSpline, PPoly

        spline = CubicSpline(self.positions, self.elevations, bc_type="not-a-knot")
        first, last = float(self.positions[0]), float(self.positions[-1])
        spacings = np.diff(self.positions)
        places, ways = self._way_back(spline, first, -1.0, float(spacings[0]))
        # A way begins at its end: each piece of it is turned round.
        lengths = np.diff([0.0, *places])
        begin = [
            _column(way(Polynomial([length, -1.0])))
            for way, length in zip(ways, lengths, strict=True)
        ]
        beyond, ways = self._way_back(spline, last, 1.0, float(spacings[-1]))
        inner = np.pad(spline.c, ((_WIDTH - 4, 0), (0, 0)))
        coefficients = np.column_stack([*begin[::-1], inner, *map(_column, ways)])
        before = [first - place for place in reversed(places)]
        after = [last + place for place in beyond]
        return PPoly(coefficients, np.array([*before, *self.positions, *after]))

    def _way_back(
        self, spline: CubicSpline, end: float, way: float, spacing: float
    ) -> tuple[list[float], list[Polynomial]]:
        """Distances beyond an end where the curvature, the slope and the elevation have gone, and
        r from one to the next, each by the distance from where it begins."""
        value, slope, curvature = (float(spline(end, order)) for order in range(3))
        bend = self._bend_length(spline, abs(slope), spacing)
        short = min(spacing, 0.5 * bend)
        high = value * _FALL(Polynomial([0.0, 1.0 / self.fade]))
        steep = high + way * slope * Polynomial([0.0, 1.0]) * _FALL(Polynomial([0.0, 1.0 / bend]))
        curved = 0.5 * curvature * Polynomial([0.0, 0.0, 1.0])
        near = steep + curved * _FALL(Polynomial([0.0, 1.0 / short]))
        return [short, bend, self.fade], [
            near, steep(Polynomial([short, 1.0])), high(Polynomial([bend, 1.0])),
        ]  # fmt: skip

    def _bend_length(self, spline: CubicSpline, slope: float, spacing: float) -> float:
        """Length over which a slope is rounded off. [m]"""
        longest = 0.9 * self.fade
        sharpest = float(np.abs(spline(self.positions, 2)).max())
        height = 0.5 * float(np.ptp(self.elevations))
        gentle = _ROUNDING * slope / sharpest if sharpest > 0.0 else longest
        flat = _BULGE * height / slope if slope > 0.0 else longest
        return min(longest, max(spacing, min(gentle, flat)))


def _column(piece: Polynomial) -> Vector:
    """Coefficients of a piece, the highest power first, padded to a common width."""
    ascending = np.zeros(_WIDTH)
    ascending[: piece.coef.size] = piece.coef
    return ascending[::-1]
