"""Starting a motion anew: velocities that fit the constraints, then accelerations and forces.

A rigid contact holds the position; Newmark's velocities and accelerations follow it only as long
as it is smooth. After an impact, a release or a kink of the path they alternate for ever. So at
such an event the velocities change by the impulse that satisfies the constraint's rate, then
accelerations and contact forces come from its second derivative:

    M (a'+ - a'-) = H' J,     H a'+ = rate,
    M a'' = F - C a' - R(a) + H' X,     H a'' = acceleration of the path

(``solver.contact.restart`` decides which wheels take part). An event is a change of status, or a
closed gap whose rate, or the jump of whose second derivative, would leave an alternating force
of more than ``RIPPLE`` times a wheel's load; without dissipation (alpha = 0), every step.

Freedoms without mass take no impulse and keep their values: a wheel of no mass has no velocity to
lose, and its contact force is that of the spring above it.
"""

from __future__ import annotations

import warnings
from functools import cached_property

import numpy as np
import scipy.sparse as sparse

from solver.arrays import BoolVector, IntVector, Matrix, Vector
from solver.contact.laws import RigidContact
from solver.contact.restart import Impulses, force_ripple, restart_forces, restart_impulses
from solver.errors import InputError, SingularSystemError
from solver.factorisation.blocks import FirstBlock
from solver.integrators.hht import HHT
from solver.methods.border import Border, Borders
from solver.methods.settings import StepState
from solver.methods.stacked import Stacked

__all__ = ["RIPPLE", "Restart", "consistent_forces"]

RIPPLE = 0.005
"""Alternating contact force that is let be, over the load of a wheel."""


