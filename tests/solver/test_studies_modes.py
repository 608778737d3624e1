"""Modal analysis of viaducts, tracks and trains, against closed forms and the thesis."""

from __future__ import annotations

import json
from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from scipy import linalg

from solver.errors import InputError
from solver.models.beam_bridge import BeamBridge
from solver.models.rails import ApproachTrack
from solver.models.viaduct import ViaductProperties
from solver.results import Sample
from solver.studies import ModalRun, Study, check, modal_analysis, modal_run, template
from solver.studies.study import Contact, Integration, Modes, NoTrack, Sweep

BEAM = template("sprung-mass-beam").study


def test_frequencies_and_damping_of_a_beam() -> None:
    """f_n = (n pi / L)^2 sqrt(EI / m) / 2 pi; zeta_n = a0 / (4 pi f_n) + a1 pi f_n."""
    bridge = BeamBridge(mass_damping=0.3, stiffness_damping=2e-4)
    found = modal_analysis(replace(BEAM, viaduct=bridge))
    json.dumps(found, allow_nan=False)
    scale = sqrt(bridge.young_modulus * bridge.second_moment / bridge.mass_per_length)
    for number in range(1, 5):
        mode = found["modes"][number - 1]
        wanted = (number * pi / 25.0) ** 2 * scale / (2.0 * pi)
        assert mode["number"] == number
        # 50 elements leave (4 pi / 50)^4 / 1440 = 3e-6 in the fourth mode.
        assert mode["frequency"] == pytest.approx(wanted, rel=5e-6)
        damping = 0.3 / (4.0 * pi * wanted) + 2e-4 * pi * wanted
        assert mode["damping"] == pytest.approx(damping, rel=1e-5)


def test_equal_spans_share_their_frequencies() -> None:
    found = modal_analysis(replace(BEAM, viaduct=BeamBridge(spans=(20.0, 20.0))))["modes"]
    assert found[0]["frequency"] == pytest.approx(found[1]["frequency"], rel=1e-9)
    assert found[2]["frequency"] == pytest.approx(4.0 * found[0]["frequency"], rel=1e-4)


def test_parts_that_do_not_fit_are_refused() -> None:
    study = template("khst-alverca").study
    with pytest.raises(InputError, match="ballasted"):
        modal_analysis(replace(study, track=NoTrack()))


# -- shapes ------------------------------------------------------------------------------------


def shapes(run: ModalRun) -> list[Sample]:
    """Every sample, each with its frame, checked for what all parts promise."""
    samples = list(run.samples())
    plan = run.plan
    assert plan.modal
    assert (plan.time_step, plan.frame_stride, plan.speed) == (1.0, 1, 0.0)
    assert len(samples) == plan.n_sample == plan.n_frame == len(run.summary["modes"])
    for mode, sample in enumerate(samples):
        assert (sample.step, sample.time) == (mode, float(mode))
        assert sample.frame is not None
        assert sample.frame.velocity is None
        moved = [np.linalg.norm(sample.frame.displacement, axis=1), np.abs(sample.channels)]
        # Edges of turning bodies reach farther than their centres; nothing reaches beyond 1.
        assert max((part.max(initial=0.0) for part in moved), default=0.0) <= 1.0 + 1e-9
    return samples


def test_shapes_of_a_beam_are_sines_upwards_of_height_one() -> None:
    run = modal_run(BEAM)
    x = run.plan.geometry.vertices[:, 0]
    for number, sample in enumerate(shapes(run)[:4], start=1):
        heights = sample.frame.displacement[:, 2]
        sine = np.sin(number * pi * x / 25.0)
        # The greatest height is that of a node: 50 elements miss the crest of the third by 0.2 %.
        assert np.abs(heights) == pytest.approx(np.abs(sine), abs=3e-3)
        assert np.abs(heights).max() == pytest.approx(1.0, abs=1e-12)
        assert run.summary["modes"][number - 1]["name"].startswith(f"bending, {number} half")


def test_a_small_model_has_fewer_modes_than_asked() -> None:
    beams = replace(BEAM, viaduct=BeamBridge(elements_per_span=2), modes=Modes(count=200))
    assert len(shapes(modal_run(beams))) == 2
    masses = replace(BEAM, modes=Modes(part="train", count=200))
    (only,) = shapes(modal_run(masses))
    # The mass goes up and down, the massless contact point stays on the rigid rail.
    assert only.frame.bodies == pytest.approx(np.array([[1.0, 0.0, 0.0]]))
    assert only.channels == pytest.approx([0.0])


