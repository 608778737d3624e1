"""Trains given as tables of axles: matrices, closed forms, two rails, and errors by row."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from solver.arrays import Vector
from solver.errors import InputError
from solver.irregularities import MeasuredProfile, ProfileSample
from solver.models.ballasted_track import TrackProperties
from solver.models.hslm import hslm_a, hslm_a_names
from solver.models.train import GRAVITY, Axle, AxleTable, SprungMasses, TrainModel, build_train
from solver.models.viaduct import ViaductProperties
from solver.reference import Crossing, SimplySupportedBeam, moving_forces
from solver.studies import Study, check, modal_analysis, prepare, simulate, template, to_json
from solver.studies.crossing import train_axles, train_length
from solver.studies.estimate import estimate, unknowns
from solver.studies.resonance import regular_spacing
from solver.studies.study import Contact, Extent, Integration, Modes, Sweep

BEAM = template("sprung-mass-beam").study
VIADUCT = template("khst-alverca").study
VEHICLE = AxleTable(
    name="vehicle",
    axles=(
        Axle(position=0.0, load=170e3),
        Axle(position=2.5, load=160e3, unsprung_mass=1800.0),
        Axle(position=17.5, load=150e3, stiffness=1.2e6, damping=4e3),
        Axle(position=20.0, load=140e3, unsprung_mass=1500.0, stiffness=0.9e6),
    ),
)


def masses_as_table(masses: SprungMasses) -> AxleTable:
    load = masses.mass * GRAVITY
    axles = tuple(
        Axle(
            position=i * masses.spacing,
            load=load,
            stiffness=masses.stiffness,
            damping=masses.damping,
        )
        for i in range(masses.count)
    )
    return AxleTable(axles=axles, damping_ratio=0.0)


def histories(study: Study) -> Vector:
    """All samples of the first run, shape (n_sample, n_channel)."""
    return np.array([sample.channels for sample in simulate(study)])


# -- against other models ------------------------------------------------------------------------


def test_a_table_of_equal_axles_is_the_train_of_sprung_masses() -> None:
    masses = SprungMasses(mass=30e3, stiffness=156.55e6, damping=2e3, count=4, spacing=20.0)
    table, train = build_train(masses_as_table(masses)), build_train(masses)
    for name in ("mass", "damping", "stiffness", "weight"):
        # The mass is the load over g: a rounding in the last place.
        assert getattr(table, name) == pytest.approx(getattr(train, name), rel=1e-15), name
    for name in ("wheel_rows", "wheel_offsets", "wheel_rail", "wheel_lateral", "axle_offsets"):
        assert np.array_equal(getattr(table, name), getattr(train, name)), name


def test_it_crosses_a_beam_as_the_sprung_masses_do() -> None:
    study = template("two-span-separation").study
    assert isinstance(study.train, SprungMasses)
    expected = histories(study)
    found = histories(replace(study, train=masses_as_table(study.train)))
    # Contact forces reach 300 kN, and the wheel that leaves the beam does so in the same step;
    # a rounding of the mass grows to some 1e-9 of that.
    assert found == pytest.approx(expected, abs=1e-2)


def test_very_soft_springs_make_moving_forces() -> None:
    """Under constant forces the beam is a closed-form series of modes."""
    table = replace(hslm_a("A1"), axles=hslm_a("A1").axles[:4])
    study = replace(
        BEAM,
        train=table,
        sweep=Sweep(speeds=(60.0,)),
        integration=Integration(alpha=0.0, time_step=5e-4),
    )
    simulation = simulate(study)
    names = [channel.name for channel in simulation.plan.channels]
    middle = names.index("mid-span 1/displacement")
    found = np.array([sample.channels[middle] for sample in simulation])
    offsets = -np.array([axle.position for axle in table.axles])
    crossing = Crossing(
        beam=SimplySupportedBeam(
            length=25.0, rigidity=2.87e9 * 2.90, mass_per_length=2303.0, n_mode=12
        ),
        speed=60.0,
        offsets=offsets,
        times=np.arange(len(found), dtype=np.float64) * study.integration.time_step,
        points=np.array([12.5]),
    )
    forces = np.array([axle.load for axle in table.axles])
    expected = moving_forces(crossing, forces).displacement[:, 0]
    peak = float(np.max(np.abs(expected)))
    # Of itself the force varies by (2 pi f)^2 u / g, with u the 21 mm of this soft beam 9e-4;
    # time steps and the modes that are left out add less than 5e-4.
    assert peak == pytest.approx(0.0210, rel=0.01)
    assert found == pytest.approx(expected, abs=2e-3 * peak)
    softer = replace(table, bounce_frequency=0.05)
    again = np.array([sample.channels[middle] for sample in simulate(replace(study, train=softer))])
    errors = [float(np.max(np.abs(curve - expected))) for curve in (found, again)]
    assert errors[1] < errors[0], "half the frequency is nearer to a constant force"


# -- the model itself ----------------------------------------------------------------------------


def test_each_axle_bounces_with_its_own_frequency_on_a_rigid_rail() -> None:
    study = replace(
        BEAM,
        train=VEHICLE,
        contact=Contact(law="rigid", unilateral=False),
        modes=Modes(part="train", count=20),
    )
    sprung = [axle.load / GRAVITY - axle.unsprung_mass for axle in VEHICLE.axles]
    own = [np.sqrt(k / m) / (2 * np.pi) for k, m in ((1.2e6, sprung[2]), (0.9e6, sprung[3]))]
    modes = modal_analysis(study)["modes"]
    found = [mode["frequency"] for mode in modes]
    assert found == pytest.approx(sorted([1.0, 1.0, *own]), rel=1e-9)
    assert {mode["name"] for mode in modes} == {"mass bounce"}


def test_what_is_not_given_follows_from_frequency_and_damping_ratio() -> None:
    train = build_train(replace(VEHICLE, bounce_frequency=2.0, damping_ratio=0.05))
    omega, mass = 4 * np.pi, 170e3 / GRAVITY
    assert train.stiffness[0, 0] == pytest.approx(mass * omega**2)
    assert train.damping[0, 0] == pytest.approx(2 * 0.05 * mass * omega)
    # Of its own stiffness, and of its own damping.
    sprung = 140e3 / GRAVITY - 1500.0
    assert train.stiffness[6, 6] == 0.9e6
    assert train.damping[6, 6] == pytest.approx(2 * 0.05 * np.sqrt(0.9e6 * sprung))
    assert (train.stiffness[4, 4], train.damping[4, 4]) == (1.2e6, 4e3)


def at_rest(train: TrainModel) -> Vector:
    """Contact forces of a train that stands still: what its weight leaves on the rails. [N]"""
    rows = train.wheel_rows
    n_dof, n_wheel = train.n_dof, train.n_wheel
    matrix = np.block([[train.stiffness, -rows.T], [rows, np.zeros((n_wheel, n_wheel))]])
    return np.linalg.solve(matrix, np.concatenate([train.weight, np.zeros(n_wheel)]))[n_dof:]


def test_at_rest_each_axle_bears_its_load() -> None:
    loads = [axle.load for axle in VEHICLE.axles]
    one, two = build_train(VEHICLE), build_train(VEHICLE, 2)
    assert at_rest(one) == pytest.approx(loads, rel=1e-12)
    assert at_rest(two) == pytest.approx(np.repeat(loads, 2) / 2, rel=1e-12)
    for train in (one, two):
        assert train.total_mass == pytest.approx(sum(loads) / GRAVITY)
        assert train.length == 20.0


def test_on_two_rails_both_wheels_together_are_the_one_on_one_rail() -> None:
    one, two = build_train(VEHICLE), build_train(VEHICLE, 2)
    assert list(two.wheel_rail) == [0, 1] * 4
    assert two.wheel_lateral == pytest.approx([0.7175, -0.7175] * 4)
    assert two.wheel_offsets == pytest.approx(np.repeat(one.wheel_offsets, 2))
    # Rails that move alike, as on a stiff structure: no axle rolls, and the rest is one rail's.
    level = np.kron(np.eye(8), np.array([[1.0], [0.0]]))
    for name in ("mass", "damping", "stiffness"):
        reduced = level.T @ getattr(two, name) @ level
        assert reduced == pytest.approx(getattr(one, name), rel=1e-14), name
    assert level.T @ two.wheel_rows.T @ np.ones(8) == pytest.approx(2 * one.wheel_rows.sum(axis=0))
    # One half that moves alone: half of the mass, of the stiffness, and the other wheel rests.
    body = next(body for body in two.bodies if body.name == "mass 01")
    motion = np.zeros(two.n_dof)
    motion[0], motion[1] = 0.5, 1.0 / 1.435
    assert body.rows @ motion == pytest.approx([0.5, 1.0 / 1.435, 0.0])
    assert motion @ two.mass @ motion == pytest.approx(0.5 * 170e3 / GRAVITY)
    assert motion @ two.stiffness @ motion == pytest.approx(0.5 * one.stiffness[0, 0])
    motion = np.roll(motion, 2)
    assert two.wheel_rows[:2] @ motion == pytest.approx([1.0, 0.0])


def test_on_two_rails_every_axle_bounces_and_rolls_alike() -> None:
    study = replace(
        small_viaduct(replace(VEHICLE, axles=VEHICLE.axles[:2]), "rigid"),
        modes=Modes(part="train", count=20),
    )
    modes = modal_analysis(study)["modes"]
    assert [mode["frequency"] for mode in modes] == pytest.approx([1.0] * 4)
    assert sorted(mode["name"] for mode in modes) == ["mass bounce"] * 2 + ["mass roll"] * 2


def test_the_first_axle_is_the_train_s_head_wherever_the_distances_begin() -> None:
    moved = replace(
        VEHICLE, axles=tuple(replace(axle, position=axle.position + 4.2) for axle in VEHICLE.axles)
    )
    study = replace(BEAM, train=moved)
    assert build_train(moved).wheel_offsets == pytest.approx(build_train(VEHICLE).wheel_offsets)
    assert (train_length(study), train_axles(study)) == (pytest.approx(20.0), 4)


# -- studies -------------------------------------------------------------------------------------


def small_viaduct(train: AxleTable, law: str = "linear_hertz") -> Study:
    return replace(
        VIADUCT,
        train=train,
        viaduct=ViaductProperties(spans=(12.0,)),
        track=TrackProperties(embankment_length=6.0),
        extent=Extent(run_in=20.0, run_out=0.0),
        contact=Contact(law=law),  # type: ignore[arg-type]
        sweep=Sweep(speeds=(70.0,)),
    )


@pytest.mark.parametrize("law", ["linear_hertz", "nonlinear_hertz", "rigid"])
def test_it_rolls_on_the_two_rails_of_a_ballasted_track(law: str) -> None:
    simulation = simulate(small_viaduct(VEHICLE, law))
    names = [channel.name for channel in simulation.plan.channels]
    wheels = [i for i, name in enumerate(names) if name.endswith("contact force")]
    forces = np.array([sample.channels[wheels] for sample in islice(simulation, 200)])
    # The last axle's stiffness and unsprung mass, and its load, are those of the table.
    assert forces[0] == pytest.approx(np.repeat([85e3, 80e3, 75e3, 70e3], 2), rel=1e-9)
    assert forces[:, 0::2] == pytest.approx(forces[:, 1::2], rel=1e-6), "alike on both rails"
    # No irregularity: what the sleepers do to a sprung mass of 1 Hz is less than a percent of its
    # load; wheelsets feel them.
    assert forces[:, 0] == pytest.approx(85e3, rel=0.01)
    assert np.ptp(forces[:, 2]) > 5 * np.ptp(forces[:, 0])


def test_unknowns_and_channels_are_counted_as_they_are_built() -> None:
    for study, structure in ((replace(BEAM, train=VEHICLE), 0), (small_viaduct(VEHICLE), None)):
        simulation = prepare(study)
        counted = unknowns(study, 100.0)
        assert simulation.plan.facts["unknowns_train"] == counted.train
        if structure is not None:
            assert counted.structure == structure


def test_a_table_passes_every_check_on_beam_and_viaduct() -> None:
    for study in (replace(BEAM, train=VEHICLE), small_viaduct(VEHICLE)):
        report = check(study)
        assert report.errors == ()
        assert report.derived["train_length"].value == 20.0
        assert "regular_spacing" not in report.derived, "one vehicle repeats nothing"


def test_each_axle_counts_in_the_time_that_is_estimated() -> None:
    """Measured on one core: 0.6 ms a step with 50 axles on a beam, 5 ms with 200; 0.2 ms with 1."""

    def per_step(count: int) -> float:
        table = AxleTable(axles=tuple(Axle(position=3.0 * i, load=170e3) for i in range(count)))
        found = estimate(replace(BEAM, train=table))
        return found.seconds / found.steps

    assert per_step(50) == pytest.approx(0.57e-3, rel=0.3)
    assert per_step(200) == pytest.approx(5.0e-3, rel=0.3)


def test_the_suspension_that_is_assumed_is_told() -> None:
    given = replace(VEHICLE, axles=(VEHICLE.axles[2], replace(VEHICLE.axles[3], damping=1e3)))
    half = replace(given, axles=VEHICLE.axles[2:], damping_ratio=0.05)

    def told(train: AxleTable) -> object:
        facts = prepare(replace(BEAM, train=train)).plan.facts
        return facts.get("assumed")

    assert told(VEHICLE) == [
        "suspension of the axles: sprung masses bounce at 1 Hz without damping"
    ]
    assert told(half) == ["damping of the axles: 5 percent of the critical one"]
    assert told(given) is None


def test_tonnes_for_kilonewtons_are_asked_about() -> None:
    light = axles(0.0, 2.5, load=17e3)
    (warning,) = check(replace(BEAM, train=light)).warnings
    assert check(replace(BEAM, train=axles(0.0, 2.5, load=60e3))).warnings == ()
    assert warning.path == ("train", "axles", 0, "load")
    assert "17 kN: were tonnes given" in warning.reason


def test_dashpots_on_massless_points_are_warned_of_before_their_forces_alternate() -> None:
    damped = replace(VEHICLE, damping_ratio=0.1)

    def warned(study: Study) -> list[str]:
        return [finding.remedy for finding in check(study).warnings]

    def alternation(study: Study) -> float:
        """Greatest change of the wheel's force in one step while it rolls on the ground."""
        force = histories(study)[:, 2]
        return float(np.max(np.abs(np.diff(force[-400:]))))

    one = replace(damped, axles=damped.axles[:1])
    study = replace(BEAM, train=one, extent=Extent(run_in=0.0, run_out=0.3))
    assert study.integration.alpha == 0.0
    assert warned(study) == ["Use -0.05, or a contact of Hertz's law."]
    calm = replace(study, integration=Integration(alpha=-0.05))
    undamped = replace(BEAM, train=replace(VEHICLE, axles=VEHICLE.axles[:2]))
    assert warned(calm) == warned(undamped) == []
    # Some 400 N in each step against the 15 N that the bouncing mass itself makes.
    assert alternation(study) > 10 * alternation(calm)


