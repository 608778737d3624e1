"""Where a wheel touches its rail: the rigid contact point of a pair of profiles.

Wheel and rail stand in one vertical plane across the track; the wheelset has neither roll nor yaw
(as in the thesis). Pressed together, they touch where the vertical distance

    gap(y) = z_w(y) - z_r(y)

is smallest: there both profiles have the same slope. The search is exact but for rounding: all
changes of sign of gap' on a fine grid are bisected, and the lowest minimum is the contact. A second
minimum that is as low within the elastic approach is a second point of contact.

Lateral coordinates count from the middle of the track outwards, on the left and the right alike,
and so does the wheel's ``displacement``: positive brings the flange to the rail.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Annotated

import numpy as np
from annotated_types import Gt
from numpy.typing import ArrayLike

from solver.arrays import FloatArray, IntVector, Matrix, Vector
from solver.contact.hertz_curvature import PrincipalCurvatures
from solver.contact.profile import Profile, rail_60e1, wheel_s1002
from solver.errors import InputError
from solver.units import Units

__all__ = ["ContactGeometry", "ContactPoints", "WheelRailPair", "find_contacts"]

_SPACING = 5e-5
"""Of the grid on which minima are looked for: of two closer ones the lower may be missed. [m]"""
_HALVINGS = 40
"""Bisections of one grid cell: to below 1e-15 m."""
_BLOCK = 64
"""Displacements handled at once, which bounds the memory (about 2 MB an array)."""


@dataclass(frozen=True, kw_only=True)
class WheelRailPair:
    """A wheel over its rail, in the position of a wheelset that stands centred on the track.

    The defaults are the pair of the thesis (section 3.4).

    Raises:
        InputError: A length is not positive, or the rail's profile ends above the gauge depth.
    """

    wheel: Profile = field(default_factory=wheel_s1002)
    """Wheel profile, from its tread datum."""
    rail: Profile = field(default_factory=rail_60e1)
    """Rail profile, from its axis."""
    nominal_radius: Annotated[float, Units.length, Gt(0.0)] = 0.46
    """Rolling radius at the wheel's tread datum."""
    track_gauge: Annotated[float, Units.length, Gt(0.0)] = 1.435
    """Distance between the rails' gauge faces."""
    gauge_depth: Annotated[float, Units.length, Gt(0.0)] = 0.014
    """Depth below the crown at which the gauge is measured."""
    flange_back_spacing: Annotated[float, Units.length, Gt(0.0)] = 1.36
    """Distance between the backs of the two flanges."""
    datum_from_flange_back: Annotated[float, Units.length, Gt(0.0)] = 0.07
    """Distance of the wheel's tread datum from the flange back."""

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            if not isinstance(value, Profile) and not 0.0 < value < np.inf:
                raise InputError(
                    f"pair.{entry.name}", value, "it is not a positive length", "Give it in m."
                )
        _ = self.rail_axis

    @property
    def wheel_datum(self) -> float:
        """Distance of the wheel's tread datum from the middle of a centred wheelset. [m]"""
        return 0.5 * self.flange_back_spacing + self.datum_from_flange_back

    @cached_property
    def rail_axis(self) -> float:
        """Distance of the rail profile's origin from the middle of the track. [m]"""
        return 0.5 * self.track_gauge - _gauge_point(self.rail, self.gauge_depth)

    def gap(self, rail_lateral: ArrayLike, displacement: ArrayLike) -> FloatArray:
        """Height of the wheel over the rail if their datums were level, and its two derivatives.

        Args:
            rail_lateral: Places in the rail's frame, any shape. [m]
            displacement: Of the wheel, outwards, a shape that broadcasts. [m]

        Returns:
            Shape (3, ...); not-a-number where only one of them is. [m, 1, 1/m]
        """
        rail = np.asarray(rail_lateral, float)
        return self.wheel.derivatives(
            self.wheel_lateral(rail, displacement)
        ) - self.rail.derivatives(rail)

    def wheel_lateral(self, rail_lateral: ArrayLike, displacement: ArrayLike) -> FloatArray:
        """The same place in the wheel's frame. [m]"""
        shift = self.rail_axis - self.wheel_datum
        return np.asarray(rail_lateral, float) + (shift - np.asarray(displacement, float))


