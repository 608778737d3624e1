"""The comparison of the methods: every cell can be made, and the page holds what was made."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from tests.benchmarks.methods import BEGIN, END, tables, write
from tests.benchmarks.methods_runs import (
    VARIANTS,
    Case,
    Result,
    beam,
    cases,
    compare,
    error,
)

PAGE = Path(__file__).parents[2] / "docs" / "methods.md"


@pytest.fixture(scope="module")
def results() -> list[Result]:
    """A case that every method solves, and one that Gauss-Seidel cannot."""
    mesh = partial(beam, 20)
    small = [
        Case(mesh=mesh, name="short run", wheels=4, n_step=20),
        Case(mesh=mesh, name="heavy wheels", wheels=1, unsprung=2e4, n_step=20),
    ]
    return [compare(case, isolated=False) for case in small]


def test_every_method_solves_the_same_crossing(results: list[Result]) -> None:
    light = results[0]
    assert light.radius < 1.0
    assert set(light.runs) == set(VARIANTS)
    for run in light.runs.values():
        assert not run.failure
        assert len(run.deflection) == 21
        # The published accuracy of the least accurate of them, the penalty method.
        assert error(run, light.runs["direct"], "forces") < 1e-3


def test_divergence_is_predicted_and_told(results: list[Result]) -> None:
    heavy = results[1]
    assert heavy.radius > 1.0
    assert "spectral radius" in heavy.runs["iterative"].failure
    others = [run for name, run in heavy.runs.items() if name != "iterative"]
    assert not any(run.failure for run in others)


def test_the_page_is_written_between_its_markers(results: list[Result], tmp_path: Path) -> None:
    page = tmp_path / "methods.md"
    page.write_text(f"Before\n{BEGIN}\nold\n{END}\nAfter\n", encoding="utf-8")
    write(results, page)
    text = page.read_text(encoding="utf-8")
    assert text.startswith("Before")
    assert text.endswith("After\n")
    assert "old" not in text
    assert tables(results) in text
    assert "| heavy wheels, 1 wheel, 20000 kg each, 0.25 ms | 40 |" in text
    assert "fails" in text
    columns = {line.count("|") for line in text.splitlines() if line.startswith("| short run")}
    assert columns == {len(VARIANTS) + 3, len(VARIANTS) + 2, 6}


def test_the_published_page_has_every_case_and_method() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for title in [case.title for case in cases()] + list(VARIANTS):
        assert title in text
    ratios = re.findall(r"^\| fine solids.* \| [\d.]+ ms \| (.*) \|$", text, flags=re.MULTILINE)
    assert len(ratios) == 2
    assert np.isfinite([float(cell) for row in ratios for cell in row.split("|")]).all()
