"""Neves (2016), section 5.3.1: four sprung masses over two spans, contact lost and found again."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from solver.arrays import BoolVector, FloatArray, IntVector, Vector
from solver.contact.laws import ContactLaw, LinearHertz, NonlinearHertz, RigidContact
from solver.integrators.hht import HHT
from solver.methods.vehicles import GRAVITY
from solver.models.plane_beam import PlaneBeams, plane_beams
from solver.reference import Crossing as ReferenceCrossing
from solver.reference import SimplySupportedBeam, moving_sprung_masses
from solver.standards.low_pass import low_pass
from solver.verification.case import Case, Findings, Progress, Result, Role, Series
from solver.verification.crossings import Crossing, CrossingHistories, cross
from solver.verification.recording import add_equilibrium, part_of
from solver.verification.series_spring import SeriesSpring, moving_masses_on_hertz_springs

__all__ = [
    "BEAM",
    "CASES",
    "CONTACT_COEFFICIENT",
    "CONTACT_STIFFNESS",
    "COUNT",
    "DURATION",
    "MASS",
    "SPEED",
    "STIFFNESS",
    "TIMOSHENKO_BEAM",
    "compare_events",
    "events",
    "two_span_crossing",
]

LENGTH, COUNT, MASS, STIFFNESS, SPEED = 20.0, 4, 30e3, 156.55e6, 115.0
DURATION = 0.9
YOUNG, AREA, SECOND_MOMENT, LINEAR_MASS, POISSON = 25e9, 6.0, 3.0, 30e3, 0.2
CONTACT_COEFFICIENT = 7.958e10
"""K_h of section 3.4. [N/m^1.5]"""
CONTACT_STIFFNESS = 1.846e9
"""k_h about the static load of 294.3 kN. [N/m]"""
BEAM = PlaneBeams(
    spans=(LENGTH, LENGTH), rigidity=YOUNG * SECOND_MOMENT, mass_per_length=LINEAR_MASS
)
TIMOSHENKO_BEAM = PlaneBeams(
    spans=(LENGTH, LENGTH),
    rigidity=YOUNG * SECOND_MOMENT,
    mass_per_length=LINEAR_MASS,
    shear_rigidity=5.0 / 6.0 * YOUNG / (2.0 * (1.0 + POISSON)) * AREA,
    rotary_inertia=LINEAR_MASS * SECOND_MOMENT / AREA,
)
"""The same beam with shear deformation (5/6 of the area) and rotary inertia."""
_LAWS: dict[str, ContactLaw] = {
    "rigid": RigidContact(),
    "linear Hertz": LinearHertz(stiffness=CONTACT_STIFFNESS),
    "nonlinear Hertz": NonlinearHertz(
        coefficient=CONTACT_COEFFICIENT, reference_force=MASS * GRAVITY
    ),
}
_LAST = 0.87
"""When the fourth mass leaves the second span: the reference ends there. [s]"""


@dataclass(frozen=True, kw_only=True)
class _Reference:
    """Semi-analytical histories, time first."""

    displacement: Vector
    mass: FloatArray
    force: FloatArray

    @property
    def contact_point(self) -> FloatArray:
        """Below each mass by its spring: z + (X - M g) / k_v."""
        return self.mass + (self.force - MASS * GRAVITY) / STIFFNESS


def two_span_crossing(
    law: ContactLaw, properties: PlaneBeams = BEAM, count: int = COUNT
) -> Crossing:
    """The four masses (or fewer) over two spans of plane beams."""
    return Crossing(
        bridge=plane_beams(properties, before=61.0, after=70.0),
        mass=MASS,
        stiffness=STIFFNESS,
        count=count,
        spacing=LENGTH,
        speed=SPEED,
        law=law,
    )


def events(lost: BoolVector) -> IntVector:
    """Steps at whose end contact was lost or found, in turn."""
    return np.flatnonzero(np.diff(lost.astype(np.int64))) + 1


def compare_events(
    findings: Findings, lost: BoolVector, reference: BoolVector, step: float, label: str
) -> None:
    """Compares every loss and return of contact of the fourth mass, to two steps."""
    found, wanted = events(lost), events(reference)
    quantity = f"instant of loss or return of contact that differs most, fourth mass, {label}"
    if found.size != wanted.size:
        findings.close(
            f"losses and returns of contact of the fourth mass, {label}", "", float(wanted.size),
            float(found.size), 0.0, "Every one of them has to occur, and no other.",
        )  # fmt: skip
        return
    findings.at_least(
        f"losses and returns of contact of the fourth mass, {label}, at least", "", 2.0,
        float(wanted.size), "Contact is lost and found again.",
    )  # fmt: skip
    if wanted.size == 0:
        return
    worst = int(np.argmax(np.abs(found - wanted)))
    findings.close(
        quantity, "s", step * float(wanted[worst]), step * float(found[worst]),
        # A hundred-thousandth for the rounding of the product.
        2.00001 * step, f"Two steps for each of the {found.size}: status is known only at the "
        "ends of steps, on both sides.",
    )  # fmt: skip


def _run_law(law: str, progress: Progress) -> Result:
    """One contact law: the thesis's step with alpha = 0 and -0.1, and a quarter of the step."""
    findings = Findings(_case_name(law))
    crossing = two_span_crossing(_LAWS[law])
    runs = (
        ("alpha = 0, dt = 1 ms", HHT(0.0, 1e-3), 0.01),
        ("alpha = -0.1, dt = 1 ms", HHT(-0.1, 1e-3), 0.01),
        ("alpha = -0.1, dt = 0.25 ms", HHT(-0.1, 2.5e-4), 0.005),
    )
    exact: dict[float, _Reference] = {}
    kept: dict[str, CrossingHistories] = {}
    for number, (label, method, tolerance) in enumerate(runs):
        part = part_of(progress, 0.3 * number, 0.3 * (number + 1))
        found = cross(crossing, method, round(DURATION / method.time_step), part)
        step = method.time_step
        if step not in exact:
            exact[step] = _reference(law, found.time[found.time <= _LAST + 0.5 * step])
        _compare(findings, found, exact[step], step, tolerance, label)
        kept[label] = found
    add_equilibrium(findings, *(found.recording for found in kept.values()))
    _draw(findings, law, kept, exact[1e-3])
    return findings.result()


