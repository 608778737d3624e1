"""Order of the HHT method in a crossing with a closed solution.

A sprung mass rolls on rigid ground over r = a0 sin(k x) at speed v, from rest at a zero of the
sine: with omega its own frequency and W = k v,

    z = a0 omega^2 (sin W t - W / omega sin omega t) / (omega^2 - W^2),     X = M (g + z'').
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from solver.arrays import Vector
from solver.contact.path import rigid_path
from solver.integrators.hht import HHT
from solver.irregularities.harmonic import HarmonicIrregularity
from solver.methods.problem import PrescribedSpeed, Problem
from solver.methods.vehicles import GRAVITY, ground_only, sprung_masses
from solver.verification.case import Case, Findings, Progress, Result, Series
from solver.verification.recording import Recording, add_equilibrium, record

__all__ = ["CASE"]

NAME = "time-integration"
_MASS, _STIFFNESS, _SPEED, _DURATION = 1000.0, 1e6, 20.0, 0.5
_ROUGHNESS = HarmonicIrregularity(amplitude=1e-3, wavelength=5.0, start=0.0)
_ALPHAS = (0.0, -0.05, -0.3)
_STEPS = (4e-3, 2e-3, 1e-3)


def run(progress: Progress) -> Result:
    """Halves the step twice for each alpha."""
    findings = Findings(NAME)
    kept: list[Recording] = []
    figure: list[Series] = []
    for number, alpha in enumerate(_ALPHAS):
        errors: list[Vector] = []
        for step in _STEPS:
            found = _run(HHT(alpha, step))
            kept.append(found)
            errors.append(_errors(found, alpha, step))
        progress((number + 1) / len(_ALPHAS))
        orders = np.log2(errors[1] / errors[2])
        names = ("displacement", "velocity", "acceleration at t + alpha dt", "contact force")
        for name, order in zip(names, orders, strict=True):
            findings.close(
                f"order of the {name}, alpha = {alpha:g}", "", 2.0, float(order), 0.05,
                "Measured between 2 and 1 ms: the terms of higher order are not yet nothing.",
            )  # fmt: skip
        role = "ours" if number == 0 else "other"
        figure.append(
            Series(name=f"alpha = {alpha:g}", x=np.log10(np.array(_STEPS)),
                   y=np.log10(np.array(errors)[:, 0]), role=role)
        )  # fmt: skip
    slope = np.log10(np.array(_STEPS))
    figure.insert(0, Series(name="order 2", x=slope, y=2.0 * slope + 0.5, role="reference"))
    add_equilibrium(findings, *kept)
    findings.figure("Error of the displacement against the time step", "log10 of the step [s]",
                    "log10 of the relative error", *figure)  # fmt: skip
    return findings.result()


def _run(method: HHT) -> Recording:
    vehicle = sprung_masses(np.zeros(1), mass=_MASS, stiffness=_STIFFNESS)
    problem = Problem(
        structure=ground_only(),
        vehicle=vehicle.subsystem,
        wheels=vehicle.wheels,
        path=rigid_path(np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]]), 1),
        drive=PrescribedSpeed(speed=_SPEED),
        unilateral=False,
        irregularity=_ROUGHNESS,
    )
    row = sparse.csr_array(sparse.hstack([sparse.csr_array((1, 1)), vehicle.masses]))
    vertical = np.concatenate([[0.0], vehicle.vertical])
    steps = round(_DURATION / method.time_step)
    return record(problem, method, steps, row, vertical=vertical, load=_MASS * GRAVITY,
                  progress=lambda fraction: None)  # fmt: skip


def _errors(found: Recording, alpha: float, step: float) -> Vector:
    """Greatest relative errors of displacement, velocity, acceleration and contact force."""
    exact = _exact(found.time)
    late = _exact(found.time[1:] + alpha * step)
    force = _MASS * (GRAVITY + exact[2])
    pairs = (
        (found.displacement[:, 0] - found.displacement[0, 0], exact[0]),
        (found.velocity[:, 0], exact[1]),
        (found.acceleration[1:, 0], late[2]),
        (found.contact_force[:, 0], force),
    )
    return np.array([np.abs(a - b).max() / np.abs(b).max() for a, b in pairs])


def _exact(time: Vector) -> tuple[Vector, Vector, Vector]:
    """Displacement, velocity and acceleration of the mass."""
    own, driven = np.sqrt(_STIFFNESS / _MASS), _ROUGHNESS.wave_number * _SPEED
    scale = _ROUGHNESS.amplitude * own**2 / (own**2 - driven**2)
    return (
        scale * (np.sin(driven * time) - driven / own * np.sin(own * time)),
        scale * driven * (np.cos(driven * time) - np.cos(own * time)),
        scale * driven * (own * np.sin(own * time) - driven * np.sin(driven * time)),
    )


CASE = Case(
    name=NAME,
    title="Order of the HHT method, a sprung mass on a wavy rigid rail",
    source="Neves (2016), equations 4.3 to 4.16; closed solution",
    weight="fast",
    run=run,
)
