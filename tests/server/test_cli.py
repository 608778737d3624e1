"""The command line: with a server and without one, and errors that can be read."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from server.store import RunReader
from solver import studies
from tests.server import odd_batches
from tests.server.command_line import ROOT, refused_here, trainbridge
from tests.server.server_case import (
    Client,
    ended,
    serving,
    settings_for,
    short_study,
    submit,
)

TOKEN = "correct horse battery staple"


@pytest.mark.slow
def test_templates_are_listed_and_printed() -> None:
    listed = trainbridge("templates")
    assert listed.returncode == 0
    assert "(--kind modes)" in listed.stdout
    assert [line.split()[0] for line in listed.stdout.splitlines()] == list(studies.templates())
    printed = trainbridge("templates", "sprung-mass-beam")
    expected = studies.to_json(studies.template("sprung-mass-beam").study)
    assert json.loads(printed.stdout) == json.loads(json.dumps(expected))
    unknown = trainbridge("templates", "nothing")
    assert unknown.returncode == 1
    assert "sprung-mass-beam" in unknown.stderr


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("part", ["viaduct", "train"])
def test_modes_are_found_without_a_server(tmp_path: Path, part: str) -> None:
    # An approach that no crossing could do with does not stand in the way of modes.
    study = json.dumps(short_study(modes={"part": part}, approach={"length": 1.0}))
    words = ("run", "-", "--kind", "modes", "--out", str(tmp_path / "out"))
    done = trainbridge(*words, given=study)
    assert done.returncode == 0, done.stderr
    reader = RunReader(tmp_path / "out")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert reader.done
    assert reader.plan.modal
    assert reader.committed == reader.committed_frames == len(summary["modes"])
    first = summary["modes"][0]
    assert f"{first['frequency']:.4g}" in done.stdout
    assert first["name"] in done.stdout


@pytest.mark.slow
def test_each_speed_gets_its_folder(tmp_path: Path) -> None:
    study = short_study(sweep={"speeds": [20.0, 30.0]})
    done = trainbridge("run", "-", "--out", str(tmp_path / "out"), given=json.dumps(study))
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["run-000", "run-001"]


@pytest.mark.slow
def test_a_full_disk_is_said_in_a_line(tmp_path: Path) -> None:
    study = tmp_path / "study.json"
    study.write_text(json.dumps(short_study()))
    limited = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)); "
        "from server.__main__ import main; main()"
    )
    full = subprocess.run(
        [sys.executable, "-c", limited, "run", str(study), "--out", str(tmp_path / "out")],
        capture_output=True,
        text=True,
        timeout=300,
        cwd=ROOT,
        check=False,
    )
    assert full.returncode == 1
    assert "There is no room left" in full.stderr
    assert "Traceback" not in full.stderr


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
    refused = refused_here("run", str(study), "--out", str(tmp_path / "out"))
    assert refused.returncode == 2
    assert words in refused.stderr
    assert "Traceback" not in refused.stderr
    assert not (tmp_path / "out" / "summary.json").exists()


def test_a_missing_file_is_said(tmp_path: Path) -> None:
    refused = trainbridge("run", str(tmp_path / "none.json"), "--out", str(tmp_path / "out"))
    assert refused.returncode == 1
    assert "cannot be read" in refused.stderr


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """A server whose runs are done at once."""
    settings = settings_for(tmp_path_factory.mktemp("server"), token=TOKEN)
    with serving(settings, compute=odd_batches.finish) as client:
        client.headers["Authorization"] = f"Bearer {TOKEN}"
        yield client


def ask(server: Client, *words: str, given: str = "") -> subprocess.CompletedProcess[str]:
    """A command that finds server and token in the environment."""
    return trainbridge(*words, given=given, **place_of(server))


def place_of(server: Client) -> dict[str, str]:
    """Variables that name the server and its token."""
    address = f"http://127.0.0.1:{server.port}"
    return {"TRAINBRIDGE_SERVER": address, "TRAINBRIDGE_TOKEN": TOKEN}


@pytest.mark.slow
def test_a_study_is_submitted_and_followed(server: Client, tmp_path: Path) -> None:
    study = tmp_path / "study.json"
    study.write_text(json.dumps(short_study(name="from the command line")))
    done = ask(server, "submit", str(study), "--wait", "--priority", "3", "--key", "k")
    assert done.returncode == 0, done.stderr
    job = done.stdout.splitlines()[0]
    assert "100 %" in done.stderr
    assert "done" in done.stderr
    assert server.json(f"jobs/{job}")["priority"] == 3
    again = ask(server, "submit", "-", "--priority", "3", "--key", "k", given=study.read_text())
    assert again.stdout.splitlines() == [job]
    watched = ask(server, "watch", job)
    assert watched.returncode == 0
    listed = ask(server, "jobs", "--state", "done", "--name", "COMMAND line")
    [_, row] = listed.stdout.splitlines()
    assert row.split()[:2] == [job, "done"]
    as_json = json.loads(ask(server, "jobs", "--name", "COMMAND line", "--json").stdout)
    assert [item["id"] for item in as_json] == [job]
    cancelled = ask(server, "cancel", job)
    assert cancelled.returncode == 0
    assert "done already" in cancelled.stdout


@pytest.mark.slow
def test_a_job_that_did_not_end_well_fails_the_command(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path, token=TOKEN), compute=odd_batches.fail) as server:
        done = ask(server, "submit", "-", "--wait", given=json.dumps(short_study()))
    assert done.returncode == 1
    assert "The job is failed: " in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("words", "given", "status", "said"),
    [
        (["submit", "-"], "{", 2, "line 1, column 2"),
        (["submit", "-"], "[]", 2, "a study is a JSON object"),
        (["submit", "-"], '{"wheels": 4}', 2, "/study/wheels"),
        (["submit", "-", "--priority", "1000"], "{}", 2, "/priority"),
        (["submit", "-", "--kind", "magic"], "{}", 2, "--kind"),
        (["submit", "none.json"], "", 1, "cannot be read"),
        (["watch", "none"], "", 1, "There is no job none"),
        (["cancel", "none"], "", 1, "There is no job none"),
        (["jobs", "--server", "http://127.0.0.1:1"], "", 1, "trainbridge serve"),
        (["watch", "a", "--server", "http://127.0.0.1:1"], "", 1, "trainbridge serve"),
        (["jobs", "--server", "nowhere"], "", 1, "is not a server's address"),
    ],
    ids=str,
)
def test_what_cannot_be_done_is_said_in_a_line(
    server: Client, words: list[str], given: str, status: int, said: str
) -> None:
    refused = refused_here(*words, given=given, **place_of(server))
    assert refused.returncode == status, refused.stderr
    assert said in refused.stderr
    assert "Traceback" not in refused.stderr


def test_a_wrong_token_is_said(server: Client) -> None:
    refused = trainbridge("jobs", "--server", f"http://127.0.0.1:{server.port}")
    assert refused.returncode == 1
    assert "TRAINBRIDGE_TOKEN" in refused.stderr


def test_the_settings_are_printed(tmp_path: Path) -> None:
    file = tmp_path / "settings.toml"
    file.write_text("quota_bytes = 5")
    variables = {"TRAINBRIDGE_TOKEN": TOKEN, "TRAINBRIDGE_PORT": "1234"}
    shown = json.loads(trainbridge("config", "--json", "--config", str(file), **variables).stdout)
    by_name = {item["name"]: item for item in shown}
    assert by_name["port"]["value"] == "1234"
    assert by_name["port"]["source"] == "variable TRAINBRIDGE_PORT"
    assert by_name["quota_bytes"]["source"] == f"file {file}"
    assert "limits.runs_per_job" in by_name
    table = refused_here("config", **variables)
    assert TOKEN not in table.stdout + json.dumps(shown)
    assert len(table.stdout.splitlines()) >= len(shown)
    refused = refused_here("config", TRAINBRIDGE_PROT="1")
    assert refused.returncode == 1
    assert "Did you mean TRAINBRIDGE_PORT" in refused.stderr


def test_a_worker_needs_a_scheduler_that_is_safe() -> None:
    refused = refused_here("worker")
    assert refused.returncode == 1
    assert "--scheduler" in refused.stderr
    refused = refused_here("worker", "--scheduler", "tcp://10.1.2.3:8786")
    assert refused.returncode == 1
    assert "any" in refused.stderr
    assert "tls://" in refused.stderr


@pytest.mark.slow
def test_only_what_no_job_refers_to_is_cleaned_away(tmp_path: Path) -> None:
    settings = settings_for(tmp_path)
    orphan = settings.data / "runs" / "0123456789abcdef" / "001"
    words = ("clean", "--data", str(settings.data))
    nowhere = trainbridge(*words)
    assert nowhere.returncode == 1
    assert "no database" in nowhere.stderr
    with serving(settings) as server:
        job = ended(server, submit(server, short_study())["id"])
        kept = settings.data / "runs" / job["runs"][0]["id"] / "001"
        orphan.mkdir(parents=True)
        (orphan / "values").write_bytes(bytes(1000))
        (settings.data / "mine.txt").write_text("not the store's")
        # While the server runs: without --yes, nothing goes.
        for options in ((), ("--dry-run", "--yes")):
            listed = trainbridge(*words, *options)
            assert listed.returncode == 0, listed.stderr
            assert "0123456789abcdef" in listed.stdout
            assert "Would remove 1 items, 1,000 B" in listed.stdout
            assert orphan.exists()
        removed = trainbridge(*words, "--yes")
        assert "Removed 1 items, 1,000 B" in removed.stdout
        assert not orphan.exists()
        assert kept.exists()
        assert (settings.data / "mine.txt").exists()
        assert server.get(f"/api/v1/runs/{job['runs'][0]['id']}/channels").status_code == 200


@pytest.mark.slow
def test_a_store_of_another_database_is_not_cleaned(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path / "ours")) as server:
        ended(server, submit(server, short_study())["id"])
    with serving(settings_for(tmp_path / "other")):
        pass
    store = tmp_path / "ours" / "data"
    data = tmp_path / "other" / "data"
    refused = trainbridge("clean", "--data", str(data), "--store", str(store), "--yes")
    assert refused.returncode == 1
    assert "Nothing was removed" in refused.stderr
    assert list((store / "runs").iterdir())


@pytest.mark.slow
def test_an_old_database_is_migrated(tmp_path: Path) -> None:
    settings = settings_for(tmp_path)
    words = ("migrate", "--data", str(settings.data))
    nothing = trainbridge(*words)
    assert nothing.returncode == 1
    assert "nothing to migrate" in nothing.stderr
    with serving(settings):
        busy = trainbridge(*words)
        assert busy.returncode == 1
        assert "Traceback" not in busy.stderr
    done = trainbridge(*words)
    assert done.returncode == 0, done.stderr
    assert "already" in done.stdout
