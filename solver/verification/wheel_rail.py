"""Neves (2016), section 3.4: the wheel S1002 on the rail 60E1, figures 3.12 to 3.23."""

from __future__ import annotations

import numpy as np

from solver.contact.figures import thesis_figures
from solver.contact.lookup_table import ContactTable, wheelset_table
from solver.contact.profile import rail_60e1
from solver.contact.wheel_rail import WheelRailPair
from solver.verification.case import Case, Figure, Findings, Progress, Result, Series

__all__ = ["CASE"]

NAME = "wheel-rail-pair"
_LEAN = 2.8e-3
"""Angle between the profiles that explains the printed positions. [rad]"""


def run(progress: Progress) -> Result:
    """The centred wheelset's numbers, the jump, and all figures of the section."""
    findings = Findings(NAME)
    pair = WheelRailPair()
    table = wheelset_table(pair).right
    centred = table.at(0.0)
    curvature = (
        "The thesis's smoothed list of points has 12.43 1/m on the rail, the drawn radius of 80 mm "
        "is 12.5 1/m: that moves the semi-axes by 0.01 mm."
    )
    printed = (
        ("longer semi-axis of the centred wheel", "mm", 7.54, 1e3 * centred.longitudinal_semi_axis,
         0.02),
        ("shorter semi-axis of the centred wheel", "mm", 3.38, 1e3 * centred.lateral_semi_axis,
         0.02),
        ("ratio of the semi-axes", "", 2.23, centred.semi_axis_ratio, 0.02),
        ("area of the contact ellipse", "cm2", 0.80, 1e4 * centred.area, 0.005),
    )  # fmt: skip
    for quantity, unit, value, ours, tolerance in printed:
        findings.close(quantity, unit, value, float(ours[0]), tolerance, curvature)
    findings.value("stiffness about 83.385 kN", "N/m", 1.2124e9,
                   float(centred.contact_stiffness[0]), 2e-3, curvature)  # fmt: skip
    progress(0.5)
    _jumps(findings, table, pair.wheel_datum)
    findings.figures.extend(_drawn())
    progress(1.0)
    return findings.result()


def _jumps(findings: Findings, table: ContactTable, datum: float) -> None:
    """Where the point of contact jumps, and where the flange touches."""
    lean = (
        "A lean of 2.8 mrad between the two profiles explains every printed position at once; the "
        "true profiles, as placed in the text, jump 0.13 mm later."
    )
    findings.close("jumps of the contact point up to 20 mm", "", 2.0, float(len(table.jumps)), 0.0,
                   "Within the tread, and onto the flange.")  # fmt: skip
    first, flange = table.jumps[0], table.jumps[-1]
    findings.close("displacement at the first jump", "mm", 3.75, 1e3 * first.displacement, 0.25,
                   f"Between 3.7 and 3.8 mm in the thesis. {lean}")  # fmt: skip
    ends = 1e3 * (datum + np.array(first.wheel_lateral))
    for name, value, ours in (("before", 731.0, ends[0]), ("after", 723.6, ends[1])):
        findings.close(f"place of contact on the wheel {name} it", "mm", value, float(ours), 0.5,
                       lean)  # fmt: skip
    leaning = wheelset_table(WheelRailPair(rail=rail_60e1(-_LEAN))).right.jumps[0]
    findings.close("displacement at the first jump, profiles leaning", "mm", 3.75,
                   1e3 * leaning.displacement, 0.05, "Between 3.7 and 3.8 mm in the thesis: half "
                   "its step, with the lean of 2.8 mrad.")  # fmt: skip
    for name, value, place in zip(("before", "after"), (731.0, 723.6), leaning.wheel_lateral,
                                  strict=True):  # fmt: skip
        findings.close(f"place of contact on the wheel {name} it, profiles leaning", "mm", value,
                       1e3 * (datum + place), 0.15, "The thesis finds places to its spacing of "
                       "profile points, about 0.1 mm; with the lean of 2.8 mrad.")  # fmt: skip
    findings.close("displacement at flange contact", "mm", 6.65, 1e3 * flange.displacement, 0.05,
                   "Greater than 6.6 mm in the thesis, which tabulates every 0.1 mm.")  # fmt: skip


def _drawn() -> list[Figure]:
    """The figures of the section."""
    return [
        Figure(
            title=f"Figure {number}: {figure.title}",
            x_label=figure.x_label,
            y_label=figure.y_label,
            series=tuple(
                Series(name=curve.label, x=curve.x, y=curve.y, role="other" if index else "ours")
                for index, curve in enumerate(figure.series)
            ),
        )
        for number, figure in thesis_figures().items()
    ]


CASE = Case(
    name=NAME,
    title="Wheel S1002 on rail 60E1",
    source="Neves (2016), section 3.4",
    weight="fast",
    run=run,
)
