"""A run as a whole: energy, errors that stop it, going on, the window of its peaks."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from solver.errors import InputError, SingularSystemError, UnstableError
from solver.integrators import Motion
from solver.irregularities import IsolatedDefect
from solver.simulation import LINES, TRAIN, Simulation
from solver.studies import Study, template
from solver.studies.study import Contact, Integration
from tests.solver.models_case import prepare

BEAM = template("sprung-mass-beam").study


# -- energy ------------------------------------------------------------------------------------


def slope_under_the_wheel(simulation: Simulation, time: float) -> float:
    """dw/dx + dr/dx where the wheel stands: derivatives of the Hermite cubics."""
    line, system = simulation.system.line, simulation.system
    x = system.wheel_positions(time)
    (node,), _ = line.locate(x)
    length = line.positions[node + 1] - line.positions[node]
    s = (x[0] - line.positions[node]) / length
    rows = np.array(
        [6 * s * (s - 1) / length, 1 - 4 * s + 3 * s**2, 6 * s * (1 - s) / length, 3 * s**2 - 2 * s]
    )
    step = 1e-6
    rail = np.zeros(1, dtype=np.int64)
    irregularity = (system.irregularity(rail, x + step) - system.irregularity(rail, x - step)) / (
        2.0 * step
    )
    beam = simulation.integrator.motions[LINES].displacement[2 * node : 2 * node + 4, 0]
    return float(rows @ beam + irregularity[0])


def mechanical_energy(simulation: Simulation) -> float:
    """Kinetic and strain energy of beam, mass, spring and contact, less the work of gravity."""
    system = simulation.system
    beam, train = simulation.integrator.motions[LINES], simulation.integrator.motions[TRAIN]
    a, v = beam.displacement[:, 0], beam.velocity[:, 0]
    energy = 0.5 * (v @ (system.line.mass @ v) + a @ (system.line.stiffness @ a))
    z, w = train.displacement, train.velocity
    energy += 0.5 * (w @ system.train.mass @ w + z @ system.train.stiffness @ z)
    force = simulation.effective.state.contact_forces
    # Weight counted from rest: gravity less the force that the springs carry already.
    energy -= system.train.weight @ z
    return float(energy + 0.5 * system.contact_compliance * force @ force)


def energy_gap(study: Study) -> tuple[float, float]:
    """Greatest imbalance and greatest exchange, both over the run. [J]"""
    simulation = prepare(study)
    speed, step = simulation.plan.speed, simulation.plan.time_step
    start, work, power, gap, exchange = 0.0, 0.0, 0.0, 0.0, 0.0
    for sample in simulation.samples():
        if simulation.system.wheel_positions(sample.time)[0] >= 24.99:
            break  # at the support the path has a kink: the drive's power jumps there
        force = simulation.effective.state.contact_forces[0]
        drive = force * speed * slope_under_the_wheel(simulation, sample.time)
        energy = mechanical_energy(simulation)
        if sample.step == 0:
            start = energy
        else:
            work += 0.5 * step * (power + drive)
        power = drive
        gap = max(gap, abs(energy - start - work))
        beam = simulation.integrator.motions[LINES].displacement[:, 0]
        exchange = max(exchange, 0.5 * beam @ (simulation.system.line.stiffness @ beam))
    return gap, exchange


@pytest.mark.parametrize(
    "study",
    [
        BEAM,
        replace(BEAM, contact=Contact(law="linear_hertz", stiffness=1e8, unilateral=False)),
        replace(BEAM, irregularity=IsolatedDefect(position=12.5, rail="left", amplitude=2e-3)),
    ],
    ids=["rigid", "hertz", "defect"],
)
def test_energy_is_work_of_gravity_and_of_the_drive(study: Study) -> None:
    """Undamped, alpha = 0, unbroken contact: closed to 1e-4 of the greatest exchange, order 2.

    The drive's work, the integral of X v (dw/dx + dr/dx), is part of it: without it the balance
    is out by percents.
    """
    steps = (1e-3, 5e-4)
    gaps = []
    for step in steps:
        gap, exchange = energy_gap(
            replace(study, integration=Integration(alpha=0.0, time_step=step))
        )
        gaps.append(gap / exchange)
    assert gaps[1] < 1e-4
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=0.02)


# -- what stops a run --------------------------------------------------------------------------


def pushed_up(simulation: Simulation, force: float) -> Simulation:
    """The same start with the first wheel's contact point lifted by a force."""
    system = simulation.system
    train = system.train.from_rest(-simulation.static.train)
    weight = train.weight + force * train.wheel_rows[0]
    return Simulation(
        simulation.plan,
        replace(system, train=replace(train, weight=weight)),
        simulation.method,
        simulation._observation,
    )


