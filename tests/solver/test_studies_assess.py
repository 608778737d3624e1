"""What a finished run says: peaks of every slab point, comfort, and what is not judged."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import pytest

from solver.arrays import IntVector, Matrix
from solver.results import RunPlan
from solver.simulation import Extremes
from solver.studies import Study, assess, template
from tests.solver.models_case import prepare


@pytest.fixture(scope="module")
def plan(small_study: Study) -> RunPlan:
    """Of the six-car KHST over one span."""
    return prepare(small_study).plan


def slab_histories(plan: RunPlan) -> Matrix:
    """At 5 Hz, point k by k + 1 mm/s2, and by far the most before the window opens."""
    times = np.arange(plan.n_sample) * plan.time_step
    wave = np.sin(2.0 * np.pi * 5.0 * times) * (1.0 + 99.0 * (times < plan.window_start - 0.1))
    return 1e-3 * wave[:, None] * (1.0 + np.arange(len(plan.slab.coordinates)))


def in_blocks(histories: Matrix) -> Iterator[tuple[IntVector, Matrix]]:
    for start in range(0, histories.shape[1], 64):
        indices = np.arange(start, min(start + 64, histories.shape[1]))
        yield indices, histories[:, indices]


def extremes_of(plan: RunPlan, accelerations: dict[str, tuple[float, float]]) -> Extremes:
    """Least and greatest of some channels, at 1 s and 2 s; all others were at rest."""
    extremes = Extremes(len(plan.channels))
    extremes.least[:], extremes.greatest[:] = 0.0, 0.0
    extremes.time_of_least[:], extremes.time_of_greatest[:] = 1.0, 2.0
    names = [channel.name for channel in plan.channels]
    for name, (least, greatest) in accelerations.items():
        index = names.index(f"{name}/acceleration")
        extremes.least[index], extremes.greatest[index] = least, greatest
    return extremes


def test_slab_peaks_are_those_that_the_verdict_is_made_of(
    small_study: Study, plan: RunPlan
) -> None:
    histories = slab_histories(plan)
    found = assess(
        small_study,
        plan,
        extremes_of(plan, {}),
        lambda: in_blocks(histories),
        lambda k: histories[:, k],
    )
    peaks = found.slab_peaks
    wanted = 1e-3 * (1.0 + np.arange(len(plan.slab.coordinates)))
    # Sampled 400 times a period, and 5 Hz pass the filter of 30 Hz: within its edge's ripple.
    assert peaks.raw == pytest.approx(wanted, rel=1e-3)
    assert peaks.filtered == pytest.approx(wanted, rel=2e-2)
    offset = small_study.integration.alpha * plan.time_step
    assert peaks.raw_time.min() >= plan.window_start + offset - 0.5 * plan.time_step
    (verdict,) = found.verdicts
    judged = np.isin(plan.slab.span, plan.slab.judged_spans)
    assert verdict["value"] == peaks.filtered[judged].max()
    assert verdict["raw"]["value"] == peaks.raw[judged].max()


def test_comfort_takes_the_greater_side_of_each_car(small_study: Study, plan: RunPlan) -> None:
    histories = slab_histories(plan)
    extremes = extremes_of(
        plan, {"carbody 01": (-3.0, 1.0), "carbody 03": (-1.2, 0.9), "carbody 04": (-0.2, 1.1)}
    )
    found = assess(
        small_study, plan, extremes, lambda: in_blocks(histories), lambda k: histories[:, k]
    )
    comfort = json.loads(json.dumps(found.comfort))
    assert len(comfort["cars"]) == 6
    assert [car["passengers"] for car in comfort["cars"]] == [False, *[True] * 4, False]
    assert comfort["cars"][0]["level"] == "beyond acceptable"
    offset = small_study.integration.alpha * plan.time_step
    worst = comfort["worst"]
    assert (worst["name"], worst["peak"], worst["level"]) == ("carbody 03", 1.2, "good")
    # Like every acceleration, at the time for which the method gives it.
    assert worst["time"] == pytest.approx(1.0 + offset)
    assert comfort["cars"][3]["time"] == pytest.approx(2.0 + offset)


def test_beams_have_raw_peaks_and_no_comfort() -> None:
    study = template("sprung-mass-beam").study
    plan = prepare(study).plan
    histories = slab_histories(plan)
    found = assess(
        study, plan, extremes_of(plan, {}), lambda: in_blocks(histories), lambda k: histories[:, k]
    )
    assert found.verdicts == ()
    assert "Not judged" in found.unjudged
    assert found.comfort is None
    assert found.slab_peaks.filtered is None
    assert found.slab_peaks.raw == pytest.approx(
        1e-3 * (1.0 + np.arange(len(plan.slab.coordinates))), rel=1e-3
    )
