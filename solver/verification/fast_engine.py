"""The fast engine of studies (``solver.system``) against the same references and the other engine.

Studies condense the structure on its rail seats and run in batches; the general engine of
``solver.methods`` does not. The two share elements, not the coupling.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import FloatArray, Vector
from solver.contact.laws import RigidContact
from solver.integrators.hht import HHT
from solver.models.plane_beam import plane_beams
from solver.reference import Crossing as ReferenceCrossing
from solver.reference import moving_sprung_masses
from solver.studies import prepare, template
from solver.verification.case import Case, Findings, Progress, Result, Series
from solver.verification.crossings import Crossing, CrossingHistories, cross
from solver.verification.recording import add_equilibrium, part_of
from solver.verification.sprung_mass import BEAM, MASS, REFERENCE_BEAM, STIFFNESS
from solver.verification.two_spans import compare_events, two_span_crossing

__all__ = ["CASES"]

SPRUNG_MASS, TWO_SPANS = "study-sprung-mass", "study-two-spans"
_SAME = (
    "The same mesh, step and method; the engines stop their contact search differently and round "
    "differently."
)


@dataclass(frozen=True, kw_only=True)
class _StudyHistories:
    time: Vector
    mid_span: Vector
    masses: FloatArray
    forces: FloatArray


def run_sprung_mass(progress: Progress) -> Result:
    """The template ``sprung-mass-beam``, section 4.4.1 with dt = 0.25 ms."""
    findings = Findings(SPRUNG_MASS)
    study = _study("sprung-mass-beam", 1, part_of(progress, 0.0, 0.4))
    speed = 100.0 / 3.6
    exact = moving_sprung_masses(
        ReferenceCrossing(beam=REFERENCE_BEAM, speed=speed, offsets=np.zeros(1),
                          times=np.asarray(study.time, np.float64), points=np.array([12.5])),
        np.array([MASS]), np.array([STIFFNESS]),
    )  # fmt: skip
    progress(0.7)
    bound = "The bound set for this case beforehand; reference by DOP853 with 20 modes."
    findings.history("displacement at mid-span", "m", exact.displacement[:, 0], study.mid_span,
                     5e-4, bound)  # fmt: skip
    findings.history("displacement of the mass", "m", exact.load_displacement[:, 0],
                     study.masses[:, 0], 5e-4, bound)  # fmt: skip
    crossing = Crossing(
        bridge=plane_beams(BEAM, before=1.0, after=1.0), mass=MASS, stiffness=STIFFNESS, count=1,
        spacing=0.0, speed=speed, unilateral=False,
    )  # fmt: skip
    general = cross(crossing, HHT(0.0, 2.5e-4), study.time.size - 1, part_of(progress, 0.7, 1.0))
    _compare_engines(findings, study, general, 1)
    add_equilibrium(findings, general.recording)
    return findings.result()


def run_two_spans(progress: Progress) -> Result:
    """The template ``two-span-separation``, section 5.3.1 with dt = 0.25 ms."""
    findings = Findings(TWO_SPANS)
    study = _study("two-span-separation", 4, part_of(progress, 0.0, 0.5))
    crossing = two_span_crossing(RigidContact())
    general = cross(crossing, HHT(-0.1, 2.5e-4), study.time.size - 1, part_of(progress, 0.5, 1.0))
    _compare_engines(findings, study, general, 4)
    add_equilibrium(findings, general.recording)
    compare_events(findings, study.forces[:, 3] <= 0.0, general.recording.leaves(3), 2.5e-4,
                   "study against general engine")  # fmt: skip
    findings.figure(
        "Contact force of the fourth mass, both engines", "Time [s]", "Force [kN]",
        Series(name="general engine", x=general.time, y=1e-3 * general.contact_force[:, 3],
               role="reference"),
        Series(name="study", x=study.time, y=1e-3 * study.forces[:, 3], role="ours"),
    )  # fmt: skip
    return findings.result()


def _study(name: str, count: int, progress: Progress) -> _StudyHistories:
    """Channels of a template's run."""
    simulation = prepare(template(name).study)
    names = [channel.name for channel in simulation.plan.channels]
    total = simulation.plan.n_step
    times: list[float] = []
    values: list[FloatArray] = []
    for sample in simulation.samples():
        times.append(sample.time)
        values.append(np.array(sample.channels))
        progress(min(1.0, len(times) / total))
    columns = dict(zip(names, np.array(values).T, strict=True))
    return _StudyHistories(
        time=np.array(times),
        mid_span=columns["mid-span 1/displacement"],
        masses=np.stack([columns[f"mass {i + 1:02d}/displacement"] for i in range(count)], axis=1),
        forces=np.stack(
            [columns[f"wheel {i + 1:02d}/contact force"] for i in range(count)], axis=1
        ),
    )


def _compare_engines(
    findings: Findings, study: _StudyHistories, general: CrossingHistories, count: int
) -> None:
    findings.history("displacement at mid-span, against the general engine", "m",
                     general.mid_span[:, 0], study.mid_span, 1e-6, _SAME)  # fmt: skip
    for mass in range(count):
        findings.history(f"displacement of mass {mass + 1}, against the general engine", "m",
                         general.mass[:, mass], study.masses[:, mass], 1e-6, _SAME)  # fmt: skip
        findings.history(f"contact force of mass {mass + 1}, against the general engine", "N",
                         general.contact_force[:, mass], study.forces[:, mass], 1e-6,
                         _SAME)  # fmt: skip


CASES = (
    Case(
        name=SPRUNG_MASS,
        title="The study of one sprung mass on a simple beam",
        source="Neves (2016), section 4.4.1",
        weight="slow",
        run=run_sprung_mass,
    ),
    Case(
        name=TWO_SPANS,
        title="The study of two spans and loss of contact",
        source="Neves (2016), section 5.3.1",
        weight="fast",
        run=run_two_spans,
    ),
)