def test_a_wheel_in_tension_at_the_start_is_an_error() -> None:
    study = template("two-span-separation").study
    with pytest.raises(InputError, match=r"wheel 01 would have to be pulled .* with 106 kN"):
        pushed_up(prepare(study), 400e3)
    # 300 kN less weight of 294.3 kN is a wheel that just stands.
    assert pushed_up(prepare(study), 294e3).static.contact_forces[0] == pytest.approx(300.0)
    bilateral = replace(study, contact=replace(study.contact, unilateral=False))
    forces = pushed_up(prepare(bilateral), 400e3).static.contact_forces
    assert forces[0] == pytest.approx(30e3 * 9.81 - 400e3)


def test_a_train_that_nothing_holds_together_is_an_error() -> None:
    simulation = prepare(BEAM)
    train = simulation.system.train
    loose = replace(train, stiffness=np.zeros_like(train.stiffness))
    with pytest.raises(SingularSystemError, match="the train"):
        Simulation(
            simulation.plan,
            replace(simulation.system, train=loose),
            simulation.method,
            simulation._observation,
        )


def test_a_response_that_is_no_number_stops_the_run() -> None:
    simulation = prepare(BEAM)
    samples = simulation.samples()
    next(samples)
    simulation.integrator.motions[LINES].velocity[20] = np.nan
    with pytest.raises(UnstableError, match=r"t = 0\.00025 s"):
        next(samples)


# -- going on, and the window ------------------------------------------------------------------


def test_iterating_again_goes_on_where_the_run_stands() -> None:
    """No sample ever carries the time of one step and the state of another."""
    wanted = [sample.channels for sample in islice(prepare(BEAM).samples(), 12)]
    simulation = prepare(BEAM)
    found = [*islice(simulation, 5), *islice(simulation, 8)]
    assert [sample.step for sample in found] == [0, 1, 2, 3, 4, 4, 5, 6, 7, 8, 9, 10, 11]
    for sample in found:
        np.testing.assert_array_equal(sample.channels, wanted[sample.step])


def test_a_run_gives_as_many_samples_and_frames_as_its_plan_says() -> None:
    simulation = prepare(BEAM)
    samples = list(simulation)
    assert len(samples) == simulation.plan.n_sample
    assert sum(sample.frame is not None for sample in samples) == simulation.plan.n_frame
    assert samples[-1].time == pytest.approx(25.0 / simulation.plan.speed, abs=2.5e-4)
    # Ended, it stays at its last sample.
    assert [sample.step for sample in simulation] == [simulation.plan.n_step]


def test_peaks_count_from_the_window_on_rounding_or_not() -> None:
    """A sample on the window's edge is inside, the one before it is not."""
    simulation = prepare(BEAM)
    step = simulation.plan.time_step
    for number in (7, 10, 13):
        plan = replace(simulation.plan, window_start=number * step * (1.0 + 1e-12), n_step=20)
        train = simulation.system.train.from_rest(-simulation.static.train)
        run = Simulation(
            plan, replace(simulation.system, train=train), simulation.method,
            simulation._observation,
        )  # fmt: skip
        values = np.array([sample.channels for sample in run])[number:]
        np.testing.assert_array_equal(run.extremes.least, values.min(axis=0))
        np.testing.assert_array_equal(run.extremes.greatest, values.max(axis=0))
        times = run.extremes.time_of_greatest
        np.testing.assert_allclose(times, step * (number + np.argmax(values, axis=0)))


def test_at_rest_all_forces_are_in_balance() -> None:
    motion = Motion.at_rest(np.array([1.0, 2.0]))
    assert not motion.velocity.any()
    assert not motion.imbalance.any()


def test_a_defect_at_rest_lifts_the_wheel_by_its_height(small_study: Study) -> None:
    """The static start stands on the irregularity: wheels of the defect's rail are lifted."""
    plain = prepare(small_study)
    x = plain.plan.start_position
    lifted = Simulation(
        plain.plan,
        replace(
            plain.system,
            train=plain.system.train.from_rest(-plain.static.train),
            irregularity=lambda lines, places: np.where(
                (lines == 1) & (np.abs(places - x) < 0.1), 1e-4, 0.0
            ),
        ),
        plain.method,
        plain._observation,
    )
    change = lifted.system.train.wheel_rest - plain.system.train.wheel_rest
    forces = lifted.static.contact_forces - plain.static.contact_forces
    # Wheel 2 is the first axle's right one; the spring below gives way a little.
    right = plain.plan.geometry.wheels.names.index("wheel 01 right")
    assert 0.5e-4 < change[right] < 1e-4
    assert forces[right] > 0.0
    assert forces.sum() == pytest.approx(0.0, abs=1e-6 * plain.static.contact_forces.sum())
