"""The table of the first page's costs: bytes are a promise, seconds are only told."""

from __future__ import annotations

import math
import shutil

import pytest

from tests.benchmarks.page import main


@pytest.mark.slow
def test_every_row_is_measured_and_the_page_is_as_small_as_promised(
    capsys: pytest.CaptureFixture[str],
) -> None:
    main(["--quick"])
    printed = capsys.readouterr().out
    lines = [line for line in printed.splitlines() if line.startswith("| ")][1:]
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    assert len(lines) == (3 if browser else 0)
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    assert all(math.isfinite(float(measured.split()[0])) for _, measured, *_ in cells)
    kept = {name: row[-1] for name, *row in cells}
    assert kept.get("first page", "yes") == "yes"
    assert "Load of the machine" in printed
