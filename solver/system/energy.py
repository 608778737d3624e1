"""Where the energy of a run goes.

    work of gravity + work of the drive
        = change of kinetic and strain energy (Hertz springs included)
        + viscous loss + loss of the integration (alpha < 0) + loss at impacts (rigid contact)

with the drive's work the integral of sum X v (dw/dx + dr/dx): wheels that roll up a slope are
pushed (modelling decision "Accuracy to expect"). Every term but one is exact for the discrete
motion; only the drive's integral is a trapezoidal rule, so what does not balance (``gap``)
measures the coupling of the contact, and is of order two in the time step while contact lasts.

The integration's own loss follows from Newmark's kinematics and the weighted equation of motion
(Hilber, Hughes and Taylor 1977): with q = C a' + K a - F, mean values over the step barred and
changes D,

    loss = alpha (q_bar - q_bar_before) Da + (beta - gamma/2) dt^2 Da'' M a''_bar
           - (gamma - 1/2) Da'' M [Da - (beta - gamma/2) dt^2 Da''].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import scipy.sparse as sparse

from solver.arrays import FloatArray, SparseMatrix, Vector
from solver.contact.path import hermite
from solver.system.coupled import EffectiveSystem
from solver.system.rigid_restart import MovingPart

__all__ = ["EnergyBalance", "EnergyTerms"]


@dataclass(frozen=True, kw_only=True)
class EnergyTerms:
    """Energies since the start. [J]

    Attributes:
        gravity: Work of gravity on the train, counted from rest.
        drive: Work of what keeps the speed.
        kinetic: Change of kinetic energy.
        strain: Change of strain energy of all parts, pads included.
        hertz: Change of the Hertz springs' energy.
        viscous: Loss in dashpots and material.
        integration: Loss of the time integration.
        impact: Loss at impacts of rigid contact.
    """

    gravity: float = 0.0
    drive: float = 0.0
    kinetic: float = 0.0
    strain: float = 0.0
    hertz: float = 0.0
    viscous: float = 0.0
    integration: float = 0.0
    impact: float = 0.0

    @property
    def gap(self) -> float:
        """What is missing: zero for a perfect balance. [J]"""
        stored = self.kinetic + self.strain + self.hertz
        lost = self.viscous + self.integration + self.impact
        return self.gravity + self.drive - stored - lost

    @property
    def exchange(self) -> float:
        """The greatest term. [J]"""
        return max(abs(float(getattr(self, entry.name))) for entry in fields(self))


@dataclass(frozen=True, kw_only=True)
class _Snapshot:
    """What the balance keeps of a step, motions flattened."""

    displacements: list[Vector]
    velocities: list[Vector]
    accelerations: list[Vector]
    imbalances: list[Vector]
    power: float
    impact_drive: float


class EnergyBalance:
    """Energy terms of a run, step after step.

    Args:
        effective: The system, with the forces of the static start; its train counted from rest.
        motions: Of lines, train and structure, at the static start.
        time_step: [s]

    ``record`` after every step updates ``terms``. It multiplies by all matrices: for checks and
    verification, not for every run.
    """

    def __init__(
        self, effective: EffectiveSystem, motions: Sequence[MovingPart], time_step: float
    ) -> None:
        self._effective, self._motions, self._time_step = effective, motions, time_step
        c = effective.coefficients
        self._alpha = c.memory
        # From A0 = 1 / (beta dt^2) and A1 = gamma / (beta dt).
        self._gamma = c.damping / c.force / c.mass / time_step
        self._kinematic = 1.0 / c.mass - 0.5 * self._gamma * time_step**2
        self._matrices = _matrices(effective, len(motions))
        self._viscous = self._integration = self._drive = self._gravity = 0.0
        self._restarts = effective.state.restarts
        self._before = self._snapshot(0.0, start=True)
        # At a static start the imbalance is zero at all times before.
        self._imbalance_before = self._before.imbalances
        self._start = self._stored()
        self.terms = EnergyTerms()

    def record(self, time: float) -> EnergyTerms:
        """Takes the state at the end of a step.

        Args:
            time: At the end of the step. [s]

        Returns:
            The terms since the start.
        """
        now, before, state = self._snapshot(time), self._before, self._effective.state
        restarted = state.restarts != self._restarts
        self._restarts = state.restarts
        for part, (_, damping, _) in enumerate(self._matrices):
            change = now.displacements[part] - before.displacements[part]
            mean = 0.5 * (now.velocities[part] + before.velocities[part])
            self._viscous += float(change @ (damping @ mean))
            if not restarted:  # after a restart the step's own equation no longer shows
                self._integration += self._integration_loss(part, now, before)
        self._viscous += self._pad_loss(now, before)
        train = self._effective.system.train
        self._gravity += float(train.weight @ (now.displacements[1] - before.displacements[1]))
        self._drive += 0.5 * self._time_step * (now.power + before.power)
        self._drive += now.impact_drive - before.impact_drive
        # A restart puts lines and train in balance: their step has no imbalance before its own.
        self._imbalance_before = before.imbalances
        if restarted:
            self._imbalance_before = now.imbalances[:2] + before.imbalances[2:]
        self._before = now
        kinetic, strain, hertz = (
            end - begin for end, begin in zip(self._stored(), self._start, strict=True)
        )
        self.terms = EnergyTerms(
            gravity=self._gravity,
            drive=self._drive,
            kinetic=kinetic,
            strain=strain,
            hertz=hertz,
            viscous=self._viscous,
            integration=self._integration,
            impact=state.impact_loss,
        )
        return self.terms

    def _snapshot(self, time: float, start: bool = False) -> _Snapshot:
        motions, alpha = self._motions, self._alpha
        accelerations = [_flat(motion.acceleration) for motion in motions]
        imbalances = [
            np.zeros_like(acceleration)
            if start
            else (alpha * _flat(motion.imbalance) - mass @ acceleration) / (1.0 + alpha)
            for motion, acceleration, (mass, _, _) in zip(
                motions, accelerations, self._matrices, strict=True
            )
        ]
        return _Snapshot(
            displacements=[_flat(motion.displacement) for motion in motions],
            velocities=[_flat(motion.velocity) for motion in motions],
            accelerations=accelerations,
            imbalances=imbalances,
            power=self._power(time),
            impact_drive=self._effective.state.impact_drive,
        )

    def _integration_loss(self, part: int, now: _Snapshot, before: _Snapshot) -> float:
        mass, kinematic = self._matrices[part][0], self._kinematic
        change = now.displacements[part] - before.displacements[part]
        jerk = now.accelerations[part] - before.accelerations[part]
        mean = 0.5 * (now.accelerations[part] + before.accelerations[part])
        # q_bar - q_bar_before spans two steps.
        imbalance = 0.5 * (now.imbalances[part] - self._imbalance_before[part])
        loss = self._alpha * float(imbalance @ change)
        loss += kinematic * float(jerk @ (mass @ mean))
        return loss - (self._gamma - 0.5) * float(jerk @ (mass @ (change - kinematic * jerk)))

    def _pad_relative(self, lines: Vector, structure: Vector) -> Vector:
        """Rails less seats, line after line."""
        system = self._effective.system
        assert system.structure is not None
        rails = lines.reshape(-1, system.line.n_line)[2 * system.seat_nodes].T.ravel()
        return rails - structure[system.structure.seats]

    def _pad_loss(self, now: _Snapshot, before: _Snapshot) -> float:
        pads = self._effective.system.structure
        if pads is None:
            return 0.0
        end = self._pad_relative(now.displacements[0], now.displacements[2])
        begin = self._pad_relative(before.displacements[0], before.displacements[2])
        rate = self._pad_relative(now.velocities[0], now.velocities[2])
        rate = 0.5 * (rate + self._pad_relative(before.velocities[0], before.velocities[2]))
        return float((end - begin) @ (pads.pad_damping * rate))

    def _stored(self) -> tuple[float, float, float]:
        """Kinetic energy, strain energy, energy of the Hertz springs."""
        kinetic = strain = 0.0
        for motion, (mass, _, stiffness) in zip(self._motions, self._matrices, strict=True):
            velocity, displacement = _flat(motion.velocity), _flat(motion.displacement)
            kinetic += 0.5 * float(velocity @ (mass @ velocity))
            strain += 0.5 * float(displacement @ (stiffness @ displacement))
        system, state = self._effective.system, self._effective.state
        if system.structure is not None:
            lines, structure = (_flat(self._motions[part].displacement) for part in (0, 2))
            relative = self._pad_relative(lines, structure)
            strain += 0.5 * float(relative @ (system.structure.pad_stiffness * relative))
        hertz = 0.5 * system.contact_compliance * float(state.contact_forces @ state.contact_forces)
        if system.nonlinear_hertz is not None:
            hertz += 0.4 * float(state.contact_forces @ state.compression)
        return kinetic, strain, hertz

    def _power(self, time: float) -> float:
        """sum X v (dw/dx + dr/dx). [W]"""
        system = self._effective.system
        line, x = system.line, system.wheel_positions(time)
        nodes, _ = line.locate(x)
        length = line.positions[nodes + 1] - line.positions[nodes]
        slopes = hermite((x - line.positions[nodes]) / length, length, 1) / length[:, None]
        dofs = 2 * nodes[:, None] + np.arange(4)
        values = self._motions[0].displacement[dofs, system.train.wheel_lines[:, None]]
        rise = np.einsum("nk,nk->n", slopes, values) + system.irregularity_derivative(x, 1)
        return float(self._effective.state.contact_forces @ rise) * system.speed


def _flat(values: FloatArray) -> Vector:
    return np.array(values, dtype=np.float64).ravel()


def _matrices(
    effective: EffectiveSystem, n_part: int
) -> list[tuple[SparseMatrix, SparseMatrix, SparseMatrix]]:
    """Mass, damping and stiffness of lines (flattened), train and structure."""
    system = effective.system
    several = sparse.eye_array(system.line.n_line)
    matrices: list[tuple[SparseMatrix, SparseMatrix, SparseMatrix]] = []
    for part in (system.line, system.train, system.structure)[:n_part]:
        assert part is not None
        three = (part.mass, part.damping, part.stiffness)
        if part is system.line:
            three = tuple(sparse.csr_array(sparse.kron(matrix, several)) for matrix in three)
        matrices.append(three)
    return matrices
