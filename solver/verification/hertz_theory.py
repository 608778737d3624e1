"""Hertz's theory: rows of tables 3.3 and 3.4, and the wheel-rail contact of section 3.4."""

from __future__ import annotations

import numpy as np

from solver.contact.hertz import hertz_contact
from solver.contact.hertz_coefficients import coefficients
from solver.contact.hertz_curvature import PrincipalCurvatures
from solver.contact.hertz_tables import neves_ellipse, neves_stiffness
from solver.verification.case import Case, Findings, Progress, Result, Series

__all__ = ["CASE"]

NAME = "hertz-theory"
_SHOWN = (10.0, 30.0, 60.0, 85.0)
"""Angles whose rows are listed, besides the worst of each table. [deg]"""
_LAST_DIGIT = "One unit of the last digit printed."
_TEN_DIGITS = (
    "Two units of the last digit printed where beta exceeds 1, one elsewhere: the table was "
    "computed with ten digits, which run out there."
)


def _allowed(letter: str, printed: float, digit: float) -> tuple[float, str]:
    """Tolerance of a printed value, and its reason."""
    if letter == "beta":
        return (2.1 if printed > 1.0 else 1.0) * digit, _TEN_DIGITS
    return digit, _LAST_DIGIT


def run(progress: Progress) -> Result:
    """Compares whole tables, and lists some rows."""
    findings = Findings(NAME)
    ellipse, stiffness = neves_ellipse(), neves_stiffness()
    exact, exact_beta = coefficients(ellipse.theta), coefficients(stiffness.theta).beta
    tables = (
        ("m", "3.3", ellipse.theta, ellipse.m, exact.m, ellipse.last_digit),
        ("n", "3.3", ellipse.theta, ellipse.n, exact.n, ellipse.last_digit),
        ("beta", "3.4", stiffness.theta, stiffness.beta, exact_beta, stiffness.last_digit),
    )
    for letter, number, theta, printed, ours, digit in tables:
        degrees = np.degrees(theta)
        worst = int(np.argmax(np.abs(ours - printed)))
        findings.close(
            f"table {number}, worst of {printed.size} values: {letter} at {degrees[worst]:g} deg",
            "", float(printed[worst]), float(ours[worst]),
            *_allowed(letter, float(printed[worst]), digit),
        )  # fmt: skip
        for angle in _SHOWN:
            found = np.flatnonzero(np.abs(degrees - angle) < 1e-6)
            if found.size:
                row = int(found[0])
                findings.close(
                    f"table {number}: {letter} at {angle:g} deg", "", float(printed[row]),
                    float(ours[row]), *_allowed(letter, float(printed[row]), digit),
                )  # fmt: skip
    _section_3_4(findings)
    degrees = np.degrees(ellipse.theta)
    findings.figure(
        "Tables 3.3: coefficients m and n", "Angle theta [deg]", "Coefficient",
        Series(name="m, printed", x=degrees, y=ellipse.m, role="reference"),
        Series(name="n, printed", x=degrees, y=ellipse.n, role="reference"),
        Series(name="m", x=degrees, y=exact.m, role="ours"),
        Series(name="n", x=degrees, y=exact.n, role="other"),
    )  # fmt: skip
    progress(1.0)
    return findings.result()


def _section_3_4(findings: Findings) -> None:
    """K_h and k_h from the curvatures printed in section 3.4 (3.17 to 3.27, 3.67, 3.71)."""
    wheel = PrincipalCurvatures(longitudinal=2.165, lateral=-5.147)
    rail = PrincipalCurvatures(longitudinal=0.0, lateral=12.426)
    contact = hertz_contact(wheel, rail)
    findings.value(
        "Hertz constant of section 3.4", "N/m^1.5", 7.958e10, float(contact.constant), 5e-4,
        "The thesis interpolates beta linearly in table 3.4: 0.35782, exact 0.35776.",
    )  # fmt: skip
    for load, printed in ((83385.0, 1.2124e9), (294300.0, 1.8460e9)):
        ours = float(contact.tangent_stiffness(load))
        findings.value(f"linear stiffness under {1e-3 * load:g} kN", "N/m", printed, ours, 5e-4,
                       "As the Hertz constant that it follows from.")  # fmt: skip


CASE = Case(
    name=NAME,
    title="Hertz's theory against the printed tables",
    source="Neves (2016), tables 3.3 and 3.4, section 3.4",
    weight="fast",
    run=run,
)
