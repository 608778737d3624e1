"""Measured profiles as parts of studies: kept in the library, read in reports and comparisons."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from server.jobs.submission import read_study
from server.library.parts import read_part
from server.reports.inputs import differences, inputs
from server.reports.words import shown
from solver import studies
from solver.irregularities import MeasuredProfile, ProfileSample
from solver.studies import Study
from solver.units import Units


def profile(count: int, **changes: Any) -> dict[str, Any]:
    """As a spreadsheet's millimetres come out in metres, with all their figures."""
    rows = [
        {"position": 0.25 * row, "left": -math.sin(row) / 300.0, "right": math.cos(row) / 700.0}
        for row in range(count)
    ]
    return {"type": "measured", "samples": rows, "fade": 10.0, **changes}


def with_profile(count: int, **changes: float) -> Study:
    study = studies.template("khst-alverca").study
    samples = tuple(ProfileSample(**row) for row in profile(count)["samples"])
    changed = (*samples[:-1], replace(samples[-1], **changes))
    return replace(study, irregularity=MeasuredProfile(samples=changed))


def test_the_longest_profile_can_be_kept_and_read_back() -> None:
    value, wrong = read_part("irregularities", profile(2000))
    assert wrong == []
    assert len(value["samples"]) == 2000
    assert read_part("irregularities", value) == (value, [])


@pytest.mark.parametrize(
    ("change", "pointer", "reason"),
    [
        ({"position": 0.5}, "/samples/3/position", "does not follow the 0.5 m of row 3"),
        ({"left": 4.2}, "/samples/3/left", "at most 0.05"),
        ({"left": "4"}, "/samples/3/left", "is not a number"),
    ],
)
def test_what_is_wrong_with_a_profile_is_said_at_its_cell(
    change: dict[str, Any], pointer: str, reason: str
) -> None:
    broken = profile(8)
    broken["samples"][3] |= change
    value, (wrong,) = read_part("irregularities", broken, ("value",))
    assert value == {}
    assert wrong.pointer == f"/value{pointer}"
    assert reason in wrong.reason


def test_a_profile_in_the_library_need_not_fit_any_one_train() -> None:
    """Where a train starts is the study's: only a study is refused for it."""
    early = profile(8)
    for row in early["samples"]:
        row["position"] -= 500.0
    assert read_part("irregularities", early)[1] == []
    body = studies.to_json(studies.template("khst-alverca").study) | {"irregularity": early}
    (refused,) = studies.check(read_study(body)).errors
    assert refused.path == ("irregularity", "samples", 0, "position")


def test_a_report_reads_a_profile_column_by_column() -> None:
    found = inputs(with_profile(240))
    columns = {at: item for at, item in found.items() if at.startswith("/irregularity/samples")}
    assert set(columns) == {
        f"/irregularity/samples/{name}" for name in ("position", "left", "right")
    }
    position, left = (columns[f"/irregularity/samples/{name}"] for name in ("position", "left"))
    assert left.unit == Units.small_length
    assert shown(position.value, position.unit) == "0 to 59.75 m in steps of 0.25 (240)"
    # Nobody reads 240 figures in a table; the study's file has them all.
    assert "more" in shown(left.value, left.unit)
    assert len(shown(left.value, left.unit)) < 250


def test_profiles_that_differ_in_one_sample_differ_in_its_column() -> None:
    found = differences([with_profile(240), with_profile(240, left=1e-3)])
    assert [item.pointer for item in found] == ["/irregularity/samples/left"]
