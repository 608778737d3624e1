"""Points of contact: closed forms, brute force, the thesis's section 3.4, pairs that do not fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver.contact.measured_profile import smooth_profile
from solver.contact.profile import Arc, Polynomial, Profile, rail_60e1, wheel_s1002
from solver.contact.wheel_rail import WheelRailPair, find_contacts
from solver.errors import InputError


def _circle(name: str, start: float, end: float, radius: float, *, cap: bool) -> Profile:
    """An arc whose crown (or lowest point) is the origin."""
    centre = (0.0, -radius if cap else radius)
    return Profile(
        name=name, pieces=(Arc(start=start, end=end, centre=centre, radius=radius, cap=cap),)
    )


def _points(profile: Profile, step: float) -> np.ndarray:
    y = np.arange(profile.start + step / 3, profile.end, step)
    y = y[np.abs(np.degrees(profile.slope_angle(y))) < 82.0]
    return np.stack((y, profile.height(y)), axis=1)


@pytest.mark.parametrize(("radius", "cap"), [(0.05, False), (0.12, True)])
def test_circle_on_circle(radius: float, cap: bool) -> None:
    # Convex wheel of 50 mm, or a hollow one of 120 mm, on a rail of 40 mm: the point of contact
    # lies on the line of centres, so that sin(angle) = offset / (sum or difference of radii).
    head = 0.04
    wheel = _circle("wheel", -0.038, 0.038, radius, cap=cap)
    rail = _circle("rail", -0.038, 0.038, head, cap=True)
    pair = WheelRailPair(wheel=wheel, rail=rail, nominal_radius=0.5)
    moves = np.linspace(-0.008, 0.008, 33)
    found = find_contacts(pair, moves)
    offset = pair.wheel_datum + moves - pair.rail_axis  # wheel's centre from the rail's
    # The wheel's frame is one in which its profile's origin is the datum.
    relative = -radius if cap else radius
    sine = offset / (head + relative)
    # Positive towards the flange side (lateral < 0) means a rising rail: its left half.
    assert np.sin(found.contact_angle) == pytest.approx(-sine, abs=1e-12)
    assert found.rail_lateral == pytest.approx(head * sine, abs=1e-12)
    assert found.rail_lateral_curvature == pytest.approx(1.0 / head)
    assert found.wheel_lateral_curvature == pytest.approx(1.0 / relative)
    height = (head + relative) * np.sqrt(1.0 - sine**2) - head - relative
    assert found.wheel_rise == pytest.approx(height, abs=1e-14)
    assert np.all(np.isnan(found.second_gap))


def test_cone_on_a_round_rail() -> None:
    # 1:20 cone: contact where the rail's slope is 1:20, whatever the displacement.
    cone = Profile(
        name="cone", pieces=(Polynomial(start=-0.05, end=0.05, coefficients=(0.0, 0.05)),)
    )
    pair = WheelRailPair(wheel=cone, rail=_circle("rail", -0.038, 0.038, 0.08, cap=True),
                         gauge_depth=0.005)  # fmt: skip
    found = find_contacts(pair, [-0.01, 0.0, 0.01])
    assert found.contact_angle == pytest.approx(np.arctan(0.05), abs=1e-12)
    assert found.rail_lateral == pytest.approx(-0.08 * np.sin(np.arctan(0.05)), abs=1e-12)
    # Moved outwards by 10 mm the wheel runs on a radius that is 0.5 mm greater.
    assert np.diff(found.rolling_radius) == pytest.approx([0.0005, 0.0005])
    assert found.wheel_rate == pytest.approx(-1.0)


def test_position_of_the_thesis_pair() -> None:
    pair = WheelRailPair()
    # Gauge face 717.5 mm from the middle, 14 mm below the crown; datum 70 mm from the flange back.
    assert pair.rail_axis + pair.rail.joints[0] < 0.7175 < pair.rail_axis + pair.rail.joints[1]
    gauge_face = 0.7175 - pair.rail_axis
    assert pair.rail.height(gauge_face) == pytest.approx(-0.014, abs=1e-12)
    assert pair.wheel_datum == pytest.approx(0.75)


def test_contact_is_the_lowest_point_by_brute_force() -> None:
    pair = WheelRailPair()
    moves = np.linspace(-0.02, 0.02, 81)
    found = find_contacts(pair, moves)
    fine = np.arange(pair.rail.start, pair.rail.end, 2e-6)
    on_rail = pair.rail.height(fine)
    for row, move in enumerate(moves):
        gap = pair.wheel.height(pair.wheel_lateral(fine, move)) - on_rail
        best = int(np.nanargmin(gap))
        # No grid point is lower than the contact, and the best one is next to it.
        lowest = -found.wheel_rise[row]
        assert gap[best] - lowest + 1e-13 >= 0.0
        assert gap[best] - lowest < 1e-9
        assert abs(fine[best] - found.rail_lateral[row]) < 2e-6 + 1e-9


def test_slopes_agree_at_the_contact() -> None:
    pair = WheelRailPair()
    found = find_contacts(pair, np.linspace(-0.02, 0.02, 401))
    wheel = pair.wheel.slope_angle(found.wheel_lateral)
    # Kinks of up to 8e-6 at S1002's joints, bisection in between.
    assert wheel == pytest.approx(found.contact_angle, abs=1e-5)
    # The search is exact: the two "contact angles" of the thesis's figure 3.14 are one.
    assert np.sum(np.abs(wheel - found.contact_angle) > 1e-9) <= 2


def test_second_place_of_contact_is_reported() -> None:
    pair = WheelRailPair()
    found = find_contacts(pair, [0.0, 0.0039, 0.004, 0.0066])
    assert np.isnan(found.second_gap[0])
    assert 0.0 < found.second_gap[1] < 5e-6
    # Just past the jump the places have changed roles.
    assert found.second_wheel_lateral[1] == pytest.approx(found.wheel_lateral[2], abs=3e-4)
    assert found.second_wheel_lateral[2] == pytest.approx(found.wheel_lateral[1], abs=6e-4)


def test_thesis_numbers_centred() -> None:
    found = find_contacts(WheelRailPair(), [0.0])
    # Section 3.4, steps 1 to 6. The radius' curvature agrees with the last digit ...
    assert found.wheel_longitudinal_curvature[0] == pytest.approx(2.165, abs=1e-3)
    # ... while the thesis's search on spline points stops 0.38 mm beside the true minimum, whose
    # gap differs by half a micrometre (next test): curvatures within 1 percent, angle within 0.4.
    assert found.rail_lateral_curvature[0] == pytest.approx(12.43, rel=0.01)
    assert found.wheel_lateral_curvature[0] == pytest.approx(-5.147, rel=0.01)
    assert np.degrees(found.contact_angle[0]) == pytest.approx(4.6, abs=0.4)
    assert 0.75 + found.wheel_lateral[0] == pytest.approx(0.7397, abs=4e-4)


def test_thesis_point_is_half_a_micrometre_above_the_lowest() -> None:
    pair = WheelRailPair()
    found = find_contacts(pair, [0.0])
    thesis = 0.7397 - pair.rail_axis
    excess = pair.gap(thesis, 0.0)[0] + found.wheel_rise[0]
    assert 4e-7 < excess < 6e-7


def test_spline_of_sampled_profiles_gives_the_same_contacts() -> None:
    exact = WheelRailPair()
    # Points at 0.25 mm, no noise; the gauge is measured where the samples end, at the same place.
    sampled = replace(
        exact,
        wheel=smooth_profile(_points(wheel_s1002(), 2.5e-4), name="sampled S1002"),
        rail=smooth_profile(_points(rail_60e1(), 2.5e-4), name="sampled 60E1"),
        gauge_depth=0.012,
        track_gauge=2.0 * (exact.rail_axis + _gauge_face(0.012)),
    )
    assert sampled.rail_axis == pytest.approx(exact.rail_axis, abs=1e-7)
    moves = np.array([-0.02, -0.015, -0.01, -0.004, 0.0, 0.002, 0.0035, 0.005, 0.006, 0.01, 0.02])
    one, two = find_contacts(exact, moves), find_contacts(sampled, moves)
    # A spline rounds the steps of the curvature off over two or three points; away from them it
    # gives the point to 10 micrometres, the height to 0.1 and the curvatures to one percent.
    assert two.wheel_lateral == pytest.approx(one.wheel_lateral, abs=1e-5)
    assert two.wheel_rise == pytest.approx(one.wheel_rise, abs=1e-7)
    assert two.contact_angle == pytest.approx(one.contact_angle, abs=2e-4)
    assert two.rail_lateral_curvature == pytest.approx(one.rail_lateral_curvature, rel=0.01)
    assert two.wheel_lateral_curvature == pytest.approx(one.wheel_lateral_curvature, rel=0.02)


def _gauge_face(depth: float) -> float:
    """Where the upright 60E1 is ``depth`` below its crown on the gauge side."""
    y = np.linspace(-0.036, -0.03, 600_001)
    return float(y[np.argmin(np.abs(rail_60e1().height(y) + depth))])


def test_pairs_that_do_not_touch() -> None:
    with pytest.raises(InputError, match="do not touch"):
        find_contacts(WheelRailPair(flange_back_spacing=2.0), [0.0])
    # The rail under the very end of the wheel.
    with pytest.raises(InputError, match="end of one of them"):
        find_contacts(WheelRailPair(), [-0.075])
    tread = Profile(name="short", pieces=wheel_s1002().pieces[-1:])
    with pytest.raises(InputError, match="short"):
        find_contacts(WheelRailPair(wheel=tread), [0.0])


def test_profiles_that_fit_each_other() -> None:
    # A hollow wheel of the rail's own radius: contact along the whole arc.
    rail = _circle("rail", -0.03, 0.03, 0.04, cap=True)
    wheel = _circle("wheel", -0.035, 0.035, 0.04, cap=True)
    pair = WheelRailPair(wheel=wheel, rail=rail, gauge_depth=0.01)
    offset = pair.rail_axis - pair.wheel_datum
    with pytest.raises(InputError, match="touch"):
        find_contacts(pair, [offset])


def test_values_that_are_no_pair() -> None:
    for field in ("track_gauge", "nominal_radius", "gauge_depth"):
        for value in (0.0, -1.0, np.nan):
            with pytest.raises(InputError, match=field):
                WheelRailPair(**{field: value})
    with pytest.raises(InputError, match="gauge side"):
        WheelRailPair(gauge_depth=0.05)
    with pytest.raises(InputError, match="finite"):
        find_contacts(WheelRailPair(), [0.0, np.nan])
