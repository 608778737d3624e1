"""A mass that rolls on the beam itself, without a spring: rigid contact of a wheel with mass."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from solver.integrators.hht import HHT
from solver.methods.problem import PrescribedSpeed, Problem, Wheels
from solver.methods.vehicles import GRAVITY
from solver.models.plane_beam import plane_beams
from solver.models.subsystem import Subsystem
from solver.reference import Crossing, moving_masses
from solver.verification.case import Case, Findings, Progress, Result, Series
from solver.verification.recording import Recording, add_equilibrium, part_of, record
from solver.verification.sprung_mass import BEAM, REFERENCE_BEAM

__all__ = ["CASE"]

NAME = "moving-mass"
_MASS, _SPEED, _DURATION = 5750.0, 100.0 / 3.6, 0.89


def run(progress: Progress) -> Result:
    """The beam of 4.4.1 under its mass without the spring, until just before it leaves."""
    findings = Findings(NAME)
    steps = (1e-3, 5e-4)
    runs = [_run(step, part_of(progress, 0.3 * n, 0.3 * (n + 1))) for n, step in enumerate(steps)]
    crossing = Crossing(
        beam=REFERENCE_BEAM, speed=_SPEED, offsets=np.zeros(1),
        times=np.asarray(runs[-1].time, np.float64), points=np.array([12.5]),
    )  # fmt: skip
    exact = moving_masses(crossing, np.array([_MASS]))
    for step, found in zip(steps, runs, strict=True):
        stride = round(step / steps[-1])
        label = f"dt = {1e3 * step:g} ms, alpha = -0.1"
        findings.history(
            f"displacement at mid-span, {label}", "m", exact.displacement[::stride, 0],
            found.displacement[:, 0], 5e-3,
            "Ten times the bound of the sprung mass: without a spring the mass feels every mode.",
        )  # fmt: skip
        findings.history(
            f"displacement under the mass, {label}", "m", exact.load_displacement[::stride, 0],
            found.displacement[:, 1], 5e-3, "As at mid-span.",
        )  # fmt: skip
        findings.history(
            f"contact force, {label}", "N", exact.contact_force[::stride, 0],
            found.contact_force[:, 0], 0.05,
            "The reference has 20 modes of the beam, the mesh 100: what either leaves out of the "
            "force lies above 1.9 kHz.",
        )  # fmt: skip
    add_equilibrium(findings, *runs)
    for title, label, scale, wanted, ours in (
        ("Displacement under the mass", "Displacement [mm]", 1e3, exact.load_displacement,
         runs[-1].displacement[:, 1]),
        ("Contact force of the mass", "Force [kN]", 1e-3, exact.contact_force,
         runs[-1].contact_force[:, 0]),
    ):  # fmt: skip
        findings.figure(
            title, "Time [s]", label,
            Series(name="semi-analytical", x=exact.time, y=scale * wanted[:, 0], role="reference"),
            Series(name="direct method", x=runs[-1].time, y=scale * ours, role="ours"),
        )  # fmt: skip
    return findings.result()


def _run(step: float, progress: Progress) -> Recording:
    bridge = plane_beams(BEAM, before=1.0, after=1.0)
    one, none = sparse.csr_array(np.ones((1, 1))), sparse.csr_array((1, 1))
    vehicle = Subsystem(
        name="the vehicle", mass=_MASS * one, damping=none, stiffness=none,
        load=np.array([-_MASS * GRAVITY]),
    )  # fmt: skip
    wheels = Wheels(names=("mass",), rows=(none, none, one), chainage=np.zeros(1))
    problem = Problem(
        structure=bridge.structure,
        vehicle=vehicle,
        wheels=wheels,
        path=bridge.path,
        drive=PrescribedSpeed(speed=_SPEED),
    )
    rows = sparse.csr_array(sparse.block_diag([bridge.mid_spans, one]))
    vertical = np.concatenate([np.zeros(0) if bridge.vertical is None else bridge.vertical, [1.0]])
    return record(
        problem, HHT(-0.1, step), round(_DURATION / step), rows, vertical=vertical,
        load=_MASS * GRAVITY, progress=progress,
    )  # fmt: skip


CASE = Case(
    name=NAME,
    title="A moving mass on a simple beam",
    source="Neves (2016), equations 4.53 to 4.58",
    weight="fast",
    run=run,
)
