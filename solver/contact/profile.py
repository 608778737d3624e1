"""Profiles of wheels and rails: height, slope and curvature across the track.

A profile is a chain of smooth pieces. The two of the standards are analytical (arcs, lines and
polynomials, as EN 13674-1 and EN 13715 give them), so that their curvature has the steps that make
a contact point jump; a measured one is a smoothed spline (``measured_profile``).

Every profile counts ``lateral`` from its own origin, positive to the field side (away from the
middle of the track), and ``height`` upwards: the rail from its axis and crown, the wheel from its
tread datum. Curvature here is that of the curve z(y), positive where its centre lies above:
a convex rail's is negative, a convex wheel's positive.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval
from numpy.typing import ArrayLike

from solver.arrays import FloatArray, IntArray
from solver.data import load
from solver.errors import InputError

__all__ = ["Arc", "Piece", "Polynomial", "Profile", "rail_60e1", "wheel_s1002"]

_STEP = 1e-7
"""Height step at a joint that is still a continuous profile: a tenth of a micrometre. [m]"""
_CORNER = 1e-4
"""Kink at a joint that is still a smooth profile; S1002's rounded coefficients make 8e-6. [rad]"""
_STEP_OF_CURVATURE = 0.1
"""Step at a joint that changes a contact; polynomials that join to rounding make 0.001. [1/m]"""
_OVERHANG = 1e-6
"""A flank of less breadth is vertical or overhangs: no function of the lateral coordinate. [m]"""
_STEEPEST = 1e6
"""Slope at which an arc's derivative is cut: its tangent may become vertical at its end."""


class Piece(Protocol):
    """One smooth stretch of a profile, a function of the lateral coordinate.

    ``start`` and ``end`` are its ends [m], start < end. ``derivatives(lateral)`` returns height,
    first and second derivative [m, 1, 1/m] for points anywhere near it, stacked on a new first
    axis.
    """

    @property
    def start(self) -> float: ...

    @property
    def end(self) -> float: ...

    def derivatives(self, lateral: FloatArray) -> FloatArray: ...


@dataclass(frozen=True, kw_only=True)
class Arc:
    """An arc of a circle, the upper half (``cap``) or the lower one.

    Attributes:
        start: Where it begins. [m]
        end: Where it ends. [m]
        centre: Its centre, lateral and height. [m]
        radius: Its radius, positive. [m]
        cap: Whether it is the upper half of the circle, as on a rail's head.
    """

    start: float
    end: float
    centre: tuple[float, float]
    radius: float
    cap: bool

    def derivatives(self, lateral: FloatArray) -> FloatArray:
        """Height, slope and second derivative, shape (3, ...)."""
        offset = lateral - self.centre[0]
        rise = np.sqrt(np.maximum(self.radius**2 - offset**2, (self.radius / _STEEPEST) ** 2))
        sign = 1.0 if self.cap else -1.0
        return np.stack(
            (
                self.centre[1] + sign * rise,
                -sign * offset / rise,
                -sign * self.radius**2 / rise**3,
            )
        )


@dataclass(frozen=True, kw_only=True)
class Polynomial:
    """A polynomial in the lateral coordinate; of degree one it is a line.

    Attributes:
        start: Where it begins. [m]
        end: Where it ends. [m]
        coefficients: Of rising powers of the lateral coordinate. [m, 1, 1/m, ...]
    """

    start: float
    end: float
    coefficients: tuple[float, ...]

    def derivatives(self, lateral: FloatArray) -> FloatArray:
        """Height, slope and second derivative, shape (3, ...)."""
        return np.stack([polyval(lateral, orders) for orders in self._differentiated])

    @cached_property
    def _differentiated(self) -> tuple[FloatArray, ...]:
        """Coefficients of the polynomial and of its first two derivatives."""
        return tuple(polyder(np.array(self.coefficients, dtype=float), k) for k in range(3))


