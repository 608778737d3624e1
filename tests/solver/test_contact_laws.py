"""The three contact laws under a train on a ballasted viaduct: statics, steps, energy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import islice

import numpy as np
import pytest

from solver.arrays import BoolVector, Matrix, Vector
from solver.contact import standing
from solver.contact.laws import NonlinearHertz
from solver.errors import ConvergenceError
from solver.irregularities import IsolatedDefect
from solver.models.train import build_train
from solver.simulation import LINES, TRAIN, Simulation
from solver.studies import Study, template
from solver.studies.study import Contact, Extent, Integration, Sweep
from solver.system import statics
from solver.system.energy import EnergyBalance
from tests.solver.models_case import prepare

LAWS = ("rigid", "linear_hertz", "nonlinear_hertz")
BUMP = IsolatedDefect(amplitude=0.012, position=-12.0, rail="right", wave_number=0.9)
"""Throws the right wheels of the first bogie off at 100 m/s."""
FAST = Sweep(speeds=(100.0,))


def with_law(study: Study, law: str, **changes: object) -> Study:
    return replace(study, contact=Contact(law=law), **changes)


@dataclass
class Thrown:
    """A crossing of the bump, with copies of what its steps leave behind; the start comes first."""

    simulation: Simulation
    time: list[float] = field(default_factory=list[float])
    forces: list[Vector] = field(default_factory=list[Vector])
    compression: list[Vector] = field(default_factory=list[Vector])
    closed: list[BoolVector] = field(default_factory=list[BoolVector])
    restarts: list[int] = field(default_factory=list[int])
    rails: list[Matrix] = field(default_factory=list[Matrix])
    train: list[Vector] = field(default_factory=list[Vector])
    train_acceleration: list[Vector] = field(default_factory=list[Vector])

    def run(self, n_step: int) -> None:
        """Takes the first steps."""
        motions, state = self.simulation.integrator.motions, self.simulation.effective.state
        for sample in islice(self.simulation, n_step + 1):
            self.time.append(sample.time)
            self.forces.append(state.contact_forces.copy())
            self.compression.append(state.compression.copy())
            self.closed.append(state.closed.copy())
            self.restarts.append(state.restarts)
            self.rails.append(motions[LINES].displacement.copy())
            self.train.append(motions[TRAIN].displacement.copy())
            self.train_acceleration.append(motions[TRAIN].acceleration.copy())


@pytest.fixture(scope="module")
def thrown(small_study: Study) -> Callable[[str], Thrown]:
    """The same crossing with each law, computed once."""

    @cache
    def cross(law: str) -> Thrown:
        recorded = Thrown(prepare(with_law(small_study, law, irregularity=BUMP, sweep=FAST)))
        recorded.run(300)
        return recorded

    return cross


def forces_over(simulation: Simulation, n_step: int) -> np.ndarray:
    """Contact forces of the static start and of the first steps."""
    state = simulation.effective.state
    return np.array([state.contact_forces.copy() for _ in islice(simulation, n_step + 1)])


# -- statics -----------------------------------------------------------------------------------


def test_nonlinear_statics_carry_the_weight_with_hertz_compressions(small_study: Study) -> None:
    found = prepare(with_law(small_study, "nonlinear_hertz")).static
    train = build_train(small_study.train)
    assert found.contact_forces.sum() == pytest.approx(train.total_mass * 9.81, rel=1e-9)
    np.testing.assert_allclose(
        found.compression, (found.contact_forces / 7.958e10) ** (2.0 / 3.0), rtol=1e-9
    )


def test_a_run_starts_and_stays_where_the_nonlinear_statics_are(small_study: Study) -> None:
    """Standing still nothing happens: from the linear state forces would dip to 49 kN."""
    study = with_law(small_study, "nonlinear_hertz")
    simulation = prepare(study)
    still = Simulation(
        simulation.plan,
        replace(simulation.system, speed=0.0),
        simulation.method,
        simulation._observation,
    )
    forces = forces_over(still, 30)
    np.testing.assert_allclose(forces, np.broadcast_to(forces[0], forces.shape), rtol=1e-8)


def test_statics_that_do_not_settle_name_a_wheel(
    small_study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    simulation = prepare(with_law(small_study, "rigid"))
    train = simulation.system.train.from_rest(-simulation.static.train)
    # Guessed from a load eighty times too small, one iteration is not enough.
    law = NonlinearHertz(coefficient=7.958e10, reference_force=1e3)
    monkeypatch.setattr(standing, "_MOST_ITERATIONS", 1)
    with pytest.raises(ConvergenceError, match=r"t = 0 s \(wheel"):
        statics.static_state(replace(simulation.system, train=train, nonlinear_hertz=law))


# -- steps -------------------------------------------------------------------------------------


def test_the_laws_agree_to_first_order_on_a_perfect_track(small_study: Study) -> None:
    """Steady forces vary by some percent, of which the spring's change is a second-order part."""
    forces = {law: forces_over(prepare(with_law(small_study, law)), 60) for law in LAWS}
    linear, nonlinear = forces["linear_hertz"], forces["nonlinear_hertz"]
    band = np.ptp(linear)
    assert band > 5e3
    assert np.abs(nonlinear - linear).max() < 0.02 * band
    # Without a contact spring the forces are stiffer, but of the same size.
    assert np.abs(forces["rigid"] - linear).max() < 0.35 * band


