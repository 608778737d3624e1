"""The table against lateral displacement, its discontinuities, and the thesis's figures from it."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from solver.contact.figures import thesis_figures
from solver.contact.hertz import hertz_contact
from solver.contact.hertz_curvature import PrincipalCurvatures
from solver.contact.lookup_table import (
    ContactRows,
    ContactTable,
    contact_table,
    displacements,
    wheelset_table,
)
from solver.contact.profile import rail_60e1
from solver.contact.wheel_rail import WheelRailPair, find_contacts
from solver.errors import InputError


@pytest.fixture(scope="module")
def table() -> ContactTable:
    """The thesis's pair, -20 to 20 mm."""
    return contact_table(WheelRailPair())


def test_rows_are_those_asked_for(table: ContactTable) -> None:
    asked = table.rows.displacement[table.requested]
    assert len(asked) == 401
    assert asked == pytest.approx(np.arange(-200, 201) * 1e-4, abs=1e-15)
    assert np.sum(~table.requested) == 2 * len(table.discontinuities)
    assert np.all(np.diff(table.rows.displacement) >= 0.0)


def test_jumps_of_the_thesis_pair(table: ContactTable) -> None:
    first, flange = table.jumps
    # Figure 3.17: 731 -> 723.6 mm; our exact profiles jump 0.13 mm later (next test but one).
    assert first.displacement == pytest.approx(3.93e-3, abs=5e-6)
    assert 0.75 + first.wheel_lateral[0] == pytest.approx(0.7310, abs=2e-4)
    assert 0.75 + first.wheel_lateral[1] == pytest.approx(0.7236, abs=4e-4)
    # "The curvature of the rail is 12.5 and 76.9 1/m" on both sides.
    around = table.at([3.9e-3, 4.0e-3]).rail_lateral_curvature
    assert around == pytest.approx([12.5, 76.92], abs=0.01)
    # "Flange contact occurs for displacements greater than 6.6 mm": between 6.6 and 6.7 mm.
    assert 6.6e-3 < flange.displacement < 6.7e-3
    assert np.degrees(flange.contact_angle[1]) == pytest.approx(70.0, abs=0.01)


def test_jumps_are_where_two_places_touch_at_once(table: ContactTable) -> None:
    pair = WheelRailPair()
    for jump in table.jumps:
        heights = pair.gap(np.array(jump.rail_lateral), jump.displacement)[0]
        # Enclosed to a picometre of displacement, times the flange's slope of 2.7.
        assert heights[0] == pytest.approx(heights[1], abs=1e-11)
    near = table.two_point(5e-5)
    assert table.rows.displacement[near].min() >= 3.6e-3
    assert {round(1e3 * float(d), 2) for d in table.rows.displacement[near]} >= {3.93, 6.68}


def test_a_lean_of_2_8_milliradians_explains_the_thesis_positions() -> None:
    # All positions that section 3.4 prints follow, together, if its two profiles are turned by
    # 0.16 degrees against each other; the true profiles as placed in the text give 740.08 mm,
    # 3.93 mm and 6.68 mm. The text gives no cause (a smoothed list of points may be one).
    upright = WheelRailPair()
    leaning = replace(upright, rail=rail_60e1(-0.0028))
    # Turned about the crown: the axis stays where it was.
    leaning = replace(leaning, track_gauge=1.435 - 2.0 * (leaning.rail_axis - upright.rail_axis))
    table = contact_table(leaning, displacements(0.007))
    assert 0.75 + table.at(0.0).wheel_lateral[0] == pytest.approx(0.7397, abs=5e-5)
    first, flange = table.jumps
    assert 3.7e-3 < first.displacement < 3.8e-3
    assert 0.75 + first.wheel_lateral[0] == pytest.approx(0.7310, abs=1e-4)
    assert 0.75 + first.wheel_lateral[1] == pytest.approx(0.7236, abs=1e-4)
    assert 6.6e-3 < flange.displacement < 6.7e-3


