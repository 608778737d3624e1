"""Energy balance of a run: where every joule went.

    work of the loads + work of the drive
        = change of kinetic and strain energy, contact springs included
          + viscous loss + loss of the HHT method + loss at re-contact (rigid law)

The drive that keeps the speed v constant does the work of sum X v (dw/dx + dr/dx) dt, the contact
forces' component along the deformed, irregular path. Over a step it is X, the mean of both ends,
times what the wheel climbs between its two places on the mean of both shapes: so a wheel that
passes a kink of the path between two instants pays for the whole of it.

The loss of the HHT method follows from its own recurrences; with d = difference and m = mean of
both ends of a step, and e = M a'' + q the imbalance that alpha leaves at an instant,

    dT + dV - m(F) da = m(e) da + (gamma - 1/2) da M da''
        - dt^2 (beta - gamma / 2) [m(a'') + (gamma - 1/2) da''] M da'',

which vanishes for alpha = 0 (beta = 1/4, gamma = 1/2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from solver.arrays import SparseMatrix, Vector
from solver.contact.laws import LinearHertz, NonlinearHertz
from solver.errors import InputError
from solver.integrators.hht import HHT
from solver.methods.problem import PrescribedSpeed, Problem
from solver.methods.settings import StepState
from solver.verification.equilibrium import contact_loads

__all__ = ["EnergyAccount", "EnergyBalance"]


@dataclass(frozen=True, kw_only=True)
class EnergyBalance:
    """Energies since the start, each of shape (n_step + 1,). [J]

    Attributes:
        loads: Work of gravity and other loads.
        drive: Work of the drive.
        kinetic: Change of kinetic energy.
        strain: Change of strain energy of structure and vehicle.
        contact: Change of the energy of the contact springs.
        viscous: Lost in dampers.
        numerical: Lost by the HHT method.
        recontact: Lost in the impulses of the rigid law.
    """

    loads: Vector
    drive: Vector
    kinetic: Vector
    strain: Vector
    contact: Vector
    viscous: Vector
    numerical: Vector
    recontact: Vector

    @property
    def stored(self) -> Vector:
        """Kinetic and strain energy, contact springs included."""
        return self.kinetic + self.strain + self.contact

    @property
    def lost(self) -> Vector:
        """All losses."""
        return self.viscous + self.numerical + self.recontact

    @property
    def remainder(self) -> Vector:
        """What the balance leaves open."""
        return self.loads + self.drive - self.stored - self.lost

    @property
    def exchange(self) -> float:
        """Greatest magnitude of any of the exchanged energies."""
        parts = (self.loads, self.drive, self.kinetic, self.strain, self.contact)
        return max(float(np.abs(part).max()) for part in parts)


@dataclass(frozen=True, kw_only=True)
class _Instant:
    """Copies of what the next step needs."""

    displacement: Vector
    velocity: Vector
    acceleration: Vector
    contact_forces: Vector
    path_rows: SparseMatrix
    elevation: Vector
    imbalance: Vector
    kinetic: float
    strain: float
    contact: float
    restarts: int


class EnergyAccount:
    """Watches a run, step by step.

    Args:
        problem: What is integrated: prescribed speed, supports that do not move, no nonlinear
            elements, constant loads.
        method: How.
    """

    def __init__(self, problem: Problem, method: HHT) -> None:
        structure, vehicle = problem.structure, problem.vehicle
        if not isinstance(problem.drive, PrescribedSpeed) or any(
            part.support_motion is not None or part.nonlinear is not None
            for part in (structure, vehicle)
        ):
            raise InputError("problem", "free drive, moving supports or nonlinear elements",
                             "have no energy account here", "Use a prescribed speed.")  # fmt: skip
        self._problem, self._method = problem, method
        self._mass = _stack(structure.mass, vehicle.mass)
        self._damping = _stack(structure.damping, vehicle.damping)
        self._stiffness = _stack(structure.stiffness, vehicle.stiffness)
        self._load = np.concatenate([structure.load_at(0.0), vehicle.load_at(0.0)])
        free = np.ones(len(self._load), dtype=bool)
        free[structure.prescribed] = False
        free[vehicle.prescribed + structure.n_dof] = False
        self._free = free
        self._before: _Instant | None = None
        self._entries: list[tuple[float, ...]] = []

    def observe(self, state: StepState) -> None:
        """Takes the state at the end of a step, or of the start."""
        now = self._instant(state)
        if self._before is None:
            self._entries.append((0.0,) * 8)
        else:
            self._entries.append(self._step(self._before, now))
        self._before = now

    def balance(self) -> EnergyBalance:
        """Energies since the start."""
        columns = np.cumsum(np.array(self._entries), axis=0).T
        return EnergyBalance(
            loads=columns[0],
            drive=columns[1],
            kinetic=columns[2],
            strain=columns[3],
            contact=columns[4],
            viscous=columns[5],
            numerical=columns[6],
            recontact=columns[7],
        )

    def _step(self, old: _Instant, new: _Instant) -> tuple[float, ...]:
        """What the step exchanged, in the order of the balance's attributes."""
        moved = new.displacement - old.displacement
        mean_force = 0.5 * (new.contact_forces + old.contact_forces)
        n_structure = self._problem.structure.n_dof
        mean_shape = 0.5 * (new.displacement + old.displacement)[:n_structure]
        climbed = (new.path_rows - old.path_rows) @ mean_shape + new.elevation - old.elevation
        viscous = 0.0
        if self._damping.nnz:
            rates = (old.velocity, new.velocity)
            step = self._method.time_step
            viscous = 0.5 * step * float(sum(rate @ (self._damping @ rate) for rate in rates))
        lost, jump = self._numerical(old, new, moved)
        return (
            float(self._load @ moved),
            float(mean_force @ climbed),
            new.kinetic - old.kinetic,
            new.strain - old.strain,
            new.contact - old.contact,
            viscous,
            lost,
            jump,
        )

    def _numerical(self, old: _Instant, new: _Instant, moved: Vector) -> tuple[float, float]:
        """Loss of the HHT method over a step, and loss in the impulses at its end."""
        method, free = self._method, self._free
        acceleration, imbalance, jump = new.acceleration, new.imbalance, 0.0
        if new.restarts > old.restarts:
            velocity = method.a1 * moved - method.a4 * old.velocity - method.a5 * old.acceleration
            acceleration = method.a0 * moved - method.a2 * old.velocity
            acceleration = acceleration - method.a3 * old.acceleration
            velocity[~free], acceleration[~free] = 0.0, 0.0
            jump = 0.5 * float(velocity @ (self._mass @ velocity)) - new.kinetic
            # q before the impulse follows from equation 4.3; e = M a'' + q.
            inertia = self._mass @ acceleration
            forces = old.imbalance - self._mass @ old.acceleration
            imbalance = method.alpha * (inertia + forces) / method.force_factor
        inertia_change = self._mass @ (acceleration - old.acceleration)
        middle = 0.5 * (acceleration + old.acceleration)
        skew = method.gamma - 0.5
        lag = method.time_step**2 * (method.beta - 0.5 * method.gamma)
        gain = 0.5 * moved @ (old.imbalance + imbalance) + skew * moved @ inertia_change
        gain -= lag * (middle + skew * (acceleration - old.acceleration)) @ inertia_change
        return -float(gain), jump

    def _instant(self, state: StepState) -> _Instant:
        problem = self._problem
        point = problem.path.at(state.chainage)
        force = state.contact_forces
        inertia = self._mass @ state.acceleration
        internal = self._stiffness @ state.displacement
        imbalance = inertia + internal - self._load - contact_loads(problem, state)
        if self._damping.nnz:
            imbalance = imbalance + self._damping @ state.velocity
        imbalance[~self._free] = 0.0
        return _Instant(
            displacement=state.displacement.copy(),
            velocity=state.velocity.copy(),
            acceleration=state.acceleration.copy(),
            contact_forces=force.copy(),
            path_rows=problem.path.rows(point.element, point.local).sparse(),
            elevation=problem.irregularity.elevation(state.chainage),
            imbalance=imbalance,
            kinetic=0.5 * float(state.velocity @ (self._mass @ state.velocity)),
            strain=0.5 * float(state.displacement @ internal),
            contact=_contact_energy(problem, force),
            restarts=state.restarts,
        )


def _contact_energy(problem: Problem, force: Vector) -> float:
    """Strain energy of the contact springs under their forces. [J]"""
    law = problem.law
    if isinstance(law, LinearHertz):
        return 0.5 * float(force @ force) / law.stiffness
    if isinstance(law, NonlinearHertz):
        pressed = np.maximum(force, 0.0)
        return 0.4 * float(np.sum(pressed ** (5.0 / 3.0))) / law.coefficient ** (2.0 / 3.0)
    return 0.0


def _stack(first: SparseMatrix, second: SparseMatrix) -> SparseMatrix:
    return sparse.csr_array(sparse.block_diag([first, second], format="csr"))
