"""Rigid contact of wheels that have mass: what happens after an event.

Displacements satisfy the constraint v - w - r = 0 at the end of every step. A kink of the path, a
touchdown or a wheel let go leaves velocities that do not, and Newmark's method would alternate
about that error for ever (modelling decision "Contact"). After an event, at the end of its step:

1. velocities jump by the impulses that make W z' - N w' - v N_x w - v r' admissible, through the
   masses of train and lines alone (the pads keep the structure out of it);
2. accelerations and contact forces follow from the constraint's second derivative,
   W z'' - N w'' - 2 v N_x w' - v^2 N_xx w - v^2 r'' = 0;
3. the imbalance of the step is set to -M a'', so that the next step starts from there.

An event is a change of status, or a closed gap whose rate, or the jump of whose second derivative,
would leave an alternating force of more than ``RIPPLE`` times the mean static wheel load. Wheels
on massless freedoms take no impulse and are left alone. What the jump changes in the pads'
dashpots acts on the lines at once and on the structure from the next step on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Arrays, BoolVector, FloatArray, IntVector, Matrix, Vector
from solver.contact.path import hermite
from solver.contact.restart import Impulses, force_ripple, restart_forces, restart_impulses
from solver.system.parts import Coefficients, LinePart
from solver.system.system import System
from solver.system.train_part import TrainPart

__all__ = ["RIPPLE", "MovingPart", "RestartEnergy", "RigidRestart"]

RIPPLE = 0.005
"""Alternating contact force that is let be, over the mean static load of a wheel."""


class MovingPart(Protocol):
    """A part's motion, changed in place by a restart."""

    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    imbalance: FloatArray


@dataclass(frozen=True, kw_only=True)
class RestartEnergy:
    """What an impact costs.

    Attributes:
        loss: Energy lost, at least zero. [J]
        drive: Work of the drive during the impact. [J]
    """

    loss: float
    drive: float


@dataclass(frozen=True, kw_only=True)
class _Place:
    """The lines under the wheels: N and its derivatives along x, and those of r."""

    dofs: IntVector
    rows: FloatArray
    slopes: FloatArray
    curvatures: FloatArray
    rise: Vector
    bend: Vector


