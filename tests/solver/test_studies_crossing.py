"""Extent of a crossing, its estimated cost, and the templates that need both."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from solver.errors import InputError
from solver.irregularities import IsolatedDefect
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.rails import ApproachTrack
from solver.studies import (
    Study,
    check,
    prepare,
    resonance_speeds,
    runs_of,
    template,
    templates,
    to_json,
)
from solver.studies.crossing import PATH_MARGIN, crossing
from solver.studies.estimate import Estimate
from solver.studies.study import Integration, NoTrack, Outputs, Sweep

KHST = template("khst-alverca-standard").study
TRAIN = 380.15
"""First to last axle of the KHST. [m]"""


def test_the_default_crossing_is_the_one_of_the_modelling_decisions() -> None:
    """Start at -66 m; end 1 s after the last axle has left; 20 m of path round every wheel."""
    extent = crossing(KHST, 120.0)
    step = KHST.integration.time_step
    assert extent.start == -66.0
    assert extent.n_step == 20822
    last_axle_leaves = (66.0 + 58.5 + TRAIN) / 120.0
    assert 0.0 <= extent.n_step * step - (last_axle_leaves + 1.0) < step
    assert extent.path_start == pytest.approx(-66.0 - TRAIN - PATH_MARGIN)
    first_axle_ends = -66.0 + 120.0 * step * extent.n_step
    assert extent.path_end == pytest.approx(first_axle_ends + PATH_MARGIN)
    # Peaks count from the first axle's arrival at x = -18 m.
    assert extent.window_start == pytest.approx(48.0 / 120.0)


def test_window_follows_the_embankment_and_never_begins_before_the_run() -> None:
    longer = replace(KHST, track=TrackProperties(embankment_length=30.0))
    assert crossing(longer, 60.0).window_start == pytest.approx(36.0 / 60.0)
    huge = replace(KHST, track=TrackProperties(embankment_length=100.0))
    assert crossing(huge, 60.0).window_start == 0.0


def test_an_approach_given_by_hand_lengthens_the_path_on_both_sides() -> None:
    given = crossing(replace(KHST, approach=ApproachTrack(length=700.0)), 120.0)
    start, end = -18.3, 58.5
    assert given.path_start == pytest.approx(start - 700.0, abs=0.31)
    assert given.path_end == pytest.approx(end + 700.0, abs=0.31)


def test_one_mass_on_one_beam_crosses_it_exactly() -> None:
    study = template("sprung-mass-beam").study
    speed = study.sweep.speeds[0]
    extent = crossing(study, speed)
    assert extent.start == 0.0
    assert extent.n_step == math.ceil(25.0 / speed / 2.5e-4)
    assert extent.window_start == 0.0


# -- estimate ----------------------------------------------------------------------------------


def estimate(study: Study) -> Estimate:
    found = check(study).estimate
    assert found is not None
    return found


def as_tuple(found: Estimate) -> tuple[float, ...]:
    return (found.steps, found.unknowns, found.seconds, found.memory_bytes, found.disk_bytes)


@pytest.mark.parametrize(
    ("cheaper", "dearer", "grows"),
    [
        (replace(KHST, mesh_level="coarse"), KHST, {1, 2, 3, 4}),
        (KHST, replace(KHST, mesh_level="fine"), {1, 2, 3, 4}),
        (KHST, replace(KHST, integration=Integration(time_step=1e-4)), {0, 2, 4}),
        (KHST, replace(KHST, sweep=Sweep(speeds=(120.0, 110.0))), {0, 2, 4}),
        (KHST, replace(KHST, outputs=Outputs(frame_interval=5e-3)), {4}),
        (KHST, replace(KHST, sweep=Sweep(speeds=(60.0,))), {0, 2, 4}),
    ],
    ids=["coarse", "fine", "time step", "runs", "frames", "slow"],
)
def test_more_costs_more(cheaper: Study, dearer: Study, grows: set[int]) -> None:
    less, more = as_tuple(estimate(cheaper)), as_tuple(estimate(dearer))
    for index, (a, b) in enumerate(zip(less, more, strict=True)):
        assert (b > a) if index in grows else (b >= a or index in {1, 3})


def test_frames_closer_than_steps_cost_no_more_than_one_a_step() -> None:
    every_step = replace(KHST, outputs=Outputs(frame_interval=2.5e-4))
    closer = replace(KHST, outputs=Outputs(frame_interval=1e-4))
    assert estimate(closer).disk_bytes == estimate(every_step).disk_bytes


def real_size(study: Study) -> tuple[int, int]:
    """Unknowns and bytes of results (doubles for channels, singles else) of a prepared run."""
    plan = prepare(study).plan
    facts = plan.facts
    unknowns = sum(int(facts[f"unknowns_{part}"]) for part in ("structure", "rails", "train"))
    steps = 8 * (len(plan.channels) + 1) + 4 * len(plan.slab.coordinates)
    # Three displacements, a velocity and an acceleration of a vertex; three of a body.
    shapes = 20 * len(plan.geometry.vertices) + 12 * len(plan.geometry.bodies)
    return unknowns, steps * plan.n_sample + shapes * plan.n_frame


def test_estimate_of_a_small_crossing_is_the_real_one(small_study: Study) -> None:
    """Unknowns within 1 percent; disk on the safe side, though not by much."""
    unknowns, size = real_size(small_study)
    found = estimate(small_study)
    assert found.unknowns == pytest.approx(unknowns, rel=0.01)
    assert size < found.disk_bytes < 2.5 * size


def test_estimate_of_beams_is_the_real_one() -> None:
    """Many elements make many points: a long fine beam is no small result."""
    study = Study(
        name="ten fine spans",
        train=template("two-span-separation").study.train,
        viaduct=BeamBridge(spans=(20.0,) * 10, elements_per_span=40),
        track=NoTrack(),
    )
    unknowns, size = real_size(study)
    found = estimate(study)
    assert found.unknowns == unknowns
    assert found.disk_bytes == pytest.approx(size, rel=0.02)


# -- templates ---------------------------------------------------------------------------------


def test_templates_have_the_names_of_the_issue_the_one_click_job_first() -> None:
    assert list(templates()) == [
        "khst-alverca", "alverca-speed-sweep", "isolated-defect", "sprung-mass-beam",
        "two-span-separation", "viaduct-modes", "train-modes", "track-modes",
        "khst-alverca-standard", "two-span-hertz",
    ]  # fmt: skip


@pytest.mark.parametrize("name", list(templates()))
def test_every_template_runs_as_it_stands(name: str) -> None:
    chosen = template(name)
    assert chosen.name == name
    report = check(chosen.study, chosen.kind)
    assert report.errors == ()
    assert chosen.kind == ("modes" if name.endswith("-modes") else "crossing")
    assert [run["speed"] for run in runs_of(chosen.study)] == list(chosen.study.sweep.speeds)


def test_the_sweep_passes_the_resonance_of_the_deciding_span() -> None:
    """Table 7.6 of the thesis: 6.34 and 6.39 Hz; bogies every 18.7 m: 427 to 430 km/h."""
    sweep = template("alverca-speed-sweep").study
    speeds = [3.6 * speed for speed in sweep.sweep.speeds]
    assert (min(speeds), max(speeds), len(speeds)) == (pytest.approx(300), pytest.approx(450), 16)
    (_, first), *_ = resonance_speeds(sweep, 6.39)
    assert 3.6 * first == pytest.approx(430.2, abs=0.1)
    assert sum(abs(speed - 3.6 * first) <= 10.0 for speed in speeds) == 2
    assert check(sweep).warnings[0].path == ("mesh_level",)


def test_the_isolated_defect_is_that_of_the_issue() -> None:
    study = template("isolated-defect").study
    defect = study.irregularity
    assert isinstance(defect, IsolatedDefect)
    spans = study.viaduct.spans
    assert defect.position == spans[0] + 0.5 * spans[1]
    assert defect.amplitude == 0.016
    assert 3.6 * study.sweep.speeds[0] == pytest.approx(350.0)
    assert study.contact.unilateral


@pytest.mark.parametrize("name", list(templates()))
def test_a_study_is_plain_json(name: str) -> None:
    document = to_json(template(name).study)
    text = json.dumps(document, allow_nan=False)
    # Lists for tuples and nothing else: JSON gives back what it was given.
    assert json.loads(text) == document
    assert document["schema_version"] == 1
    assert document["train"]["type"] in {"articulated", "sprung_masses"}


def test_the_one_click_job_is_what_the_issue_says() -> None:
    study = template("khst-alverca").study
    assert study.mesh_level == "coarse"
    assert study.integration == Integration(alpha=-0.05, time_step=5e-4)
    assert study.sweep.speeds == (120.0,)
    assert study.contact.stiffness == 1.212e9
    standard = template("khst-alverca-standard").study
    assert standard.mesh_level == "standard"
    assert standard.integration.time_step == 2.5e-4


def test_an_unknown_template_names_those_there_are() -> None:
    with pytest.raises(InputError, match="khst-alverca"):
        template("tgv")


@pytest.mark.parametrize("run_index", [-1, 1])
def test_a_run_that_the_sweep_has_not_is_an_error(run_index: int) -> None:
    with pytest.raises(InputError, match="runs 0 to 0"):
        prepare(template("sprung-mass-beam").study, run_index)