def test_trains_that_do_not_fit_the_structure_are_told_what_does() -> None:
    masses = replace(VIADUCT, train=SprungMasses())
    khst = replace(BEAM, train=VIADUCT.train)
    for study in (masses, khst):
        (error,) = check(study).errors
        assert '"axle_table"' in error.remedy
        assert check(replace(study, train=VEHICLE)).errors == ()


def test_an_approach_shorter_than_the_train_is_refused() -> None:
    study = small_viaduct(hslm_a("A1"))
    short = replace(study, approach=replace(study.approach, length=100.0))
    (error,) = check(short).errors
    assert error.path == ("approach", "length")
    assert "397.5 m" in error.reason


# -- errors and JSON -----------------------------------------------------------------------------


def axles(*positions: float, load: float = 170e3, **changes: float) -> AxleTable:
    return AxleTable(axles=tuple(Axle(position=x, load=load, **changes) for x in positions))


def test_every_row_out_of_order_is_named() -> None:
    table = axles(0.0, 2.5, 2.5, 20.0, 18.0)
    errors = check(replace(BEAM, train=table)).errors
    assert [error.path for error in errors] == [
        ("train", "axles", 2, "position"),
        ("train", "axles", 4, "position"),
    ]
    assert errors[0].reason == "is not behind the axle of row 2, which stands at 2.5 m"
    assert errors[1].reason == "is not behind the axle of row 4, which stands at 20 m"
    with pytest.raises(InputError, match="row 2"):
        build_train(table)


