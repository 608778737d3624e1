"""Measured profiles: the spline, its ends, crossings over it, and its words."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from solver.arrays import FloatArray
from solver.irregularities import (
    BellShapedDefect,
    IsolatedDefect,
    MeasuredProfile,
    PerfectRail,
    SampledProfile,
    describe,
    rail_irregularities,
)
from solver.simulation import Simulation
from solver.studies import Study, prepare, to_json
from solver.studies.study import Extent
from tests.solver.profile_case import BEAM, KHST, found, measured, ramp

BELL = BellShapedDefect(amplitude=0.010, wave_number=0.9, centre=27.0)
DERIVATIVES = ("elevation", "slope", "curvature")


def sampled(spacing: float, fade: float = 10.0) -> SampledProfile:
    x = np.arange(0.0, 60.0 + 0.5 * spacing, spacing)
    return SampledProfile(positions=x, elevations=ramp(x), fade=fade)


# -- the function -----------------------------------------------------------------------------


def test_halving_the_spacing_gains_the_orders_of_a_cubic_spline() -> None:
    """Errors of elevation, slope, curvature against the closed form: orders 4, 3, 2."""
    x = np.linspace(15.0, 39.0, 5001)
    errors = []
    for count in (97, 193, 385):
        places = np.linspace(15.0, 39.0, count)
        rail = SampledProfile(positions=places, elevations=BELL.elevation(places), fade=10.0)
        errors.append(
            [np.abs(getattr(rail, d)(x) - getattr(BELL, d)(x)).max() for d in DERIVATIVES]
        )
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    # Spacings of 0.25 to 0.0625 m of a bell of width 1/k = 1.1 m: nearly asymptotic.
    assert orders == pytest.approx(np.array([[4.0, 3.0, 2.0]] * 2), abs=0.15)
    # At 0.25 m the bell of 10 mm is held to 0.2 micrometres.
    assert errors[0][0] < 2.5e-7


def test_the_order_holds_up_to_the_ends_of_the_samples() -> None:
    """Not-a-knot: a spline without curvature at its ends would be of order two there."""
    x = np.linspace(0.0, 1.0, 401)
    errors = [np.abs(sampled(h).elevation(x) - ramp(x)).max() for h in (0.5, 0.25)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.3)


def test_the_samples_are_met_whatever_the_fade() -> None:
    x = np.linspace(0.0, 60.0, 2001)
    short, long = sampled(0.5, 0.5), sampled(0.5, 100.0)
    np.testing.assert_allclose(short.elevation(short.positions), short.elevations, atol=1e-17)
    for name in DERIVATIVES:
        np.testing.assert_array_equal(getattr(short, name)(x), getattr(long, name)(x))


@pytest.mark.parametrize("fade", [0.5, 10.0, 1000.0])
def test_far_away_the_rail_is_perfect_and_nothing_jumps_on_the_way(fade: float) -> None:
    rail = sampled(0.5, fade)
    far = np.array([-2.0 * fade, -fade, 60.0 + fade, 61.0 + 2.0 * fade])
    joints = rail._pieces.x[[0, 1, 2, -3, -2, -1]]
    for name in DERIVATIVES:
        value = getattr(rail, name)
        assert np.array_equal(value(far), np.zeros(4))
        scale = np.abs(value(np.linspace(-fade, 60.0 + fade, 20001))).max()
        # A joint is met from both sides: within 1e-9 m anything continuous hardly moves.
        jumps = value(joints + 1e-9) - value(joints - 1e-9)
        assert np.abs(jumps).max() < 1e-6 * scale, name


@pytest.mark.parametrize("length", [1.0, 20.0], ids=["short waves", "long waves"])
def test_waves_that_end_on_their_steepest_slope_run_out_like_waves(length: float) -> None:
    """No bulge above the waves' height, no bend sharper than twice theirs, A k^2."""
    wave, x = 2.0 * np.pi / length, np.arange(0.0, 20.01, 0.1)
    rail = SampledProfile(positions=x, elevations=1e-3 * np.sin(wave * x), fade=10.0)
    outside = np.concatenate([np.linspace(-10.0, 0.0, 2001), np.linspace(20.0, 30.0, 2001)])
    assert np.abs(rail.elevation(outside)).max() < 1e-3
    assert np.abs(rail.curvature(outside)).max() < 2.0 * 1e-3 * wave**2


def test_nothing_rises_beside_samples_that_begin_at_zero() -> None:
    """Waves of 3 mm that swell from zero, written to a micrometre as spreadsheets have them."""
    x = np.arange(0.0, 24.01, 0.4)
    waves = np.round(3e-3 * np.sin(np.pi * x / 24.0) ** 2 * np.cos(1.3 * x), 6)
    rail = SampledProfile(positions=x, elevations=waves, fade=10.0)
    beside = np.concatenate([np.linspace(-10.0, 0.0, 2001), np.linspace(24.0, 34.0, 2001)])
    # The last samples differ by 16 micrometres.
    assert np.abs(rail.elevation(beside)).max() < 1.6e-5