@dataclass(frozen=True, kw_only=True)
class Profile:
    """The cross section of a wheel or of a rail head.

    Attributes:
        name: For figures and error messages.
        pieces: From the smallest lateral coordinate to the largest, without gaps.

    Raises:
        InputError: There is no piece, or two neighbours do not meet or meet at a corner: Hertz's
            theory has no answer there.
    """

    name: str
    pieces: tuple[Piece, ...]

    def __post_init__(self) -> None:
        if not self.pieces:
            raise InputError("profile", self.name, "it is empty", "Give at least one piece.")
        for left, right in zip(self.pieces[:-1], self.pieces[1:], strict=True):
            before, after = (p.derivatives(np.asarray(left.end)) for p in (left, right))
            kink = abs(float(np.arctan(after[1]) - np.arctan(before[1])))
            step = abs(float(after[0] - before[0]))
            if left.end != right.start or step > _STEP or kink > _CORNER:
                raise InputError(
                    f"profile.{self.name}",
                    left.end,
                    f"two pieces do not join smoothly there (step {step:.2g} m, kink {kink:.2g} "
                    "rad)",
                    "Let the pieces follow each other with the same height and slope.",
                )

    @property
    def start(self) -> float:
        """Smallest lateral coordinate. [m]"""
        return self.pieces[0].start

    @property
    def end(self) -> float:
        """Largest lateral coordinate. [m]"""
        return self.pieces[-1].end

    @property
    def joints(self) -> FloatArray:
        """Where two pieces meet, shape (n_piece - 1,): the curvature may step there. [m]"""
        return np.array([piece.start for piece in self.pieces[1:]])

    @property
    def curvature_steps(self) -> FloatArray:
        """The joints at which the curvature does step, shape (n_step,). [m]"""
        ends = [
            (piece.derivatives(np.asarray(left.end)) for piece in (left, right))
            for left, right in zip(self.pieces[:-1], self.pieces[1:], strict=True)
        ]
        steps = [
            abs(_curvature(before) - _curvature(after)) > _STEP_OF_CURVATURE
            for before, after in ends
        ]
        return self.joints[np.array(steps, bool)]

    def piece_index(self, lateral: ArrayLike) -> IntArray:
        """Which piece each point lies on, the right one at a joint; shape of ``lateral``."""
        return np.asarray(np.searchsorted(self.joints, np.asarray(lateral, float), side="right"))

    def derivatives(self, lateral: ArrayLike) -> FloatArray:
        """Height, slope and second derivative of the curve z(y).

        Args:
            lateral: Lateral coordinates, any shape. [m]

        Returns:
            Shape (3, ...), not-a-number outside the profile. [m, 1, 1/m]
        """
        y = np.asarray(lateral, float)
        index = self.piece_index(y)
        inside = (y >= self.start) & (y <= self.end)
        result = np.full((3, *y.shape), np.nan)
        for number, piece in enumerate(self.pieces):
            chosen = inside & (index == number)
            if np.any(chosen):
                result[:, chosen] = piece.derivatives(y[chosen])
        return result

    def height(self, lateral: ArrayLike) -> FloatArray:
        """Height above the profile's origin, shape of ``lateral``. [m]"""
        return self.derivatives(lateral)[0]

    def slope_angle(self, lateral: ArrayLike) -> FloatArray:
        """Angle of the tangent, positive where the profile rises outwards. [rad]"""
        return np.arctan(self.derivatives(lateral)[1])

    def curvature(self, lateral: ArrayLike) -> FloatArray:
        """Curvature z'' / (1 + z'^2)^(3/2) of the curve, shape of ``lateral``. [1/m]"""
        return _curvature(self.derivatives(lateral))


def _curvature(derivatives: FloatArray) -> FloatArray:
    return derivatives[2] / (1.0 + derivatives[1] ** 2) ** 1.5


@cache
def wheel_s1002() -> Profile:
    """The wheel profile S1002 of EN 13715, flange 28 mm high and 32.5 mm thick.

    Returns:
        Its eight sections, A (tread) to H (flange back), in the order of their lateral coordinate.
        The published coefficients are rounded and leave steps of up to 0.12 micrometres between
        the sections: they are closed by shifting the sections beyond, seen from the tread.
    """
    sections = load("wheel_S1002")["sections"]
    pieces: list[Piece] = []
    # From the tread (last) to the flange: the tread keeps its published height.
    for section in reversed(sections):
        piece = _wheel_section(section, 0.0)
        if pieces:
            joint = np.asarray(piece.end)
            shift = pieces[0].derivatives(joint)[0] - piece.derivatives(joint)[0]
            piece = _wheel_section(section, float(shift))
        pieces.insert(0, piece)
    return Profile(name="S1002", pieces=tuple(pieces))


