"""Neves (2016), section 4.4.1: one sprung mass over the beam of Yang and Yau."""

from __future__ import annotations

import numpy as np

from solver.arrays import Vector
from solver.integrators.hht import HHT
from solver.methods.vehicles import GRAVITY
from solver.models.plane_beam import PlaneBeams, plane_beams
from solver.reference import Crossing as ReferenceCrossing
from solver.reference import Response, SimplySupportedBeam, moving_sprung_masses
from solver.standards.low_pass import low_pass
from solver.verification.case import Case, Findings, Progress, Result, Series
from solver.verification.crossings import Crossing, CrossingHistories, cross
from solver.verification.recording import add_equilibrium, part_of

__all__ = ["BEAM", "CASES", "MASS", "REFERENCE_BEAM", "STIFFNESS"]

NAME = "sprung-mass"
ACCELERATION_NAME = "sprung-mass-acceleration"
MASS, STIFFNESS = 5750.0, 1595e3
SPEED = 100.0 / 3.6
DURATION = 0.9
BEAM = PlaneBeams(spans=(25.0,), rigidity=2.87e9 * 2.90, mass_per_length=2303.0)
REFERENCE_BEAM = SimplySupportedBeam(
    length=25.0, rigidity=2.87e9 * 2.90, mass_per_length=2303.0, n_mode=20
)
_EXACT = "reference by DOP853 (rtol 1e-10) with 20 modes, which shares no code with the solver"


def run(progress: Progress) -> Result:
    """Runs the thesis's time step, and a quarter of it."""
    findings = Findings(NAME)
    coarse = _ours(HHT(0.0, 1e-3), part_of(progress, 0.0, 0.15))
    fine = _ours(HHT(0.0, 2.5e-4), part_of(progress, 0.15, 0.45))
    damped = _ours(HHT(-0.1, 2.5e-4), part_of(progress, 0.45, 0.75))
    exact = _reference(coarse.time)
    progress(0.95)
    _compare(findings, coarse, fine, exact)
    _compare_acceleration(findings, damped)
    add_equilibrium(findings, coarse.recording, fine.recording, damped.recording)
    _draw(findings, coarse, exact, _modal(HHT(0.0, 1e-3), len(coarse.time)))
    return findings.result()


def run_acceleration(progress: Progress) -> Result:
    """Runs with a step so short that the fifth mode keeps its phase."""
    findings = Findings(ACCELERATION_NAME)
    method = HHT(-0.1, 5e-5)
    damped = _ours(method, part_of(progress, 0.0, 0.8))
    # The acceleration of the HHT method belongs to t + alpha dt.
    exact = _reference(np.maximum(damped.time + method.alpha * method.time_step, 0.0))
    both = np.stack([exact.acceleration[:, 0], damped.mid_span_acceleration[:, 0]], axis=1)
    smooth = low_pass(both, method.time_step, 150.0)
    findings.history(
        "acceleration at mid-span below 150 Hz, dt = 0.05 ms, alpha = -0.1", "m/s2", smooth[:, 0],
        smooth[:, 1], 0.02,
        "The fifth mode (119 Hz) lags by (omega dt)^2 / 12 of its phase, 0.08 rad in 0.9 s here; "
        "with dt = 0.25 ms it would be 2 rad and the difference 24 percent of the peak.",
    )  # fmt: skip
    add_equilibrium(findings, damped.recording)
    findings.figure(
        "Acceleration at mid-span below 150 Hz", "Time [s]", "Acceleration [m/s²]",
        Series(name="semi-analytical", x=damped.time[::10], y=smooth[::10, 0], role="reference"),
        Series(name="direct method, dt = 0.05 ms, alpha = -0.1", x=damped.time[::10],
               y=smooth[::10, 1], role="ours"),
    )  # fmt: skip
    return findings.result()


def _modal(method: HHT, count: int) -> Vector:
    """Acceleration at mid-span of 20 modes and the mass by the HHT method (4.62, 4.63).

    The modal equations, their stiffness changing with the mass's place; equation 4.3 as it stands.

    Returns:
        Shape (count,). [m/s2]
    """
    beam, step, alpha = REFERENCE_BEAM, method.time_step, method.alpha
    beta, gamma = (1.0 - alpha) ** 2 / 4.0, 0.5 - alpha
    masses = np.append(np.full(beam.n_mode, beam.modal_mass), MASS)
    springs = np.diag(np.append(beam.modal_mass * beam.angular_frequencies**2, 0.0))
    middle = np.sin(beam.wave_numbers * 0.5 * beam.length)
    place, velocity, acceleration, imbalance = np.zeros((4, beam.n_mode + 1))
    found = np.zeros(count)
    for index in range(count):
        shapes = np.sin(beam.wave_numbers * min(SPEED * step * index, beam.length))
        reach = np.append(-shapes, 1.0)
        stiffness = springs + STIFFNESS * np.outer(reach, reach)
        load = np.append(-MASS * GRAVITY * shapes, 0.0)
        if index > 0:
            ahead = place + step * velocity + step**2 * (0.5 - beta) * acceleration
            matrix = np.diag(masses) + (1.0 + alpha) * beta * step**2 * stiffness
            force = (1.0 + alpha) * (load - stiffness @ ahead) + alpha * imbalance
            new = np.linalg.solve(matrix, force)
            place = ahead + beta * step**2 * new
            velocity = velocity + step * ((1.0 - gamma) * acceleration + gamma * new)
            acceleration = new
        imbalance = stiffness @ place - load
        found[index] = middle @ acceleration[: beam.n_mode]
    return found