def test_a_rough_profile_does_not_swing_out_at_its_ends() -> None:
    """The worst a file can hold, noise from sample to sample, whose spline ends on steep slopes."""
    noise = np.random.default_rng(7).uniform(-1e-3, 1e-3, (20, 40))
    x = np.arange(40) * 0.25
    for elevations in noise:
        rail = SampledProfile(positions=x, elevations=elevations, fade=10.0)
        beside = np.concatenate([np.linspace(-10.0, 0.0, 2001), np.linspace(9.75, 19.75, 2001)])
        inside = np.linspace(0.0, 9.75, 2001)
        # End slopes of 30 mm/m over nine tenths of the fade would rise by 70 mm instead.
        for value, most in ((rail.elevation, 3.0), (rail.curvature, 5.0)):
            assert np.abs(value(beside)).max() < most * np.abs(value(inside)).max()


def test_slope_and_curvature_are_the_derivatives_in_any_shape() -> None:
    rail, h = sampled(0.5), 1e-4
    x = np.linspace(-9.7, 69.3, 240).reshape(4, 60)
    slope = (rail.elevation(x + h) - rail.elevation(x - h)) / (2.0 * h)
    bend = (rail.slope(x + h) - rail.slope(x - h)) / (2.0 * h)
    # Central differences: h^2 / 6 times the third derivative, and rounding of 1e-18 / h.
    np.testing.assert_allclose(rail.slope(x), slope, atol=1e-10)
    np.testing.assert_allclose(rail.curvature(x), bend, atol=2e-7)
    assert rail.elevation(np.float64(3.0)).shape == ()


def test_each_rail_has_its_own_profile() -> None:
    x = np.linspace(0.0, 30.0, 61)
    left, right = rail_irregularities(measured(x, ramp(x)))
    assert left.elevation(x) == pytest.approx(ramp(x))
    assert isinstance(right, PerfectRail)


# -- crossings --------------------------------------------------------------------------------


def histories(study: Study) -> tuple[FloatArray, FloatArray]:
    """Contact forces and the acceleration at mid-span, of every step."""
    simulation = prepare(study)
    names = [channel.name for channel in simulation.plan.channels]
    acceleration = next(i for i, name in enumerate(names) if "acceleration" in name)
    forces, deck = [], []
    for sample in simulation.samples():
        forces.append(simulation.effective.state.contact_forces.copy())
        deck.append(sample.channels[acceleration])
    return np.array(forces), np.array(deck)


def test_a_crossing_over_the_samples_is_that_over_the_closed_form() -> None:
    """Spline error e on a spring k: forces differ by k e, at most twice that as it swings.

    It changes with the samples, v / 0.1 m = 278 Hz and half of that: of the modes of 4.8 n^2 Hz the
    first, third and fifth follow, each with its modal mass m L / 2 at mid-span.
    """
    defect = IsolatedDefect(amplitude=2e-3, wave_number=2.0, position=12.5, rail="left")
    bell, _ = rail_irregularities(defect)
    x = np.arange(5.0, 20.01, 0.1)
    beside = 0.5 * (x[1:] + x[:-1])
    profile = measured(x, bell.elevation(x), fade=0.5)
    spline, _ = rail_irregularities(profile)
    error = np.abs(spline.elevation(beside) - bell.elevation(beside)).max()
    closed, closed_deck = histories(replace(BEAM, irregularity=defect))
    found, found_deck = histories(replace(BEAM, irregularity=profile))
    assert 1e-9 < error < 1e-6
    assert np.ptp(closed) > 1e3, "the defect is felt"
    bound = 2.0 * BEAM.train.stiffness * error
    assert np.abs(found - closed).max() < bound
    modal_mass = 0.5 * 2303.0 * 25.0
    assert np.abs(found_deck - closed_deck).max() < 3.0 * bound / modal_mass
    assert np.abs(closed_deck).max() > 1e4 * bound / modal_mass, "the beam is shaken"


def test_on_a_level_stretch_forces_are_the_static_ones() -> None:
    """Elevation is no load: 5 mm everywhere change nothing, from the start on, before the beam."""
    level = measured(np.linspace(-40.0, 60.0, 21), np.full(21, 5e-3))
    study = replace(BEAM, irregularity=level, extent=Extent(run_in=20.0, run_out=0.0))
    simulation = prepare(study)
    weight = BEAM.train.mass * 9.81
    for sample in islice(simulation.samples(), 2000):
        if simulation.system.wheel_positions(sample.time)[0] >= 0.0:
            break
        # Rounding of the elevation, 5 mm over 50 Newmark steps squared, times 1.6 MN/m.
        assert simulation.effective.state.contact_forces[0] == pytest.approx(weight, rel=1e-9)
    assert simulation.static.train[0] == pytest.approx(5e-3 - weight / BEAM.train.stiffness)


