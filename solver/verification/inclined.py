"""Neves (2016), section 5.3.3: two axles on an inclined rigid beam, driven by forces alone.

The slope is 45 / 60; without gravity a push of 20 N on each axle gives 12 N at right angles to the
beam and 4 m/s2 along it for axles of 4 kg, a mass that is inferred from the end point of figure
5.17: (40, 30) m after 5 s.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from solver.arrays import Vector
from solver.contact.laws import ContactLaw, NonlinearHertz, RigidContact
from solver.contact.path import rigid_path
from solver.integrators.hht import HHT
from solver.methods.problem import FreeDrive, Problem, Wheels
from solver.methods.vehicles import Vehicle, ground_only
from solver.models.subsystem import Subsystem
from solver.verification.case import Case, Findings, Progress, Result, Series
from solver.verification.recording import Recording, add_equilibrium, part_of, record
from solver.verification.two_spans import CONTACT_COEFFICIENT

__all__ = ["CASE"]

NAME = "inclined-beam"
_PUSH, _MASS, _ALONG = 20.0, 4.0, np.array([0.8, 0.0, 0.6])
"""Push on each axle [N], mass of each axle [kg], direction of the slope 45 / 60."""


def run(progress: Progress) -> Result:
    """Two axles pushed up a rigid incline, with the rigid and the nonlinear law."""
    findings = Findings(NAME)
    laws: dict[str, ContactLaw] = {
        "rigid": RigidContact(),
        "nonlinear Hertz": NonlinearHertz(coefficient=CONTACT_COEFFICIENT, reference_force=12.0),
    }
    runs: dict[str, Recording] = {}
    for number, (law, contact) in enumerate(laws.items()):
        part = part_of(progress, 0.5 * number, 0.5 * (number + 1))
        found = runs[law] = _push(contact, part)
        along = 0.5 * _PUSH * _ALONG[0] / _MASS * found.time**2
        for axle, name in ((1, "front"), (0, "rear")):
            for axis, direction, end in ((0, "horizontal", 40.0), (1, "vertical", 30.0)):
                ours = found.displacement[:, 2 * axle + axis]
                what = f"{direction} displacement of the {name} axle, {law}"
                findings.history(
                    what, "m", along * _ALONG[2 * axis], ours, 1e-6,
                    "A constant acceleration is exact in Newmark's method; Newton's stops at 1e-6.",
                )  # fmt: skip
                findings.close(
                    f"{what}, after 5 s", "m", end, float(ours[-1]), 1e-6,
                    "The thesis's end point; 4 kg an axle are inferred from it.",
                )  # fmt: skip
            for axis, direction, value in ((0, "horizontal", -7.2), (2, "vertical", 9.6)):
                component = (-_ALONG[2] if axis == 0 else _ALONG[0]) * found.contact_force[:, axle]
                worst = int(np.argmax(np.abs(component - value)))
                findings.close(
                    f"{direction} contact force of the {name} axle, {law}, worst step", "N", value,
                    float(component[worst]), 1e-3,
                    "Constant in the exact solution; Newton's method stops at 1e-4 of an axle's "
                    "force.",
                )  # fmt: skip
    add_equilibrium(findings, *runs.values())
    _draw(findings, runs)
    return findings.result()


def _push(law: ContactLaw, progress: Progress) -> Recording:
    """500 steps of 10 ms from rest, the contact springs already compressed."""
    path = rigid_path(np.array([[0.0, 0.0, 0.0], [60.0, 0.0, 45.0]]), 1)
    vehicle = _frame(np.array([0.0, 0.5]))
    normal = np.array([-_ALONG[2], _ALONG[0]])
    compression = 0.0
    if isinstance(law, NonlinearHertz):
        compression = law.reference_compression
    start = np.concatenate([[0.0], -compression * normal, [0.0]])
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
    rows = sparse.csr_array(sparse.hstack([sparse.csr_array((4, 1)), vehicle.masses]))
    return record(problem, HHT(0.0, 0.01), 500, rows, vertical=None, load=2.0 * _PUSH,
                  progress=progress)  # fmt: skip


def _frame(chainage: Vector) -> Vehicle:
    """A rigid frame of two axles: displacement along x and upwards, and pitch.

    The pitch turns the front axle about the rear: the frame lies along the slope.

    Args:
        chainage: Of the rear and the front axle, shape (2,). [m]
    """
    base = float(chainage[1] - chainage[0])
    # Rear and front, along x and upwards; a positive pitch lifts the front.
    half = 0.5 * base
    arm = np.array([-half, half])
    rows = np.zeros((4, 3))
    for axle in range(2):
        rows[2 * axle] = [1.0, 0.0, -arm[axle] * _ALONG[2]]
        rows[2 * axle + 1] = [0.0, 1.0, arm[axle] * _ALONG[0]]
    mass = sparse.csr_array(_MASS * rows.T @ rows)
    empty = sparse.csr_array((3, 3))
    axle_load = np.tile([_PUSH, 0.0], 2)
    subsystem = Subsystem(
        name="the vehicle", mass=mass, damping=empty, stiffness=empty, load=rows.T @ axle_load
    )

    wheels = Wheels(
        names=("rear axle", "front axle"),
        rows=(
            sparse.csr_array(rows[0::2]), sparse.csr_array((2, 3)), sparse.csr_array(rows[1::2]),
        ),
        chainage=chainage,
    )  # fmt: skip
    return Vehicle(
        subsystem=subsystem,
        wheels=wheels,
        masses=sparse.csr_array(rows),
        vertical=np.array([0.0, 1.0, 0.0]),
    )


def _draw(findings: Findings, runs: dict[str, Recording]) -> None:
    found = runs["nonlinear Hertz"]
    time = found.time
    along = 0.5 * _PUSH * _ALONG[0] / _MASS * time**2
    for axle, name in ((1, "a: front"), (0, "b: rear")):
        findings.figure(
            f"Figure 5.17{name} contact point", "Horizontal displacement [m]",
            "Vertical displacement [m]",
            Series(name="analytical", x=along * _ALONG[0], y=along * _ALONG[2], role="reference"),
            Series(name="direct method", x=found.displacement[:, 2 * axle],
                   y=found.displacement[:, 2 * axle + 1], role="ours"),
        )  # fmt: skip
    for figure, direction, value, factor in (
        ("5.18", "horizontal", -7.2, -_ALONG[2]), ("5.19", "vertical", 9.6, _ALONG[0]),
    ):  # fmt: skip
        findings.figure(
            f"Figure {figure}: {direction} contact force, front and rear", "Time [s]", "Force [N]",
            Series(name="analytical", x=time, y=np.full(time.size, value), role="reference"),
            Series(name="front", x=time, y=factor * found.contact_force[:, 1], role="ours"),
            Series(name="rear", x=time, y=factor * found.contact_force[:, 0], role="other"),
        )  # fmt: skip


CASE = Case(
    name=NAME,
    title="Two axles on an inclined rigid beam, free drive",
    source="Neves (2016), section 5.3.3",
    weight="fast",
    run=run,
)
