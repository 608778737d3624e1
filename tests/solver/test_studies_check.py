"""What ``check`` forbids, warns of and derives, before anything is allocated."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

import solver.studies.crossing as crossing_module
import solver.studies.estimate as estimate_module
from solver.errors import InputError
from solver.irregularities import IsolatedDefect
from solver.models.ballasted_track import TrackProperties
from solver.models.rails import ApproachTrack
from solver.models.train import SprungMasses
from solver.models.viaduct import ViaductProperties
from solver.studies import Study, check, resonance_speeds, simulate, template
from solver.studies.advice import mesh_frequency
from solver.studies.bounds import Finding
from solver.studies.resonance import first_frequency
from solver.studies.study import Contact, Extent, Integration, NoTrack, Outputs, Sweep

KHST = template("khst-alverca-standard").study
BEAM = template("sprung-mass-beam").study


def found(study: Study) -> dict[str, Finding]:
    return {".".join(map(str, finding.path)): finding for finding in check(study).errors}


def with_defect(study: Study, **values: object) -> Study:
    return replace(study, irregularity=IsolatedDefect(**values))


BEYOND_THEIR_BOUNDS = [
    (replace(KHST, sweep=Sweep(speeds=(120.0, 0.0))), "sweep.speeds.1", "greater than 0"),
    (replace(KHST, sweep=Sweep(speeds=(-3.0,))), "sweep.speeds.0", "greater than 0"),
    (replace(KHST, sweep=Sweep(speeds=(math.nan,))), "sweep.speeds.0", "a number"),
    (replace(KHST, sweep=Sweep(speeds=(math.inf,))), "sweep.speeds.0", "a number"),
    (replace(KHST, sweep=Sweep(speeds=(True,))), "sweep.speeds.0", "a number"),
    (replace(KHST, sweep=Sweep(speeds=("fast",))), "sweep.speeds.0", "a number"),
    (replace(KHST, sweep=Sweep(speeds=())), "sweep.speeds", "1 to 500"),
    (replace(KHST, sweep=Sweep(speeds=120.0)), "sweep.speeds", "a list"),
    (replace(KHST, integration=Integration(alpha=0.1)), "integration.alpha", "at most 0"),
    (replace(KHST, integration=Integration(time_step=0.0)), "integration.time_step", "1e-07 s"),
    (replace(KHST, contact=Contact(law="glue")), "contact.law", "'rigid'"),
    (
        replace(KHST, contact=Contact(law="nonlinear_hertz", hertz_constant=7.958)),
        "contact.hertz_constant",
        "N/m^1.5",
    ),
    (replace(KHST, contact=Contact(unilateral=1)), "contact.unilateral", "true or false"),
    (replace(KHST, mesh_level="finest"), "mesh_level", "'fine'"),
    (replace(KHST, name=""), "name", "1 to 120"),
    (replace(KHST, name=7), "name", "a text"),
    (replace(KHST, track=None), "track", "TrackProperties or NoTrack"),
    (replace(KHST, extent=Outputs()), "extent", "Extent"),
    (replace(BEAM, train=SprungMasses(count=1.5)), "train.count", "whole number"),
    (replace(BEAM, train=SprungMasses(count=10**400)), "train.count", "at most 100"),
    (with_defect(KHST, amplitude=0.06), "irregularity.amplitude", "at most 0.05 m"),
]


@pytest.mark.parametrize(
    ("study", "path", "remedy"), BEYOND_THEIR_BOUNDS, ids=[case[1] for case in BEYOND_THEIR_BOUNDS]
)
def test_values_beyond_their_bounds(study: Study, path: str, remedy: str) -> None:
    report = check(study)
    (error,) = report.errors
    assert ".".join(map(str, error.path)) == path
    assert remedy in error.remedy
    assert error.reason.startswith(("is ", "has "))
    assert report.estimate is None


RELATIONS = [
    (replace(KHST, track=NoTrack()), "track.type", "does not go with", "ballasted"),
    (replace(BEAM, track=TrackProperties()), "track.type", "does not go with", "none"),
    (replace(BEAM, train=KHST.train), "train.type", "two rails", "sprung_masses"),
    (replace(KHST, train=SprungMasses()), "train.type", "one path", "articulated"),
    (
        replace(KHST, train=replace(KHST.train, consist=(KHST.train.consist[0], "spaceship"))),
        "train.consist.1", "", "",
    ),
    (
        replace(KHST, track=TrackProperties(ballast_width=4.5)),
        "track.ballast_width", "walls leave", "Narrow",
    ),
    (replace(KHST, sweep=Sweep(speeds=(1e-4,))), "sweep.speeds.0", "hardly ever end", "0.001"),
    (replace(KHST, sweep=Sweep(speeds=(5e-324,))), "sweep.speeds.0", "hardly ever end", "0.001"),
    (
        replace(KHST, integration=Integration(time_step=7e-4)),
        "integration.time_step", "half of a rail element of 0.15 m", "0.000625 s",
    ),
    (
        replace(
            KHST, sweep=Sweep(speeds=(1.0,)), integration=Integration(time_step=5e-3)
        ),
        "integration.time_step", "up to 100 Hz", "at most 0.0044 s",
    ),
    (
        replace(KHST, outputs=Outputs(cut_off_frequency=1000.0),
                integration=Integration(time_step=5e-4)),
        "integration.time_step", "chosen cut-off 1000 Hz", "lower cut-off",
    ),
    (
        replace(KHST, approach=ApproachTrack(length=300.0)),
        "approach.length", "shorter than the 520.2 m that the train of 380.1 m", "521 m",
    ),
    (with_defect(KHST, position=-64.0), "irregularity.position", "train's start", "-61.6 m"),
    (with_defect(KHST, position=500.0), "irregularity.position", "beyond the end", "438.6 m"),
    (
        with_defect(BEAM, position=12.5, wave_number=2.0),
        "irregularity.rail", "no wheel rolls there", '"left"',
    ),
]  # fmt: skip


@pytest.mark.parametrize(
    ("study", "path", "reason", "remedy"), RELATIONS, ids=[case[1] for case in RELATIONS]
)
def test_relations_between_fields(study: Study, path: str, reason: str, remedy: str) -> None:
    errors = found(study)
    assert list(errors) == [path]
    assert reason in errors[path].reason
    assert remedy in errors[path].remedy
    assert errors[path].value is not None


def test_all_errors_at_once() -> None:
    bounds = replace(
        KHST,
        sweep=Sweep(speeds=(-1.0, 300.0)),
        extent=Extent(run_in=-1.0),
        train=replace(KHST.train, name=""),
        mesh_level="finest",
    )
    assert set(found(bounds)) == {
        "sweep.speeds.0", "sweep.speeds.1", "extent.run_in", "train.name", "mesh_level",
    }  # fmt: skip
    relations = replace(
        with_defect(KHST, position=1000.0),
        approach=ApproachTrack(length=1.0),
        integration=Integration(time_step=1e-3),
    )
    assert set(found(relations)) == {
        "irregularity.position", "approach.length", "integration.time_step",
    }  # fmt: skip


def test_a_wheel_off_the_approach_needs_what_the_remedy_says() -> None:
    """The length that the remedy names is enough, a metre less is not."""
    assert found(replace(KHST, approach=ApproachTrack(length=521.0))) == {}
    assert "approach.length" in found(replace(KHST, approach=ApproachTrack(length=520.0)))


@pytest.mark.parametrize("speed", [1.7, 55.5, 71.3, 119.9, 200.0])
def test_the_time_step_of_the_remedy_is_accepted(speed: float) -> None:
    study = replace(KHST, sweep=Sweep(speeds=(speed,)), integration=Integration(time_step=0.1))
    steps = [
        float(word)
        for finding in check(study).errors
        for word in finding.remedy.split()
        if word[0].isdigit()
    ]
    assert found(replace(study, integration=Integration(time_step=min(steps)))) == {}


def test_simulate_raises_what_check_finds() -> None:
    with pytest.raises(InputError, match=r"sweep\.speeds\.0 = 0\.0: is not greater than 0 m/s"):
        simulate(replace(KHST, sweep=Sweep(speeds=(0.0,))))


def warned(study: Study) -> dict[str, Finding]:
    report = check(study)
    assert report.errors == ()
    return {".".join(map(str, finding.path)): finding for finding in report.warnings}


def test_warnings() -> None:
    assert warned(KHST) == {}
    assert warned(BEAM) == {}
    assert "screening" in warned(replace(KHST, mesh_level="coarse"))["mesh_level"].reason
    short = warned(replace(KHST, extent=Extent(run_in=57.0)))["extent.run_in"]
    assert "58 m" in short.remedy
    longer = replace(KHST.track, embankment_length=30.0)
    assert "70 m" in warned(replace(KHST, track=longer))["extent.run_in"].remedy
    sharp = warned(with_defect(KHST, wave_number=20.0))["irregularity.wave_number"]
    assert "0.0001 s" in sharp.remedy
    assert warned(with_defect(KHST)) == {}


def test_a_coarse_time_step_is_warned_of_with_the_value_to_use() -> None:
    """Four steps over a rail element of 0.15 m at 120 m/s: 0.15 / 480 s."""
    coarse = replace(KHST, integration=Integration(time_step=4e-4))
    warning = warned(coarse)["integration.time_step"]
    assert "3.1 steps over a rail element of 0.15 m" in warning.reason
    assert "Use 0.000312 s" in warning.remedy
    assert warned(replace(KHST, integration=Integration(time_step=0.000312))) == {}
    # Twice as fast again, it is no longer a matter of taste.
    assert "integration.time_step" in found(replace(coarse, sweep=Sweep(speeds=(200.0,))))


def test_a_cut_off_beyond_the_mesh_is_warned_of() -> None:
    """Six shells of 0.74, 0.3, 0.2 m along a bending wave of the slab with its ballast."""
    frequencies = [mesh_frequency(KHST, level) for level in ("coarse", "standard", "fine")]
    stiffness = 35.4e9 * 0.27**3 / (12.0 * 0.96)
    mass = 2469.8 * 0.27 + 2039.0 * 0.313
    wanted = [
        (math.pi / (3.0 * length)) ** 2 * math.sqrt(stiffness / mass) / (2.0 * math.pi)
        for length in (0.74, 0.3, 0.2)
    ]
    assert frequencies == pytest.approx(wanted, rel=1e-12)
    coarse = replace(KHST, mesh_level="coarse", integration=Integration(time_step=5e-4))

    def remedies(cut_off: float) -> list[str]:
        study = replace(coarse, outputs=Outputs(cut_off_frequency=cut_off))
        waves = [item for item in check(study).warnings if "bending waves" in item.reason]
        return [item.remedy for item in waves]

    assert remedies(0.0) == remedies(60.0) == []
    assert remedies(100.0) == ["Use the standard mesh."]
    beyond = replace(KHST, mesh_level="fine", outputs=Outputs(cut_off_frequency=1000.0))
    assert "at most 939 Hz" in warned(beyond)["mesh_level"].remedy


def test_resonance_speeds_are_those_of_the_first_frequency_and_the_bogies() -> None:
    """v = f d / i: at the thesis's 6.34 Hz and 18.7 m 427 km/h, and its fractions."""
    speeds = resonance_speeds(KHST, 6.34)
    assert [order for order, _ in speeds] == [1, 2, 3, 4]
    wanted = [426.8, 213.4, 142.3, 106.7]
    assert [3.6 * speed for _, speed in speeds] == pytest.approx(wanted, abs=0.1)
    derived = check(KHST).derived
    first = derived["first_frequency"]
    # The modal analysis gives 6.6 Hz for span 2 with its neighbours, the thesis 6.39.
    assert first.value == pytest.approx(6.6, rel=0.05)
    assert "span 2" in first.title
    assert "estimate" in first.title
    assert derived["regular_spacing"].value == pytest.approx(18.7)
    assert derived["resonance_2"].value == pytest.approx(0.5 * first.value * 18.7)
    assert resonance_speeds(BEAM, 4.78) == []
    masses = replace(BEAM, train=SprungMasses(count=3, spacing=20.0))
    assert resonance_speeds(masses, 5.0)[0] == (1, pytest.approx(100.0))
    # f = pi / (2 L^2) sqrt(EI / m) of the beam of Yang and Yau: 30.02 rad/s (thesis 4.4.1).
    yang = check(BEAM).derived["first_frequency"].value
    assert 2.0 * math.pi * yang == pytest.approx(30.02, rel=1e-4)


