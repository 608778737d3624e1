"""One run: system, integrator and recorder, one step at a time.

``Simulation.samples`` is a generator: the caller owns progress, cancellation, storage.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.arrays import (
    Arrays,
    FloatArray,
    SparseMatrix,
    Vector,
    attributes_of,
    below,
    put_back,
    under,
)
from solver.errors import InputError, UnstableError
from solver.factorisation import Condense
from solver.integrators import HHT, HHTIntegrator, Motion
from solver.results import Frame, RunPlan, Sample
from solver.system import Coefficients, EffectiveSystem, System
from solver.system.statics import StaticState, static_state

__all__ = ["Extremes", "Observation", "Simulation", "effective_coefficients"]

LINES, TRAIN, STRUCTURE = 0, 1, 2
"""Order of the parts' motions."""


@dataclass(frozen=True, kw_only=True)
class Observation:
    """What is read from the motions, as sparse rows.

    Attributes:
        deck: Vertical displacement of the deck's channels, from the deck's freedoms.
        slab: Vertical displacement of the slab points, from the deck's freedoms.
        surface: Displacement of the structure's vertices, (3 n_vertex, n_dof), from the deck's.
        rails: Vertical displacement of the rails' vertices, from the lines' freedoms flattened.
        bearings: Tension in the bearings, from the deck's freedoms. [N/m]
        cars: Vertical displacement of the train's channels, from the train's freedoms.
        bodies: Bounce, roll, pitch of the bodies, (3 n_body, n_dof).
        deck_part: Index of the part that the deck is: STRUCTURE, or LINES for a plain beam.
    """

    deck: SparseMatrix
    slab: SparseMatrix
    surface: SparseMatrix
    rails: SparseMatrix
    bearings: SparseMatrix
    cars: SparseMatrix
    bodies: SparseMatrix
    deck_part: int


def effective_coefficients(method: HHT) -> Coefficients:
    """Coefficients of the effective equation (4.18) for a method."""
    return Coefficients(
        mass=method.a0,
        damping=method.force_factor * method.a1,
        stiffness=method.force_factor,
        force=method.force_factor,
        memory=method.alpha,
    )


