"""What is told of a study that is too large: the need and the limit, never two equal numbers."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from server.jobs.submission import Capacity, limit_findings
from server.settings import Limits
from solver import studies

_ENOUGH = Capacity(memory_bytes=1e15, disk_bytes=1e15)


def _report(**estimate: int) -> studies.Report:
    """A sound study's report, with other numbers in its estimate."""
    report = studies.check(studies.template("sprung-mass-beam").study, "crossing")
    assert report.estimate is not None
    return replace(report, estimate=replace(report.estimate, **estimate))


def _told(need: int, limit: float) -> tuple[str, str]:
    """The need and the limit as somebody reads them whose disk is too small."""
    report = _report(disk_bytes=need)
    [finding] = limit_findings(report, Limits(), replace(_ENOUGH, disk_bytes=limit))
    assert finding.pointer == "/outputs/frame_interval"
    told = re.fullmatch(r"needs (.+) of disk; the limit is (.+)", finding.reason)
    assert told is not None, finding.reason
    assert finding.value == told[1]
    return told[1], told[2]


@pytest.mark.parametrize(
    ("need", "limit", "words"),
    [
        (157_900_000_000, 54.4e9, ("158 GB", "54.4 GB")),
        (56_626_000_000, 56.614e9, ("56.63 GB", "56.61 GB")),
        (56_625_985_009, 56_625_984_996, ("56.62599 GB", "56.62598 GB")),
    ],
)
def test_need_and_limit_have_as_many_digits_as_tell_them_apart(
    need: int, limit: float, words: tuple[str, str]
) -> None:
    assert _told(need, limit) == words


def test_one_byte_too_much_is_seen() -> None:
    needed, allowed = (
        float(text.split()[0]) for text in _told(1_234_567_890_123, 1_234_567_890_122)
    )
    assert needed > allowed


def test_what_is_just_enough_is_no_finding() -> None:
    report = _report(disk_bytes=10_000)
    assert limit_findings(report, Limits(), replace(_ENOUGH, disk_bytes=1e4)) == []


def test_counts_are_told_in_full() -> None:
    report = _report(runs=2, steps=1_234_567_891)
    limits = Limits(runs_per_job=1, steps_per_job=1_234_567_890)
    runs, steps = limit_findings(report, limits, _ENOUGH)
    assert runs.reason == "needs 2 runs; the limit is 1"
    assert steps.reason == "needs 1234567891 time steps; the limit is 1234567890"
