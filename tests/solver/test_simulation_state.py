"""A run interrupted and taken up again: bit for bit the run that was never interrupted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from solver.errors import InputError
from solver.irregularities import IsolatedDefect
from solver.models.train import SprungMasses
from solver.results import Sample
from solver.simulation import Simulation
from solver.studies import Study, template
from solver.studies.study import Contact, Integration, Outputs
from tests.solver.models_case import prepare

BEAM = replace(
    template("sprung-mass-beam").study,
    integration=Integration(alpha=-0.05, time_step=5e-3),
    outputs=Outputs(frame_interval=0.05),
)
FLIGHT = replace(
    template("two-span-separation").study, integration=Integration(alpha=-0.1, time_step=1e-3)
)

DEFECT = IsolatedDefect(position=12.5, rail="left", amplitude=5e-3, wave_number=5.0)

STUDIES = {
    "linear Hertz": replace(BEAM, contact=Contact(law="linear_hertz", stiffness=1e8)),
    "rigid, lost and found": FLIGHT,
    "nonlinear Hertz, lost and found": replace(
        FLIGHT, contact=Contact(law="nonlinear_hertz", hertz_constant=1e11)
    ),
}


def with_wheels_of_mass(study: Study) -> Simulation:
    """The same run on wheels of 300 kg: after an event their velocities restart."""
    simulation = prepare(study)
    train = simulation.system.train.from_rest(-simulation.static.train)
    own = np.diag(train.wheel_rows.sum(axis=0) * 300.0)
    heavy = replace(train, mass=train.mass + own, weight=train.weight - 9.81 * own.diagonal())
    return Simulation(
        simulation.plan,
        replace(simulation.system, train=heavy),
        simulation.method,
        simulation._observation,
    )


def equal(found: Sample, wanted: Sample) -> None:
    """Every number of two samples, to the last bit."""
    assert (found.step, found.time) == (wanted.step, wanted.time)
    np.testing.assert_array_equal(found.channels, wanted.channels)
    np.testing.assert_array_equal(found.slab, wanted.slab)
    assert (found.frame is None) == (wanted.frame is None)
    if found.frame is not None and wanted.frame is not None:
        np.testing.assert_array_equal(found.frame.displacement, wanted.frame.displacement)
        np.testing.assert_array_equal(found.frame.bodies, wanted.frame.bodies)


def same_end(found: Simulation, wanted: Simulation) -> None:
    """Extremes, facts, and all that a further step would read."""
    assert found.contact_facts == wanted.contact_facts
    assert found.status_changes == wanted.status_changes
    first, second = found.state(), wanted.state()
    assert first.keys() == second.keys()
    for name, value in first.items():
        np.testing.assert_array_equal(value, second[name], err_msg=name)


def taken_up(make: Callable[[], Simulation], stops: list[int], n_step: int) -> Simulation:
    """Runs to each stop, and goes on in a new simulation each time; compares every sample."""
    whole = make()
    wanted = list(islice(whole.samples(), n_step + 1))
    run, done = make(), 0
    for stop in [*stops, n_step]:
        for found in islice(run.samples(), stop - done + 1):
            equal(found, wanted[found.step])
        assert run.step == stop
        state, run, done = run.state(), make(), stop
        run.restore(state)
    same_end(run, whole)
    return run


@pytest.mark.parametrize("name", STUDIES)
def test_a_run_taken_up_again_is_the_run_never_interrupted(name: str) -> None:
    """At the start, between any two steps, twice in a row, and at the end."""
    study = STUDIES[name]
    n_step = prepare(study).plan.n_step
    stops = [0, 1, 2, n_step // 3, n_step // 3 + 1, n_step - 1]
    run = taken_up(lambda: prepare(study), stops, n_step)
    if "lost" in name:
        assert run.status_changes >= 2


def test_a_run_is_taken_up_at_the_step_of_every_event() -> None:
    """Where contact is lost or found and velocities restart, and the steps beside."""
    study = replace(FLIGHT, irregularity=DEFECT)
    run, before, events = with_wheels_of_mass(study), (0, 0), []
    for sample in run.samples():
        after = (run.status_changes, run.effective.state.restarts)
        if after != before:
            events.append(sample.step)
        before = after
    assert min(before) > 2
    stops = sorted({step + k for step in events[:8] for k in (-1, 0, 1) if step + k >= 0})
    taken_up(lambda: with_wheels_of_mass(study), stops, stops[-1] + 20)


def test_a_viaduct_with_pads_is_taken_up(small_study: Study) -> None:
    """Structure, pads, rails and a train of many wheels; the large factor is made anew."""
    defect = IsolatedDefect(amplitude=0.005, position=-19.0, rail="right", wave_number=5.0)
    study = replace(small_study, irregularity=defect)
    taken_up(lambda: prepare(study, factor_anew=True), [3, 41], 60)
    rigid = replace(study, contact=Contact(law="rigid"))
    taken_up(lambda: prepare(rigid, factor_anew=True), [3, 4, 30], 60)


def test_what_was_taken_is_a_copy() -> None:
    """Further steps, and changes by whoever holds the state, touch nothing."""
    simulation = prepare(BEAM)
    samples = simulation.samples()
    next(samples)
    state = simulation.state()
    before = {name: value.copy() for name, value in state.items()}
    next(samples)
    assert simulation.state()["step"] == 1
    for name, value in state.items():
        np.testing.assert_array_equal(value, before[name])
    fresh = prepare(BEAM)
    fresh.restore(state)
    for value in state.values():
        value.fill(7)
    assert fresh.state()["step"] == 0
    assert not (fresh.integrator.motions[0].velocity == 7.0).any()


def test_a_state_survives_a_file(tmp_path: Path) -> None:
    """Plain arrays, no pickle: numpy's own format is enough."""
    run = prepare(FLIGHT)
    for _ in islice(run.samples(), 30):
        pass
    np.savez(tmp_path / "state.npz", **run.state())
    fresh = prepare(FLIGHT)
    with np.load(tmp_path / "state.npz", allow_pickle=False) as file:
        fresh.restore(dict(file))
    for found, wanted in zip(islice(fresh, 20), islice(run, 20), strict=True):
        equal(found, wanted)