def test_hertz_numbers_of_the_thesis() -> None:
    # Steps 3 to 13 of section 3.4 from its own curvatures.
    law = hertz_contact(
        PrincipalCurvatures(longitudinal=2.165, lateral=-5.147),
        PrincipalCurvatures(longitudinal=0.0, lateral=12.426),
    )
    patch = law.patch(83_385.0)
    assert float(patch.extent(0.0) / patch.extent(np.pi / 2)) == pytest.approx(2.2, abs=0.05)
    assert float(law.constant) == pytest.approx(7.958e10, rel=2e-4)  # printed digits
    assert float(law.tangent_stiffness(83_385.0)) == pytest.approx(1.212e9, rel=5e-4)


def test_hertz_numbers_of_our_contact(table: ContactTable) -> None:
    centred = table.at(0.0)
    assert centred.semi_axis_ratio[0] == pytest.approx(2.2, abs=0.05)
    # The point of contact differs from the thesis's by 0.38 mm (test_contact_wheel_rail): K_h by
    # 0.2 percent, k_h by 0.1.
    assert centred.hertz_constant[0] == pytest.approx(7.958e10, rel=2e-3)
    assert centred.contact_stiffness[0] == pytest.approx(1.212e9, rel=1e-3)
    assert 1e4 * centred.area[0] == pytest.approx(0.80, abs=0.005)


def test_shape_of_the_thesis_curves(table: ContactTable) -> None:
    asked, rows = table.requested, table.rows
    angle = np.degrees(rows.contact_angle[asked])
    moves = rows.displacement[asked]
    # Figure 3.14: below 10 degrees to 3.9 mm, flange face from 6.7 mm, then down the flange's R20.
    assert np.all(angle[moves < 3.9e-3] < 10.0)
    assert angle.max() == pytest.approx(70.0, abs=1e-3)
    flange = angle[moves > 6.65e-3]
    assert np.all(np.diff(flange) <= 1e-9)
    # Figure 3.17: wheel and point of contact move in opposite directions (in the wheel's frame).
    assert np.all(np.diff(rows.wheel_lateral[asked]) < 0.0)
    # Figure 3.15: thin long patches on the flange (to 25), transverse ones on the tread's crown.
    assert 20.0 < rows.semi_axis_ratio[asked].max() < 26.0
    assert rows.semi_axis_ratio[asked].min() < 1.0
    # Figure 3.22: the smallest area is 0.2 cm2, on the flange.
    assert 1e4 * rows.area[asked].min() == pytest.approx(0.24, abs=0.01)


def test_joint_of_the_rail_head_is_a_step_of_curvature(table: ContactTable) -> None:
    joint = table.discontinuities[0]
    assert joint.kind == "joint"
    assert joint.rail_lateral == pytest.approx([-0.010228] * 2, abs=1e-9)
    before, after = (table.at(joint.displacement + step) for step in (-1e-9, 1e-9))
    # From R300 to R80: the same place, another ellipse.
    assert before.rail_lateral_curvature[0] == pytest.approx(1 / 0.3)
    assert after.rail_lateral_curvature[0] == pytest.approx(12.5)


def test_ellipses_over_a_step_of_curvature_are_marked(table: ContactTable) -> None:
    marked = table.across_step[table.requested]
    moves = table.rows.displacement[table.requested]
    # Centred, the 6.7 mm wide ellipse about 13.4 mm from the rail's axis covers the joint of R300
    # and R80 at 10.2 mm by 0.2 mm; moved 3 mm outwards it lies on R80 alone. Beside -6.6 mm the
    # ellipse would be 35 mm wide.
    assert marked[np.isclose(moves, 0.0)][0]
    assert not marked[np.isclose(moves, 0.003)][0]
    assert np.all(marked[np.abs(moves + 0.0068) < 2.5e-4])


def test_interpolation_between_rows(table: ContactTable) -> None:
    rng = np.random.default_rng(1)
    moves = np.sort(rng.uniform(-0.02, 0.02, 500))
    exact, read = find_contacts(WheelRailPair(), moves), table.at(moves)
    # Linear between rows 0.1 mm apart; the point moves fast only where the bodies nearly fit each
    # other (rates 14 beside -6.58 mm, 10 at 6.6 mm). No row is mixed with one from across a jump.
    assert read.wheel_lateral == pytest.approx(exact.wheel_lateral, abs=5e-5)
    assert read.contact_angle == pytest.approx(exact.contact_angle, abs=5e-3)
    assert read.rolling_radius == pytest.approx(exact.rolling_radius, abs=4e-5)
    assert np.all(np.isin(np.round(read.rail_lateral_curvature, 3), [3.333, 12.5, 76.923]))


