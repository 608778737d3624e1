"""Contact of a step with a linear law: appendix A and a complementarity problem.

Rigid and linear Hertz contact add no unknown to the second block: the spring is 1 / k_h on its
diagonal. At a prescribed speed the rows do not depend on the displacements and one pass is exact;
in free drive the rows follow the iterate.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import BoolVector, Matrix, Vector
from solver.contact.complementarity import solve_contact
from solver.contact.laws import LinearHertz
from solver.errors import ConvergenceError
from solver.factorisation.blocks import TwoBlockFactorisation
from solver.integrators.hht import HHT
from solver.methods.border import Border, Borders
from solver.methods.contact_step import ContactSolution, UnsettledError
from solver.methods.settings import Settings, StepState
from solver.methods.stacked import Stacked
from solver.methods.step import StepEquations

__all__ = ["LinearContactSolver"]


class LinearContactSolver:
    """Factorises the effective matrix once, for one step length.

    Args:
        stacked: Matrices.
        borders: Contact rows.
        settings: Tolerances.
        method: The method with its step length.
    """

    def __init__(self, stacked: Stacked, borders: Borders, settings: Settings, method: HHT) -> None:
        self._stacked, self._borders, self._settings = stacked, borders, settings
        problem = stacked.problem
        positions = stacked.free_position(borders.freedoms)
        self._interface = borders.freedoms[positions >= 0]
        self._place = np.full(stacked.n_dof, -1)
        self._place[self._interface] = np.arange(self._interface.size)
        effective = stacked.effective(method)
        self.blocks = TwoBlockFactorisation(
            effective, positions[positions >= 0], "structure and vehicle"
        )
        self._factor = method.force_factor
        law = problem.law
        self._spring = 1.0 / law.stiffness if isinstance(law, LinearHertz) else 0.0
        self._corner = -self._factor * self._spring * np.eye(problem.wheels.count)

    def solve(
        self, step: StepEquations, state: StepState, keep_closed: BoolVector | None = None
    ) -> ContactSolution:
        """See ``ContactSolver``."""
        free = self.blocks.forward(step.load)
        whole = self._supports(step)
        whole[self._interface] = free
        closed, chainage, forces = state.closed, state.chainage, state.contact_forces
        iterations = 0
        for _ in range(self._settings.most_iterations):
            border = self._borders.at(step.time, whole, chainage)
            forces, closed, solves = self._contact(step, border, closed, keep_closed)
            iterations += solves
            interface = self.blocks.interface(forces)
            whole[self._interface] = interface
            chainage = border.chainage
            if not self._borders.moves_freely:
                break
            moved = self._borders.again(step.time, whole, border)
            if self._settled(border, moved, forces, closed, step):
                border = moved
                break
        else:
            raise UnsettledError(self._worst(forces), float(np.abs(forces).max(initial=0.0)))
        return ContactSolution(
            displacement=np.array(self.blocks.backward(interface)),
            forces=forces, closed=closed, border=border, iterations=iterations,
        )  # fmt: skip

    def _supports(self, step: StepEquations) -> Vector:
        """All freedoms, the prescribed ones at their places and the others at zero."""
        whole = np.zeros(self._stacked.n_dof)
        whole[self._stacked.prescribed] = step.supports[0]
        return whole

    def _contact(
        self, step: StepEquations, border: Border, closed: BoolVector,
        keep_closed: BoolVector | None,
    ) -> tuple[Vector, BoolVector, int]:  # fmt: skip
        """Contact forces for the rows of a border."""
        rows = border.h.renumbered(self._place, self._interface.size)
        complement = self.blocks.border(rows.scaled(-self._factor), self._corner)
        if border.gap.size == 0:
            return np.zeros(0), closed, 0
        compliance = complement / self._factor
        approach = border.elevation + self.blocks.border_free() / self._factor
        if self._stacked.supports_move:
            approach = approach - border.h.dot(self._supports(step))
        unilateral = self._stacked.problem.unilateral
        try:
            if keep_closed is None or not unilateral:
                return solve_contact(compliance, approach, closed, unilateral, step.time)
            return _with_some_kept(compliance, approach, closed, keep_closed, step.time)
        except ConvergenceError as error:
            raise UnsettledError("a wheel", error.residual) from error

    def _settled(
        self, before: Border, after: Border, forces: Vector, closed: BoolVector,
        step: StepEquations,
    ) -> bool:  # fmt: skip
        """Whether neither the rows nor the gaps of closed contacts moved any more."""
        settings = self._settings
        change = after.h.transposed_dot(forces) - before.h.transposed_dot(forces)
        load = max(float(np.linalg.norm(step.external)), float(np.abs(forces).max(initial=0.0)))
        penetration = after.gap + self._spring * forces
        tight = np.abs(penetration[closed]).max(initial=0.0) <= settings.gap_tolerance
        # Without any load the change ends in the rounding of the histories.
        rounding = 1e-12 * float(np.linalg.norm(step.load))
        return bool(tight and np.linalg.norm(change) <= settings.tolerance * load + rounding)

    def _worst(self, forces: Vector) -> str:
        return self._stacked.problem.wheels.names[int(np.argmax(np.abs(forces)))]


def _with_some_kept(
    compliance: Matrix, approach: Vector, closed: BoolVector, kept: BoolVector, time: float
) -> tuple[Vector, BoolVector, int]:
    """Complementarity among the other wheels; those kept stay closed whatever their force."""
    others, kept_ids = np.flatnonzero(~kept), np.flatnonzero(kept)
    if others.size == 0:
        return solve_contact(compliance, approach, closed, False, time)
    inner = compliance[np.ix_(kept_ids, kept_ids)]
    cross = compliance[np.ix_(others, kept_ids)]
    share = np.linalg.solve(inner, np.column_stack([approach[kept_ids], cross.T]))
    reduced = compliance[np.ix_(others, others)] - cross @ share[:, 1:]
    forces, status = np.zeros_like(approach), np.ones_like(closed)
    forces[others], status[others], solves = solve_contact(
        0.5 * (reduced + reduced.T), approach[others] - cross @ share[:, 0], closed[others], True,
        time,
    )  # fmt: skip
    forces[kept_ids] = share[:, 0] - share[:, 1:] @ forces[others]
    return forces, status, solves
