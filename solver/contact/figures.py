"""What the thesis's figures 3.12 to 3.23 show, as numbers ready to be drawn.

As there, lateral positions and displacements count to the *right* (the right wheel's own outward
direction; elsewhere in the solver y points left), and the point of contact is given in the wheel's
frame (figure 3.17 fits nothing else). Curves are interrupted by a not-a-number where the contact
jumps. Quantities carry the figures' units, named in the labels.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import Vector
from solver.contact.lookup_table import ContactTable, WheelsetTable, wheelset_table
from solver.contact.profile import Profile
from solver.contact.wheel_rail import WheelRailPair

__all__ = [
    "Figure",
    "Series",
    "contact_figures",
    "law_figure",
    "patch_figure",
    "profile_figures",
    "thesis_figures",
]

_MM = 1e3
_PATCHES = {"3.16": 0.0, "3.18": 3.7e-3, "3.19": 3.8e-3, "3.20": 6.6e-3, "3.21": -6.6e-3}
"""Displacements to the right of the figures of contact patches. [m]"""
_TO_THE_RIGHT = "Wheel lateral displacement, to the right (mm)"
_POSITION = "y, to the right (mm)"


@dataclass(frozen=True, kw_only=True)
class Series:
    """One curve.

    Attributes:
        label: For the legend.
        x: Abscissae, shape (n,), in the unit of the figure's label.
        y: Ordinates, shape (n,), not-a-number where the curve is interrupted.
    """

    label: str
    x: Vector
    y: Vector


@dataclass(frozen=True, kw_only=True)
class Figure:
    """One set of axes.

    Attributes:
        number: Of the thesis's figure, with a letter where it has several axes: 3.12a.
        title: What it shows.
        x_label: With the unit.
        y_label: With the unit.
        series: The curves.
    """

    number: str
    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]


def thesis_figures(pair: WheelRailPair | None = None) -> dict[str, Figure]:
    """Every figure of section 3.4 that shows results.

    Args:
        pair: Profiles, the thesis's if not given; the same on both sides.

    Returns:
        The figures by number: 3.12a to 3.13c, 3.14 to 3.23.

    Raises:
        InputError: The pair cannot be tabulated from -20 to 20 mm.
    """
    used = pair or WheelRailPair()
    wheelset = wheelset_table(used)
    figures = [
        *profile_figures(used),
        *contact_figures(wheelset, used.wheel_datum),
        *(
            patch_figure(number, wheelset, right, used.wheel_datum)
            for number, right in _PATCHES.items()
        ),
        law_figure(wheelset.right),
    ]
    return {figure.number: figure for figure in sorted(figures, key=lambda entry: entry.number)}


def profile_figures(pair: WheelRailPair, spacing: float = 1e-4) -> tuple[Figure, ...]:
    """Height, slope and curvature of the right rail and wheel (figures 3.12 and 3.13).

    Args:
        pair: The profiles and where they stand, the wheelset centred.
        spacing: Distance of two points. [m]

    Returns:
        Three figures of the rail, three of the wheel.
    """
    parts = (
        ("3.12", "rail", pair.rail, pair.rail_axis),
        ("3.13", "wheel", pair.wheel, pair.wheel_datum),
    )
    return tuple(figure for part in parts for figure in _one_profile(*part, spacing=spacing))


def _one_profile(
    number: str, part: str, profile: Profile, origin: float, *, spacing: float
) -> list[Figure]:
    count = int(np.ceil((profile.end - profile.start) / spacing)) + 1
    # Each side of a joint, so that a step of the curvature is drawn upright.
    near = np.concatenate((profile.joints - 1e-9, profile.joints))
    lateral = np.unique(np.concatenate((np.linspace(profile.start, profile.end, count), near)))
    x = _MM * (origin + lateral)
    quantities = (
        ("a", "Profile", "z (mm)", _MM * profile.height(lateral)),
        ("b", "Tangential angle", "Tangential angle (°)", np.degrees(profile.slope_angle(lateral))),
        ("c", "Curvature", "Curvature (1/m)", profile.curvature(lateral)),
    )
    return [
        Figure(
            number=number + letter,
            title=f"{title} of the {part} {profile.name}",
            x_label=_POSITION,
            y_label=label,
            series=(Series(label=profile.name, x=x, y=y),),
        )
        for letter, title, label, y in quantities
    ]


def contact_figures(wheelset: WheelsetTable, wheel_datum: float) -> tuple[Figure, ...]:
    """Angle, ratio of the semi-axes, position and area (figures 3.14, 3.15, 3.17 and 3.22).

    Args:
        wheelset: Both wheels' tables.
        wheel_datum: Distance of the tread datum from the middle of the wheelset. [m]

    Returns:
        Four figures with a curve for each wheel.
    """
    left, right = wheelset.left.rows, wheelset.right.rows
    quantities = (
        (
            "3.14",
            "Contact angle",
            "Contact angle (°)",
            [np.degrees(rows.contact_angle) for rows in (left, right)],
        ),
        (
            "3.15",
            "Semi-axes ratio a/b of the contact ellipse",
            "Ellipse semi-axes ratio a/b",
            [rows.semi_axis_ratio for rows in (left, right)],
        ),
        (
            "3.17",
            "Lateral position of the contact point on the wheel",
            "Distance from the middle of the wheelset (mm)",
            [_MM * (wheel_datum + rows.wheel_lateral) for rows in (left, right)],
        ),
        (
            "3.22",
            "Elliptical contact area",
            "Contact area (cm²)",
            [1e4 * rows.area for rows in (left, right)],
        ),
    )
    return tuple(
        Figure(
            number=number,
            title=title,
            x_label=_TO_THE_RIGHT,
            y_label=label,
            series=(
                _curve("Left wheel", wheelset.left, -1.0, values[0]),
                _curve("Right wheel", wheelset.right, 1.0, values[1]),
            ),
        )
        for number, title, label, values in quantities
    )


def _curve(label: str, table: ContactTable, sign: float, values: Vector) -> Series:
    """A quantity against the displacement to the right, interrupted at discontinuities."""
    x = sign * _MM * table.rows.displacement
    gaps = np.flatnonzero(np.diff(table.rows.displacement) == 0.0) + 1
    x, y = np.insert(x, gaps, x[gaps]), np.insert(values, gaps, np.nan)
    return (
        Series(label=label, x=x, y=y) if sign > 0.0 else Series(label=label, x=x[::-1], y=y[::-1])
    )


def patch_figure(number: str, wheelset: WheelsetTable, right: float, wheel_datum: float) -> Figure:
    """Outlines of both wheels' contact ellipses (figures 3.16 and 3.18 to 3.21).

    Args:
        number: Of the figure.
        wheelset: Both wheels' tables.
        right: The wheelset's displacement to the right. [m]
        wheel_datum: Distance of the tread datum from the middle of the wheelset. [m]

    Returns:
        Two closed curves in the planes of contact, each centred on its point in the wheel's frame.

    Raises:
        InputError: The displacement is outside the tables.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    series: list[Series] = []
    for label, rows, sign in zip(
        ("Left wheel", "Right wheel"), wheelset.at(-right), (-1.0, 1.0), strict=True
    ):
        centre = sign * (wheel_datum + rows.wheel_lateral)
        series.append(
            Series(
                label=label,
                x=_MM * (centre + rows.lateral_semi_axis * np.cos(turn)),
                y=_MM * rows.longitudinal_semi_axis * np.sin(turn),
            )
        )
    return Figure(
        number=number,
        title=f"Contact patches, wheelset {_MM * right:g} mm to the right",
        x_label=_POSITION,
        y_label="x, along the track (mm)",
        series=tuple(series),
    )


def law_figure(table: ContactTable, displacement: ArrayLike = 0.0, loads: float = 3.0) -> Figure:
    """Linear and nonlinear force-deflection relationship of the contact (figure 3.23).

    Args:
        table: A wheel's table, whose normal force is the static load.
        displacement: Of the wheel, outwards; one number. [m]
        loads: Greatest force, in static loads. [1]

    Returns:
        Hertz's law and the spring of the stiffness k_h, both through the origin: the two laws of
        the contact element.

    Raises:
        InputError: The displacement is outside the table.
    """
    rows = table.at(displacement)
    constant, stiffness = rows.hertz_constant[0], rows.contact_stiffness[0]
    deflection = np.linspace(0.0, (loads * table.normal_force / constant) ** (2.0 / 3.0), 201)
    laws = {"Nonlinear": constant * deflection**1.5, "Linear": stiffness * deflection}
    return Figure(
        number="3.23",
        title="Force-deflection relationships of the contact spring",
        x_label="Deflection (mm)",
        y_label="Contact force (kN)",
        series=tuple(
            Series(label=label, x=_MM * deflection, y=1e-3 * force) for label, force in laws.items()
        ),
    )
