"""The table of the 3D view's costs: bytes and counts are promises, seconds are only told."""

from __future__ import annotations

import math
import shutil

import pytest

from server.viewer.decimation import MOST_VERTICES
from tests.benchmarks.viewer import FRAME_RATE, main, streamed


@pytest.mark.slow
def test_a_coloured_vertex_costs_fifteen_bytes_and_no_more_than_fifteen_pictures_come() -> None:
    seconds = 2.0
    found = streamed(seconds)
    assert found.vertices == MOST_VERTICES
    assert found.surface_bytes == 15 * found.vertices
    # 92 wheels, 43 bodies, arrows and names beside 300 kB.
    assert found.frame_bytes < 1.1 * found.surface_bytes
    # One more where the window begins just before a picture.
    assert 0 < found.rate <= FRAME_RATE + 1.0 / seconds


@pytest.mark.slow
def test_every_row_is_measured(capsys: pytest.CaptureFixture[str]) -> None:
    main(["--quick"])
    printed = capsys.readouterr().out
    lines = [line for line in printed.splitlines() if line.startswith("| ")][1:]
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    assert len(lines) == (7 if browser else 5)
    for line in lines:
        name, measured, *_ = [cell.strip() for cell in line.strip("|").split("|")]
        assert name
        assert math.isfinite(float(measured.split()[0]))
    assert "Load of the machine" in printed
