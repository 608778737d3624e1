"""Structure, rails and train coupled through rail pads and wheel-rail contact.

The forces between the parts are the unknowns of a step: P in the pads (seats of the structure
against the rails) and X in the contacts (wheels against the rails). With w the rails, u the seats,
v the wheels, superscript 0 for motions without interface forces, f = 1 + alpha:

    u = u0 + f C_s P,   w = w0 - f Y P - f R X,   v = v0 + f T X
    P = k_p (w - u) + p_h                          (pads with dashpots, Newmark history p_h)
    v - w - r = -X / k_h                           (closed contact, equations 4.24 and 5.32)

P is eliminated once and for all (its matrix is constant), which leaves the Schur complement of
the contact rows of appendix A, a matrix of the number of wheels:

    [f T + f R_xx + 1/k_h - f^2 R_xs A^-1 R_sx] X = r + w0 - v0 - f R_xs A^-1 b.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.arrays import (
    Arrays,
    BoolVector,
    FloatArray,
    IntVector,
    Matrix,
    Vector,
    below,
    under,
)
from solver.contact.complementarity import contact_forces, solve_contact
from solver.contact.nonlinear import solve_hertz
from solver.errors import UnstableError
from solver.factorisation import Condense
from solver.system.coupled_state import CoupledState
from solver.system.parts import Coefficients, LinePart, StructurePart
from solver.system.rigid_restart import MovingPart, RigidRestart
from solver.system.system import System, TrainMatrices
from solver.system.train_part import TrainPart

__all__ = ["CoupledState", "EffectiveSystem", "System", "TrainMatrices"]


@dataclass
class _Contact:
    """Where the wheels are in the step under way."""

    nodes: IntVector = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    rows: FloatArray = field(default_factory=lambda: np.zeros((0, 4)))


class EffectiveSystem:
    """A system with its effective matrices factorised: one factorisation, any number of steps.

    Args:
        system: The system.
        coefficients: Of the effective equation.
        table: Whether the compliance of the rails is tabulated for moving wheels.
        condenser: What factorises the structure, ``condense`` or what remembers its factors.
    """

    def __init__(
        self,
        system: System,
        coefficients: Coefficients,
        table: bool = True,
        condenser: Condense | None = None,
    ) -> None:
        self.system = system
        self.coefficients = coefficients
        line, train = system.line, system.train
        self.lines = LinePart(line, coefficients, table)
        self.structure = (
            None
            if system.structure is None
            else StructurePart(system.structure, coefficients, condenser)
        )
        self.train = (
            None
            if coefficients.mass == 0.0
            else TrainPart(
                train.mass, train.damping, train.stiffness, train.weight, train.wheel_rows,
                coefficients,
            )
        )  # fmt: skip
        self._wheels = np.arange(train.wheel_offsets.size)
        self._contact = _Contact()
        self._near, self._coupling = np.zeros(0, dtype=np.int64), np.zeros((0, 0))
        self._pad_history = np.zeros(self.n_pad)
        self._seats_viscous = np.zeros(self.n_pad)
        self._viscous: dict[int, FloatArray] = {}
        self._eliminate_pads()
        self.state = CoupledState(
            contact_forces=np.zeros(self._wheels.size),
            closed=np.ones(self._wheels.size, dtype=bool),
            pad_forces=np.zeros(self.n_pad),
            compression=np.zeros(self._wheels.size),
        )
        self._restart = self._rigid_restart()
        self._event, self._time = False, 0.0

    def _rigid_restart(self) -> RigidRestart | None:
        """What restarts rigid wheels that have mass, or None where there are none."""
        if self.train is None or not self.system.is_rigid or not self.train.wheels_with_mass.any():
            return None
        return RigidRestart(self.system, self.coefficients, self.lines, self.train)

    def stand(self, contact_forces: Vector, pad_forces: Vector, compression: Vector) -> None:
        """Takes the forces of the static start."""
        self.state.contact_forces = contact_forces
        self.state.pad_forces = pad_forces
        self.state.compression = compression
        if self._restart is not None:
            self._restart.reference_load = float(np.abs(contact_forces).mean())

    def kept_state(self) -> Arrays:
        """Copies of all that the next step depends on, the motions apart.

        Free motions, histories and the wheels' places are those of one step only: the next one
        makes them anew.
        """
        state = under("contact", self.state.arrays())
        return state if self._restart is None else state | under("restart", self._restart.state())

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Takes what ``kept_state`` gave."""
        self.state.restore(below("contact", state))
        if self._restart is not None:
            self._restart.restore(below("restart", state))

    @property
    def n_pad(self) -> int:
        """Pads of all lines."""
        structure = self.system.structure
        return 0 if structure is None else structure.seats.size

    def _eliminate_pads(self) -> None:
        """Inverse of the pads' matrix A, and the rails' displacements for unit pad forces."""
        n_seat = self.system.seat_nodes.size
        seat_rows = np.zeros((n_seat, 4))
        seat_rows[:, 0] = 1.0
        self._seat_columns = self.lines.columns(self.system.seat_nodes, seat_rows)
        self._pad_inverse = np.zeros((0, 0))
        if self.structure is None:
            return
        c, pads = self.coefficients, self.structure.matrices
        self._pad_effective = pads.pad_stiffness + pads.pad_damping * c.damping / c.force
        matrix = np.diag(1.0 / self._pad_effective) + c.force * self.structure.seat_compliance
        on_rail = self._seat_columns[2 * self.system.seat_nodes]
        for k in range(self.system.line.n_line):
            block = slice(k * n_seat, (k + 1) * n_seat)
            matrix[block, block] += c.force * on_rail
        inverse = np.linalg.inv(matrix)
        self._pad_inverse = 0.5 * (inverse + inverse.T)

    # -- the integrator's three questions ---------------------------------------------------

    def begin(
        self, part: int, motion: MovingPart, inertia: FloatArray, viscous: FloatArray
    ) -> None:
        """Takes a part's histories (0 the lines, 1 the train, 2 the structure)."""
        owner = (self.lines, self.train, self.structure)[part]
        assert owner is not None
        motion.imbalance = owner.begin(inertia, viscous, motion.acceleration, motion.imbalance)
        self._viscous[part] = viscous
        if self.n_pad and part == 0:
            self._seats_viscous = viscous[2 * self.system.seat_nodes].T.ravel()
        if part == 2 and self.structure is not None:
            pads = self.structure.matrices
            relative = self._seats_viscous - viscous[pads.seats]
            self._pad_history = -pads.pad_damping * relative

    def couple(self, time: float) -> None:
        """Finds pad and contact forces at the end of the step.

        Raises:
            UnstableError: The motion is not finite.
            ConvergenceError: No admissible contact state.
        """
        system, state = self.system, self.state
        x = system.wheel_positions(time)
        self._time = time
        self._locate(x)
        assert self.train is not None
        approach = (
            system.irregularity(system.train.wheel_lines, x)
            + self._on_lines(self.lines.free)
            - self.train.free_wheels
            - system.train.wheel_rest
        )
        if not np.isfinite(approach).all():
            raise UnstableError(time, "the motion of the wheels")
        compliance, gap_load = self.contact_problem(self.train.wheel_compliance)
        before = state.closed
        self._solve_contact(compliance, approach - gap_load, time)
        self._event = False
        if self._restart is not None:
            self._restart.move(x, self._contact.nodes, self._contact.rows)
            self._hold(compliance, approach - gap_load, before, time)
        state.status_changes += int(np.count_nonzero(state.closed != before))
        state.pad_forces = self.pad_forces_for(state.contact_forces)

    def _solve_contact(self, compliance: Matrix, approach: Vector, time: float) -> None:
        """Contact forces and statuses at the end of the step, by the system's law."""
        system, state = self.system, self.state
        law = system.nonlinear_hertz
        if law is None:
            state.contact_forces, state.closed, solves = solve_contact(
                compliance, approach, state.closed, system.unilateral, time
            )
            state.small_solves += solves
            return
        found = solve_hertz(compliance, approach, law, state.compression, system.unilateral, time)
        state.contact_forces, state.closed = found.forces, found.closed
        state.compression = found.compression
        state.small_solves += found.iterations

    def _hold(self, compliance: Matrix, approach: Vector, before: BoolVector, time: float) -> None:
        """Holds rigid wheels whose tension is an echo of an event, and notes the event."""
        assert self._restart is not None
        assert self.train is not None
        state = self.state
        self._event = bool((self._restart.wheels & (state.closed != before)).any())
        released = self._restart.wheels & before & ~state.closed
        if not released.any():
            return
        forces = state.contact_forces
        lines = self.lines.finish(self.line_load(forces, self.pad_forces_for(forces)))
        rate = self.coefficients.damping / self.coefficients.force
        velocity = rate * lines - self._viscous[0]
        train_velocity = rate * self.train.finish(forces) - self._viscous[1]
        kept = self._restart.kept(
            released, forces, state.closed, (lines, velocity), train_velocity, time
        )
        state.small_solves += 2
        if kept.any():
            state.closed = state.closed | kept
            state.contact_forces = contact_forces(compliance, approach, state.closed)
            state.small_solves += 1

    def settle(self, motions: Sequence[MovingPart]) -> None:
        """Ends a step: after an event of rigid contact, restarts velocities and accelerations.

        Args:
            motions: Of lines, train and structure at the end of the step; changed in place.

        Raises:
            ConvergenceError: No admissible contact state.
        """
        restart, state = self._restart, self.state
        if restart is None:
            return
        lines, train = motions[0], motions[1]
        if not (self._event or restart.is_due(lines, train, state.closed)):
            return
        forces, closed, jump, energy, solves = restart.apply(
            lines, train, state.closed, state.contact_forces, self._time
        )
        state.status_changes += int(np.count_nonzero(closed != state.closed))
        state.contact_forces, state.closed = forces, closed
        state.small_solves += solves
        state.restarts += 1
        state.impact_loss += energy.loss
        state.impact_drive += energy.drive
        if self.structure is not None:
            seats = jump[2 * self.system.seat_nodes].T.ravel()
            state.pad_forces = state.pad_forces + self.structure.matrices.pad_damping * seats

    def finish(self, part: int) -> FloatArray:
        """The part's displacement at the end of the step."""
        state = self.state
        if part == 1:
            assert self.train is not None
            return self.train.finish(state.contact_forces)
        if part == 2:
            assert self.structure is not None
            return self.structure.finish(state.pad_forces)
        return self.lines.finish(self.line_load(state.contact_forces, state.pad_forces))

    # -- the interface -----------------------------------------------------------------------

    def _locate(self, x: Vector) -> None:
        nodes, rows = self.system.line.locate(x)
        self._contact = _Contact(nodes, self.lines.masked(nodes, rows))

    def _on_lines(self, chain: Matrix) -> Vector:
        """Displacement of the rails under the wheels, shape (n_wheel,)."""
        dofs = 2 * self._contact.nodes[:, None] + np.arange(4)
        lines = self.system.train.wheel_lines[:, None]
        return np.einsum("nk,nk->n", self._contact.rows, chain[dofs, lines])

    def contact_problem(self, wheel_compliance: Matrix) -> tuple[Matrix, Vector]:
        """Compliance S between the contact points, and the share of the pads in the approach."""
        c = self.coefficients
        compliance = c.force * wheel_compliance
        diagonal = self._wheels
        compliance[diagonal, diagonal] += self.system.contact_compliance
        self._add_rails(compliance)
        load = np.zeros(diagonal.size)
        if self.structure is None:
            return compliance, load
        near, coupling = self._wheels_near_seats()
        if near.size:
            product = coupling @ self._pad_inverse
            compliance[np.ix_(near, near)] -= c.force**2 * (product @ coupling.T)
            load[near] = c.force * (product @ self._pad_load())
        self._near, self._coupling = near, coupling
        return compliance, load

    def _add_rails(self, compliance: Matrix) -> None:
        """Adds f R_xx: the rails' own compliance between wheels on one line."""
        first, second = self._pairs
        nodes, rows = self._contact.nodes, self._contact.rows
        if self.lines.has_table:
            values = self.lines.between(nodes[first], rows[first], nodes[second], rows[second])
        else:
            columns = self.lines.columns(nodes, rows)
            dofs = 2 * nodes[first][:, None] + np.arange(4)
            values = np.einsum("nk,nk->n", rows[first], columns[dofs, second[:, None]])
        values = self.coefficients.force * values
        compliance[first, second] += values
        mirrored = first != second
        compliance[second[mirrored], first[mirrored]] += values[mirrored]

    @cached_property
    def _pairs(self) -> tuple[IntVector, IntVector]:
        """Wheels on one line within reach of each other; their distances never change."""
        train = self.system.train
        reach = self.lines.window_length if self.lines.has_table else np.inf
        distance = np.abs(train.wheel_offsets[:, None] - train.wheel_offsets)
        same = train.wheel_lines[:, None] == train.wheel_lines
        first, second = np.nonzero(np.triu(same & (distance <= reach)))
        return first, second

    def _wheels_near_seats(self) -> tuple[IntVector, Matrix]:
        """Wheels that the pads feel, and R_xs for them, shape (n_near, n_pad)."""
        n_seat, train = self.system.seat_nodes.size, self.system.train
        dofs = 2 * self._contact.nodes[:, None] + np.arange(4)
        values = np.einsum("nk,nks->ns", self._contact.rows, self._seat_columns[dofs])
        near = np.flatnonzero(np.abs(values).max(axis=1) > 1e-17 * self._seat_scale)
        coupling = np.zeros((near.size, self.n_pad))
        for k in range(self.system.line.n_line):
            own = train.wheel_lines[near] == k
            coupling[own, k * n_seat : (k + 1) * n_seat] = values[near[own]]
        return near, coupling

    @cached_property
    def _seat_scale(self) -> float:
        return float(np.abs(self._seat_columns).max())

    def _pad_load(self) -> Vector:
        """b: relative displacement of the pads without interface forces, and their history."""
        assert self.structure is not None
        rails = self.lines.free[2 * self.system.seat_nodes].T.ravel()
        history = self._pad_history / self._pad_effective
        return rails - self.structure.free_seats + history

    def pad_forces_for(self, contact_forces: Vector) -> Vector:
        """Pad forces that belong to the contact forces."""
        if self.structure is None:
            return np.zeros(0)
        load = self._pad_load()
        if self._near.size:
            load -= self.coefficients.force * (self._coupling.T @ contact_forces[self._near])
        return self._pad_inverse @ load

    def line_load(self, contact_forces: Vector, pad_forces: Vector) -> Matrix:
        """Interface forces on the chain's freedoms, shape (2 n_node, n_line)."""
        load = np.zeros((2 * self.system.line.n_node, self.system.line.n_line))
        dofs = 2 * self._contact.nodes[:, None] + np.arange(4)
        lines = np.broadcast_to(self.system.train.wheel_lines[:, None], dofs.shape)
        np.subtract.at(load, (dofs, lines), self._contact.rows * contact_forces[:, None])
        if pad_forces.size:
            seats = 2 * self.system.seat_nodes
            load[seats] -= pad_forces.reshape(self.system.line.n_line, -1).T
        return load

    def locate_wheels(self, time: float) -> None:
        """Moves the contact points to where the wheels are at ``time``."""
        self._locate(self.system.wheel_positions(time))