def _wheel_section(section: dict[str, Any], shift: float) -> Piece:
    """One section of the file, whose depth counts downwards, raised by ``shift``. [m]"""
    start, end = section["start"], section["end"]
    if section["kind"] == "polynomial":
        constant, *others = (-c for c in section["coefficients"])
        return Polynomial(start=start, end=end, coefficients=(constant + shift, *others))
    return Arc(
        start=start,
        end=end,
        centre=(section["centre_lateral"], shift - section["centre_depth"]),
        radius=section["radius"],
        cap=section["bulge"] == "up",
    )


@cache
def rail_60e1(inclination: float = 0.0) -> Profile:
    """The head of the rail 60E1 (UIC 60) of EN 13674-1.

    Args:
        inclination: Tangent of the rail's lean towards the middle of the track: 0 as in the
            thesis, 1/20 or 1/40 as laid. The flank on which the leaning head overhangs is left
            out. [1]

    Returns:
        Arcs of 300, 80 and 13 mm and the 1:20 flanks, from the gauge side (lateral < 0) to the
        field side; the origin is the crown of the upright rail.

    Raises:
        InputError: The inclination is not within 1:20 of upright.
    """
    if not abs(inclination) <= 0.05:
        raise InputError(
            "rail.inclination", inclination, "it lies outside -1/20 to 1/20", "Use 0, 1/40 or 1/20."
        )
    name = "60E1" if inclination == 0.0 else f"60E1 inclined {inclination:g}"
    vertices, arcs = _upright_head(load("rail_60E1_head"))
    lean = float(np.arctan(inclination))
    turned = [_turn(vertex, lean) for vertex in vertices]
    pieces: list[Piece] = []
    for first, last, arc in zip(turned[:-1], turned[1:], arcs, strict=True):
        if arc is not None:
            centre = _turn(arc[0], lean)
            pieces.append(Arc(start=first[0], end=last[0], centre=centre, radius=arc[1], cap=True))
        elif last[0] - first[0] > _OVERHANG:
            slope = (last[1] - first[1]) / (last[0] - first[0])
            line = (first[1] - slope * first[0], slope)
            pieces.append(Polynomial(start=first[0], end=last[0], coefficients=line))
    return Profile(name=name, pieces=tuple(pieces))


_Point: TypeAlias = tuple[float, float]


def _upright_head(data: dict[str, Any]) -> tuple[list[_Point], list[tuple[_Point, float] | None]]:
    """Vertices from the gauge flank's foot to the field flank's, and the arc between each two.

    An arc is its centre and radius; none stands for a line.
    """
    half: list[_Point] = []
    arcs: list[tuple[_Point, float] | None] = []
    for arc in data["arcs"]:
        centre = (arc["centre_lateral"], arc["centre_height"])
        end, radius = arc["end"], arc["radius"]
        half.append((end, centre[1] + float(np.sqrt(radius**2 - (end - centre[0]) ** 2))))
        arcs.append((centre, radius))
    tip, flank = half[-1], data["flank"]
    foot = tip[0] + flank["lateral_per_height"] * (tip[1] - flank["end_height"])
    half.append((foot, flank["end_height"]))
    mirrored = [arc and ((-arc[0][0], arc[0][1]), arc[1]) for arc in reversed(arcs[1:])]
    vertices = [(-y, z) for y, z in reversed(half)] + half
    return vertices, [None, *mirrored, *arcs, None]


def _turn(point: _Point, lean: float) -> _Point:
    """The point turned about the origin; a positive lean moves what is high to the gauge side."""
    y, z = point
    cosine, sine = float(np.cos(lean)), float(np.sin(lean))
    return y * cosine - z * sine, y * sine + z * cosine