def _reference(law: str, times: Vector) -> _Reference:
    """20 modes a span, DOP853; a linear Hertz spring only makes the mass's spring softer."""
    beam = SimplySupportedBeam(
        length=LENGTH, rigidity=BEAM.rigidity, mass_per_length=LINEAR_MASS, n_mode=20, n_span=2
    )
    offsets = -LENGTH * np.arange(COUNT, dtype=np.float64)
    if law == "nonlinear Hertz":
        spring = SeriesSpring(stiffness=STIFFNESS, coefficient=CONTACT_COEFFICIENT)
        found = moving_masses_on_hertz_springs(
            beam,
            spring,
            mass=MASS,
            offsets=offsets,
            speed=SPEED,
            times=np.asarray(times, np.float64),
            point=0.5 * LENGTH,
        )
        return _Reference(
            displacement=found.displacement,
            mass=found.mass_displacement,
            force=found.contact_force,
        )
    soft = 1.0 / CONTACT_STIFFNESS if law == "linear Hertz" else 0.0
    series = 1.0 / (1.0 / STIFFNESS + soft)
    crossing = ReferenceCrossing(
        beam=beam,
        speed=SPEED,
        offsets=offsets,
        times=np.asarray(times, np.float64),
        points=np.array([0.5 * LENGTH]),
    )
    response = moving_sprung_masses(
        crossing, np.full(COUNT, MASS), np.full(COUNT, series), unilateral=True
    )
    return _Reference(
        displacement=response.displacement[:, 0],
        mass=response.load_displacement,
        force=response.contact_force,
    )


