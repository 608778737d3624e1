"""The run that all methods share: start, time loop, halved steps, restarts, reactions.

Methods differ in how they solve one step. A solver of steps is made once for each step length in
use: once, as long as no step has to be halved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from solver.arrays import Vector
from solver.contact.laws import RigidContact
from solver.errors import ConvergenceError, UnstableError
from solver.integrators.hht import HHT
from solver.methods.border import Borders
from solver.methods.contact_step import ContactSolution, ContactSolver, UnsettledError
from solver.methods.problem import Problem
from solver.methods.restart import Restart
from solver.methods.settings import Settings, StepState
from solver.methods.stacked import Stacked
from solver.methods.start import start_state
from solver.methods.step import (
    StepEquations,
    begin_step,
    imbalance_after,
    motion_after,
    reactions_after,
)

__all__ = ["MakeSolver", "MethodRun"]


MakeSolver: TypeAlias = Callable[[Stacked, Borders, HHT], ContactSolver]
"""Makes the solver of steps of one length; what it factorises once, it factorises here."""


class MethodRun:
    """Integrates a problem.

    Args:
        problem: What to solve.
        settings: How.
        make: Makes the solvers of steps.

    Raises:
        InputError: The path ends before the run does, or a wheel steps over a whole element.
        SingularSystemError: A part can move without resistance.
    """

    def __init__(self, problem: Problem, settings: Settings, make: MakeSolver) -> None:
        problem.check_duration(settings.n_step * settings.time_step, settings.time_step)
        self.problem, self.settings = problem, settings
        self.stacked = Stacked(problem)
        self.borders = Borders(problem, self.stacked)
        self._restart = Restart(self.stacked, self.borders)
        self._make = make
        self._solvers: dict[int, ContactSolver] = {}
        self.state = start_state(self.stacked, self.borders, self._restart)
        self._solver(0)

    @property
    def n_factorisation(self) -> int:
        """Effective matrices factorised so far: one for each step length used."""
        return len(self._solvers)

    def states(self) -> Iterator[StepState]:
        """The present state and the state after every further step; on a fresh run, the start.

        Raises:
            ConvergenceError: A step did not settle, halved as often as allowed; what was computed
                before it has been yielded.
            UnstableError: The response is not finite.
        """
        yield self.state
        for step in range(self.state.step + 1, self.settings.n_step + 1):
            end = step * self.settings.time_step
            self.state = replace(self._advance(self.state, end, 0), step=step)
            yield self.state

    def _method(self, level: int) -> HHT:
        method = self.settings.method
        return replace(method, time_step=method.time_step / 2**level)

    def _solver(self, level: int) -> ContactSolver:
        """The solver for a step halved ``level`` times, made when first needed."""
        if level not in self._solvers:
            self._solvers[level] = self._make(self.stacked, self.borders, self._method(level))
        return self._solvers[level]

    def _advance(self, state: StepState, end: float, level: int) -> StepState:
        """One step to ``end``, in two halves where it does not settle."""
        try:
            return self._step(state, end, level)
        except UnsettledError as error:
            if level == self.settings.most_halvings:
                raise ConvergenceError(end, error.wheel, error.residual) from error
        half = end - self.settings.time_step / 2 ** (level + 1)
        middle = self._advance(state, half, level + 1)
        done = self._advance(middle, end, level + 1)
        return replace(
            done, iterations=middle.iterations + done.iterations, halvings=done.halvings + 1
        )

    def _step(self, state: StepState, end: float, level: int) -> StepState:
        """One undivided step."""
        method = self._method(level)
        solver = self._solver(level)
        step = begin_step(self.stacked, method, state, end)
        if not np.isfinite(step.load).all():
            raise UnstableError(end, "a load, displacement, velocity or acceleration")
        found = solver.solve(step, state)
        self._require_short(state, found, method)
        new = self._state_after(state, method, end, step, found)
        if not isinstance(self.problem.law, RigidContact):
            return new
        released = state.closed & ~found.closed & self._restart.reaches(found.border)
        if released.any():
            kept = self._restart.stays(found.border, released, new, method)
            if kept.any():
                found = solver.solve(step, state, keep_closed=kept)
                new = self._state_after(state, method, end, step, found)
        event = bool((found.closed != state.closed).any()) or bool(released.any())
        reached = self._restart.reaches(found.border)
        due = self._restart.is_due(found.border, state, new, method)
        if not due and not (event and reached.any()):
            return new
        self._restart.apply(found.border, new, method)
        return self._rebalanced(state, new, found)

    def _require_short(self, state: StepState, found: ContactSolution, method: HHT) -> None:
        """No wheel that rolls freely may step over a whole element of a flexible path."""
        if not self.borders.moves_freely or state.chainage.size == 0:
            return
        advance = np.abs(found.border.chainage - state.chainage)
        wheel = int(np.argmax(advance))
        self.problem.require_short(float(advance[wheel]), method.time_step, wheel)

    def _rebalanced(self, state: StepState, new: StepState, found: ContactSolution) -> StepState:
        """Imbalances, reactions and counts that belong to the restarted accelerations."""
        stacked = self.stacked
        inertia = stacked.mass @ new.acceleration
        imbalance_p = -inertia[stacked.prescribed]
        motion = (new.displacement, new.velocity, new.acceleration)
        contact = found.border.h.transposed_dot(new.contact_forces)
        return replace(
            new,
            imbalance=-inertia[stacked.free],
            imbalance_prescribed=imbalance_p,
            reactions=reactions_after(stacked, new.time, motion, contact, imbalance_p),
            status_changes=state.status_changes + int((new.closed != state.closed).sum()),
            restarts=new.restarts + 1,
        )

    def _state_after(
        self, state: StepState, method: HHT, end: float, step: StepEquations, found: ContactSolution
    ) -> StepState:  # fmt: skip
        """The state that a contact solution leads to."""
        motion = motion_after(self.stacked, step, found.displacement)
        imbalance, imbalance_p = imbalance_after(self.stacked, method, state, motion[2])
        contact: Vector = found.border.h.transposed_dot(found.forces)
        changes = int(np.count_nonzero(found.closed != state.closed))
        return StepState(
            step=state.step, time=end,
            displacement=motion[0], velocity=motion[1], acceleration=motion[2],
            contact_forces=found.forces, closed=found.closed, chainage=found.border.chainage,
            reactions=reactions_after(self.stacked, end, motion, contact, imbalance_p),
            imbalance=imbalance, imbalance_prescribed=imbalance_p,
            iterations=found.iterations, status_changes=state.status_changes + changes,
            halvings=state.halvings, restarts=state.restarts,
            gap_acceleration=state.gap_acceleration,
        )  # fmt: skip