@dataclass(frozen=True, kw_only=True)
class ContactGeometry:
    """Points of contact against the wheel's lateral displacement, every array of shape (n_row,).

    Attributes:
        displacement: Of the wheel, outwards from the centred position. [m]
        rail_lateral: Point of contact in the rail's frame. [m]
        wheel_lateral: Point of contact in the wheel's frame. [m]
        contact_angle: Angle of the common tangent to the wheelset's axis, positive towards the
            flange. [rad]
        rolling_radius: Of the wheel there. [m]
        wheel_rise: Height of the wheel's datum over the rail's origin. [m]
        wheel_longitudinal_curvature: cos(contact angle) / rolling radius (3.36). [1/m]
        wheel_lateral_curvature: Positive where the wheel is convex. [1/m]
        rail_lateral_curvature: Positive where the rail is convex. [1/m]
    """

    displacement: Vector
    rail_lateral: Vector
    wheel_lateral: Vector
    contact_angle: Vector
    rolling_radius: Vector
    wheel_rise: Vector
    wheel_longitudinal_curvature: Vector
    wheel_lateral_curvature: Vector
    rail_lateral_curvature: Vector

    @property
    def wheel_curvatures(self) -> PrincipalCurvatures:
        """Of the wheel, for Hertz's theory."""
        return PrincipalCurvatures(
            longitudinal=self.wheel_longitudinal_curvature, lateral=self.wheel_lateral_curvature
        )

    @property
    def rail_curvatures(self) -> PrincipalCurvatures:
        """Of the straight rail, for Hertz's theory."""
        return PrincipalCurvatures(longitudinal=0.0, lateral=self.rail_lateral_curvature)


@dataclass(frozen=True, kw_only=True)
class ContactPoints(ContactGeometry):
    """What the search finds.

    Attributes:
        wheel_rate: d(wheel_lateral)/d(displacement) while nothing jumps. [1]
        wheel_piece: Number of the wheel profile's piece that touches.
        rail_piece: Number of the rail profile's piece that touches.
        second_wheel_lateral: The next lowest minimum, in the wheel's frame; not-a-number if there
            is none. [m]
        second_gap: How far it is from touching, seen vertically. [m]
    """

    wheel_rate: Vector
    wheel_piece: IntVector
    rail_piece: IntVector
    second_wheel_lateral: Vector
    second_gap: Vector


def find_contacts(pair: WheelRailPair, displacement: ArrayLike) -> ContactPoints:
    """Points of contact of a wheel and its rail.

    Args:
        pair: The profiles and how they stand.
        displacement: Of the wheel, outwards from the centred position, shape (n_row,). [m]

    Returns:
        The points.

    Raises:
        InputError: A displacement is not finite, or the profiles do not touch each other there:
            one does not reach the other, or the lowest place is an end of one of them.
    """
    moves = np.atleast_1d(np.asarray(displacement, float))
    if not np.all(np.isfinite(moves)):
        value = float(moves[~np.isfinite(moves)][0])
        raise InputError("displacement", value, "it is not a finite number", "Give it in m.")
    found = [_lowest_two(pair, moves[i : i + _BLOCK]) for i in range(0, len(moves), _BLOCK)]
    places = np.concatenate(found) if found else np.empty((0, 2))
    return _points(pair, moves, places)


def _gauge_point(rail: Profile, depth: float) -> float:
    """Where the gauge face is met, in the rail's frame: the gauge side at a depth. [m]"""
    grid = np.linspace(rail.start, rail.end, 4001)
    height = rail.height(grid)
    crown = int(np.nanargmax(height))
    level = float(height[crown]) - depth
    if not height[0] < level:
        raise InputError(
            "pair.gauge_depth",
            depth,
            f"the gauge side of {rail.name} ends {float(height[crown] - height[0]):.3g} m below "
            "its crown, above the depth at which the gauge is measured",
            "Give more points of the gauge side, or a smaller gauge depth.",
        )
    inner = int(np.max(np.nonzero(height[: crown + 1] < level)[0]))
    low, high = grid[inner], grid[inner + 1]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rail.height(middle) < level else (low, middle)
    return float(0.5 * (low + high))


