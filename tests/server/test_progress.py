"""Progress as it is measured where a run computes, and summed for a job."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from server.jobs.progress import ProgressMeter, job_progress
from tests.server.test_store_arrays import make_plan, samples_of


def reports_of(n_step: int, seconds_per_step: float) -> list[Mapping[str, Any]]:
    """All reports of a run at a steady pace."""
    reports: list[Mapping[str, Any]] = []
    now = 0.0
    meter = ProgressMeter(reports.append, seconds=0.1, clock=lambda: now)
    meter.stage("building the model")
    plan = make_plan(n_step, n_point=2)
    meter.start(plan)
    for sample in samples_of(plan):
        now += seconds_per_step
        meter.step(sample)
    meter.stage("judging")
    return reports


@pytest.mark.parametrize(("n_step", "pace"), [(10_000, 1e-6), (300, 0.2), (50, 1e-6)])
def test_progress_is_steps_over_steps(n_step: int, pace: float) -> None:
    reports = reports_of(n_step, pace)
    steps = [report["step"] for report in reports]
    assert steps == sorted(steps)
    assert len(set(steps)) >= 10
    assert steps[-1] == n_step
    assert reports[0]["stage"] == "building the model"
    assert reports[-1]["stage"] == "judging"
    assert all(report["fraction"] == report["step"] / n_step for report in reports[1:])


def test_reports_are_rationed() -> None:
    # A thousand steps a second for ten seconds: ten a second, not a thousand.
    assert 90 <= len(reports_of(10_000, 1e-3)) <= 140


def test_the_time_left_is_a_range_around_the_truth() -> None:
    for report in reports_of(2000, 0.01)[5:-2]:
        low, high = report["remaining"]
        truth = (2000 - report["step"]) * 0.01
        assert low <= truth <= high
        assert high <= 1.5 * truth + 1e-9


def test_curves_come_in_bounded_pieces() -> None:
    reports = reports_of(50_000, 1e-4)
    times = [t for report in reports if "points" in report for t in report["points"]["time"]]
    assert len(times) == 1001
    assert times == sorted(times)


def test_a_job_sums_its_runs() -> None:
    done = {"step": 100, "steps": 100, "stage": "judging", "rate": 50.0, "simulated_time": 1.0}
    half = {"step": 50, "steps": 100, "stage": "computing", "rate": 25.0, "simulated_time": 0.5}
    total = job_progress([done, half, {}], 300)
    assert (total["step"], total["steps"], total["fraction"]) == (150, 300, 0.5)
    assert total["stage"] == "computing"
    low, high = total["remaining"]
    assert low <= 150 / 25.0 <= high