def test_the_closed_form_follows_the_modal_analysis_of_the_outer_span() -> None:
    """16.5 m alone: 10.26 Hz by modal analysis; a short, deep beam is the harder case."""
    short = replace(KHST, viaduct=ViaductProperties(spans=(16.5,)))
    assert first_frequency(short).frequency == pytest.approx(10.26, rel=0.07)


def test_derived_values_count_steps_and_unknowns() -> None:
    study = replace(KHST, sweep=Sweep(speeds=(60.0, 120.0)))
    report = check(study)
    assert report.derived["steps"].value == report.estimate.steps
    assert report.derived["unknowns"].value == report.estimate.unknowns
    assert report.derived["wheel_step"].value == pytest.approx(120.0 * 2.5e-4)
    defect = check(with_defect(study)).derived
    # 6.7 m from end to end at 0.9 1/m: 18 Hz at 120 m/s.
    assert defect["defect_length"].value == pytest.approx(6.67, abs=0.01)
    assert defect["defect_frequency"].value == pytest.approx(18.0)


def test_derived_values_belong_to_the_slowest_and_the_fastest_run() -> None:
    derived = check(replace(KHST, sweep=Sweep(speeds=(60.0, 120.0)))).derived
    assert derived["train_length"].value == pytest.approx(380.15)
    # (66 + 58.5 + 380.15) m at 60 m/s, and one second more.
    assert derived["duration"].value == pytest.approx(504.65 / 60.0 + 1.0, abs=2.5e-4)
    assert derived["sleeper_passing"].value == pytest.approx(200.0)
    assert derived["approach"].value == pytest.approx(520.15, abs=0.05)
    assert "sleeper_passing" not in check(BEAM).derived


def counted(monkeypatch: pytest.MonkeyPatch, module: object, name: str) -> list[object]:
    """Counts the calls of a module's function from here on."""
    calls: list[object] = []
    original: Callable[..., object] = getattr(module, name)

    def counting(*arguments: object) -> object:
        calls.append(arguments)
        return original(*arguments)

    monkeypatch.setattr(module, name, counting)
    return calls


def test_a_sweep_of_500_speeds_lays_out_train_and_mesh_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The issue's 50 ms, as counts: neither train nor mesh lines depend on the speed."""
    layouts = counted(monkeypatch, crossing_module, "lay_out")
    meshes = counted(monkeypatch, estimate_module, "estimate_unknowns")
    extents = counted(monkeypatch, estimate_module, "crossing")
    crossing_module._axles.cache_clear()
    estimate_module.structure_unknowns.cache_clear()
    report = check(replace(KHST, sweep=Sweep(speeds=tuple(60.0 + 0.1 * k for k in range(500)))))
    assert report.errors == ()
    assert report.estimate is not None
    assert report.estimate.runs == 500
    assert (len(layouts), len(meshes), len(extents)) == (1, 1, 500)