def _ours(method: HHT, progress: Progress) -> CrossingHistories:
    bridge = plane_beams(BEAM, before=1.0, after=1.0)
    crossing = Crossing(
        bridge=bridge,
        mass=MASS,
        stiffness=STIFFNESS,
        count=1,
        spacing=0.0,
        speed=SPEED,
        unilateral=False,
    )
    return cross(crossing, method, round(DURATION / method.time_step), progress)


def _reference(times: Vector) -> Response:
    crossing = ReferenceCrossing(
        beam=REFERENCE_BEAM,
        speed=SPEED,
        offsets=np.zeros(1),
        times=np.asarray(times, np.float64),
        points=np.array([12.5]),
    )
    return moving_sprung_masses(crossing, np.array([MASS]), np.array([STIFFNESS]))


def _compare(
    findings: Findings, coarse: CrossingHistories, fine: CrossingHistories, exact: Response
) -> None:
    pairs = (
        ("displacement at mid-span", exact.displacement[:, 0], "mid_span"),
        ("displacement of the mass", exact.load_displacement[:, 0], "mass"),
    )
    for quantity, wanted, field in pairs:
        findings.history(
            f"{quantity}, dt = 1 ms", "m", wanted, getattr(coarse, field)[:, 0], 8e-3,
            f"The thesis's step; sixteen times the bound at a quarter of it, by order 2; {_EXACT}.",
        )  # fmt: skip
        findings.history(
            f"{quantity}, dt = 0.25 ms", "m", wanted, getattr(fine, field)[::4, 0], 5e-4,
            f"The bound set for this case beforehand; {_EXACT}.",
        )  # fmt: skip
    findings.history(
        "acceleration of the mass, dt = 0.25 ms", "m/s2", exact.load_acceleration[:, 0],
        fine.mass_acceleration[::4, 0], 2e-3,
        "Four times the displacement's bound: the mass hardly feels the beam's higher modes.",
    )  # fmt: skip
    findings.history(
        "contact force, dt = 0.25 ms", "N", exact.contact_force[:, 0],
        fine.contact_force[::4, 0], 5e-4, "The spring's force follows from displacements.",
    )  # fmt: skip


def _compare_acceleration(findings: Findings, damped: CrossingHistories) -> None:
    method = HHT(-0.1, 2.5e-4)
    modal = _modal(method, len(damped.time))
    both = np.stack([modal, damped.mid_span_acceleration[:, 0]], axis=1)
    smooth = low_pass(both, method.time_step, 150.0)
    findings.history(
        "acceleration at mid-span below 150 Hz, alpha = -0.1", "m/s2", smooth[:, 0], smooth[:, 1],
        0.02, "The bound set beforehand, against 20 modes by the same integration, as in the "
        "thesis; with alpha = 0 and unfiltered, undamped modes near the sampling limit leave "
        "17 percent at dt = 1 ms.",
    )  # fmt: skip


def _draw(findings: Findings, coarse: CrossingHistories, exact: Response, modal: Vector) -> None:
    t = coarse.time
    figures = (
        ("Figure 4.7: displacement at mid-span", "Displacement [mm]",
         1e3 * exact.displacement[:, 0], 1e3 * coarse.mid_span[:, 0], ""),
        ("Figure 4.8: acceleration at mid-span", "Acceleration [m/s²]", modal,
         coarse.mid_span_acceleration[:, 0],
         "Both by Newmark's method with dt = 1 ms, as in the thesis: modes near the sampling limit "
         "are not damped and make the difference."),
        ("Figure 4.9: displacement of the mass", "Displacement [mm]",
         1e3 * exact.load_displacement[:, 0], 1e3 * coarse.mass[:, 0], ""),
        ("Figure 4.10: acceleration of the mass", "Acceleration [m/s²]",
         exact.load_acceleration[:, 0], coarse.mass_acceleration[:, 0], ""),
    )  # fmt: skip
    for title, label, wanted, ours, note in figures:
        findings.figure(
            title, "Time [s]", label,
            Series(name="semi-analytical", x=t, y=wanted, role="reference"),
            Series(name="direct method, dt = 1 ms", x=t, y=ours, role="ours"),
            note=note,
        )  # fmt: skip


CASES = (
    Case(
        name=NAME,
        title="One sprung mass over a simple beam",
        source="Neves (2016), section 4.4.1; Yang and Yau (1997)",
        weight="fast",
        run=run,
    ),
    Case(
        name=ACCELERATION_NAME,
        title="One sprung mass over a simple beam: acceleration of the beam",
        source="Neves (2016), section 4.4.1",
        weight="slow",
        run=run_acceleration,
    ),
)
