"""The contact of wheel and rail tabulated against the wheel's lateral displacement.

Where the point of contact jumps, or passes a joint of a profile at which the curvature steps, the
table holds two rows for the same displacement, one for each side, and never interpolates between
them: the discontinuities are found to a picometre and stay discontinuities.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import BoolVector, IntVector, Vector
from solver.contact.hertz import STEEL, Material, hertz_contact
from solver.contact.wheel_rail import (
    ContactGeometry,
    ContactPoints,
    WheelRailPair,
    find_contacts,
)
from solver.errors import InputError

__all__ = [
    "WHEEL_LOAD",
    "ContactRows",
    "ContactTable",
    "Discontinuity",
    "WheelsetTable",
    "contact_table",
    "displacements",
    "wheelset_table",
]

WHEEL_LOAD = 83_385.0
"""Static load of a wheel, 8.5 t (the thesis, section 3.4, prints kN for N). [N]"""
_RESOLUTION = 1e-12
"""Width to which a discontinuity is enclosed. [m]"""
_SMOOTH = 1e-6
"""Deviation from the trapezoid rule that is still smooth movement of the contact point. [m]"""
_JUMP = 1e-5
"""Least movement that counts as a jump; the rounded joints of S1002 give about 1e-6. [m]"""
_CURVATURE_STEP = 1e-3
"""Least step of the relative curvature, as a part of it, that counts as a discontinuity."""


@dataclass(frozen=True, kw_only=True)
class ContactRows(ContactGeometry):
    """Geometry and Hertzian contact, every array of shape (n_row,).

    Attributes:
        longitudinal_semi_axis: Of the contact ellipse, along the track. [m]
        lateral_semi_axis: Across it, in the plane of contact. [m]
        hertz_constant: K_h of F = K_h delta^1.5. [N/m^1.5]
        contact_stiffness: k_h, the law's tangent at the table's normal force. [N/m]
    """

    longitudinal_semi_axis: Vector
    lateral_semi_axis: Vector
    hertz_constant: Vector
    contact_stiffness: Vector

    @property
    def semi_axis_ratio(self) -> Vector:
        """Longitudinal over lateral semi-axis (a/b of the thesis's figure 3.15). [1]"""
        return self.longitudinal_semi_axis / self.lateral_semi_axis

    @property
    def area(self) -> Vector:
        """Area of the contact ellipse. [m2]"""
        return np.pi * self.longitudinal_semi_axis * self.lateral_semi_axis


@dataclass(frozen=True, kw_only=True)
class Discontinuity:
    """A displacement at which the contact changes at once.

    Attributes:
        kind: ``jump``: the point of contact moves, the wheel touches at two points there;
            ``joint``: only the curvature changes.
        displacement: Where, outwards. [m]
        wheel_lateral: Points of contact on the wheel, before and after. [m]
        rail_lateral: Points of contact on the rail, before and after. [m]
        contact_angle: Contact angles before and after. [rad]
    """

    kind: Literal["jump", "joint"]
    displacement: float
    wheel_lateral: tuple[float, float]
    rail_lateral: tuple[float, float]
    contact_angle: tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class ContactTable:
    """One wheel's contact against its displacement outwards.

    Attributes:
        rows: The table: the requested displacements, and two rows at each discontinuity.
        requested: Which rows were asked for, shape (n_row,); false at discontinuities.
        second_gap: Vertical distance at the second lowest place, not-a-number where there is
            none, shape (n_row,). [m]
        second_wheel_lateral: That place on the wheel, shape (n_row,). [m]
        across_step: Rows whose ellipse reaches over a step of the curvature of wheel or rail,
            shape (n_row,): Hertz's assumption does not hold there, the ellipse is a convention.
        discontinuities: In the order of their displacement.
        normal_force: For which the ellipses and stiffnesses are given. [N]
    """

    rows: ContactRows
    requested: BoolVector
    second_gap: Vector
    second_wheel_lateral: Vector
    across_step: BoolVector
    discontinuities: tuple[Discontinuity, ...]
    normal_force: float

    @property
    def jumps(self) -> tuple[Discontinuity, ...]:
        """The discontinuities at which the point of contact moves."""
        return tuple(entry for entry in self.discontinuities if entry.kind == "jump")

    def at(self, displacement: ArrayLike) -> ContactRows:
        """The contact at any displacement, linear between rows, never across a discontinuity.

        Args:
            displacement: Of the wheel, outwards, shape (n,) or a number. [m]

        Returns:
            Arrays of shape (n,); at a discontinuity itself those of the greater displacement.

        Raises:
            InputError: A displacement is outside the table.
        """
        wanted = np.atleast_1d(np.asarray(displacement, float))
        nodes = self.rows.displacement
        outside = ~((wanted >= nodes[0]) & (wanted <= nodes[-1]))
        if np.any(outside):
            raise InputError(
                "displacement",
                float(wanted[outside][0]),
                f"the table covers {nodes[0]:g} to {nodes[-1]:g} m",
                "Build the table for a wider range.",
            )
        # Of two rows at one displacement the search finds the second, which begins its interval.
        left = np.searchsorted(nodes, wanted, side="right") - 1
        left = np.minimum(left, len(nodes) - 2)
        share = (wanted - nodes[left]) / (nodes[left + 1] - nodes[left])
        return ContactRows(
            **{
                entry.name: (1.0 - share) * getattr(self.rows, entry.name)[left]
                + share * getattr(self.rows, entry.name)[left + 1]
                for entry in fields(ContactRows)
            }
        )

    def two_point(self, tolerance: float) -> IntVector:
        """Rows in which a second place is as good as touching.

        Args:
            tolerance: Vertical distance that the elastic approach closes, about 1e-4. [m]

        Returns:
            Numbers of the rows.
        """
        return np.flatnonzero(np.nan_to_num(self.second_gap, nan=np.inf) <= tolerance)


@dataclass(frozen=True, kw_only=True)
class WheelsetTable:
    """Both wheels of a wheelset without roll or yaw.

    Attributes:
        left: The left wheel's table, against its displacement outwards.
        right: The right wheel's.
    """

    left: ContactTable
    right: ContactTable

    def at(self, lateral: ArrayLike) -> tuple[ContactRows, ContactRows]:
        """Contacts of both wheels.

        Args:
            lateral: Of the wheelset, y to the left as everywhere, shape (n,) or a number. [m]

        Returns:
            Left and right wheel; their own displacements count outwards.

        Raises:
            InputError: A displacement is outside one of the tables.
        """
        y = np.asarray(lateral, float)
        return self.left.at(y), self.right.at(-y)


def displacements(greatest: float = 0.02, step: float = 1e-4) -> Vector:
    """Equally spaced displacements, -20 to 20 mm in steps of 0.1 mm as in the thesis.

    Args:
        greatest: Half the range. [m]
        step: Distance between two rows. [m]

    Returns:
        Shape (2 greatest / step + 1,). [m]
    """
    count = round(greatest / step)
    return np.arange(-count, count + 1) * (greatest / count)


def contact_table(
    pair: WheelRailPair,
    displacement: ArrayLike | None = None,
    *,
    normal_force: float = WHEEL_LOAD,
    wheel_material: Material = STEEL,
    rail_material: Material = STEEL,
) -> ContactTable:
    """Tabulates the contact of one wheel.

    Args:
        pair: The profiles and how they stand.
        displacement: Displacements outwards, growing, shape (n,), two at least; -20 to 20 mm in
            steps of 0.1 mm if none are given. [m]
        normal_force: Force at right angles to the plane of contact; as in the thesis the wheel
            load, whatever the contact angle. [N]
        wheel_material: Of the wheel.
        rail_material: Of the rail.

    Returns:
        The table.

    Raises:
        InputError: The displacements do not grow, the force is not positive, or the pair does not
            touch as Hertz's theory needs it.
    """
    moves = displacements() if displacement is None else np.asarray(displacement, float)
    if moves.ndim != 1 or len(moves) < 2 or not np.all(np.diff(moves) > 0.0):
        raise InputError(
            "displacement", moves.tolist()[:3], "it is not a growing list", "Sort the values."
        )
    if not 0.0 < normal_force < np.inf:
        raise InputError("normal_force", normal_force, "it is not positive", "Give it in N.")
    points = find_contacts(pair, moves)
    before, after = _enclose_discontinuities(pair, points)
    found = _describe(before, after)
    keep = np.array([entry is not None for entry in found], bool)
    middle = 0.5 * (before.displacement + after.displacement)
    order = np.argsort(
        np.concatenate((moves, middle[keep], middle[keep])), kind="stable"
    )  # stable: before comes before after
    merged = {
        entry.name: np.concatenate(
            [getattr(points, entry.name)]
            + [getattr(side, entry.name)[keep] for side in (before, after)]
        )[order]
        for entry in fields(ContactPoints)
    }
    merged["displacement"] = np.concatenate((moves, middle[keep], middle[keep]))[order]
    geometry = {entry.name: merged[entry.name] for entry in fields(ContactGeometry)}
    rows = _with_ellipse(ContactGeometry(**geometry), normal_force, wheel_material, rail_material)
    return ContactTable(
        rows=rows,
        requested=order < len(moves),
        second_gap=merged["second_gap"],
        second_wheel_lateral=merged["second_wheel_lateral"],
        across_step=_reaches(rows, rows.rail_lateral, pair.rail.curvature_steps)
        | _reaches(rows, rows.wheel_lateral, pair.wheel.curvature_steps),
        discontinuities=tuple(entry for entry in found if entry is not None),
        normal_force=normal_force,
    )


def wheelset_table(
    left: WheelRailPair | None = None,
    right: WheelRailPair | None = None,
    displacement: ArrayLike | None = None,
    *,
    normal_force: float = WHEEL_LOAD,
) -> WheelsetTable:
    """Tabulates both wheels of a wheelset.

    Args:
        left: Left wheel and rail, the thesis's pair if not given.
        right: Right wheel and rail, the same as the left if not given.
        displacement: As in ``contact_table``, outwards for each wheel. [m]
        normal_force: On each wheel. [N]

    Returns:
        The two tables, one and the same if the pairs are.

    Raises:
        InputError: As in ``contact_table``.
    """
    first = contact_table(left or WheelRailPair(), displacement, normal_force=normal_force)
    if right is None or right is left:
        return WheelsetTable(left=first, right=first)
    other = contact_table(right, displacement, normal_force=normal_force)
    return WheelsetTable(left=first, right=other)


def _with_ellipse(
    geometry: ContactGeometry, normal_force: float, wheel: Material, rail: Material
) -> ContactRows:
    """Adds Hertz's theory to the geometry."""
    law = hertz_contact(
        geometry.wheel_curvatures,
        geometry.rail_curvatures,
        wheel_material=wheel,
        rail_material=rail,
    )
    patch = law.patch(normal_force)
    return ContactRows(
        **{entry.name: getattr(geometry, entry.name) for entry in fields(ContactGeometry)},
        longitudinal_semi_axis=patch.extent(0.0),
        lateral_semi_axis=patch.extent(0.5 * np.pi),
        hertz_constant=law.constant,
        contact_stiffness=law.tangent_stiffness(normal_force),
    )


def _reaches(rows: ContactRows, centre: Vector, steps: Vector) -> BoolVector:
    """Whether the ellipse about ``centre`` covers one of the places ``steps``."""
    half_width = rows.lateral_semi_axis * np.cos(rows.contact_angle)
    return np.any(np.abs(centre[:, None] - steps) < half_width[:, None], axis=1)


def _enclose_discontinuities(
    pair: WheelRailPair, points: ContactPoints
) -> tuple[ContactPoints, ContactPoints]:
    """Halves every interval that is not smooth until it is, or has no width.

    Returns:
        The contacts on both sides of each discontinuity, in the order of the displacement.
    """
    low, high = _take(points, slice(None, -1)), _take(points, slice(1, None))
    enclosed: list[tuple[ContactPoints, ContactPoints]] = []
    while True:
        rough = ~_is_smooth(low, high)
        low, high = _take(low, rough), _take(high, rough)
        done = high.displacement - low.displacement <= _RESOLUTION
        enclosed.append((_take(low, done), _take(high, done)))
        low, high = _take(low, ~done), _take(high, ~done)
        if not len(low.displacement):
            break
        middle = find_contacts(pair, 0.5 * (low.displacement + high.displacement))
        low, high = _join(low, middle), _join(middle, high)
    before, after = (_join(*sides) for sides in zip(*enclosed, strict=True))
    order = np.argsort(before.displacement)
    return _take(before, order), _take(after, order)


def _is_smooth(low: ContactPoints, high: ContactPoints) -> BoolVector:
    """Whether the contact point moves as its rate says, on the same pieces of both profiles."""
    width = high.displacement - low.displacement
    expected = 0.5 * (low.wheel_rate + high.wheel_rate) * width
    moved = high.wheel_lateral - low.wheel_lateral
    same = (low.wheel_piece == high.wheel_piece) & (low.rail_piece == high.rail_piece)
    return same & (np.abs(moved - expected) <= _SMOOTH)


def _describe(before: ContactPoints, after: ContactPoints) -> list[Discontinuity | None]:
    """What happens at each enclosed place; nothing if only the piece's number changes."""
    moved = np.abs(after.wheel_lateral - before.wheel_lateral) > _JUMP
    relative = [s.wheel_lateral_curvature + s.rail_lateral_curvature for s in (before, after)]
    bent = np.abs(relative[1] - relative[0]) > _CURVATURE_STEP * np.maximum(*relative)

    def sides(name: str, row: int) -> tuple[float, float]:
        return float(getattr(before, name)[row]), float(getattr(after, name)[row])

    return [
        Discontinuity(
            kind="jump" if moved[row] else "joint",
            displacement=0.5 * sum(sides("displacement", row)),
            wheel_lateral=sides("wheel_lateral", row),
            rail_lateral=sides("rail_lateral", row),
            contact_angle=sides("contact_angle", row),
        )
        if moved[row] or bent[row]
        else None
        for row in range(len(moved))
    ]


def _take(points: ContactPoints, rows: slice | BoolVector | IntVector) -> ContactPoints:
    """Some of the rows."""
    return ContactPoints(**{f.name: getattr(points, f.name)[rows] for f in fields(ContactPoints)})


def _join(*parts: ContactPoints) -> ContactPoints:
    """All the rows of several."""
    names = [f.name for f in fields(ContactPoints)]
    return ContactPoints(**{n: np.concatenate([getattr(p, n) for p in parts]) for n in names})