# -- states of another study -------------------------------------------------------------------


@pytest.mark.parametrize(
    "other",
    [
        replace(BEAM, viaduct=replace(BEAM.viaduct, elements_per_span=20)),
        replace(BEAM, train=SprungMasses(count=2, spacing=8.0)),
        replace(BEAM, integration=Integration(alpha=-0.05, time_step=4e-3)),
        replace(BEAM, contact=Contact(law="rigid")),
    ],
    ids=["mesh", "train", "time step", "law"],
)
def test_a_state_of_another_study_is_refused(other: Study) -> None:
    simulation = prepare(replace(BEAM, contact=Contact()))
    before = simulation.state()
    with pytest.raises(InputError, match=r"not what a simulation of this study keeps") as caught:
        simulation.restore(prepare(other).state())
    assert caught.value.field == "state"
    for key, value in simulation.state().items():
        np.testing.assert_array_equal(value, before[key])


@pytest.mark.parametrize("name", ["step", "motions/1/velocity", "system/contact/closed"])
def test_a_state_with_a_name_too_few_or_a_wrong_kind_is_refused(name: str) -> None:
    simulation = prepare(BEAM)
    state = simulation.state()
    short = {key: value for key, value in state.items() if key != name}
    wrong_kind = state | {name: state[name].astype(np.complex128)}
    for bad in (short, wrong_kind, state | {"more": np.zeros(1)}):
        with pytest.raises(InputError):
            simulation.restore(bad)


def test_a_state_beyond_the_end_is_refused() -> None:
    simulation = prepare(BEAM)
    for step in (-1, simulation.plan.n_step + 1):
        with pytest.raises(InputError):
            simulation.restore(simulation.state() | {"step": np.array(step)})