def _lowest_two(pair: WheelRailPair, moves: Vector) -> Matrix:
    """Rail coordinates of the lowest and the second lowest minimum of the gap, shape (n, 2)."""
    rail = pair.rail
    count = int(np.ceil((rail.end - rail.start) / _SPACING)) + 1
    grid = np.unique(np.concatenate((np.linspace(rail.start, rail.end, count), rail.joints)))
    on_rail = rail.derivatives(grid)
    on_wheel = pair.wheel.derivatives(pair.wheel_lateral(grid, moves[:, None]))
    gap, slope, _ = on_wheel - on_rail[:, None, :]
    row, cell = np.nonzero((slope[:, :-1] < 0.0) & (slope[:, 1:] >= 0.0))
    place = _bisect(pair, moves[row], grid[cell], grid[cell + 1])
    depth = pair.gap(place, moves[row])[0]
    order = np.lexsort((depth, row))
    row, place, depth = row[order], place[order], depth[order]
    first = np.searchsorted(row, np.arange(len(moves)))
    has_one = np.append(row, -1)[first] == np.arange(len(moves))
    lowest = np.where(has_one, np.append(depth, np.nan)[first], np.inf)
    _check_ends(pair, moves, gap, lowest)
    second = np.minimum(first + 1, len(row) - 1)
    has_two = (row[second] == np.arange(len(moves))) & (second > first)
    return np.stack((place[first], np.where(has_two, place[second], np.nan)), axis=1)


def _bisect(pair: WheelRailPair, moves: Vector, low: Vector, high: Vector) -> Vector:
    """Where the gap's slope turns positive, within one grid cell each."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        falling = pair.gap(middle, moves)[1] < 0.0
        low, high = np.where(falling, middle, low), np.where(falling, high, middle)
    return 0.5 * (low + high)


def _check_ends(pair: WheelRailPair, moves: Vector, gap: Matrix, lowest: Vector) -> None:
    """Refuses pairs whose profiles miss each other or touch with the end of one of them."""
    common = np.isfinite(gap)
    missed = ~np.any(common, axis=1)
    if np.any(missed):
        raise InputError(
            "pair",
            float(moves[missed][0]),
            f"{pair.wheel.name} and {pair.rail.name} do not touch: at this displacement [m] no "
            "part of the wheel is above the rail",
            "Check the gauge, the spacing of the flange backs and the origins of the profiles.",
        )
    rows = np.arange(len(moves))
    start = np.argmax(common, axis=1)
    end = gap.shape[1] - 1 - np.argmax(common[:, ::-1], axis=1)
    at_end = np.minimum(gap[rows, start], gap[rows, end]) <= lowest
    if np.any(at_end):
        raise InputError(
            "pair",
            float(moves[at_end][0]),
            f"{pair.wheel.name} and {pair.rail.name} do not touch within their profiles: at this "
            "displacement [m] the lowest place is an end of one of them",
            "Extend the profiles or limit the range of displacements.",
        )


def _points(pair: WheelRailPair, moves: Vector, places: Matrix) -> ContactPoints:
    """Everything known about the points at ``places`` (first and second minimum)."""
    rail, second = places[:, 0], places[:, 1]
    wheel = pair.wheel_lateral(rail, moves)
    rail_z, rail_slope, rail_bend = pair.rail.derivatives(rail)
    wheel_z, wheel_slope, wheel_bend = pair.wheel.derivatives(wheel)
    if np.any(wheel_bend <= rail_bend):
        raise InputError(
            "pair",
            float(moves[wheel_bend <= rail_bend][0]),
            f"{pair.wheel.name} and {pair.rail.name} fit each other: at this displacement [m] they "
            "touch along a line or at a corner, which Hertz's theory does not cover",
            "Use profiles with different curvatures, or smooth the measured ones.",
        )
    # Both slopes agree but for a wheel's rounded joint, where the rail's is the tangent.
    angle = np.arctan(rail_slope)
    radius = pair.nominal_radius - wheel_z
    rise = rail_z - wheel_z
    return ContactPoints(
        displacement=moves,
        rail_lateral=rail,
        wheel_lateral=wheel,
        contact_angle=angle,
        rolling_radius=radius,
        wheel_rise=rise,
        wheel_longitudinal_curvature=np.cos(angle) / radius,
        wheel_lateral_curvature=wheel_bend / (1.0 + wheel_slope**2) ** 1.5,
        rail_lateral_curvature=-rail_bend / (1.0 + rail_slope**2) ** 1.5,
        wheel_rate=rail_bend / (wheel_bend - rail_bend),
        wheel_piece=pair.wheel.piece_index(wheel),
        rail_piece=pair.rail.piece_index(rail),
        second_wheel_lateral=pair.wheel_lateral(second, moves),
        second_gap=pair.gap(second, moves)[0] + rise,
    )
