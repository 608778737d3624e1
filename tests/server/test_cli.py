"""The command line without a server: templates and runs, and errors that can be read."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from server.store import RunReader
from solver import studies
from tests.server.server_case import short_study

ROOT = Path(__file__).parents[2]


def trainbridge(*words: str, given: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "server", *words],
        input=given,
        capture_output=True,
        text=True,
        timeout=120,
        cwd=ROOT,
        check=False,
        env={**os.environ, "COLUMNS": "200"},
    )


def test_templates_are_listed_and_printed() -> None:
    listed = trainbridge("templates")
    assert listed.returncode == 0
    assert [line.split()[0] for line in listed.stdout.splitlines()] == list(studies.templates())
    printed = trainbridge("templates", "sprung-mass-beam")
    expected = studies.to_json(studies.template("sprung-mass-beam").study)
    assert json.loads(printed.stdout) == json.loads(json.dumps(expected))
    unknown = trainbridge("templates", "nothing")
    assert unknown.returncode == 1
    assert "sprung-mass-beam" in unknown.stderr


def test_a_study_runs_without_a_server(tmp_path: Path) -> None:
    study = tmp_path / "study.json"
    study.write_text(json.dumps(short_study()))
    done = trainbridge("run", str(study), "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    assert "100 %" in done.stderr
    assert "100 km/h" in done.stdout
    assert "Not judged" in done.stdout
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert {"verdicts", "peaks", "timings", "versions"} <= set(summary)
    reader = RunReader(tmp_path / "out")
    assert reader.done
    assert reader.committed == reader.plan.n_sample
    # A second time: what is there is not overwritten.
    again = trainbridge("run", str(study), "--out", str(tmp_path / "out"))
    assert again.returncode == 1
    assert "not empty" in again.stderr


def test_each_speed_gets_its_folder(tmp_path: Path) -> None:
    study = short_study(sweep={"speeds": [20.0, 30.0]})
    done = trainbridge("run", "-", "--out", str(tmp_path / "out"), given=json.dumps(study))
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["run-000", "run-001"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "line 1, column 2"),
        ('{"name": NaN}', "/name"),
        ('{"wheels": 4}', "/wheels"),
        ("[]", "object"),
        (json.dumps(short_study(sweep={"speeds": [0.0]})), "/sweep/speeds/0"),
        (json.dumps(short_study(approach={"length": 1.0})), "/approach/length"),
    ],
)
def test_a_bad_study_is_explained(tmp_path: Path, text: str, words: str) -> None:
    study = tmp_path / "study.json"
    study.write_text(text)
    refused = trainbridge("run", str(study), "--out", str(tmp_path / "out"))
    assert refused.returncode == 2
    assert words in refused.stderr
    assert "Traceback" not in refused.stderr
    assert not (tmp_path / "out" / "summary.json").exists()


def test_a_missing_file_is_said(tmp_path: Path) -> None:
    refused = trainbridge("run", str(tmp_path / "none.json"), "--out", str(tmp_path / "out"))
    assert refused.returncode == 1
    assert "cannot be read" in refused.stderr
