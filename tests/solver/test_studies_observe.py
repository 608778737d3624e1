"""What a run records: every name belongs to its number, frames move where the load is."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from solver.models.ballasted_track import TrackProperties
from solver.models.viaduct import ViaductProperties
from solver.results import RunPlan, Sample
from solver.simulation import LINES, STRUCTURE, TRAIN, Simulation
from solver.studies import Study, template
from solver.studies.study import Extent, Outputs
from tests.solver.models_case import prepare


@pytest.fixture(scope="module")
def two_spans(small_study: Study) -> Study:
    """Two spans of 9 m, the first axle over the first abutment at the start."""
    return replace(
        small_study,
        viaduct=ViaductProperties(spans=(9.0, 9.0)),
        track=TrackProperties(embankment_length=6.0),
        extent=Extent(run_in=0.0, run_out=0.0),
    )


@pytest.fixture(scope="module")
def standing(two_spans: Study) -> Simulation:
    """The train at rest, its first bogie on the second span, its second before the first."""
    simulation = prepare(two_spans)
    system = replace(simulation.system, start_position=13.5)
    plan = replace(simulation.plan, start_position=13.5)
    unrested = replace(system, train=system.train.from_rest(-simulation.static.train))
    return Simulation(plan, unrested, simulation.method, simulation._observation)


def first(simulation: Simulation) -> Sample:
    return next(iter(simulation))


def value(simulation: Simulation, sample: Sample, name: str) -> float:
    names = [channel.name for channel in simulation.plan.channels]
    return float(sample.channels[names.index(name)])


def test_names_and_values_of_the_channels_are_one_order(standing: Simulation) -> None:
    """After some steps each channel is read again by its name, straight from the motions."""
    simulation = standing
    samples = list(islice(simulation.samples(), 8))
    sample, plan = samples[-1], simulation.plan
    motions, train = simulation.integrator.motions, simulation.system.train
    assert len({channel.name for channel in plan.channels}) == len(plan.channels)
    for channel in plan.channels:
        subject, quantity = channel.name.split("/")
        found = value(simulation, sample, channel.name)
        if channel.group == "deck":
            row = simulation._observation.slab[[plan.slab.named[subject]]]
            wanted = row @ getattr(motions[STRUCTURE], quantity)
        elif channel.group == "wheel":
            wheel = plan.geometry.wheels.names.index(subject)
            moved = train.wheel_rest + train.wheel_rows @ motions[TRAIN].displacement
            forces = simulation.effective.state.contact_forces
            wanted = (forces if quantity == "contact force" else moved)[wheel]
        elif channel.group == "vehicle":
            body = [entry.name for entry in plan.geometry.bodies].index(subject)
            row = simulation._observation.bodies[[3 * body]]
            assert plan.geometry.bodies[body].kind in {"carbody", "bogie"}
            wanted = row @ getattr(motions[TRAIN], quantity)
        else:
            continue
        assert found == pytest.approx(np.asarray(wanted).item(), rel=1e-12, abs=1e-300)


def test_accelerations_alone_carry_the_time_of_the_method(standing: Simulation) -> None:
    """Second order at t + alpha dt (modelling decision "Accuracy")."""
    method = standing.method
    for channel in standing.plan.channels:
        late = channel.name.endswith("/acceleration")
        assert channel.time_offset == (method.alpha * method.time_step if late else 0.0)


def test_bearings_carry_the_weight_of_the_deck_and_of_the_train_on_it(two_spans: Study) -> None:
    """Dead load, and under the standing train some more: compression is negative."""
    simulation = prepare(two_spans)
    dead = simulation._dead_load
    structure = simulation.system.structure
    assert structure is not None
    assert np.all(dead < 0.0)
    # The embankment's track and half of what bridges the abutment rest on the ground.
    assert 0.5 * structure.weight.sum() > dead.sum() > structure.weight.sum()
    names = [channel.name for channel in simulation.plan.channels]
    bearings = [index for index, name in enumerate(names) if name.startswith("bearing")]
    sample = first(simulation)
    assert len(bearings) == dead.size == 8
    # The first axle stands over the abutment: bearings and embankment share its load.
    added = dead - sample.channels[bearings]
    assert 0.0 < added.sum() < 2.0 * simulation.static.contact_forces[0]
    assert np.all(added[:2] > 0.9 * 0.5 * added.sum())


def test_wheels_stand_on_rail_and_hertz_spring(standing: Simulation) -> None:
    """v = w + r - X / k_h at the static start, wheel by wheel."""
    static, system = standing.static, standing.system
    wheels = standing.plan.geometry.wheels
    x = standing.plan.start_position + wheels.offsets
    nodes, rows = system.line.locate(x)
    dofs = 2 * nodes[:, None] + np.arange(4)
    lines = np.where(wheels.lateral > 0.0, 0, 1)
    rails = np.einsum("nk,nk->n", rows, static.lines[dofs, lines[:, None]])
    wanted = rails - static.contact_forces / 1.212e9
    np.testing.assert_allclose(system.train.wheel_rest, wanted, atol=1e-12)
    assert np.all(rails < 0.0)


def test_only_the_loaded_span_sinks(standing: Simulation, two_spans: Study) -> None:
    """The frame at the start: the second span, under the first bogie, sinks; the first rests."""
    fresh = Simulation(
        standing.plan,
        replace(standing.system, train=standing.system.train.from_rest(-standing.static.train)),
        standing.method,
        standing._observation,
    )
    frame = first(fresh).frame
    assert frame is not None
    geometry = fresh.plan.geometry
    assert frame.displacement.shape == geometry.vertices.shape
    assert frame.bodies.shape == (len(geometry.bodies), 3)
    slab = np.unique(
        np.concatenate([layer.faces.ravel() for layer in geometry.layers if layer.name == "slab"])
    )
    x, sinking = geometry.vertices[slab, 0], -frame.displacement[slab, 2]
    loaded, unloaded = sinking[x > 9.5].max(), np.abs(sinking[x < 8.5]).max()
    assert loaded > 1e-5
    assert abs(x[np.argmax(sinking)] - 12.75) < 1.5
    # Ballast and rails run on over the joint: on spans this short a quarter goes with them.
    assert unloaded < 0.3 * loaded


def test_rails_are_drawn_where_they_are(standing: Simulation) -> None:
    """Vertices of the rails: left rail at y > 0, moved by the rail's own displacement."""
    geometry, line = standing.plan.geometry, standing.system.line
    (rails,) = [layer for layer in geometry.layers if layer.name == "rails"]
    vertices = np.unique(rails.faces)
    places = geometry.vertices[vertices]
    np.testing.assert_allclose(np.abs(places[:, 1]), 0.7175, atol=0.04)
    np.testing.assert_allclose(places[:, 2], geometry.wheels.contact_height)
    nodes = np.searchsorted(line.positions, places[:, 0] - 1e-9)
    wanted = standing.static.lines[2 * nodes, np.where(places[:, 1] > 0.0, 0, 1)]
    rows = standing._observation.rails
    found = rows @ standing.static.lines.ravel()
    np.testing.assert_allclose(found, wanted, atol=1e-15)