def test_a_start_on_a_slope_strikes_the_wheel_and_is_refused() -> None:
    """Why the train must start on perfect rails: with the rail's slope the mass is struck."""
    x = np.linspace(-40.0, 30.0, 71)
    study = replace(
        BEAM,
        irregularity=measured(x, 2e-3 * np.sin(0.5 * (x + 20.0))),
        extent=Extent(run_in=20.0, run_out=0.0),
    )
    first, second = (s.copy() for s in _forces(prepare(study), 2))
    assert first[0] == pytest.approx(BEAM.train.mass * 9.81, rel=1e-9)
    # v r' dt k = 27.8 * 1e-3 * 2.5e-4 s * 1.6 MN/m = 11 N in a step, from nothing.
    assert second[0] - first[0] == pytest.approx(11.1, rel=0.05)
    assert "irregularity.samples.0.position" in found(study)
    apart = replace(study, irregularity=measured(x + 31.0, 2e-3 * np.sin(0.5 * x)))
    assert found(apart) == {}
    first, second = (s.copy() for s in _forces(prepare(apart), 2))
    assert second[0] == pytest.approx(first[0], rel=1e-6)


def _forces(simulation: Simulation, count: int) -> list[FloatArray]:
    return [
        simulation.effective.state.contact_forces.copy()
        for _ in islice(simulation.samples(), count)
    ]


def test_a_raised_left_rail_rolls_the_train_to_the_right(small_study: Study) -> None:
    """Cant of d under all of a train is a rigid roll of d / gauge, and moves no load."""
    x = np.linspace(-900.0, 900.0, 37)
    level = prepare(replace(small_study, irregularity=measured(x, 0.0 * x)))
    tilted = prepare(replace(small_study, irregularity=measured(x, np.full(37, 3e-3), right=-1e-3)))
    roll = 4e-3 / (2.0 * small_study.track.rail_position)
    train = level.system.train
    moved = tilted.static.train - level.static.train
    rolls = [body.rows[1] @ moved for body in _bodies(small_study)]
    # Left side up is positive; the suspension is linear: rounding only.
    assert rolls == pytest.approx([roll] * len(rolls), rel=1e-6)
    assert tilted.static.contact_forces == pytest.approx(level.static.contact_forces, rel=1e-6)
    assert set(train.wheel_lines.tolist()) == {0, 1}


def _bodies(study: Study) -> list[Any]:
    from solver.models.train import build_train

    return [body for body in build_train(study.train).bodies if body.rows[1].any()]


# -- plain data -------------------------------------------------------------------------------

ADAPTER = TypeAdapter(Study)


def body() -> dict[str, Any]:
    """A study with a profile, as JSON."""
    x = np.linspace(0.0, 20.0, 41)
    return to_json(replace(KHST, irregularity=measured(x, ramp(x), 1e-3)))


def test_a_study_with_a_profile_goes_through_json() -> None:
    text = json.dumps(body())
    study = ADAPTER.validate_json(text, strict=True)
    assert isinstance(study.irregularity, MeasuredProfile)
    assert json.dumps(to_json(study)) == text
    assert hash(study.irregularity) == hash(ADAPTER.validate_json(text).irregularity)


def test_the_schema_names_units_and_bounds_of_the_columns() -> None:
    schema = TypeAdapter(MeasuredProfile).json_schema()
    assert schema["properties"]["samples"]["minItems"] == 4
    sample = schema["$defs"]["ProfileSample"]["properties"]
    assert {name: part["unit"]["display"] for name, part in sample.items()} == {
        "position": "m", "left": "mm", "right": "mm",
    }  # fmt: skip
    assert all(part["description"] for part in sample.values())
    assert sample["left"]["maximum"] == 0.05


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"position": 1.0, "left": 0.0}, ("samples", 2, "right")),
        ({"position": "1", "left": 0.0, "right": 0.0}, ("samples", 2, "position")),
        ({"position": 1.0, "left": 0.0, "right": 0.0, "middle": 0.0}, ("samples", 2, "middle")),
    ],
)
def test_a_sample_is_read_strictly(change: dict[str, Any], place: tuple[str | int, ...]) -> None:
    broken = body()
    broken["irregularity"]["samples"][2] = change
    with pytest.raises(ValidationError) as caught:
        ADAPTER.validate_json(json.dumps(broken), strict=True)
    places = [error["loc"] for error in caught.value.errors()]
    assert ("irregularity", "MeasuredProfile", *place) in places


def test_words_for_verdicts() -> None:
    x = np.linspace(0.0, 60.0, 241)
    assert describe(measured(x, 4.2e-3 * np.sin(0.5 * np.pi * x), 1e-3)) == (
        "measured profile of 241 samples, x = 0.0 to 60.0 m, at most 4.2 mm on the left rail"
    )
    assert describe(measured(x, x * 0.0, -2e-3)).endswith("at most 2 mm on the right rail")
    assert describe(measured(x, x * 0.0 - 2e-3, 2e-3)).endswith("at most 2 mm on either rail")
    assert describe(MeasuredProfile()).endswith("x = 0.0 to 30.0 m, all zero")


def test_the_profile_is_plain_frozen_data() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        MeasuredProfile().fade = 1.0  # type: ignore[misc]
