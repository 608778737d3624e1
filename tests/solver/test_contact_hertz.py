"""Hertz's theory against the thesis's tables and numbers, closed forms and the half-space."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from scipy.integrate import quad
from scipy.special import ellipe, ellipkm1

from solver.arrays import FloatArray
from solver.contact.hertz import (
    STEEL,
    HertzContact,
    Material,
    contact_modulus,
    hertz_contact,
)
from solver.contact.hertz_coefficients import axes_ratio, coefficients, hertz_integrals
from solver.contact.hertz_curvature import PrincipalCurvatures, combine
from solver.contact.hertz_tables import (
    hertz_1882,
    neves_ellipse,
    neves_stiffness,
    shabana_2001,
)
from solver.errors import InputError

WHEEL = PrincipalCurvatures(longitudinal=2.165, lateral=-5.147)
RAIL = PrincipalCurvatures(longitudinal=0.0, lateral=12.426)
"""S1002 on 60E1, wheelset centred: Neves (2016), section 3.4 (12.43 there, rounded)."""
WHEEL_LOAD = 83385.0
"""8.5 t. [N] (The thesis prints kN.)"""


def body(longitudinal: ArrayLike, lateral: ArrayLike) -> PrincipalCurvatures:
    return PrincipalCurvatures(longitudinal=longitudinal, lateral=lateral)


def rounded_differently(ours: FloatArray, printed: FloatArray, last_digit: float) -> set[int]:
    """Rows, counted in steps of 2 degrees from 2, whose last printed digit is not ours."""
    return {2 * int(i) + 2 for i in np.flatnonzero(np.abs(ours - printed) > 0.5 * last_digit)}


# Coefficients: tables and independent computations ---------------------------------------------


def test_table_3_3_to_the_last_printed_digit() -> None:
    table = neves_ellipse()
    ours = coefficients(table.theta)
    assert table.theta.size == 45
    # Within one unit of the eighth decimal; Maple's last digit is not the rounded one at:
    assert np.all(np.abs(ours.m - table.m) < table.last_digit)
    assert np.all(np.abs(ours.n - table.n) < table.last_digit)
    assert rounded_differently(ours.m, table.m, table.last_digit) == {2, 14, 20, 32, 50}
    assert rounded_differently(ours.n, table.n, table.last_digit) == {86}


def test_table_3_4_to_the_last_printed_digit() -> None:
    table = neves_stiffness()
    ours = coefficients(table.theta).beta
    assert table.theta.size == 45
    # Within one unit of the ninth decimal; two where beta is above one, because Maple worked with
    # ten digits in all: 2.0, 1.7 and 1.2 units at 2, 4 and 8 degrees.
    units = np.abs(ours - table.beta) / table.last_digit
    assert np.all(units < np.where(table.beta > 1.0, 2.1, 1.0))
    expected = {2, 4, 8, 24, 32, 38, 82, 86, 90}
    assert rounded_differently(ours, table.beta, table.last_digit) == expected


def test_hertz_own_table() -> None:
    table = hertz_1882()
    ours = coefficients(table.theta)
    degrees = np.rint(np.degrees(table.theta))
    error_m, error_n = np.abs(ours.m / table.m - 1.0), np.abs(ours.n / table.n - 1.0)
    # Neves (2016), below figure 3.10: greatest difference 2.4 percent.
    assert 100.0 * max(error_m.max(), error_n.max()) == pytest.approx(2.4, abs=0.05)
    assert degrees[np.argmax(error_n)] == 10.0
    # Hertz interpolated in Legendre's tables: all but these five agree to a part in ten thousand.
    assert set(degrees[error_m > 1e-4]) == {20.0, 70.0}
    assert set(degrees[error_n > 2e-4]) == {10.0, 20.0, 70.0}


def test_closed_forms_of_shabana() -> None:
    table = hertz_1882()
    m, _ = shabana_2001(table.theta)
    error = 100.0 * (m / table.m - 1.0)
    # Neves (2016), below table 3.2: "about 7.8 percent", which is at 10 degrees.
    assert np.argmax(np.abs(error)) == 0
    assert error[0] == pytest.approx(-7.8, abs=0.05)
    theta = np.radians(np.linspace(10.0, 90.0, 801))
    m, n = shabana_2001(theta)
    exact = coefficients(theta)
    assert 100.0 * np.max(np.abs(m / exact.m - 1.0)) == pytest.approx(7.82, abs=0.01)
    assert 100.0 * np.max(np.abs(n / exact.n - 1.0)) == pytest.approx(4.80, abs=0.01)
    assert m[-1] == pytest.approx(1.0, abs=1e-12)
    assert n[-1] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    ("degrees", "k", "m", "n", "beta"),
    [  # mpmath 1.3 with 40 digits, from K and E (their cancellation is harmless there)
        (
            1e-6,
            1.9296435495847277e-9,
            555020.01687387185,
            0.0010709907954510735,
            2607860.7634307482,
        ),
        (1e-3, 2.3901490243774635e-6, 4812.1968866930771, 0.011501867693841725, 3856.1624256540696),
        (1.0, 0.0035550509439462485, 36.931940300150979, 0.13129492922581823, 7.5526401749777005),
        (45.0, 0.3134388680265536, 1.9264621329921903, 0.60382811026109208, 0.40282756387098046),
        (89.0, 0.97699660002775291, 1.0117382602443879, 0.98846484037676085, 0.31834221065159976),
        (89.999, 0.99997672921407461, 1.000011635629887, 0.99998836457319132, 0.31830988621611158),
        (
            89.999999,
            0.9999999767289437,
            1.0000000116355284,
            0.99999998836447182,
            0.3183098861837907,
        ),
        (90.0, 1.0, 1.0, 1.0, 1.0 / np.pi),
    ],
)
def test_all_digits_from_line_to_circle(
    degrees: float, k: float, m: float, n: float, beta: float
) -> None:
    theta = np.radians(degrees)
    # Double precision throughout: a few units of rounding, nothing lost to cancellation.
    assert axes_ratio(theta) == pytest.approx(k, rel=1e-14)
    assert tuple(coefficients(theta)) == pytest.approx((m, n, beta), rel=1e-14)


@pytest.mark.parametrize("k", [0.02, 0.3, 0.95])
def test_integrals_by_quadrature_and_by_legendre_forms(k: float) -> None:
    def integrand(first: float, second: float, z: float) -> float:
        return (1.0 + (k * z) ** 2) ** -first * (1.0 + z**2) ** -second

    powers = ((0.5, 0.5), (1.5, 0.5), (0.5, 1.5))
    # z = tan(t) makes the interval finite: dz = (1 + z^2) dt.
    quadratures = [
        quad(lambda t, p=p: integrand(p[0], p[1] - 1.0, np.tan(t)), 0.0, 0.5 * np.pi)[0]
        for p in powers
    ]
    ours = hertz_integrals(k)
    assert tuple(map(float, ours)) == pytest.approx(quadratures, rel=1e-10)  # quad's own accuracy
    K, E, parameter = ellipkm1(k**2), ellipe(1.0 - k**2), 1.0 - k**2
    legendre = (K, (K - E) / parameter, (E - k**2 * K) / parameter)
    assert tuple(map(float, ours)) == pytest.approx(legendre, rel=1e-13)  # cancels at k = 0.95


@given(st.lists(st.floats(1e-8, 0.5 * np.pi), min_size=2, max_size=8, unique=True))
@settings(deadline=None)
def test_coefficients_are_monotonic(angles: list[float]) -> None:
    theta = np.sort(angles)
    theta = theta[np.append(True, np.diff(theta) > 1e-6 * theta[1:])]
    m, n, beta = coefficients(theta)
    for line, circle in pairwise(range(theta.size)):
        assert m[line] > m[circle] >= 1.0
        assert n[line] < n[circle] <= 1.0
        # Flat at the circle, where differences of beta are of second order in pi/2 - theta.
        assert beta[line] >= beta[circle] * (1.0 - 1e-14)


# Geometry --------------------------------------------------------------------------------------


def test_section_3_4_geometry() -> None:
    curvature = combine(WHEEL, RAIL)
    assert float(curvature.C1) == pytest.approx(4.722, abs=5e-4)
    assert float(curvature.C2) == pytest.approx(-2.557, abs=5e-4)
    assert float(np.degrees(curvature.theta)) == pytest.approx(57.21, abs=5e-3)
    assert float(np.cos(curvature.theta)) == pytest.approx(float(-curvature.C2 / curvature.C1))
    assert curvature.direction == 0.0, "the long axis lies along the track"


CURVATURE = st.floats(0.01, 100.0)
ANGLE = st.floats(-np.pi, np.pi)


@given(CURVATURE, CURVATURE, CURVATURE, st.floats(-0.009, 100.0), ANGLE)
@settings(deadline=None)
def test_relative_curvature_is_the_principal_system_of_the_gap(
    w1: float, w2: float, r1: float, r2: float, psi: float
) -> None:
    ours = combine(body(w1, w2), body(r1, r2), psi)
    largest = max(w1, w2, r1, abs(r2))
    # Law of cosines of the thesis (3.20, 3.26), as printed.
    C1 = 0.5 * (w1 + w2 + r1 + r2)
    p, q = w1 - w2, r1 - r2
    C2 = -0.5 * np.sqrt(max(p**2 + q**2 + 2.0 * p * q * np.cos(2.0 * psi), 0.0))
    assert float(ours.C1) == pytest.approx(C1, rel=1e-13)
    assert float(ours.C2) == pytest.approx(C2, abs=1e-7 * largest)  # root of a difference
    # The direction: the curvature of the gap along the long axis is 2 A, across it 2 B (Euler).
    for turn, coefficient in ((0.0, ours.A), (0.5 * np.pi, ours.B)):
        along = ours.direction + turn
        gap = body(w1, w2).along(along) + body(r1, r2).along(along - psi)
        assert float(gap) == pytest.approx(2.0 * float(coefficient), abs=1e-13 * largest)


@given(CURVATURE, CURVATURE, CURVATURE, CURVATURE, ANGLE)
@settings(deadline=None)
def test_invariance_under_exchange_of_bodies_and_turn_of_axes(
    w1: float, w2: float, r1: float, r2: float, psi: float
) -> None:
    ours = hertz_contact(body(w1, w2), body(r1, r2), psi)
    same = {
        "bodies exchanged": hertz_contact(body(r1, r2), body(w1, w2), psi),
        "angle reversed": hertz_contact(body(w1, w2), body(r1, r2), -psi),
        "rail turned half round": hertz_contact(body(w1, w2), body(r1, r2), psi + np.pi),
        "rail's axes renamed": hertz_contact(body(w1, w2), body(r2, r1), psi + 0.5 * np.pi),
        "both bodies' axes renamed": hertz_contact(body(w2, w1), body(r2, r1), psi),
    }
    for what, other in same.items():
        assert float(other.constant) == pytest.approx(float(ours.constant), rel=1e-9), what
        patch, reference = other.patch(1e5), ours.patch(1e5)
        # An angle at pi is known to 1e-16, A then to that part of the largest curvature, 1e-12 of
        # A in the worst case drawn.
        assert float(patch.long_semi_axis) == pytest.approx(
            float(reference.long_semi_axis), rel=1e-9
        ), what


def test_direction_turns_with_the_bodies() -> None:
    flat = body(0.0, 0.0)
    long_wheel = body(1.0, 5.0)
    assert combine(long_wheel, flat).direction == 0.0
    assert combine(body(5.0, 1.0), flat).direction == 0.5 * np.pi
    turned = combine(flat, body(1.0, 5.0), 0.3)
    assert float(turned.direction) == pytest.approx(0.3)
    circle = combine(body(0.0, 2.0), body(0.0, 2.0), 0.5 * np.pi)
    assert circle.direction == 0.0, "rounding does not turn a circle"
    patch = hertz_contact(flat, body(1.0, 5.0), 0.3).patch(1e5)
    assert float(patch.extent(0.3)) == pytest.approx(float(patch.long_semi_axis))
    assert float(patch.extent(0.3 + 0.5 * np.pi)) == pytest.approx(float(patch.short_semi_axis))


def test_nearly_conforming_bodies_keep_their_digits() -> None:
    # Rail 10 1/m in a groove of -10 (1 - 1e-10): A by differences of C1 and C2 would lose them.
    groove = -10.0 * (1.0 - 1e-10)
    curvature = combine(body(2.0, groove), body(0.0, 10.0))
    assert float(curvature.A) == pytest.approx(0.5 * (10.0 + groove), rel=1e-15)
    contact = hertz_contact(body(2.0, groove), body(0.0, 10.0))
    assert np.isfinite(contact.constant)
    assert float(contact.patch(1e5).extent(0.5 * np.pi)) > 1e3 * float(contact.patch(1e5).extent(0))


@pytest.mark.parametrize(
    ("wheel", "rail", "psi", "field", "value"),
    [
        (body(2.0, -20.0), body(0.0, 12.5), 0.0, "curvature lateral", -7.5),
        (body(2.0, -12.5), body(0.0, 12.5), 0.0, "curvature lateral", 0.0),  # fits exactly
        (
            body(0.0, 3.0),
            body(0.0, 4.0),
            0.0,
            "curvature longitudinal",
            0.0,
        ),  # rollers side by side
        (body(0.0, 0.0), body(0.0, 0.0), 0.0, "curvature longitudinal", 0.0),
        (body(-2.0, -3.0), body(1.0, 1.0), 0.0, "curvature lateral", -2.0),
        (body(0.0, 3.0), body(4.0, 0.0), 0.5 * np.pi, "curvature longitudinal", 0.0),
        (body(1.0, 1.0), body(3.0, -2.0), 0.7, "curvature at -49.893 degrees", -1.0),
        (body(np.nan, 1.0), body(0.0, 1.0), 0.0, "wheel.longitudinal", np.nan),
        (body(1.0, 1.0), body(0.0, np.inf), 0.0, "rail.lateral", np.inf),
    ],
)
def test_bodies_that_do_not_touch_at_a_point_are_refused(
    wheel: PrincipalCurvatures, rail: PrincipalCurvatures, psi: float, field: str, value: float
) -> None:
    with pytest.raises(InputError) as caught:
        hertz_contact(wheel, rail, psi)
    assert caught.value.field == field
    assert caught.value.value == pytest.approx(value, abs=1e-12, nan_ok=True)
    assert caught.value.remedy


def test_the_entry_of_a_table_is_named() -> None:
    with pytest.raises(InputError, match=r"curvature lateral \(entry 2\) = -1\.0.*wheel -4 1/m"):
        combine(body(2.0, np.array([-1.0, -2.0, -4.0])), body(0.0, 3.0))


# Law and patch ---------------------------------------------------------------------------------


def test_section_3_4_law() -> None:
    contact = hertz_contact(WHEEL, RAIL)
    assert contact.modulus == pytest.approx(115.385e9, abs=5e5)
    # The thesis reads 0.3578 from table 3.4 by linear interpolation.
    table = neves_stiffness()
    interpolated = float(np.interp(contact.curvature.theta, table.theta, table.beta))
    assert interpolated == pytest.approx(0.3578, abs=5e-5)
    printed = replace(contact, coefficients=contact.coefficients._replace(beta=np.array(0.3578)))
    # Half a unit of the last digit in the thesis (kN there) and, for k_h, in our own notes.
    assert float(printed.constant) == pytest.approx(7.958e10, abs=0.5e7)
    assert float(printed.tangent_stiffness(WHEEL_LOAD)) == pytest.approx(1.2124e9, abs=0.5e5)
    assert float(printed.tangent_stiffness(294.3e3)) == pytest.approx(1.8460e9, abs=0.5e5)
    # Exact beta: 0.015 percent less, as the chord of a convex curve lies above it.
    exact = float(contact.coefficients.beta)
    assert exact == pytest.approx(0.35775, abs=5e-6)
    assert exact / 0.3578 == pytest.approx(1.0 - 1.5e-4, abs=1e-5)
    assert float(contact.constant) == pytest.approx(7.957e10, abs=0.5e7)
    assert float(contact.tangent_stiffness(WHEEL_LOAD)) == pytest.approx(1.212e9, abs=0.5e6)
    assert float(contact.tangent_stiffness(294.3e3)) == pytest.approx(1.846e9, abs=0.5e6)


def test_section_3_4_patch() -> None:
    patch = hertz_contact(WHEEL, RAIL).patch(WHEEL_LOAD)
    longitudinal, lateral = float(patch.extent(0.0)), float(patch.extent(0.5 * np.pi))
    assert longitudinal / lateral == pytest.approx(2.23, abs=5e-3)
    assert longitudinal == pytest.approx(7.54e-3, abs=5e-6)
    assert lateral == pytest.approx(3.38e-3, abs=5e-6)
    assert float(patch.area) == pytest.approx(0.80e-4, abs=5e-7)
    assert float(patch.greatest_pressure) == pytest.approx(1.5 * WHEEL_LOAD / float(patch.area))


def test_sphere_on_plane_and_crossed_cylinders() -> None:
    radius, load = 0.46, WHEEL_LOAD
    modulus = contact_modulus(STEEL, STEEL)
    sphere = hertz_contact(body(1 / radius, 1 / radius), body(0.0, 0.0))
    cylinders = hertz_contact(body(1 / radius, 0.0), body(1 / radius, 0.0), 0.5 * np.pi)
    for contact in (sphere, cylinders):
        # Johnson (1985), equations 4.22 to 4.24; rounding only.
        assert float(contact.constant) == pytest.approx(
            4 / 3 * modulus * np.sqrt(radius), rel=1e-14
        )
        patch = contact.patch(load)
        circle = np.cbrt(0.75 * load * radius / modulus)
        assert float(patch.long_semi_axis) == pytest.approx(circle, rel=1e-14)
        assert float(patch.short_semi_axis) == pytest.approx(circle, rel=1e-14)
        pressure = np.cbrt(6.0 * load * modulus**2 / (np.pi**3 * radius**2))
        assert float(patch.greatest_pressure) == pytest.approx(pressure, rel=1e-14)
        assert float(contact.approach(load)) == pytest.approx(circle**2 / radius, rel=1e-14)


CONTACTS = {
    "wheel on rail": hertz_contact(WHEEL, RAIL),
    "yawed": hertz_contact(WHEEL, RAIL, 0.02),
    "gauge corner": hertz_contact(body(2.2, -50.0), body(0.0, 76.9)),
    "nearly conforming": hertz_contact(body(2.2, -12.49), body(0.0, 12.5)),
}


@pytest.mark.parametrize("name", CONTACTS)
def test_pressure_carries_the_load(name: str) -> None:
    patch = CONTACTS[name].patch(WHEEL_LOAD)
    a, b = float(patch.long_semi_axis), float(patch.short_semi_axis)
    # Polar coordinates of the ellipse with radius sqrt(1 - t^2): the pressure is then p0 t, the
    # area element a b t dt dphi, and both quadratures are exact.
    nodes, weights = np.polynomial.legendre.leggauss(4)
    t, phi = 0.5 * (nodes[:, None] + 1.0), 2.0 * np.pi * np.arange(8) / 8
    x, y = (np.sqrt(1.0 - t**2) * part for part in (a * np.cos(phi), b * np.sin(phi)))
    total = 0.5 * weights @ (a * b * t * patch.pressure(x, y)) @ np.full(8, 2.0 * np.pi / 8)
    assert float(total) == pytest.approx(WHEEL_LOAD, rel=1e-12)
    assert patch.pressure(0.0, 0.0) == patch.greatest_pressure
    assert patch.pressure(1.01 * a, 0.0) == 0.0
    assert patch.pressure(0.0, 1.01 * b) == 0.0


@pytest.mark.parametrize("name", CONTACTS)
def test_half_spaces_deform_as_the_gap_demands(name: str) -> None:
    """Boussinesq's integral of our pressure gives delta - A x^2 - B y^2 (3.41), all parts at once.

    Along every chord through a point the pressure is a semi-ellipse; its integral over r is known,
    and the integral over the direction is of a periodic function (trapezoidal rule, exponential).
    """
    contact = CONTACTS[name]
    patch, curvature = contact.patch(WHEEL_LOAD), contact.curvature
    a, b = float(patch.long_semi_axis), float(patch.short_semi_axis)
    phi = np.pi * np.arange(4000) / 4000
    for x, y in ((0.0, 0.0), (0.5 * a, 0.0), (0.0, 0.7 * b), (-0.4 * a, 0.6 * b)):
        c0 = 1.0 - (x / a) ** 2 - (y / b) ** 2
        c1 = -2.0 * (x * np.cos(phi) / a**2 + y * np.sin(phi) / b**2)
        c2 = (np.cos(phi) / a) ** 2 + (np.sin(phi) / b) ** 2
        chord = np.pi / 8.0 * (c1**2 + 4.0 * c0 * c2) / c2**1.5
        displacement = patch.greatest_pressure / (np.pi * contact.modulus) * np.pi * chord.mean()
        demanded = contact.approach(WHEEL_LOAD) - curvature.A * x**2 - curvature.B * y**2
        assert float(displacement) == pytest.approx(float(demanded), rel=1e-11)


@given(st.floats(1.0, 1e7), CURVATURE, CURVATURE, CURVATURE)
@settings(deadline=None)
def test_law_is_consistent(load: float, w1: float, w2: float, r2: float) -> None:
    contact = hertz_contact(body(w1, w2), body(0.0, r2))
    approach = float(contact.approach(load))
    assert float(contact.force(approach)) == pytest.approx(load, rel=1e-13)
    h = 1e-4 * approach
    slope = (contact.force(approach + h) - contact.force(approach - h)) / (2.0 * h)
    # Central difference of delta^1.5: relative error h^2 / 24 of the step's ratio, 4e-10.
    assert float(contact.tangent_stiffness(load)) == pytest.approx(float(slope), rel=1e-9)
    stiffness = contact.tangent_stiffness(np.array([load, 2.0 * load]))
    assert stiffness[1] / stiffness[0] == pytest.approx(2.0 ** (1.0 / 3.0))
    stiffer = hertz_contact(body(w1, w2), body(0.0, 0.5 * r2))
    assert stiffer.patch(load).area > contact.patch(load).area, "flatter bodies touch over more"
    assert stiffer.constant > contact.constant


def test_no_load_no_patch_and_no_tension() -> None:
    contact = hertz_contact(WHEEL, RAIL)
    patch = contact.patch(0.0)
    for value in (
        patch.long_semi_axis,
        patch.short_semi_axis,
        patch.area,
        patch.extent(0.3),
        patch.greatest_pressure,
        patch.pressure(0.0, 0.0),
        contact.approach(0.0),
        contact.tangent_stiffness(0.0),
        contact.force(-1e-3),
    ):
        assert value == 0.0
    for use in (contact.approach, contact.tangent_stiffness, contact.patch):
        for load in (-1.0, np.nan, np.inf):
            with pytest.raises(InputError, match="force"):
                use(np.array([1.0, load]))


def test_a_table_of_contacts_at_once() -> None:
    lateral = np.linspace(-12.0, 0.0, 5)
    table: HertzContact = hertz_contact(body(2.165, lateral), RAIL)
    loads = np.array([[0.0], [5e4], [1e5]])
    patch = table.patch(loads)
    assert patch.area.shape == patch.direction.shape == (3, 5)
    assert table.tangent_stiffness(loads).shape == (3, 5)
    for i, value in enumerate(lateral):
        one = hertz_contact(body(2.165, float(value)), RAIL)
        assert float(one.constant) == pytest.approx(float(table.constant[i]), rel=1e-14)
        assert float(one.patch(1e5).area) == pytest.approx(float(patch.area[2, i]), rel=1e-14)


def test_bad_materials_and_angles_are_refused() -> None:
    for bad in ({"young_modulus": 0.0}, {"young_modulus": np.nan}, {"poisson_ratio": 0.51}):
        with pytest.raises(InputError):
            Material(**bad)
    for theta in (0.0, -0.1, 1.5708, np.nan):
        with pytest.raises(InputError, match="theta"):
            coefficients([0.5, theta])
    # Unlike materials: a rubber-like body (nu = 0.5) on a stiff one carries all the deformation.
    soft = Material(young_modulus=1e6, poisson_ratio=0.5)
    assert contact_modulus(soft, STEEL) == pytest.approx(1e6 / 0.75, rel=1e-5)
