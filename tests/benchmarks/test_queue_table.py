"""The table of the queue's costs: every row can be measured. Its seconds are nobody's promise."""

from __future__ import annotations

import math

import pytest

from tests.benchmarks.queue import main
from tests.benchmarks.table import Row


def test_a_row_says_whether_its_promise_is_kept() -> None:
    assert Row(name="n", unit="s", value=1.0, bound=2.0).text == "| n | 1 s | 2 s | yes |"
    assert Row(name="n", unit="s", value=3.0, bound=2.0).text == "| n | 3 s | 2 s | NO |"
    assert Row(name="n", unit="MB", value=3.0).text == "| n | 3 MB | | |"


@pytest.mark.slow
def test_every_row_is_measured(capsys: pytest.CaptureFixture[str]) -> None:
    main(["--quick"])
    printed = capsys.readouterr().out
    lines = [line for line in printed.splitlines() if line.startswith("| ")][1:]
    assert len(lines) == 21
    for line in lines:
        name, measured, *_ = [cell.strip() for cell in line.strip("|").split("|")]
        assert name
        assert math.isfinite(float(measured.split()[0]))
    assert "Load of the machine" in printed
