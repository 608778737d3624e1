"""Profiles of wheel and rail: geometry of the standards, smoothing of points, bad lists."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.contact.measured_profile import parse_profile, smooth_profile
from solver.contact.profile import Arc, Polynomial, Profile, rail_60e1, wheel_s1002
from solver.errors import InputError


def _points(profile: Profile, step: float = 2.5e-4, steepest: float = 82.0) -> np.ndarray:
    """Points on a profile where it is not steeper than a measuring device can follow."""
    y = np.arange(profile.start + step / 3, profile.end, step)
    y = y[np.abs(np.degrees(profile.slope_angle(y))) < steepest]
    return np.stack((y, profile.height(y)), axis=1)


def test_rail_head_has_the_dimensions_of_the_drawing() -> None:
    rail = rail_60e1()
    # 72 mm wide 14.3 mm below the crown (EN 13674-1); arcs of 300, 80 and 13 mm in between.
    assert rail.height(0.036) == pytest.approx(-0.0143, abs=1e-5)
    assert rail.height(0.0) == 0.0
    assert rail.curvature([0.005, 0.02, -0.03]) == pytest.approx([-1 / 0.3, -12.5, -1 / 0.013])
    assert np.degrees(rail.slope_angle(rail.end)) == pytest.approx(-np.degrees(np.arctan(20.0)))
    y = np.linspace(0.0, rail.end, 200)
    assert rail.height(-y) == pytest.approx(rail.height(y), abs=1e-15)


def test_wheel_has_the_dimensions_of_the_standard() -> None:
    wheel = wheel_s1002()
    assert wheel.height(0.0) == pytest.approx(0.0, abs=1e-12)
    # Flange height 28 mm, tip at -55 mm; slope of the flange face 70 degrees; reverse slope 1:15.
    assert wheel.height(-0.055) == pytest.approx(-0.028, abs=1e-6)
    assert np.degrees(wheel.slope_angle(-0.039)) == pytest.approx(70.0, abs=1e-5)
    assert wheel.slope_angle(0.05) == pytest.approx(np.arctan(1 / 15), rel=1e-6)
    # Flange thickness 32.5 mm, measured 10 mm below the tread datum from the flange back at -70 mm.
    face = np.linspace(-0.0393, -0.036, 20001)
    y = face[np.argmin(np.abs(wheel.height(face) + 0.010))]
    assert y + 0.070 == pytest.approx(0.0325, abs=1e-6)
    assert wheel.curvature([-0.058, -0.045, -0.037]) == pytest.approx([1 / 0.012, 50.0, -1 / 0.013])


@pytest.mark.parametrize("profile", [wheel_s1002(), rail_60e1(), rail_60e1(0.025), rail_60e1(0.05)])
def test_joints_are_smooth_and_derivatives_are_those_of_the_height(profile: Profile) -> None:
    for joint in profile.joints:
        below, above = profile.derivatives([joint - 1e-12, joint])[:2].T
        # Steep flanks move 1e-11 m in 1e-12 m; S1002's rounded coefficients leave kinks of 8e-6.
        assert above[0] == pytest.approx(below[0], abs=1e-9)
        assert np.arctan(above[1]) == pytest.approx(np.arctan(below[1]), abs=1e-5)
    h = 4e-6  # smaller ones lose the second difference to rounding (heights to 3e-14 m)
    y = np.linspace(profile.start, profile.end, 1003)[1:-1]
    far = np.all(np.abs(y[:, None] - profile.joints) > 2 * h, axis=1)
    y = y[far & (np.abs(profile.slope_angle(y)) < np.radians(80))]
    z, slope, bend = profile.derivatives(y)
    # Central differences: error h^2 z''''/6, where arcs of 13 mm end steeply.
    assert (profile.height(y + h) - profile.height(y - h)) / (2 * h) == pytest.approx(
        slope, rel=1e-4, abs=1e-8
    )
    assert (profile.height(y + h) - 2 * z + profile.height(y - h)) / h**2 == pytest.approx(
        bend, rel=2e-3, abs=1e-2
    )


def test_inclined_rail_is_the_upright_one_turned() -> None:
    upright, leaning = rail_60e1(), rail_60e1(1 / 40)
    y = np.linspace(-0.03, 0.03, 50)
    lean = np.arctan(1 / 40)
    turned_y = y * np.cos(lean) - upright.height(y) * np.sin(lean)
    turned_z = y * np.sin(lean) + upright.height(y) * np.cos(lean)
    assert leaning.height(turned_y) == pytest.approx(turned_z, abs=1e-14)
    assert leaning.slope_angle(turned_y) == pytest.approx(upright.slope_angle(y) + lean, abs=1e-12)


def test_a_corner_or_a_gap_is_no_profile() -> None:
    line = Polynomial(start=0.0, end=0.01, coefficients=(0.0, 0.1))
    for other in (
        Polynomial(start=0.01, end=0.02, coefficients=(0.0, 0.2)),
        Polynomial(start=0.01, end=0.02, coefficients=(1e-6, 0.1)),
        Polynomial(start=0.011, end=0.02, coefficients=(0.0, 0.1)),
    ):
        with pytest.raises(InputError, match="join smoothly"):
            Profile(name="broken", pieces=(line, other))
    with pytest.raises(InputError, match="empty"):
        Profile(name="nothing", pieces=())
    with pytest.raises(InputError, match="inclination"):
        rail_60e1(0.3)


def test_interpolating_spline_follows_a_circle() -> None:
    # 81 points at 0.5 mm on R = 80 mm: error of a cubic spline, of order (step / R)^2 in curvature.
    circle = Arc(start=-0.02, end=0.02, centre=(0.0, -0.08), radius=0.08, cap=True)
    y = np.linspace(-0.02, 0.02, 81)
    spline = smooth_profile(np.stack((y, circle.derivatives(y)[0]), 1), name="circle")
    inner = np.linspace(-0.018, 0.018, 333)
    assert spline.height(inner) == pytest.approx(circle.derivatives(inner)[0], abs=1e-10)
    assert spline.curvature(inner) == pytest.approx(-12.5, rel=1e-3)
    assert np.all(np.isnan(spline.height([-0.021, 0.021])))


@pytest.mark.parametrize("profile", [wheel_s1002(), rail_60e1()])
def test_smoothing_uses_up_the_stated_noise(profile: Profile) -> None:
    exact = _points(profile)
    noisy = exact + np.random.default_rng(0).normal(0.0, 1e-5 / np.sqrt(2.0), exact.shape)
    smooth = smooth_profile(noisy, name="measured", noise=1e-5)
    y = noisy[2:-2, 0]
    y = y[np.abs(np.degrees(profile.slope_angle(y))) < 75.0]
    # Distance at right angles to the profile; noise of 10 micrometres averages out over the points
    # between two knots; three times the noise at most, beside the steps of the curvature.
    error = np.abs(smooth.height(y) - profile.height(y)) * np.cos(profile.slope_angle(y))
    assert np.max(error) < 3e-5
    assert np.sqrt(np.mean(error**2)) < 8e-6


def test_csv_text_in_millimetres() -> None:
    exact = _points(rail_60e1()) * 1e3
    lines = "\n".join(f"{y:.9f}; {z:.9f}" for y, z in exact)
    table = parse_profile(f"# measured\nlateral [mm]; height [mm]\n\n{lines}\n")
    assert table == pytest.approx(exact * 1e-3, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "no points"),
        ("y,z\n", "no points"),
        ("1,2\nfour,5\n", "line 2"),
        ("1,2\n3\n", "line 2"),
        ("1,2,3\n", "line 1"),
        ("y,z\nname,units\n1,2\n", "line 2"),
        ("1,2\n" * 50_000, "too many"),
    ],
)
def test_csv_text_that_is_no_profile(text: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        parse_profile(text)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda p: p[:0], "empty"),
        (lambda p: p[:, 0], "no list of pairs"),
        (lambda p: p[:5], "too few"),
        (lambda p: p[::-1], "not sorted"),
        (lambda p: p[[0, 2, 1, *range(3, len(p))]], "not sorted"),
        (lambda p: p[[0, 1, 1, *range(2, len(p))]], "repeated"),
        (lambda p: np.where(p == p[7, 1], np.nan, p), "not finite"),
        (lambda p: np.where(p == p[7, 1], np.inf, p), "not finite"),
        (lambda p: p * 1e3, "breadth"),
    ],
)
def test_lists_of_points_that_are_no_profile(change, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        smooth_profile(change(_points(rail_60e1())), name="bad")


def test_noise_that_is_no_noise() -> None:
    for noise in (-1e-6, 0.1, np.nan):
        with pytest.raises(InputError, match="noise"):
            smooth_profile(_points(rail_60e1()), name="bad", noise=noise)


@given(st.text(max_size=200))
def test_any_text_is_points_or_an_input_error(text: str) -> None:
    try:
        table = parse_profile(text)
    except InputError:
        return
    assert table.shape[1] == 2


def test_a_mark_of_byte_order_is_no_heading() -> None:
    points = parse_profile("\ufeff-10.5,0.3\n0,0\n")
    np.testing.assert_allclose(points, [[-10.5e-3, 0.3e-3], [0.0, 0.0]])


def test_a_first_point_with_a_slip_of_the_pen_is_not_taken_for_a_heading() -> None:
    with pytest.raises(InputError, match=r"profile\.line 1"):
        parse_profile("-10.5;O.3\n0;0\n")
    np.testing.assert_allclose(parse_profile("y;z\n1;2\n"), [[1e-3, 2e-3]])