def test_values_at_rows_and_jumps(table: ContactTable) -> None:
    moves = table.rows.displacement[table.requested]
    read = table.at(moves)
    for entry in fields(ContactRows):
        of_rows = getattr(table.rows, entry.name)[table.requested]
        assert getattr(read, entry.name) == pytest.approx(of_rows, rel=1e-9), entry.name
    jump = table.jumps[0]
    sides = table.at([jump.displacement - 1e-12, jump.displacement])
    assert sides.wheel_lateral == pytest.approx(jump.wheel_lateral, abs=1e-9)
    with pytest.raises(InputError, match="table covers"):
        table.at([0.0, 0.0201])
    with pytest.raises(InputError, match="table covers"):
        table.at(np.nan)


def test_wheels_are_each_others_mirror_image() -> None:
    moves = displacements(0.008)
    pair = WheelRailPair()
    wheelset = wheelset_table(pair, WheelRailPair(), moves)
    lateral = np.linspace(-0.008, 0.008, 57)
    left, right = wheelset.at(lateral)[0], wheelset.at(-lateral)[1]
    for entry in fields(ContactRows):
        assert np.array_equal(getattr(left, entry.name), getattr(right, entry.name))
    # To the left (y > 0) the left wheel's flange comes to the rail.
    left, right = wheelset.at(0.0075)
    assert np.degrees(left.contact_angle[0]) == pytest.approx(70.0, abs=0.01)
    assert np.degrees(right.contact_angle[0]) < 3.0


def test_force_and_range_are_checked() -> None:
    for force in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(InputError, match="normal_force"):
            contact_table(WheelRailPair(), [0.0, 0.001], normal_force=force)
    for moves in ([0.0], [0.0, 0.0], [1e-3, 0.0], [[0.0, 1e-3]]):
        with pytest.raises(InputError, match="displacement"):
            contact_table(WheelRailPair(), moves)


def test_figures_of_the_thesis() -> None:
    figures = thesis_figures()
    assert list(figures) == [
        "3.12a", "3.12b", "3.12c", "3.13a", "3.13b", "3.13c", "3.14", "3.15", "3.16", "3.17",
        "3.18", "3.19", "3.20", "3.21", "3.22", "3.23",
    ]  # fmt: skip
    for figure in figures.values():
        assert figure.x_label
        assert figure.y_label
        for series in figure.series:
            assert series.x.shape == series.y.shape
            assert np.all(np.isfinite(series.x))
    # Figure 3.12: curvatures -3.3, -12.5 and -76.9 1/m; 3.13: from -76.9 (fillet) to 83.3 (tip).
    rail, wheel = figures["3.12c"].series[0].y, figures["3.13c"].series[0].y
    assert rail.min() == pytest.approx(-1 / 0.013)
    assert wheel.max() == pytest.approx(1 / 0.012)
    assert wheel.min() == pytest.approx(-1 / 0.013, rel=1e-3)
    # The right wheel's flange touches to the right, and its curve is interrupted at each jump.
    left, right = figures["3.14"].series
    assert np.nanmax(right.y[right.x < 0.0]) < 10.0 < np.nanmax(right.y[right.x > 6.7])
    assert np.sum(np.isnan(right.y)) == np.sum(np.isnan(left.y)) == 4
    assert np.all(np.diff(left.x) >= 0.0)
    assert np.array_equal(left.y, right.y[::-1], equal_nan=True)
    # Figure 3.16: two ellipses, 15 mm long and 6.7 mm wide, 740 mm on each side of the middle.
    for series, side in zip(figures["3.16"].series, (-1.0, 1.0), strict=True):
        assert np.mean(series.x[:-1]) == pytest.approx(side * 740.08, abs=0.01)
        assert np.ptp(series.y) / np.ptp(series.x) == pytest.approx(2.24, abs=0.01)
    # Figure 3.23: the linear spring has Hertz's tangent at the static load, hence two thirds of
    # the compression there.
    nonlinear, linear = figures["3.23"].series
    static = np.interp(83.385, nonlinear.y, nonlinear.x)
    assert np.interp(83.385, linear.y, linear.x) == pytest.approx(2 / 3 * static, rel=1e-4)