def _compare(
    findings: Findings, found: CrossingHistories, exact: _Reference, step: float,
    tolerance: float, label: str,
) -> None:  # fmt: skip
    count = len(exact.displacement)
    frequency = np.sqrt(STIFFNESS / MASS)
    lag = float((frequency * step) ** 2 / 12.0 * frequency * _LAST)
    bound = f"The bound of the two models of this bridge, {tolerance:.1%}; reference by modes."
    findings.history(f"displacement at mid-span 1, {label}", "m", exact.displacement,
                     found.mid_span[:count, 0], tolerance, bound)  # fmt: skip
    for mass, name in ((0, "first"), (3, "fourth")):
        findings.history(
            f"displacement of the {name} mass, {label}", "m", exact.mass[:, mass],
            found.mass[:count, mass], tolerance + lag,
            f"{tolerance:.1%}, and a lag of {lag:.2%} of the phase, (omega dt)^2 / 12 of it, that "
            "the mass gathers at its 11.5 Hz in 0.87 s.",
        )  # fmt: skip
        findings.history(
            f"displacement of the {name} contact point, {label}", "m",
            exact.contact_point[:, mass], found.contact_point[:count, mass], tolerance + lag,
            "As of the mass above it.",
        )  # fmt: skip
        both = np.stack([exact.force[:, mass], found.contact_force[:count, mass]], axis=1)
        smooth = low_pass(both - MASS * GRAVITY, step, 200.0) + MASS * GRAVITY
        findings.history(
            f"contact force of the {name} mass below 200 Hz, {label}", "N", smooth[:, 0],
            smooth[:, 1], 0.03, "The bound set beforehand for contact forces of this bridge.",
        )  # fmt: skip
    findings.at_least(f"least contact force of the first mass, {label}", "N", 1.0,
                      float(found.contact_force[:, 0].min()),
                      "The first mass never leaves the path.")  # fmt: skip
    findings.at_least(f"least contact force of the fourth mass, {label}", "N", 0.0,
                      float(found.contact_force[:, 3].min()),
                      "A contact that may open never pulls.")  # fmt: skip
    compare_events(findings, found.recording.leaves(3)[:count], exact.force[:, 3] <= 0.0, step,
                   label)  # fmt: skip


def _draw(
    findings: Findings, law: str, runs: dict[str, CrossingHistories], exact: _Reference
) -> None:
    ours = runs["alpha = -0.1, dt = 1 ms"]
    points = (1e3 * exact.contact_point, 1e3 * ours.contact_point, "Displacement [mm]")
    forces = (1e-3 * exact.force, 1e-3 * ours.contact_force, "Force [kN]")
    if law == "rigid":
        _draw_accelerations(findings, runs)
        title = "Figure 5.4: displacement at mid-span 1, rigid"
        _add(findings, title, "Displacement [mm]", ours.time, 1e3 * exact.displacement,
             1e3 * ours.mid_span[:, 0])  # fmt: skip
        masses = (1e3 * exact.mass, 1e3 * ours.mass, "Displacement [mm]")
        shown = (("5.6", "mass", masses), ("5.7", "contact force", forces))
    else:
        numbers = ("5.8", "5.9") if law == "linear Hertz" else ("5.10", "5.11")
        shown = ((numbers[0], "contact point", points), (numbers[1], "contact force", forces))
    for number, what, (wanted, values, label) in shown:
        for mass, which in ((0, "a: first"), (3, "b: fourth")):
            title = f"Figure {number}{which} {what}, {law}"
            _add(findings, title, label, ours.time, wanted[:, mass], values[:, mass])


def _draw_accelerations(findings: Findings, runs: dict[str, CrossingHistories]) -> None:
    both: tuple[tuple[str, Role], ...] = (("alpha = 0", "other"), ("alpha = -0.1", "ours"))
    histories = [runs[f"{label}, dt = 1 ms"] for label, _ in both]
    findings.figure(
        "Figure 5.3: acceleration at mid-span 1, rigid", "Time [s]", "Acceleration [m/s²]",
        *(
            Series(name=label, x=run.time, y=run.mid_span_acceleration[:, 0], role=role)
            for (label, role), run in zip(both, histories, strict=True)
        ),
        note="Numerical damping removes the spurious high frequencies.",
    )  # fmt: skip


def _add(
    findings: Findings, title: str, label: str, time: Vector, wanted: Vector, ours: Vector
) -> None:
    """One figure; the reference ends when the fourth mass leaves."""
    findings.figure(
        title, "Time [s]", label,
        Series(name="semi-analytical", x=time[: len(wanted)], y=wanted, role="reference"),
        Series(name="direct method, alpha = -0.1", x=time, y=ours, role="ours"),
        note="The thesis's beam is softer by its shear (6.07 against 6.21 Hz)."
        if title.startswith("Figure 5.4") else "",
    )  # fmt: skip


def _case_name(law: str) -> str:
    return "two-spans-" + law.lower().replace(" ", "-")


CASES = tuple(
    Case(
        name=_case_name(law),
        title=f"Four sprung masses over two spans, contact lost and found: {law}",
        source="Neves (2016), section 5.3.1",
        weight="slow",
        run=partial(_run_law, law),
    )
    for law in _LAWS
)