@pytest.mark.parametrize("law", ["rigid", "linear_hertz", "nonlinear_hertz"])
def test_a_sprung_mass_on_its_contact(law: str) -> None:
    """f = sqrt(k / m) / 2 pi, k the suspension and the contact in series."""
    contact = Contact(law=law, stiffness=2e6, hertz_constant=8e8)
    train = BEAM.train
    force = 9.81 * train.mass
    tangent = 1.5 * 8e8 ** (2.0 / 3.0) * force ** (1.0 / 3.0)
    spring = {"rigid": float("inf"), "linear_hertz": 2e6, "nonlinear_hertz": tangent}[law]
    series = 1.0 / (1.0 / train.stiffness + 1.0 / spring)
    study = replace(BEAM, contact=contact, modes=Modes(part="train"))
    (mode,) = modal_run(study).summary["modes"]
    assert mode["frequency"] == pytest.approx(sqrt(series / train.mass) / (2.0 * pi), rel=1e-9)


def test_the_khst_has_the_frequencies_of_the_thesis() -> None:
    """Section 6.2.3: 0.694 to 10.48 Hz of bodies; 173.15 Hz of wheelsets on linear springs."""
    run = modal_run(template("train-modes").study)
    modes = run.summary["modes"]
    frequencies = np.array([mode["frequency"] for mode in modes])
    assert frequencies[:2] == pytest.approx([0.694, 0.697], rel=1e-3)
    for wanted, name in (
        (1.240, "carbody bounce"),
        (1.897, "carbody pitch"),
        (8.991, "bogie bounce"),
        (10.478, "bogie pitch"),
        (173.15, "wheelset bounce"),
    ):
        near = np.flatnonzero(np.abs(frequencies / wanted - 1.0) < 1e-3)
        assert name in {modes[mode]["name"] for mode in near}, wanted
    samples = shapes(run)
    assert len(run.plan.geometry.bodies) == 43
    assert [channel.name for channel in run.plan.channels][:2] == [
        "wheel 01 left/displacement", "wheel 01 right/displacement",
    ]  # fmt: skip
    # A carbody that pitches drives its ends up and down by 1, not its centre.
    (pitching, *_) = [k for k, mode in enumerate(modes) if mode["name"] == "carbody pitch"]
    bodies = samples[pitching].frame.bodies
    lengths = [body.size[0] for body in run.plan.geometry.bodies]
    assert np.max(np.abs(bodies[:, 0]) + 0.5 * np.abs(bodies[:, 2]) * lengths) > 0.9
    wheels = [k for k, mode in enumerate(modes) if mode["name"] == "wheelset bounce"]
    assert np.abs(samples[wheels[0]].channels).max() == pytest.approx(1.0)


def track_study(**changes: float) -> Study:
    """A coarse track whose bed is given: nothing has to be matched."""
    study = template("track-modes").study
    approach = ApproachTrack(
        bed_stiffness=changes.pop("bed_stiffness", 0.935e8),
        sleeper_mass=changes.pop("sleeper_mass", 207.6),
    )
    return replace(study, approach=approach, track=replace(study.track, **changes))


def smeared(study: Study, wave_number: float) -> tuple[float, float]:
    """Both frequencies of a rail on pads, sleepers and bed, smeared over the length. [Hz]"""
    track, approach = study.track, study.approach
    pad, bed, sleeper = (
        value / track.sleeper_spacing
        for value in (track.pad_stiffness, approach.bed_stiffness, approach.sleeper_mass)
    )
    rigidity = track.rail_young_modulus * track.rail_second_moment
    stiffness = np.array([[rigidity * wave_number**4 + pad, -pad], [-pad, pad + bed]])
    mass = np.diag([track.rail_area * track.rail_density, sleeper])
    squares = linalg.eigh(stiffness, mass, eigvals_only=True)
    return tuple(np.sqrt(squares) / (2.0 * pi))


def test_a_track_is_a_beam_on_an_elastic_bed() -> None:
    """Pads and sleepers away: omega^2 = (EI k^4 + bed) / (m + sleepers), k = n pi / L."""
    study = track_study(bed_stiffness=1e7, pad_stiffness=1e11, sleeper_mass=1.0)
    track = study.track
    run = modal_run(study)
    rigidity = track.rail_young_modulus * track.rail_second_moment
    mass = track.rail_area * track.rail_density + 1.0 / track.sleeper_spacing
    bed = study.approach.bed_stiffness / track.sleeper_spacing
    assert run.summary["facts"]["length"] == pytest.approx(18.0)
    for number, mode in enumerate(run.summary["modes"][:8]):
        wanted = sqrt((rigidity * (number * pi / 18.0) ** 4 + bed) / mass) / (2.0 * pi)
        # A stiffer bed would let the rail bend between the sleepers: 0.25 percent at 0.935e8.
        assert mode["frequency"] == pytest.approx(wanted, rel=1e-3)
        assert mode["name"].startswith("bounce" if number == 0 else f"{number} half wave")
        assert mode["assurance"] > 0.999