class Extremes:
    """Least and greatest value of every channel since the window opened.

    Attributes:
        least: Shape (n_channel,).
        greatest: Shape (n_channel,).
        time_of_least: Shape (n_channel,). [s]
        time_of_greatest: Shape (n_channel,). [s]
    """

    def __init__(self, n_channel: int) -> None:
        self.least = np.full(n_channel, np.inf)
        self.greatest = np.full(n_channel, -np.inf)
        self.time_of_least = np.zeros(n_channel)
        self.time_of_greatest = np.zeros(n_channel)

    def add(self, values: Vector, time: float) -> None:
        """Takes one step's values."""
        lower, higher = values < self.least, values > self.greatest
        self.time_of_least[lower] = time
        self.time_of_greatest[higher] = time
        np.minimum(self.least, values, out=self.least)
        np.maximum(self.greatest, values, out=self.greatest)

    def state(self) -> Arrays:
        """Copies of the four arrays."""
        return attributes_of(self)

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Takes what ``state`` gave."""
        put_back(self, state)


class Simulation:
    """One time integration.

    Args:
        plan: What is known before the first step.
        system: Train, rails, structure; the train's freedoms are then counted from its rest.
        method: Time integration.
        observation: What is recorded.
        static: The static start of this system where it is known; None finds it.
        condenser: What factorises the structure; None does it anew.

    Raises:
        SingularSystemError: Train or structure can move without resistance.
        InputError: A wheel that may leave its rail would have to be pulled onto it at the start.
    """

    def __init__(
        self,
        plan: RunPlan,
        system: System,
        method: HHT,
        observation: Observation,
        *,
        static: StaticState | None = None,
        condenser: Condense | None = None,
    ) -> None:
        self.plan = plan
        self.method = method
        self._observation = observation
        self._heights = observation.surface[2::3]
        self.static = static_state(system) if static is None else static
        if system.unilateral:
            _refuse_tension(plan, self.static.contact_forces)
        self.system = replace(system, train=system.train.from_rest(self.static.train))
        self.effective = EffectiveSystem(
            self.system, effective_coefficients(method), condenser=condenser
        )
        self.integrator = HHTIntegrator(method, self.effective, _motions(self.static))
        static = self.static
        self.effective.stand(static.contact_forces, static.pad_forces, static.compression)
        self._dead_load = np.zeros(observation.bearings.shape[0])
        if self.static.dead_load is not None:
            self._dead_load = observation.bearings @ self.static.dead_load
        self.extremes = Extremes(len(plan.channels))
        self._step = 0

    @property
    def status_changes(self) -> int:
        """Contacts lost or found so far."""
        return self.effective.state.status_changes

    @property
    def contact_facts(self) -> dict[str, object]:
        """How hard the contact was to find, for the run's summary."""
        state = self.effective.state
        return {
            "contacts_lost_or_found": state.status_changes,
            "contact_solves_per_step": state.small_solves / max(1, self._step),
            "contact_restarts": state.restarts,
        }

    def __iter__(self) -> Iterator[Sample]:
        return self.samples()

    def samples(self) -> Iterator[Sample]:
        """The present state and every step after it.

        On a fresh simulation these are the static start and all steps, ``plan.n_sample`` in all;
        iterated again, it goes on from where it stands.

        Raises:
            UnstableError: The response is not finite.
            ConvergenceError: No admissible contact state.
        """
        yield self._sample(self._step)
        while self._step < self.plan.n_step:
            self.integrator.advance((self._step + 1) * self.plan.time_step)
            self.effective.settle(self.integrator.motions)
            self._step += 1
            yield self._sample(self._step)

    # -- checkpoints ---------------------------------------------------------------------------

    @property
    def step(self) -> int:
        """Steps taken so far."""
        return self._step

    def state(self) -> Arrays:
        """Copies of all that the next step, the extremes and the facts depend on.

        What the study alone decides (matrices, factors, static start) is not in it: a simulation
        made of the same study has them already.

        Returns:
            Flat names such as ``motions/0/displacement``; numbers as arrays without axes.
        """
        return {
            "step": np.array(self._step),
            "plan": self._plan_numbers(),
            **under("motions", self.integrator.state()),
            **under("system", self.effective.kept_state()),
            **under("extremes", self.extremes.state()),
        }

    def _plan_numbers(self) -> Vector:
        """By what runs differ whose arrays have the same shapes."""
        plan, method, system = self.plan, self.method, self.system
        law = system.nonlinear_hertz
        return np.array(
            [
                plan.n_step, plan.time_step, plan.speed, plan.start_position,
                method.alpha, method.beta, method.gamma, system.contact_compliance,
                0.0 if law is None else law.coefficient, system.unilateral,
            ]
        )  # fmt: skip

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Goes to where another simulation of the same study stood when ``state`` was called.

        ``samples`` then yields that step again, and goes on from there: bit for bit what a
        simulation that was never interrupted gives on the same machine.

        Raises:
            InputError: The state is of another study.
        """
        _require_same_study(self.state(), state)
        self.integrator.restore(below("motions", state))
        self.effective.restore(below("system", state))
        self.extremes.restore(below("extremes", state))
        self._step = int(state["step"])

    # -- what is recorded ----------------------------------------------------------------------

    def _sample(self, step: int) -> Sample:
        observation, motions = self._observation, self.integrator.motions
        deck, train = motions[observation.deck_part], self.system.train
        time = step * self.plan.time_step
        acceleration = deck.acceleration.ravel()
        channels = np.concatenate(
            [
                observation.deck @ acceleration,
                observation.deck @ deck.displacement.ravel(),
                self.effective.state.contact_forces,
                train.wheel_rest + train.wheel_rows @ motions[TRAIN].displacement,
                observation.cars @ motions[TRAIN].acceleration,
                observation.cars @ motions[TRAIN].displacement,
                observation.bearings @ deck.displacement.ravel() + self._dead_load,
            ]
        )
        if not np.isfinite(channels).all():
            raise UnstableError(time, "a recorded channel")
        # Half a step of slack, as the verdict takes it: a sample on the window's edge is inside.
        if time > self.plan.window_start - 0.5 * self.plan.time_step:
            self.extremes.add(channels, time)
        frame = self._frame() if step % self.plan.frame_stride == 0 else None
        return Sample(
            step=step,
            time=time,
            channels=channels,
            slab=observation.slab @ acceleration,
            frame=frame,
        )

    def _frame(self) -> Frame:
        observation, motions = self._observation, self.integrator.motions
        deck, lines = motions[observation.deck_part], motions[LINES]
        surface = np.asarray(observation.surface @ deck.displacement.ravel()).reshape(-1, 3)
        rails = np.zeros((observation.rails.shape[0], 3))
        rails[:, 2] = observation.rails @ lines.displacement.ravel()
        bodies = np.asarray(observation.bodies @ motions[TRAIN].displacement).reshape(-1, 3)
        return Frame(
            displacement=np.concatenate([surface, rails]),
            bodies=bodies,
            velocity=self._upward(deck.velocity, lines.velocity),
            acceleration=self._upward(deck.acceleration, lines.acceleration),
        )

    def _upward(self, deck: FloatArray, lines: FloatArray) -> Vector:
        """Vertical motion of every vertex, the structure's and then the rails'."""
        surface, rails = self._heights @ deck.ravel(), self._observation.rails @ lines.ravel()
        return np.concatenate([surface, rails])


def _require_same_study(own: Arrays, given: Mapping[str, NDArray[Any]]) -> None:
    """Refuses a state whose names, shapes, kinds or plan are not the simulation's own."""
    different = sorted(own.keys() ^ given.keys()) or [
        name
        for name, value in own.items()
        if value.shape != given[name].shape or value.dtype != given[name].dtype
    ]
    if not different and not np.array_equal(own["plan"], given["plan"]):
        different = ["plan"]
    if not different and not 0 <= int(given["step"]) <= own["plan"][0]:
        different = ["step"]
    if different:
        raise InputError(
            "state",
            different[0],
            "is not what a simulation of this study keeps: the state is of another one",
            "Prepare the study and the run that the state was taken from.",
        )


def _refuse_tension(plan: RunPlan, contact_forces: Vector) -> None:
    """The static start is found with every wheel on its rail: none may need pulling down."""
    least = int(np.argmin(contact_forces))
    if contact_forces[least] < -1e-9 * np.abs(contact_forces).max():
        raise InputError(
            "contact.unilateral",
            True,
            f"{plan.geometry.wheels.names[least]} would have to be pulled onto its rail with "
            f"{-1e-3 * contact_forces[least]:.3g} kN at the static start",
            "Check the train's masses and lengths, or let the contact pull (unilateral: false).",
        )


def _motions(static: StaticState) -> list[Motion]:
    motions = [Motion.at_rest(static.lines), Motion.at_rest(np.zeros_like(static.train))]
    if static.structure is not None:
        motions.append(Motion.at_rest(static.structure))
    return motions
