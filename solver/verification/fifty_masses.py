"""Neves (2016), section 4.4.2: fifty sprung masses over a beam with a sinusoidal irregularity.

The irregularity excites the masses at their own frequency while they are on the beam; beside it
the rail is perfect: had the last mass ridden 147 m in resonance, its amplitude would be 46 mm, not
the thesis's 13.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np

from solver.arrays import Vector
from solver.integrators.hht import HHT
from solver.irregularities.harmonic import HarmonicIrregularity
from solver.models.plane_beam import BeamOnSupports, plane_beams
from solver.models.solid_beam import SolidBeams, solid_beams
from solver.reference import Crossing as ReferenceCrossing
from solver.reference import Response, moving_sprung_masses
from solver.verification.case import Case, Findings, Progress, Result, Series
from solver.verification.crossings import Crossing, CrossingHistories, cross
from solver.verification.indented_beam import indented_beams
from solver.verification.recording import add_equilibrium, part_of
from solver.verification.sprung_mass import BEAM, MASS, REFERENCE_BEAM, STIFFNESS

__all__ = ["CASES", "SOLID_BEAM"]

COUNT, SPACING, SPEED, STEPS = 50, 3.0, 47.7 / 3.6, 14_000
METHOD = HHT(0.0, 1e-3)
ROUGHNESS = HarmonicIrregularity(amplitude=0.5e-3, wavelength=5.0, start=0.0, end=25.0)
SOLID_BEAM = SolidBeams(
    spans=(25.0,),
    width=2.2272,
    height=2.5,
    young_modulus=2.87e9,
    poisson_ratio=0.2,
    mass_per_length=2303.0,
    elements=(100, 10, 10),
    supports="pinned_pinned",
)
"""10,000 solids with 36,597 unknowns: so the two lines of supports hold all three directions."""
_TIMOSHENKO_BEAM = replace(
    BEAM,
    shear_rigidity=5.0 / 6.0 * 2.87e9 / 2.4 * 2.2272 * 2.5,
    rotary_inertia=2303.0 * 2.5**2 / 12.0,
)
_BEFORE, _AFTER = 150.0, 165.0
"""Lengths of the ground: all masses start on it, and the last ends there. [m]"""
_WINDOWS = {"first": (0, 0.0, 3.0), "last": (COUNT - 1, 11.0, 14.0)}
_FIGURES = {
    "beam": {"first": ("4.11", "4.12"), "last": ("4.13", "4.14")},
    "solids": {"first": ("4.16", ""), "last": ("4.17", "")},
}


def run(model: Literal["beam", "solids"], progress: Progress) -> Result:
    """Runs the 14,000 steps on one of the two models."""
    findings = Findings(_name(model))
    if model == "beam":
        found = _ours(plane_beams(BEAM, before=_BEFORE, after=_AFTER), part_of(progress, 0.0, 0.6))
    else:
        bridge = solid_beams(SOLID_BEAM, before=_BEFORE, after=_AFTER)
        unknowns = bridge.structure.n_dof - bridge.structure.prescribed.size
        findings.close("unconstrained degrees of freedom", "", 36597.0, float(unknowns), 0.0,
                       "The thesis's count is the mesh's and the supports'.")  # fmt: skip
        found = _ours(bridge, part_of(progress, 0.0, 0.75))
        fitting, _ = indented_beams(_TIMOSHENKO_BEAM, SOLID_BEAM, before=_BEFORE, after=_AFTER)
        flexible = _ours(fitting, part_of(progress, 0.75, 0.85))
        _compare_models(findings, found, flexible)
    exact = _reference(found.time)
    progress(0.99)
    for which in _WINDOWS:
        _compare(findings, model, which, found, exact)
    add_equilibrium(findings, found.recording)
    return findings.result()


def _ours(bridge: BeamOnSupports, progress: Progress) -> CrossingHistories:
    crossing = Crossing(
        bridge=bridge,
        mass=MASS,
        stiffness=STIFFNESS,
        count=COUNT,
        spacing=SPACING,
        speed=SPEED,
        unilateral=False,
        irregularity=ROUGHNESS,
    )
    return cross(crossing, METHOD, STEPS, progress)


def _reference(times: Vector) -> Response:
    crossing = ReferenceCrossing(
        beam=REFERENCE_BEAM,
        speed=SPEED,
        offsets=-SPACING * np.arange(COUNT, dtype=np.float64),
        times=np.asarray(times, np.float64),
        points=np.array([12.5]),
        surface=ROUGHNESS,
    )
    return moving_sprung_masses(crossing, np.full(COUNT, MASS), np.full(COUNT, STIFFNESS))


def _compare_models(
    findings: Findings, found: CrossingHistories, flexible: CrossingHistories
) -> None:
    """Solids against a beam with shear deformation and the dents that wheels press into solids."""
    pairs = [("displacement at mid-span", flexible.mid_span[:, 0], found.mid_span[:, 0])]
    for which, (mass, _, _) in _WINDOWS.items():
        pairs.append(
            (f"displacement of the {which} mass", flexible.mass[:, mass], found.mass[:, mass])
        )
    for quantity, wanted, ours in pairs:
        findings.history(
            f"{quantity}, against the beam with shear and dents", "m", wanted, ours, 0.03,
            "The bound of solids against beams in section 5.3.2 for whatever hangs on contact "
            "forces.",
        )  # fmt: skip


def _compare(
    findings: Findings, model: str, which: str, found: CrossingHistories, exact: Response
) -> None:
    mass, start, end = _WINDOWS[which]
    window = (found.time >= start - 1e-9) & (found.time <= end + 1e-9)
    time = found.time[window]
    pairs = (
        ("displacement", "m", "Displacement [mm]", 1e3, exact.load_displacement, found.mass),
        ("acceleration", "m/s2", "Acceleration [m/s²]", 1.0, exact.load_acceleration,
         found.mass_acceleration),
    )  # fmt: skip
    for number, (quantity, unit, label, scale, wanted, ours) in enumerate(pairs):
        theirs, mine = wanted[window, mass], ours[window, mass]
        if model == "beam":
            tolerance, reason = 0.01, (
                "Newmark's method lags by (omega dt)^2 / 12 of the phase, less than 0.1 percent "
                "for masses at 2.65 Hz; the irregularity's ends add kinks of 0.6 mrad."
            )  # fmt: skip
        else:
            tolerance, reason = 0.085, (
                "The reference knows neither shear, 2.4 percent of deflections, nor the dent under "
                "the wheel, which softens each spring by 0.4 percent: 6 percent of the phase in "
                "the 1.9 s of resonance on the beam."
            )  # fmt: skip
        findings.history(
            f"{quantity} of the {which} mass, {start:g} to {end:g} s", unit, theirs, mine,
            tolerance, reason,
        )  # fmt: skip
        figure = _FIGURES[model][which][number]
        if figure:
            findings.figure(
                f"Figure {figure}: {quantity} of the {which} mass, {model}", "Time [s]", label,
                Series(name="semi-analytical", x=time, y=scale * theirs, role="reference"),
                Series(name=f"direct method, {model}", x=time, y=scale * mine, role="ours"),
            )  # fmt: skip


def _name(model: str) -> str:
    return "fifty-masses" if model == "beam" else "fifty-masses-solids"


CASES = (
    Case(
        name=_name("beam"),
        title="Fifty sprung masses over a beam with an irregularity",
        source="Neves (2016), section 4.4.2",
        weight="slow",
        run=partial(run, "beam"),
    ),
    Case(
        name=_name("solids"),
        title="Fifty sprung masses over a beam of 10,000 solids",
        source="Neves (2016), section 4.4.2",
        weight="slow",
        run=partial(run, "solids"),
    ),
)