def test_sleepers_move_with_the_rail_or_against_it() -> None:
    """The two branches of the smeared track; sleepers 0.6 m apart are felt by shorter waves."""
    study = track_study()
    run = modal_run(study)
    by_name = {mode["name"]: mode["frequency"] for mode in run.summary["modes"]}
    for number in (0, 1, 2, 4, 6):
        lower, upper = smeared(study, number * pi / 18.0)
        waves = {0: "bounce", 1: "1 half wave"}.get(number, f"{number} half waves")
        assert by_name[f"{waves}, sleepers with rail"] == pytest.approx(lower, rel=2e-3)
        assert by_name[f"{waves}, sleepers against rail"] == pytest.approx(upper, rel=2e-2)
    bounce = shapes(run)[0].frame.displacement
    assert {layer.name for layer in run.plan.geometry.layers} == {"rails", "sleepers"}
    assert bounce[:, :2] == pytest.approx(0.0)
    assert bounce[:, 2].min() > 0.8, "rails and sleepers rise together"


def test_rails_follow_the_deck_below_them(small_study: Study) -> None:
    """In bending both rails go up with the slab, in torsion each with its own side."""
    study = replace(small_study, viaduct=ViaductProperties(spans=(12.0,)), modes=Modes(count=6))
    run = modal_run(study)
    names = [mode["name"] for mode in run.summary["modes"]]
    samples = shapes(run)
    x, y, _ = run.plan.geometry.vertices.T
    faces = {layer.name: layer.faces for layer in run.plan.geometry.layers}

    def heights(mode: str, layer: str, low: float, high: float) -> np.ndarray:
        """Of the layer's vertices at mid-span, between two distances from the axis."""
        own = np.unique(faces[layer])
        chosen = own[(np.abs(x[own] - 6.0) < 0.31) & (y[own] > low) & (y[own] < high)]
        return samples[names.index(mode)].frame.displacement[chosen, 2]

    for mode, side in (("bending of span 1", 1.0), ("torsion of span 1", -1.0)):
        left, right = heights(mode, "rails", 0.6, 0.8), heights(mode, "rails", -0.8, -0.6)
        assert left.mean() == pytest.approx(side * right.mean(), rel=0.01)
        # The rail's axis is above the slab's nodes at 0.72 m; pads and ballast give a little.
        assert left.mean() == pytest.approx(heights(mode, "slab", 0.6, 0.8).mean(), rel=0.1)
    rail = np.unique(faces["rails"])
    bending = samples[names.index("bending of span 1")].frame.displacement
    assert bending[rail][x[rail] < -4.0] == pytest.approx(0.0, abs=0.01)
    # The deck also moves along: bent, its underside and its top go opposite ways.
    assert np.abs(bending[:, 0]).max() > 0.05
    assert run.plan.geometry.wheels.names == ()
    assert run.plan.geometry.bodies == ()


# -- what a modal job needs --------------------------------------------------------------------


def test_a_modal_analysis_needs_its_own_part_alone() -> None:
    khst = template("khst-alverca").study
    no_track = replace(khst, track=NoTrack())
    hopeless = replace(
        no_track, integration=Integration(time_step=0.1), sweep=Sweep(speeds=(1e-4,))
    )
    part_of = {
        part: replace(hopeless, modes=Modes(part=part)) for part in ("viaduct", "track", "train")
    }
    assert check(part_of["train"], "modes").errors == ()
    for part in ("viaduct", "track"):
        (error,) = check(part_of[part], "modes").errors
        assert error.path == ("track", "type")
    beams = replace(khst, viaduct=BeamBridge(), track=NoTrack())
    assert check(beams, "modes").errors == ()
    wrong = replace(khst, train=replace(khst.train, consist=("spaceship",)))
    assert check(wrong, "modes").errors == ()
    (error,) = check(replace(wrong, modes=Modes(part="train")), "modes").errors
    assert error.path == ("train", "consist", 0)
    (error,) = check(replace(khst, modes=Modes(count=201)), "modes").errors
    assert error.path == ("modes", "count")


@pytest.mark.parametrize("name", ["viaduct-modes", "train-modes", "track-modes"])
def test_the_estimate_of_a_modal_analysis_is_near(name: str) -> None:
    """Unknowns within 2 percent; disk on the safe side."""
    chosen = template(name)
    found = check(chosen.study, "modes").estimate
    run = modal_run(chosen.study)
    assert found.unknowns == pytest.approx(run.summary["facts"]["unknowns"], rel=0.02)
    frames = 12 * (len(run.plan.geometry.vertices) + len(run.plan.geometry.bodies))
    assert found.disk_bytes >= run.plan.n_frame * (frames + 8 * len(run.plan.channels))
    assert (found.runs, found.steps) == (1, 1)