def test_named_points_of_the_alverca_viaduct(small_study: Study) -> None:
    """The nearest slab nodes to mid-span and the rails, under the ballast, span by span."""
    plan = prepare(small_study).plan
    assert list(plan.slab.named) == [
        f"mid-span 1, {name}" for name in ("axis", "left rail", "right rail")
    ]
    wanted = {"axis": 0.0, "left rail": 0.7175, "right rail": -0.7175}
    for name, index in plan.slab.named.items():
        x, y, _ = plan.slab.coordinates[index]
        assert abs(x - 6.0) < 0.4
        assert abs(y - wanted[name.split(", ")[1]]) < 0.4
    assert np.abs(plan.slab.coordinates[:, 1]).max() <= 2.15 + 1e-9
    assert plan.slab.judged_spans == (0,)


def test_a_narrower_ballast_judges_fewer_points(small_study: Study) -> None:
    """Slab points count where ballast lies on them, whatever its width."""
    track = replace(small_study.track, ballast_width=3.0)
    plan = prepare(replace(small_study, track=track)).plan
    assert np.abs(plan.slab.coordinates[:, 1]).max() <= 1.5 + 1e-9


def test_beams_record_mid_spans_masses_and_contact_points() -> None:
    simulation = prepare(template("two-span-separation").study)
    plan: RunPlan = simulation.plan
    names = [channel.name for channel in plan.channels]
    assert names == [
        *(f"mid-span {k}/acceleration" for k in (1, 2)),
        *(f"mid-span {k}/displacement" for k in (1, 2)),
        *(f"wheel {k:02d}/contact force" for k in (1, 2, 3, 4)),
        *(f"wheel {k:02d}/displacement" for k in (1, 2, 3, 4)),
        *(f"mass {k:02d}/acceleration" for k in (1, 2, 3, 4)),
        *(f"mass {k:02d}/displacement" for k in (1, 2, 3, 4)),
    ]
    sample = next(islice(simulation.samples(), 300, None))
    motions = simulation.integrator.motions
    line = simulation.system.line
    mid = 2 * int(np.flatnonzero(np.isclose(line.positions, 10.0))[0])
    wanted = motions[LINES].displacement[mid, 0]
    assert wanted < 0.0
    assert value(simulation, sample, "mid-span 1/displacement") == wanted
    assert value(simulation, sample, "mass 01/displacement") == motions[TRAIN].displacement[0]
    np.testing.assert_array_equal(plan.geometry.spans, [[0.0, 20.0], [20.0, 40.0]])