def test_compressions_are_the_gaps_of_the_motion(thrown: Callable[[str], Thrown]) -> None:
    """v - w - r = -d and F = K_h d^1.5, from the motions alone, through loss and return."""
    run = thrown("nonlinear_hertz")
    system = run.simulation.system
    for step in range(1, len(run.time)):
        x = system.wheel_positions(run.time[step])
        nodes, rows = system.line.locate(x)
        columns = 2 * nodes[:, None] + np.arange(4)
        lines = run.rails[step]
        rail = np.einsum("nk,nk->n", rows, lines[columns, system.train.wheel_lines[:, None]])
        wheels = system.train.wheel_rest + system.train.wheel_rows @ run.train[step]
        depth = rail + system.irregularity(system.train.wheel_lines, x) - wheels
        np.testing.assert_allclose(run.compression[step], depth, atol=1e-9)  # the rule
        law = 7.958e10 * np.maximum(depth, 0.0) ** 1.5
        np.testing.assert_allclose(run.forces[step], law, atol=1e-4 * 83e3)
    assert not np.all(run.closed[1:])
    assert run.simulation.effective.state.small_solves / (len(run.time) - 1) < 8


@pytest.mark.parametrize("law", LAWS)
def test_a_bump_throws_wheels_off_once_whatever_the_law(
    thrown: Callable[[str], Thrown], law: str
) -> None:
    """Two axles of the first bogie meet the bump; each right wheel leaves once and returns."""
    simulation, forces = thrown(law).simulation, np.array(thrown(law).forces)
    assert forces.min() >= 0.0
    away = np.flatnonzero(forces[:, 1] == 0.0)
    assert away.size > 5
    assert np.all(np.diff(away) == 1)
    assert forces[away[-1] + 1 :, 1].min() > 0.0
    assert forces[:, 0].min() > 0.0
    assert simulation.status_changes <= 8
    facts = simulation.contact_facts
    assert facts["contacts_lost_or_found"] == simulation.status_changes
    assert (facts["contact_restarts"] > 0) == (law == "rigid")


@pytest.mark.parametrize("law", ["rigid", "nonlinear_hertz"])
def test_forces_weight_and_inertia_are_in_balance_at_every_step(
    small_study: Study, thrown: Callable[[str], Thrown], law: str
) -> None:
    """As HHT weighs them; after a restart as they stand: M a'' + weight = contact forces."""
    run = thrown(law)
    train = build_train(small_study.train)
    lift, *_ = np.linalg.lstsq(
        np.array([body.rows[0] for body in train.bodies]), np.ones(len(train.bodies)), rcond=None
    )
    weight, alpha = train.total_mass * 9.81, run.simulation.method.alpha
    previous, restarts, worst = 0.0, 0, 0.0
    for step in range(1, len(run.time)):
        inertia = float(lift @ train.mass @ run.train_acceleration[step])
        surplus = float(run.forces[step].sum()) - weight
        weighed = (1.0 + alpha) * surplus - alpha * previous
        expected = surplus if run.restarts[step] > restarts else weighed
        worst = max(worst, abs(inertia - expected))
        previous, restarts = surplus, run.restarts[step]
    assert worst < 1e-6 * weight
    assert (restarts > 0) == (law == "rigid")