class RigidRestart:
    """Velocities, accelerations and contact forces after an event.

    Args:
        system: The system, its law rigid.
        coefficients: Of the effective equation.
        lines: The lines.
        train: The train.
    """

    def __init__(
        self, system: System, coefficients: Coefficients, lines: LinePart, train: TrainPart
    ) -> None:
        self._system, self._coefficients = system, coefficients
        self._lines, self._train = lines, train
        self.wheels = train.wheels_with_mass
        rows = system.train.wheel_rows
        self._wheel_mobility = rows @ train.mobility @ rows.T
        newmark_a1 = coefficients.damping / coefficients.force
        self._spent = newmark_a1 / coefficients.mass  # gamma dt
        self.reference_load = 0.0
        self._place: _Place | None = None
        self._bend = np.zeros(self.wheels.size)

    def state(self) -> Arrays:
        """What the next step needs of the steps before: the gaps' second derivatives."""
        return {"bend": np.array(self._bend)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Takes what ``state`` gave."""
        self._bend = np.array(state["bend"])

    def move(self, x: Vector, nodes: IntVector, rows: FloatArray) -> None:
        """Takes the wheels' places at the end of the step; the rows masked."""
        line, system = self._system.line, self._system
        length = line.positions[nodes + 1] - line.positions[nodes]
        local = (x - line.positions[nodes]) / length
        slopes = hermite(local, length, 1) / length[:, None]
        curvatures = hermite(local, length, 2) / length[:, None] ** 2
        self._nodes = nodes
        self._place = _Place(
            dofs=2 * nodes[:, None] + np.arange(4),
            rows=rows,
            slopes=self._lines.masked(nodes, slopes),
            curvatures=self._lines.masked(nodes, curvatures),
            rise=system.irregularity_derivative(x, 1),
            bend=system.irregularity_derivative(x, 2),
        )

    # -- before the step is finished ----------------------------------------------------------

    def kept(
        self, released: BoolVector, forces: Vector, closed: BoolVector,
        lines: tuple[Matrix, Matrix], train_velocity: Vector, time: float,
    ) -> BoolVector:  # fmt: skip
        """Released wheels whose tension does not persist once velocities are in order.

        Args:
            released: Wheels that the step's displacements would let go.
            forces: Contact forces with these wheels let go. [N]
            closed: Which wheels touch then.
            lines: Displacement and velocity of the lines then.
            train_velocity: Velocity of the train then.
            time: At the end of the step. [s]
        """
        candidates = self.wheels & (closed | released)
        rate = self._gap_rate(lines[0], lines[1], train_velocity)
        impulses = self._impulses(candidates, rate, forces, time)[0]
        stays = np.zeros_like(released)
        stays[candidates] = impulses.closed
        return stays & released

    # -- at the end of the step ---------------------------------------------------------------

    def is_due(self, lines: MovingPart, train: MovingPart, closed: BoolVector) -> bool:
        """Whether velocities or accelerations contradict the constraint of a closed wheel.

        The constraint's second derivative counts by its jump over the step: with alpha < 0 the
        accelerations belong to an earlier time, which leaves a steady difference.
        """
        index = np.flatnonzero(self.wheels & closed)
        rate = self._gap_rate(lines.displacement, lines.velocity, train.velocity)
        bend = self._gap_bend((lines.acceleration, train.acceleration), lines)
        errors = np.stack([rate / self._spent, 0.5 * (bend - self._bend)], axis=1)[index]
        self._bend = bend
        if index.size == 0:
            return False
        allowed = RIPPLE * self.reference_load
        # Without the lines the compliance is least and the ripple greatest: cheap, and enough.
        least = self._wheel_mobility[np.ix_(index, index)]
        if np.all(force_ripple(least, errors) <= allowed):
            return False
        return bool(force_ripple(self._compliance(index)[0], errors).max() > allowed)

    def apply(
        self, lines: MovingPart, train: MovingPart, closed: BoolVector, forces: Vector, time: float
    ) -> tuple[Vector, BoolVector, Matrix, RestartEnergy, int]:
        """Restarts the motions of lines and train, in place.

        Returns:
            Contact forces [N]; which wheels touch; change of the lines' velocity, shape
            (n_dof, n_line); energy; small solves.
        """
        candidates = self.wheels & closed
        index = np.flatnonzero(candidates)
        rate = self._gap_rate(lines.displacement, lines.velocity, train.velocity)
        impulses, compliance, columns = self._impulses(candidates, rate, forces, time)
        jump = self._lines_under(columns, index, impulses.change, lines.velocity.shape[0])
        rows = self._system.train.wheel_rows[index]
        train_jump = self._train.mobility @ (rows.T @ impulses.change)
        lines.velocity += jump
        train.velocity += train_jump
        free = self._free_accelerations(lines, train, forces, jump, train_jump)
        bend = self._gap_bend(free, lines)[index]
        found, touching, solves = restart_forces(
            compliance, bend, impulses.closed, self._system.unilateral, time
        )
        self._accelerate(lines, train, free, found, index, columns)
        self._bend = np.zeros(self.wheels.size)
        forces, closed = forces.copy(), closed.copy()
        forces[index], closed[index] = found, touching
        sudden = impulses.total - self._spent * self._coefficients.force * found
        sudden[~impulses.closed] = 0.0
        energy = RestartEnergy(
            loss=0.5 * float(sudden @ compliance @ sudden),
            drive=float(sudden @ self._path_rate(lines.displacement)[index]),
        )
        return forces, closed, jump, energy, impulses.solves + solves

    # -- the algebra's ingredients ------------------------------------------------------------

    def _at(self) -> _Place:
        assert self._place is not None
        return self._place

    def _under(self, weights: FloatArray, values: Matrix) -> Vector:
        """Weights times the lines' freedoms under each wheel."""
        lines = self._system.train.wheel_lines[:, None]
        return np.einsum("nk,nk->n", weights, values[self._at().dofs, lines])

    def _path_rate(self, displacement: Matrix) -> Vector:
        """v (dw/dx + dr/dx): how fast the path rises under a wheel because it rolls."""
        place = self._at()
        return self._system.speed * (self._under(place.slopes, displacement) + place.rise)

    def _gap_rate(self, displacement: Matrix, velocity: Matrix, train_velocity: Vector) -> Vector:
        """Rate of the gap v - w - r. [m/s]"""
        wheels = self._system.train.wheel_rows @ train_velocity
        return wheels - self._under(self._at().rows, velocity) - self._path_rate(displacement)

    def _gap_bend(self, free: tuple[Matrix, Vector], lines: MovingPart) -> Vector:
        """Second derivative of the gap under given accelerations. [m/s2]"""
        place, speed = self._at(), self._system.speed
        return (
            self._system.train.wheel_rows @ free[1]
            - self._under(place.rows, free[0])
            - 2.0 * speed * self._under(place.slopes, lines.velocity)
            - speed**2 * (self._under(place.curvatures, lines.displacement) + place.bend)
        )

    def _compliance(self, index: IntVector) -> tuple[Matrix, Matrix]:
        """A between wheels, and the lines' velocities for unit impulses under them."""
        place, lines = self._at(), self._system.train.wheel_lines
        columns = self._lines.mass_columns(self._nodes[index], place.rows[index])
        between = np.einsum("nk,nkm->nm", place.rows[index], columns[place.dofs[index]])
        same = lines[index][:, None] == lines[index]
        return self._wheel_mobility[np.ix_(index, index)] + same * between, columns

    def _impulses(
        self, candidates: BoolVector, rate: Vector, forces: Vector, time: float
    ) -> tuple[Impulses, Matrix, Matrix]:
        index = np.flatnonzero(candidates)
        compliance, columns = self._compliance(index)
        spent = self._spent * self._coefficients.force * forces[index]
        impulses = restart_impulses(compliance, rate[index], spent, self._system.unilateral, time)
        return impulses, compliance, columns

    def _lines_under(self, columns: Matrix, index: IntVector, loads: Vector, n_dof: int) -> Matrix:
        """Lines' response, shape (n_dof, n_line), to downward loads under wheels."""
        wheel_lines = self._system.train.wheel_lines[index]
        response = np.zeros((n_dof, self._system.line.n_line))
        for k in range(self._system.line.n_line):
            own = wheel_lines == k
            response[: len(columns), k] = -columns[:, own] @ loads[own]
        return response

    def _free_accelerations(
        self, lines: MovingPart, train: MovingPart, forces: Vector, jump: Matrix, train_jump: Vector
    ) -> tuple[Matrix, Vector]:
        """Accelerations after the jump with the contact forces of wheels that have mass removed."""
        c, system = self._coefficients, self._system
        gone = np.where(self.wheels, forces, 0.0)
        inertia = self._train.inertia_force(train.acceleration)
        imbalance = c.imbalance(inertia, train.imbalance)
        imbalance = imbalance + system.train.wheel_rows.T @ gone
        imbalance += self._train.damping_force(train_jump)
        # Massless freedoms keep what the step gave them.
        train_free = train.acceleration - self._train.mobility @ (inertia + imbalance)
        on_lines = c.imbalance(self._lines.inertia_force(lines.acceleration), lines.imbalance)
        on_lines = on_lines + self._lines.damping_force(jump)
        place = self._at()
        wheel_lines = np.broadcast_to(system.train.wheel_lines[:, None], place.dofs.shape)
        np.subtract.at(on_lines, (place.dofs, wheel_lines), place.rows * gone[:, None])
        if system.structure is not None:
            seats = 2 * system.seat_nodes
            dashpots = system.structure.pad_damping.reshape(system.line.n_line, -1).T
            on_lines[seats] += dashpots * jump[seats]
        return -self._lines.accelerated(on_lines), train_free

    def _accelerate(
        self, lines: MovingPart, train: MovingPart, free: tuple[Matrix, Vector],
        forces: Vector, index: IntVector, columns: Matrix,
    ) -> None:  # fmt: skip
        """Accelerations under the new contact forces, and the imbalance that goes with them."""
        rows = self._system.train.wheel_rows[index]
        lines.acceleration[:] = free[0] + self._lines_under(
            columns, index, forces, lines.acceleration.shape[0]
        )
        train.acceleration[:] = free[1] + self._train.mobility @ (rows.T @ forces)
        lines.imbalance = -self._lines.inertia_force(lines.acceleration)
        train.imbalance = -self._train.inertia_force(train.acceleration)