class Restart:
    """The mass matrix, factorised when first needed, and the pairs that an impulse can reach.

    Attributes:
        reference_load: Load of a wheel, against which an alternating force is judged. [N]
    """

    def __init__(self, stacked: Stacked, borders: Borders) -> None:
        self._stacked, self._borders = stacked, borders
        diagonal = stacked.mass_ff.diagonal()
        self._massive: IntVector = np.flatnonzero(diagonal > 0.0)
        self._columns = stacked.free[self._massive]
        self._is_free = np.zeros(stacked.n_dof, dtype=bool)
        self._is_free[stacked.free] = True
        self._is_massive = np.zeros(stacked.n_dof, dtype=bool)
        self._is_massive[self._columns] = True
        self._wheel_inverse: tuple[IntVector, Matrix] | None = None
        self._rigid = isinstance(stacked.problem.law, RigidContact)
        self.reference_load = 0.0

    def reaches(self, border: Border) -> BoolVector:
        """Rigid pairs with mass on every free freedom that they move, shape (n_wheel,)."""
        if not self._rigid:
            return np.zeros(border.gap.size, dtype=bool)
        touched = border.h.values != 0.0
        free = self._is_free[border.h.columns] & touched
        massive = self._is_massive[border.h.columns] & touched
        return massive.any(axis=1) & (free == massive).all(axis=1)

    @cached_property
    def _mass(self) -> FirstBlock:
        """The masses, factorised once, with the freedoms that contact rows touch as interface."""
        matrix = self._stacked.mass_ff[self._massive][:, self._massive]
        place = np.full(self._stacked.n_dof, -1)
        place[self._columns] = np.arange(self._columns.size)
        interface = place[self._borders.freedoms]
        try:
            return FirstBlock(sparse.csr_array(matrix), interface[interface >= 0], "the masses")
        except SingularSystemError as error:
            raise InputError(
                "mass", "singular", "a freedom that shares in a mass can move without inertia",
                "Give every body its rotary inertia.",
            ) from error  # fmt: skip

    @cached_property
    def _interface(self) -> IntVector:
        """Freedoms of the interface among all freedoms."""
        freedoms = self._borders.freedoms
        return freedoms[self._is_massive[freedoms]]

    @cached_property
    def _place(self) -> IntVector:
        place = np.full(self._stacked.n_dof, -1)
        place[self._interface] = np.arange(self._interface.size)
        return place

    def _mobility(self, border: Border, index: IntVector) -> tuple[Matrix, Matrix]:
        """Compliance of the masses between pairs, and the interface's part for unit impulses.

        Returns:
            Shapes (n, n) and (n, n_interface).
        """
        if index.size == 0:
            return np.zeros((0, 0)), np.zeros((0, self._interface.size))
        rows = border.h.take(index).renumbered(self._place, self._interface.size)
        response = rows.times(self._mass.flexibility)
        compliance = rows.times_transposed(response)
        return 0.5 * (compliance + compliance.T), response

    def gap_rate(self, border: Border, state: StepState) -> Vector:
        """Rate of each pair's gap, shape (n_wheel,). [m/s]"""
        rate = self._borders.path_rate(border, state.displacement, state.velocity)
        return border.h.dot(state.velocity) - rate

    def gap_acceleration(self, border: Border, state: StepState) -> Vector:
        """Second derivative of each pair's gap, shape (n_wheel,). [m/s2]"""
        bend = self._borders.path_acceleration(border, state.displacement, state.velocity)
        return border.h.dot(state.acceleration) - bend

    def stays(
        self, border: Border, released: BoolVector, new: StepState, method: HHT
    ) -> BoolVector:
        """Released wheels whose tension does not persist once velocities are in order.

        Args:
            border: Contact rows.
            released: Wheels that the step would let go, shape (n_wheel,).
            new: The state with these wheels let go.
            method: The method with the step's length.
        """
        index = np.flatnonzero((new.closed | released) & self.reaches(border))
        compliance, _ = self._mobility(border, index)
        impulses = self._impulses(compliance, border, new, index, method)
        stays = np.zeros_like(released)
        stays[index] = impulses.closed
        return stays & released

    def is_due(self, border: Border, before: StepState, new: StepState, method: HHT) -> bool:
        """Whether a closed wheel's velocity or acceleration contradicts its constraint.

        Without dissipation every error of a constraint's rate stays and adds to the alternating
        force (Newmark's method has a double root of -1 there), so that with alpha = 0 the motion
        is put right at every step. The second derivative counts by its jump over the step: with
        alpha < 0 the accelerations belong to an earlier time, which leaves a steady difference.
        """
        reached = self.reaches(border)
        if not reached.any():
            return False
        new.gap_acceleration = np.where(reached, self.gap_acceleration(border, new), 0.0)
        index = np.flatnonzero(new.closed & reached)
        if index.size == 0 or method.alpha == 0.0:
            return index.size > 0
        jump = 0.5 * (new.gap_acceleration - before.gap_acceleration)
        rate = self.gap_rate(border, new) / (method.gamma * method.time_step)
        errors = np.stack([rate, jump], axis=1)[index]
        allowed = RIPPLE * self.reference_load
        # Without the structure the compliance is least and the ripple greatest: cheap, enough.
        least = self._wheel_compliance(border, index)
        if np.all(force_ripple(least, errors) <= allowed):
            return False
        compliance, _ = self._mobility(border, index)
        return bool(force_ripple(compliance, errors).max() > allowed)

    def _wheel_compliance(self, border: Border, index: IntVector) -> Matrix:
        """Compliance of the wheels' own masses between pairs."""
        if self._wheel_inverse is None:
            freedoms = self._borders.wheel_freedoms
            own = self._is_massive & np.isin(np.arange(self._stacked.n_dof), freedoms)
            columns = np.flatnonzero(own)
            matrix = self._stacked.mass[columns][:, columns].toarray()
            self._wheel_inverse = columns, np.linalg.inv(matrix)
        columns, inverse = self._wheel_inverse
        rows = border.wheel.take(index).dense()[:, columns]
        return rows @ inverse @ rows.T

    def apply(self, border: Border, state: StepState, method: HHT | None = None) -> None:
        """Starts ``state`` anew, its closed rigid pairs on masses included; changes it in place.

        Contact forces of other closed pairs (on wheels without mass) stay as they are. Wheels
        that separate, or whose tension persists, are let go.

        Args:
            border: Contact rows.
            state: The state.
            method: The method with the step's length; None where no step led here.

        Raises:
            SingularSystemError: The constraints depend on each other.
        """
        if self._massive.size == 0:
            return
        unilateral = self._stacked.problem.unilateral
        reached = self.reaches(border)
        index = np.flatnonzero(state.closed & reached)
        compliance, response = self._mobility(border, index)
        impulses = self._impulses(compliance, border, state, index, method)
        if impulses.change.any():
            self._mass.forward(np.zeros(self._massive.size))
            state.velocity[self._columns] += self._mass.backward(impulses.change @ response)
        state.contact_forces = np.where(reached, 0.0, state.contact_forces)
        force = self._force(state) + border.h.transposed_dot(state.contact_forces)[self._columns]
        free = self._mass.forward(force)
        state.acceleration[self._interface] = free
        found, touching, _ = restart_forces(
            compliance, self.gap_acceleration(border, state)[index], impulses.closed, unilateral,
            state.time,
        )  # fmt: skip
        state.acceleration[self._columns] = self._mass.backward(free + found @ response)
        state.contact_forces[index] = found
        state.closed = state.closed.copy()
        state.closed[index] = touching
        state.gap_acceleration = np.zeros(border.gap.size)

    def _impulses(
        self, compliance: Matrix, border: Border, state: StepState, index: IntVector,
        method: HHT | None,
    ) -> Impulses:  # fmt: skip
        """Impulses that make the rates of closed pairs admissible."""
        spent = np.zeros(index.size)
        if method is not None:
            new = method.gamma * method.time_step * method.force_factor
            spent = new * state.contact_forces[index]
        rate = self.gap_rate(border, state)[index]
        unilateral = self._stacked.problem.unilateral
        return restart_impulses(compliance, rate, spent, unilateral, state.time)

    def _force(self, state: StepState) -> Vector:
        """F - C a' - R(a), and the supports' inertia, on the freedoms with mass."""
        stacked = self._stacked
        external, _ = stacked.load(state.time)
        internal = (stacked.stiffness @ state.displacement + stacked.damping @ state.velocity)[
            stacked.free
        ]
        total = external - internal
        if stacked.nonlinear:
            total = total - stacked.nonlinear_force(state.displacement[stacked.free])
        if stacked.supports_move:
            total = total - stacked.mass_fp @ state.acceleration[stacked.prescribed]
        return total[self._massive]


def consistent_forces(stacked: Stacked, border: Border, state: StepState) -> Vector:
    """Contact forces on wheels without mass that balance their massless freedoms.

    Returns:
        Shape (n_wheel,), zero for wheels with mass. [N]
    """
    massless = stacked.free[stacked.mass_ff.diagonal() == 0.0]
    rows = border.rows[:, massless].toarray()
    concerned = np.flatnonzero(np.abs(rows).sum(axis=1))
    forces = np.zeros(border.gap.size)
    if concerned.size == 0:
        return forces
    whole = stacked.whole(stacked.load(state.time)[0], np.zeros(stacked.prescribed.size))
    pull = stacked.stiffness @ state.displacement + stacked.damping @ state.velocity - whole
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            forces[concerned] = np.linalg.lstsq(rows[concerned].T, pull[massless], rcond=None)[0]
        except np.linalg.LinAlgError as error:
            raise SingularSystemError("the contact", "its forces are not determined") from error
    return forces