def test_frames_hold_the_motion_of_every_vertex(two_spans: Study) -> None:
    """Velocity and acceleration of the deck and of the rails are derivatives of their heights."""
    study = replace(two_spans, outputs=Outputs(frame_interval=5e-4))
    simulation = prepare(study)
    step = simulation.plan.time_step
    samples = list(islice(simulation.samples(), 60))
    frames = [sample.frame for sample in samples]
    heights = np.array([frame.displacement[:, 2] for frame in frames])
    velocities = np.array([frame.velocity for frame in frames])
    accelerations = np.array([frame.acceleration for frame in frames])
    assert velocities.shape == accelerations.shape == (60, len(simulation.plan.geometry.vertices))
    assert np.all(velocities[0] == 0.0), "at rest at the start"
    names = {layer.name: np.unique(layer.faces) for layer in simulation.plan.geometry.layers}
    for name in ("slab", "rails"):
        own = names[name]
        slope = (heights[2:, own] - heights[:-2, own]) / (2.0 * step)
        # The rails hum at 800 Hz under the wheels: 0.4 of a cycle a step.
        scale = np.abs(slope).max()
        assert (
            np.abs(velocities[1:-1, own] - slope).max() < {"slab": 0.1, "rails": 0.5}[name] * scale
        )
        # Newmark's own relation holds exactly: v1 = v0 + dt ((1 - gamma) a0 + gamma a1).
        gamma = simulation.method.gamma
        change = step * ((1.0 - gamma) * accelerations[:-1, own] + gamma * accelerations[1:, own])
        np.testing.assert_allclose(
            np.diff(velocities[:, own], axis=0),
            change,
            atol=1e-9 * np.abs(velocities[:, own]).max(),
        )
    # The slab's points are vertices, and both are recorded: the same numbers.
    points, vertices = simulation.plan.slab.coordinates, simulation.plan.geometry.vertices
    for index in simulation.plan.slab.named.values():
        vertex = int(np.argmin(np.linalg.norm(vertices - points[index], axis=1)))
        recorded = [sample.slab[index] for sample in samples]
        np.testing.assert_allclose(accelerations[:, vertex], recorded, rtol=1e-12)


def test_a_beams_frames_hold_its_motion_too() -> None:
    simulation = prepare(template("sprung-mass-beam").study)
    samples = [sample for sample in islice(simulation.samples(), 900) if sample.frame is not None]
    middle = int(np.argmin(np.abs(simulation.plan.geometry.vertices[:, 0] - 12.5)))
    names = [channel.name for channel in simulation.plan.channels]
    column = names.index("mid-span 1/acceleration")
    assert samples[-1].frame.acceleration[middle] == pytest.approx(samples[-1].channels[column])
    assert samples[-1].frame.velocity[middle] != 0.0
