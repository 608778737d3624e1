"""Two masses on a curved vertical profile, driven by gravity alone: Huygens's cycloid.

On a hanging cycloid a mass swings with one period whatever its amplitude A, and the contact force
is known in closed form:

    s = -A cos(omega t),   omega^2 = g / 4R,
    sin(slope) = s / 4R,   curvature = 1 / (4R cos(slope)),
    X = m (g cos(slope) + s'^2 curvature) = m g (1 + (A / 4R)^2 - 2 sin(slope)^2) / cos(slope).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sparse

from solver.arrays import FloatArray, Vector
from solver.contact.laws import ContactLaw, NonlinearHertz, RigidContact
from solver.contact.path import Path, rigid_path
from solver.integrators.hht import HHT
from solver.methods.problem import FreeDrive, Problem
from solver.methods.vehicles import GRAVITY, ground_only, plane_masses
from solver.verification.case import Case, Findings, Progress, Result, Series
from solver.verification.recording import Recording, add_equilibrium, part_of, record
from solver.verification.two_spans import CONTACT_COEFFICIENT

__all__ = ["CASE", "cycloid_path"]

NAME = "cycloid"
_RADIUS = 5.0
"""R of the circle that draws the cycloid. [m]"""
_MASS = 100.0
"""Of each mass. [kg]"""
_AMPLITUDES = np.array([8.0, 12.0])
"""Distances along the cycloid from its lowest point to the masses at the start. [m]"""


def cycloid_path(radius: float, count: int, n_dof: int = 1) -> Path:
    """Rigid ground along a hanging cycloid, with its exact tangents at the nodes.

    x = R (phi + sin phi), z = R (1 - cos phi), its slope phi / 2; chainage 0 at the lowest point.

    Args:
        radius: R. [m]
        count: Elements, over phi from -0.8 pi to 0.8 pi.
        n_dof: Freedoms of the structure.
    """
    phi = np.linspace(-0.8, 0.8, count + 1) * np.pi
    points = np.stack(
        [radius * (phi + np.sin(phi)), np.zeros_like(phi), radius * (1.0 - np.cos(phi))], axis=1
    )
    straight = rigid_path(points, n_dof)
    directions = np.stack([np.cos(0.5 * phi), np.zeros_like(phi), np.sin(0.5 * phi)], axis=1)
    middle = 0.5 * (straight.chainage[0] + straight.chainage[-1])
    return replace(
        straight,
        chainage=straight.chainage - middle,
        tangents=np.stack([directions[:-1], directions[1:]], axis=1),
    )


def run(progress: Progress) -> Result:
    """Two masses from different heights, two laws: isochronous, and forces in closed form."""
    findings = Findings(NAME)
    laws: dict[str, ContactLaw] = {
        "rigid": RigidContact(),
        "nonlinear Hertz": NonlinearHertz(
            coefficient=CONTACT_COEFFICIENT, reference_force=_MASS * GRAVITY
        ),
    }
    runs: dict[str, Recording] = {}
    for number, (law, contact) in enumerate(laws.items()):
        part = part_of(progress, 0.5 * number, 0.5 * (number + 1))
        runs[law] = _swing(contact, part)
        _compare(findings, law, runs[law])
    add_equilibrium(findings, *runs.values())
    _draw(findings, runs["rigid"])
    return findings.result()


def _swing(law: ContactLaw, progress: Progress) -> Recording:
    """1.25 periods from rest at different heights, 2.5 ms steps."""
    path = cycloid_path(_RADIUS, 2000)
    chainage = -_AMPLITUDES
    weight = np.array([0.0, -_MASS * GRAVITY])
    vehicle = plane_masses(chainage, mass=_MASS, load=weight)
    start = np.zeros(5)
    if isinstance(law, NonlinearHertz):
        _, force = _exact(np.zeros(1))
        pressed = (force[0] / law.coefficient) ** (2.0 / 3.0)
        point = path.at(chainage)
        start[1::2], start[2::2] = (-pressed * point.normal[:, axis] for axis in (0, 2))
    problem = Problem(
        structure=ground_only(),
        vehicle=vehicle.subsystem,
        wheels=vehicle.wheels,
        path=path,
        law=law,
        drive=FreeDrive(),
        start="consistent",
        displacement=start,
    )
    rows = sparse.csr_array(sparse.hstack([sparse.csr_array((2, 1)), vehicle.masses]))
    load = 2.0 * _MASS * GRAVITY
    step = 2.5e-3
    count = round(1.25 * 2.0 * np.pi / _frequency() / step)
    return record(problem, HHT(0.0, step), count, rows, vertical=None, load=load, progress=progress)


def _frequency() -> float:
    """Circular frequency on the cycloid, whatever the amplitude. [rad/s]"""
    return float(np.sqrt(GRAVITY / (4.0 * _RADIUS)))


def _exact(time: Vector) -> tuple[FloatArray, FloatArray]:
    """Distance along the cycloid and normal force, each of shape (n_step, 2)."""
    arc = -_AMPLITUDES * np.cos(_frequency() * time)[:, None]
    sine = arc / (4.0 * _RADIUS)
    spread = (_AMPLITUDES / (4.0 * _RADIUS)) ** 2
    force = _MASS * GRAVITY * (1.0 + spread - 2.0 * sine**2) / np.sqrt(1.0 - sine**2)
    return arc, force


def _compare(findings: Findings, law: str, found: Recording) -> None:
    arc, force = _exact(found.time)
    for mass in range(2):
        name = f"mass from {_AMPLITUDES[mass]:g} m, {law}"
        findings.history(
            f"distance along the cycloid, {name}", "m", arc[:, mass], found.chainage[:, mass], 1e-4,
            "Newmark's method lags by (omega dt)^2 / 12 of the phase, 2e-6 of 7.9 rad; the path's "
            "chainage counts chords, a millionth shorter than the arc.",
        )  # fmt: skip
        findings.history(
            f"contact force, {name}", "N", force[:, mass], found.contact_force[:, mass], 1e-3,
            "Of order 2 in the step like displacements; the curvature enters by the path's cubics.",
        )  # fmt: skip


def _draw(findings: Findings, found: Recording) -> None:
    arc, force = _exact(found.time)
    for title, label, wanted, ours in (
        ("Distance along the cycloid", "Distance [m]", arc, found.chainage),
        ("Contact force on the cycloid", "Force [N]", force, found.contact_force),
    ):
        series: list[Series] = []
        for mass, role in ((0, "ours"), (1, "other")):
            start = f"from {_AMPLITUDES[mass]:g} m"
            series += [
                Series(name=f"closed form, {start}", x=found.time, y=wanted[:, mass],
                       role="reference"),
                Series(name=f"direct method, {start}", x=found.time, y=ours[:, mass],
                       role="ours" if role == "ours" else "other"),
            ]  # fmt: skip
        findings.figure(title, "Time [s]", label, *series,
                        note="Both masses reach the lowest point at the same time.")  # fmt: skip


CASE = Case(
    name=NAME,
    title="Two masses on a curved vertical profile, a cycloid, free drive",
    source="Huygens (1673): isochronous motion on a cycloid",
    weight="fast",
    run=run,
)
