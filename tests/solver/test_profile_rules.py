"""What a check says of a measured profile: errors at their rows, warnings, what samples hold."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.arrays import FloatArray
from solver.errors import InputError
from solver.irregularities import (
    MeasuredProfile,
    rail_irregularities,
)
from solver.studies import Study, check, simulate
from solver.studies.bounds import Finding
from solver.studies.study import Extent, Integration, Outputs, Sweep
from tests.solver.profile_case import BEAM, KHST, found, measured, named


def warned(study: Study) -> dict[str, Finding]:
    report = check(study)
    assert report.errors == ()
    return named(report.warnings)


def with_profile(study: Study, x: FloatArray, left: FloatArray, **values: Any) -> Study:
    return replace(study, irregularity=measured(x, left, **values))


def gentle(x: FloatArray) -> FloatArray:
    """Level at both ends of 60 m."""
    return 2e-3 * np.sin(np.pi * x / 60.0) ** 4


FINE = np.arange(0.0, 60.01, 0.25)


def test_a_sensible_profile_is_accepted_without_a_word_and_its_resolution_said() -> None:
    study = with_profile(KHST, FINE, gentle(FINE))
    assert warned(study) == {}
    derived = check(study).derived
    assert derived["profile_wave"].value == pytest.approx(0.5)
    assert derived["profile_frequency"].value == pytest.approx(120.0 / 0.5)


def test_rows_out_of_order_are_named() -> None:
    x = FINE.copy()
    x[3], x[40] = x[2], x[41]
    study = with_profile(KHST, x, gentle(FINE))
    errors = found(study)
    assert list(errors) == ["irregularity.samples.3.position", "irregularity.samples.41.position"]
    assert errors["irregularity.samples.3.position"].reason.startswith(
        "does not follow the 0.5 m of row 3"
    )
    assert "order of x" in errors["irregularity.samples.3.position"].remedy
    with pytest.raises(InputError, match=r"irregularity\.samples\.3\.position = 0\.5: does not"):
        simulate(study)
    with pytest.raises(InputError, match=r"samples\.3\.position"):
        rail_irregularities(study.irregularity)


def test_a_profile_that_runs_backwards_is_one_error() -> None:
    (error,) = found(with_profile(KHST, FINE[::-1].copy(), gentle(FINE))).values()
    assert "Turn the samples round" in error.remedy


def test_values_beyond_their_bounds_are_named() -> None:
    samples = list(with_profile(KHST, FINE, gentle(FINE)).irregularity.samples)
    samples[5] = replace(samples[5], right=0.06)
    profile = MeasuredProfile(samples=tuple(samples))
    assert list(found(replace(KHST, irregularity=profile))) == ["irregularity.samples.5.right"]
    few = replace(profile, samples=tuple(samples[:3]))
    assert "4 to" in found(replace(KHST, irregularity=few))["irregularity.samples"].remedy


def test_the_samples_lie_between_the_train_and_the_end_of_the_crossing() -> None:
    early = found(with_profile(KHST, FINE - 60.0, gentle(FINE)))["irregularity.samples.0.position"]
    assert "struck" in early.reason
    assert "x = -56.0 m" in early.remedy
    assert "run-in to 70 m" in early.remedy
    assert found(with_profile(KHST, FINE - 56.0, gentle(FINE))) == {}
    longer = replace(KHST, extent=Extent(run_in=70.0))
    assert found(with_profile(longer, FINE - 60.0, gentle(FINE))) == {}
    far = found(with_profile(KHST, FINE - 5000.0, gentle(FINE)))
    (behind,) = far.values()
    assert "run-in" not in behind.remedy, "none is so long"
    (late,) = found(with_profile(KHST, FINE + 500.0, gentle(FINE))).values()
    assert "beyond the end" in late.reason


def test_a_profile_of_zeros_may_lie_anywhere_and_is_said_to_do_nothing() -> None:
    study = replace(BEAM, irregularity=MeasuredProfile())
    assert "all zero" in warned(study)["irregularity.samples"].reason


def test_what_an_engineer_should_know_of_the_samples() -> None:
    dense = np.arange(0.0, 20.01, 0.02)
    hollow = 1e-3 * np.exp(-((dense - 10.0) ** 2))
    warnings = warned(with_profile(KHST, dense, hollow))
    step = warnings["integration.time_step"]
    assert "30 mm a step, over samples 20 mm apart" in step.reason
    # 20 mm at 120 m/s in two steps.
    assert "8.33e-05 s" in step.remedy
    short = replace(KHST, integration=Integration(time_step=8.33e-5))
    assert warned(with_profile(short, dense, hollow)) == {}
    sharp = hollow.copy()
    sharp[500] -= 1e-3
    dip = warned(with_profile(short, dense, sharp))["irregularity.samples.500.left"]
    assert "x = 10.00 m" in dip.reason


def test_metres_for_millimetres_are_asked_about() -> None:
    said = warned(with_profile(KHST, FINE, 1e-3 * gentle(FINE)))["irregularity.samples"]
    assert "were metres given for millimetres?" in said.reason


def test_samples_too_far_apart_for_what_is_looked_at_are_said() -> None:
    coarse = np.arange(0.0, 60.01, 2.0)
    slow = replace(KHST, sweep=Sweep(speeds=(40.0, 120.0)))
    said = warned(with_profile(slow, coarse, gentle(coarse)))["irregularity.samples"]
    # v / (2 dx) = 40 / 4 Hz; half of 40 m/s / 30 Hz.
    assert "above 10 Hz" in said.reason
    assert "0.66 m" in said.remedy
    lower = replace(slow, outputs=Outputs(cut_off_frequency=10.0))
    assert warned(with_profile(lower, coarse, gentle(coarse))) == {}


def test_a_fade_sharper_than_the_samples_is_said() -> None:
    warnings = warned(with_profile(KHST, FINE, gentle(FINE) + 5e-3, right=0.0))
    assert "comes back from 5 mm" in warnings["irregularity.fade"].reason
    assert warned(with_profile(KHST, FINE, gentle(FINE) + 5e-3, fade=40.0)) == {}


def test_a_plain_beam_reads_the_left_rail() -> None:
    study = replace(BEAM, extent=Extent(run_in=10.0, run_out=0.0))
    x = np.arange(0.0, 25.01, 0.25)
    profile = {"x": x, "left": 1e-3 * np.sin(np.pi * x / 25.0) ** 4}
    said = warned(with_profile(study, **profile))["irregularity.samples"]
    assert "left rail only" in said.reason
    both = measured(**profile)
    same = tuple(replace(sample, right=sample.left) for sample in both.samples)
    assert warned(replace(study, irregularity=replace(both, samples=same))) == {}