@pytest.mark.slow
def test_restarts_bring_rigid_contact_to_its_limit_sooner(small_study: Study) -> None:
    """Setting off at once from a bent rail is an event: without a restart the error of a rigid
    wheel's force does not fall with the time step (270 to 420 N at any), with it it does."""
    histories = [
        forces_over(
            prepare(
                with_law(small_study, "rigid", integration=Integration(alpha=-0.05, time_step=step))
            ),
            round(0.04 / step),
        )[:: round(2e-3 / step)]
        for step in (5e-4, 2.5e-4, 1.25e-4)
    ]
    coarse, middle, fine = (history[2:] for history in histories)
    first, second = np.std(coarse - middle), np.std(middle - fine)
    assert first < 300.0
    assert second < 0.5 * first


def test_facts_name_the_law_and_its_constant(small_study: Study) -> None:
    facts = prepare(with_law(small_study, "nonlinear_hertz")).plan.facts
    assert facts["contact_law"] == "nonlinear Hertz, K_h = 7.958e+04 MN/m^1.5"
    beam = prepare(template("sprung-mass-beam").study).plan.facts
    assert beam["contact_law"] == "rigid, also in tension"


# -- energy ------------------------------------------------------------------------------------


def energy(study: Study, until: float) -> tuple[float, EnergyBalance, float]:
    """Greatest gap over greatest exchange, the balance, and that exchange, up to a time. [s]"""
    simulation = prepare(study)
    balance = EnergyBalance(
        simulation.effective, simulation.integrator.motions, simulation.plan.time_step
    )
    gap = exchange = 0.0
    for sample in islice(simulation, 1, None):
        if sample.time > until:
            break
        terms = balance.record(sample.time)
        gap, exchange = max(gap, abs(terms.gap)), max(exchange, terms.exchange)
    return gap / exchange, balance, exchange


ONE_MASS = template("sprung-mass-beam").study
ON_BEAM = 24.9 / (100.0 / 3.6)
"""At the support the path has a kink: the drive's power jumps there. [s]"""


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_undamped_and_unbroken_the_balance_closes_at_order_two(law: str) -> None:
    contact = Contact(law=law, stiffness=1e8, hertz_constant=1e10, unilateral=False)
    gaps = []
    for step in (1e-3, 5e-4):
        study = replace(
            ONE_MASS, contact=contact, integration=Integration(alpha=0.0, time_step=step)
        )
        gap, balance, exchange = energy(study, ON_BEAM)
        gaps.append(gap)
        assert abs(balance.terms.integration) < 1e-12 * exchange  # Newmark loses nothing
    assert gaps[1] < 1e-4  # the modelling decision's bound
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=0.05)


def test_what_alpha_costs_is_counted() -> None:
    """A mass that bounces on level ground, in six steps a period: alpha takes most of its energy,
    and the balance closes to rounding, because nothing but the drive's integral is approximate."""
    study = replace(
        template("two-span-separation").study,
        contact=Contact(law="linear_hertz", unilateral=False),
        integration=Integration(alpha=-0.3, time_step=0.015),
        extent=Extent(run_in=115.0),
    )
    simulation = prepare(study)
    motions = simulation.integrator.motions
    motions[TRAIN].velocity[0] = 0.1
    start = 0.5 * 30e3 * 0.1**2
    balance = EnergyBalance(simulation.effective, motions, simulation.plan.time_step)
    for sample in islice(simulation, 1, 50):
        terms = balance.record(sample.time)
        assert abs(terms.gap) < 1e-9 * start
    assert terms.integration > 0.5 * start


@pytest.mark.slow
def test_the_balance_of_a_train_on_a_ballasted_track_closes(small_study: Study) -> None:
    """All parts, pads and dashpots, contact lost and found: order two, HHT's loss included."""
    gaps = []
    for step in (5e-4, 2.5e-4):
        study = with_law(
            small_study, "nonlinear_hertz", irregularity=BUMP, sweep=FAST,
            integration=Integration(alpha=-0.05, time_step=step),
        )  # fmt: skip
        gap, balance, exchange = energy(study, 0.12)
        gaps.append(gap)
        assert balance.terms.viscous > 0.1 * exchange
    assert gaps[1] < 1e-3
    assert gaps[0] / gaps[1] > 3.0