def test_rows_of_the_train_and_of_the_rails_are_named_at_once() -> None:
    """Whoever pasted two tables mends both, not one after the other."""
    places = (0.0, 1.0, 1.0, 3.0, 4.0)
    samples = tuple(ProfileSample(position=x, left=1e-3, right=0.0) for x in places)
    measured = MeasuredProfile(samples=samples)
    errors = check(replace(BEAM, train=axles(0.0, 2.5, 2.5), irregularity=measured)).errors
    assert [error.path for error in errors] == [
        ("train", "axles", 2, "position"),
        ("irregularity", "samples", 2, "position"),
    ]


def test_a_wheelset_heavier_than_its_load_is_named() -> None:
    table = axles(0.0, 2.5, load=20e3, unsprung_mass=1.5e3)
    assert check(replace(BEAM, train=table)).errors == ()
    heavy = replace(table, axles=(table.axles[0], replace(table.axles[1], unsprung_mass=2.1e3)))
    (error,) = check(replace(BEAM, train=heavy)).errors
    assert error.path == ("train", "axles", 1, "unsprung_mass")
    assert "20 kN is 2.039 t" in error.reason


def test_bounds_name_the_row() -> None:
    (error,) = check(replace(BEAM, train=axles(0.0, load=0.0))).errors
    assert error.path == ("train", "axles", 0, "load")
    (none,) = check(replace(BEAM, train=AxleTable(axles=()))).errors
    assert none.path == ("train", "axles")


