"""Hertz's theory: rows of tables 3.3 and 3.4, and the wheel-rail contact of section 3.4."""

from __future__ import annotations

import numpy as np

from solver.contact.hertz import STEEL, contact_modulus
from solver.contact.hertz_coefficients import coefficients
from solver.contact.hertz_tables import neves_ellipse, neves_stiffness
from solver.verification.case import Case, Findings, Progress, Result, Series

__all__ = ["CASE"]

NAME = "hertz-theory"
_SHOWN = (10.0, 30.0, 60.0, 85.0)
"""Angles whose rows are listed, besides the worst of each table. [deg]"""
_UNITS = 2.5
"""Units of the last digit printed."""
_LAST_DIGIT = (
    "Two and a half units of the last digit printed: the tables were computed with ten digits, "
    "whose own rounding reaches two units."
)


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
            "", float(printed[worst]), float(ours[worst]), _UNITS * digit, _LAST_DIGIT,
        )  # fmt: skip
        for angle in _SHOWN:
            found = np.flatnonzero(np.abs(degrees - angle) < 1e-6)
            if found.size:
                row = int(found[0])
                findings.close(
                    f"table {number}: {letter} at {angle:g} deg", "", float(printed[row]),
                    float(ours[row]), _UNITS * digit, _LAST_DIGIT,
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
    wheel, rail = (2.165, -5.147), (0.0, 12.426)
    first = 0.5 * (sum(wheel) + sum(rail))
    second = -0.5 * abs((wheel[0] - wheel[1]) + (rail[0] - rail[1]))
    theta = float(np.arccos(-second / first))
    modulus = contact_modulus(STEEL, STEEL)
    beta = float(coefficients(theta).beta)
    constant = 4.0 * np.pi * beta * modulus / (3.0 * np.sqrt(first))
    findings.value(
        "Hertz constant of section 3.4", "N/m^1.5", 7.958e10, float(constant), 5e-4,
        "The thesis interpolates beta linearly in table 3.4: 0.35782, exact 0.35776.",
    )  # fmt: skip
    for load, printed in ((83385.0, 1.2124e9), (294300.0, 1.8460e9)):
        ours = 1.5 * constant ** (2.0 / 3.0) * load ** (1.0 / 3.0)
        findings.value(f"linear stiffness under {1e-3 * load:g} kN", "N/m", printed, float(ours),
                       5e-4, "As the Hertz constant that it follows from.")  # fmt: skip


CASE = Case(
    name=NAME,
    title="Hertz's theory against the printed tables",
    source="Neves (2016), tables 3.3 and 3.4, section 3.4",
    weight="fast",
    run=run,
)
