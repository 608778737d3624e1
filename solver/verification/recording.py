"""Runs a problem through the general engine and keeps what a case compares."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from solver.arrays import BoolVector, FloatArray, SparseMatrix, Vector
from solver.integrators.hht import HHT
from solver.methods import DirectMethod, Settings, StepState
from solver.methods.problem import Problem
from solver.verification.case import Findings, Progress
from solver.verification.energy import EnergyAccount, EnergyBalance
from solver.verification.equilibrium import EquilibriumCheck, Imbalance

__all__ = ["Recording", "add_equilibrium", "part_of", "record"]

_EQUILIBRIUM_REASON = (
    "Equation 4.3 evaluated anew at every step; the engine stops iterating at 1e-6 of the load."
)


@dataclass(frozen=True, kw_only=True)
class Recording:
    """Histories of one run, time first.

    Attributes:
        time: Shape (n_step + 1,). [s]
        displacement: Of the rows asked for, shape (n_step + 1, n_row). [m]
        velocity: Likewise. [m/s]
        acceleration: Likewise. [m/s2]
        contact_force: Shape (n_step + 1, n_wheel). [N]
        closed: Shape (n_step + 1, n_wheel).
        chainage: Shape (n_step + 1, n_wheel). [m]
        iterations: Of each step, shape (n_step + 1,).
        status_changes: Contacts lost or found in the run.
        restarts: Impulses of the rigid law in the run.
        imbalance: Greatest residuals of equilibrium.
        energy: Energy balance, where it was asked for.
    """

    time: Vector
    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    contact_force: FloatArray
    closed: FloatArray
    chainage: FloatArray
    iterations: Vector
    status_changes: int
    restarts: int
    imbalance: Imbalance
    energy: EnergyBalance | None

    def leaves(self, wheel: int) -> BoolVector:
        """At which steps a wheel is off the path, shape (n_step + 1,)."""
        return np.asarray(~self.closed[:, wheel].astype(bool))


def record(
    problem: Problem,
    method: HHT,
    n_step: int,
    rows: SparseMatrix,
    *,
    vertical: Vector | None,
    load: float,
    progress: Progress,
    energy: bool = False,
) -> Recording:
    """Integrates by the direct method, and checks equilibrium at every step.

    Args:
        problem: What to integrate.
        method: Time integration.
        n_step: Steps.
        rows: Displacements to keep, shape (n_row, n_dof) over structure then vehicle.
        vertical: Rigid-body translation upwards of all freedoms, shape (n_dof,), or None.
        load: Greatest magnitude of the total load. [N]
        progress: Told after every step.
        energy: Whether to keep the energy account.
    """
    check = EquilibriumCheck(problem=problem, method=method, vertical=vertical, load=load)
    account = EnergyAccount(problem, method) if energy else None
    kept: list[tuple[FloatArray, ...]] = []
    last: StepState | None = None
    for state in _states(problem, method, n_step):
        check.observe(state)
        if account is not None:
            account.observe(state)
        kept.append(
            (
                np.array([state.time]),
                rows @ state.displacement,
                rows @ state.velocity,
                rows @ state.acceleration,
                state.contact_forces.copy(),
                state.closed.astype(float),
                state.chainage.copy(),
                np.array([float(state.iterations)]),
            )
        )
        last = state
        progress(state.step / n_step)
    columns = [np.array(column) for column in zip(*kept, strict=True)]
    return Recording(
        time=columns[0][:, 0],
        displacement=columns[1],
        velocity=columns[2],
        acceleration=columns[3],
        contact_force=columns[4],
        closed=columns[5],
        chainage=columns[6],
        iterations=columns[7][:, 0],
        status_changes=0 if last is None else last.status_changes,
        restarts=0 if last is None else last.restarts,
        imbalance=check.imbalance(),
        energy=None if account is None else account.balance(),
    )


def _states(problem: Problem, method: HHT, n_step: int) -> Iterator[StepState]:
    return DirectMethod(problem, Settings(method=method, n_step=n_step)).states()


def add_equilibrium(findings: Findings, *recordings: Recording) -> None:
    """Reports the greatest residuals of the runs of a case as comparisons."""
    runs = [recording.imbalance for recording in recordings]
    steps, skipped = sum(run.steps for run in runs), sum(run.skipped for run in runs)
    reason = f"{_EQUILIBRIUM_REASON} {steps} instants checked"
    reason += f", {skipped} halved steps left out." if skipped else "."
    parts = {
        "equation of motion": [run.motion for run in runs],
        "reactions": [run.reactions for run in runs],
        "weights, reactions and inertia forces": [run.vertical for run in runs],
    }
    for name, values in parts.items():
        if not np.isnan(values).all():
            findings.close(
                f"equilibrium at every step: {name}", "of the load", 0.0, max(values), 1e-6, reason
            )


def part_of(progress: Progress, first: float, last: float) -> Progress:
    """Progress of one part of a case, between two fractions of the whole."""
    return lambda fraction: progress(first + (last - first) * fraction)