def test_a_study_comes_back_from_json_as_it_was() -> None:
    study = replace(VIADUCT, train=VEHICLE)
    text = json.dumps(to_json(study))
    assert TypeAdapter(Study).validate_json(text) == study
    strange = json.loads(text)
    strange["train"]["axles"][1]["mass"] = 1.0
    with pytest.raises(ValidationError, match="mass"):
        TypeAdapter(Study).validate_python(strange)


# -- EN 1991-2 -----------------------------------------------------------------------------------

_AXLES_AND_LENGTH = {
    "A1": (50, 397.525), "A2": (48, 398.525), "A3": (46, 397.525), "A4": (44, 394.525),
    "A5": (42, 389.525), "A6": (40, 382.525), "A7": (40, 397.525), "A8": (38, 387.525),
    "A9": (36, 375.525), "A10": (36, 388.525),
}  # fmt: skip
"""Of each HSLM-A, as published with the trains' axle tables."""


@pytest.mark.parametrize("name", hslm_a_names())
def test_hslm_trains_have_their_axles_length_and_regular_distance(name: str) -> None:
    train = hslm_a(name)
    positions = [axle.position for axle in train.axles]
    assert (len(positions), positions[-1]) == _AXLES_AND_LENGTH[name]
    # The same from both ends.
    assert positions == pytest.approx([positions[-1] - x for x in reversed(positions)])
    length = 17.0 + int(name[1:])
    assert regular_spacing(replace(BEAM, train=train)) == pytest.approx(length), "18 to 27 m"


def test_hslm_a1_stands_as_it_is_published() -> None:
    positions = [axle.position for axle in hslm_a("A1").axles]
    published = [0, 3, 14, 17, 20.525, 22.525, 35.7625, 37.7625, 53.7625, 55.7625]
    assert positions[:10] == published
    assert positions[-8:] == [359.7625, 361.7625, 375, 377, 380.525, 383.525, 394.525, 397.525]


def test_hslm_forces_are_constant_on_a_bridge() -> None:
    """The standard's point forces do not change; the table's do by less than one in a thousand."""
    study = small_viaduct(replace(hslm_a("A1"), axles=hslm_a("A1").axles[:4]))
    simulation = simulate(study)
    wheels = [i for i, c in enumerate(simulation.plan.channels) if c.name.endswith("contact force")]
    forces = np.array([sample.channels[wheels] for sample in simulation])
    # (2 pi f)^2 u / g with u of a few millimetres of rail: 1e-4.
    assert forces == pytest.approx(85e3, rel=5e-4)
