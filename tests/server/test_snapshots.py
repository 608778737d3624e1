"""The API's answers stay as the page knows them.

``pytest tests/server/test_snapshots.py --update-snapshots`` writes ``tests/js/snapshots`` anew
where an answer changed; tests/js and tests/browser read these files as the API's answers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from server.settings import Limits
from solver import studies
from tests.server.server_case import Client, beam_study, ended, serving, settings_for, submit, until
from tests.server.snapshot_batches import compute_as_named
from tests.server.snapshots import (
    FOLDER,
    Snapshot,
    differences,
    normalised,
    read,
    spoken,
    text,
)

ROOT = "/api/v1"
ENDING_ODDLY = ("failed", "out_of_memory", "cancelled", "running", "queued")
POINTS = "points=80"
"""Enough to see a curve's shape, few enough to read a change of its file."""


@dataclass
class Studio:
    """A server with a job of every kind and state, and names for what it identifies by chance."""

    client: Client
    names: dict[str, str] = field(default_factory=dict[str, str])

    def add(self, name: str, study: dict[str, Any], **parts: Any) -> str:
        """Submits a job; itself and its runs are called by its name henceforth."""
        job = submit(self.client, {**study, "name": f"{study['name']}, {name}"}, **parts)
        self.names[job["id"]] = f"job-{name}"
        for index, run in enumerate(job["runs"]):
            self.names[run["id"]] = f"run-{name}" + (f"-{index + 1}" if index else "")
        return job["id"]

    def ask(self, method: str, path: str, body: Any = None) -> Snapshot:
        """Asks for what has a label in braces, and gives the answer with labels in it."""
        asked, told = path, path
        for identifier, label in self.names.items():
            asked = asked.replace(f"{{{label}}}", identifier)
            told = told.replace(f"{{{label}}}", spoken(label))
        answer = self.client.request(method, ROOT + asked, json=body)
        names = {identifier: spoken(label) for identifier, label in self.names.items()}
        return Snapshot(
            method=method,
            path=ROOT + told,
            status=answer.status_code,
            answer=normalised(answer.json(), names),
        )


def _study() -> dict[str, Any]:
    """A run of some tenths of a second."""
    study = beam_study()
    study["integration"]["time_step"] = 1e-3
    study["name"] = "Sprung mass"
    return study


@pytest.fixture(scope="module")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    """Beams only: seconds."""
    folder = tmp_path_factory.mktemp("server")
    names = _timed_out(folder)
    settings = settings_for(folder, limits=Limits(batch_bytes=250_000_000))
    with serving(settings, compute=compute_as_named) as client:
        studio = Studio(client, names)
        done = studio.add("done", _study())
        sweep = studio.add("sweep", {**_study(), "sweep": {"speeds": [20.0, 25.0, 30.0]}})
        modes = studio.add("modes", _study(), kind="modes")
        for job in (done, sweep, modes):
            assert ended(client, job)["state"] == "done"
        jobs = {state: studio.add(state, _study()) for state in ENDING_ODDLY}
        _bring_about(client, jobs)
        yield studio
        for state in ("queued", "running"):
            client.post(f"/api/v1/jobs/{jobs[state]}/cancel")


def _timed_out(folder: Path) -> dict[str, str]:
    """A job that took too long, on a server of its own: others need their time."""
    with serving(
        settings_for(folder, limits=Limits(batch_seconds=0.3)), compute=compute_as_named
    ) as client:
        while True:
            studio = Studio(client)
            job = ended(client, studio.add("timed_out", _study()))
            assert job["state"] == "timed_out"
            if job["progress"]:
                return studio.names
            # On a busy machine its time is over before it has told of its first step.
            client.delete(f"/api/v1/jobs/{job['id']}")


def _bring_about(client: Client, jobs: dict[str, str]) -> None:
    """Waits until each job is in the state of its name, and cancels the one that has to be."""

    def stepping(state: str) -> None:
        path = f"jobs/{jobs[state]}"
        until(lambda: client.json(path)["progress"], lambda progress: progress and progress["step"])

    stepping("cancelled")
    client.post(f"/api/v1/jobs/{jobs['cancelled']}/cancel")
    for state in ("failed", "out_of_memory", "cancelled"):
        assert ended(client, jobs[state])["state"] == state
    stepping("running")
    assert client.json(f"jobs/{jobs['queued']}")["state"] == "queued"


@pytest.fixture
def check(request: pytest.FixtureRequest) -> Callable[[str, Snapshot], None]:
    """Compares an answer with its file, or writes it where that is asked for."""
    update = request.config.getoption("--update-snapshots")

    def compare(name: str, found: Snapshot) -> None:
        file = FOLDER / f"{name}.json"
        if update and (not file.exists() or _changes(read(name), found)):
            FOLDER.mkdir(exist_ok=True)
            file.write_text(text(found), encoding="utf-8")
        assert file.exists(), f"{name}: never written. Run pytest with --update-snapshots."
        changes = _changes(read(name), found)
        words = "The page and its tests read this answer. If it is meant: --update-snapshots."
        assert changes == [], f"{name}: {words}"

    return compare


def _changes(kept: Snapshot, found: Snapshot) -> list[str]:
    requests = [(item.method, item.path, item.status) for item in (kept, found)]
    changed = [] if requests[0] == requests[1] else [f"is {requests[1]}, was {requests[0]}"]
    return changed + differences(kept.answer, found.answer)


FIGURES = ("slab-acceleration", "contact-force", "displacement", "vehicle-acceleration")
ANSWERS = {
    "meta": "/meta",
    "machine": "/machine",
    "templates": "/templates",
    "template": "/templates/sprung-mass-beam",
    "library": "/library",
    **{
        f"library-{kind}": f"/library/{kind}"
        for kind in ("trains", "viaducts", "tracks", "irregularities")
    },
    "library-item": "/library/trains/khst",
    "compare": "/compare?run={run-done}&run={run-sweep}",
    "compare-histories": "/compare/plots/histories.json?run={run-done}&run={run-sweep}"
    f"&channel=mid-span+1%2Fdisplacement&{POINTS}",
    "figure-speed-sweep": "/jobs/{job-sweep}/plots/speed-sweep.json",
    "figures-modes": "/runs/{run-modes}/plots",
    "jobs": "/jobs",
    **{
        f"job-{name}": f"/jobs/{{job-{name}}}"
        for name in (*ENDING_ODDLY, "timed_out", "done", "sweep", "modes")
    },
    "job-unknown": "/jobs/0000000000000000",
    "job-study": "/jobs/{job-done}/study",
    "job-verdicts": "/jobs/{job-done}/verdicts",
    "run-done": "/runs/{run-done}",
    "run-modes": "/runs/{run-modes}",
    "run-verdicts": "/runs/{run-done}/verdicts",
    "run-channels": "/runs/{run-done}/channels",
    "run-frames": "/runs/{run-done}/frames",
    "run-figures": "/runs/{run-done}/plots",
    "run-without-histories": "/runs/{run-failed}/plots/displacement.json",
    **{f"figure-{name}": f"/runs/{{run-done}}/plots/{name}.json?{POINTS}" for name in FIGURES},
}
"""Name of the file: what is asked."""


@pytest.mark.parametrize("name", ANSWERS)
def test_an_answer_is_as_the_page_knows_it(
    name: str, studio: Studio, check: Callable[[str, Snapshot], None]
) -> None:
    check(name, studio.ask("GET", ANSWERS[name]))


def test_a_study_that_can_run_is_reported_on(
    studio: Studio, check: Callable[[str, Snapshot], None]
) -> None:
    study = studies.to_json(studies.template("khst-alverca").study)
    body = {"kind": "crossing", "study": study}
    check("validate", studio.ask("POST", "/studies/validate", body))


def test_what_is_wrong_with_a_study_comes_by_pointer(
    studio: Studio, check: Callable[[str, Snapshot], None]
) -> None:
    study = _study()
    study["sweep"]["speeds"] = [-1.0]
    study["integration"]["alpha"] = 0.5
    check("problem-study", studio.ask("POST", "/jobs", {"study": study}))


JUDGED = {
    "job-judged": "/jobs/{job-judged}",
    "job-judged-verdicts": "/jobs/{job-judged}/verdicts",
    "run-judged": "/runs/{run-judged}",
    "run-judged-verdicts": "/runs/{run-judged}/verdicts",
    "run-judged-channels": "/runs/{run-judged}/channels",
    "run-judged-figures": "/runs/{run-judged}/plots",
    **{
        f"figure-judged-{name}": f"/runs/{{run-judged}}/plots/{name}.json?points=60"
        for name in (*FIGURES, "envelope", "spectrum", "slab-map")
    },
}
"""The same of a run that has a verdict."""


def _short_train() -> dict[str, Any]:
    """The KHST of five cars over the viaduct with a coarse step: a verdict in a quarter minute."""
    study = studies.to_json(studies.template("khst-alverca").study)
    power, motorised, passengers, *_ = study["train"]["consist"]
    study["train"]["consist"] = [power, motorised, passengers, motorised, power]
    study["integration"]["time_step"] = 1e-3
    study["extent"] = {"run_in": 30.0, "run_out": 1.0}
    return {**study, "name": "Five cars over the viaduct"}


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    """A run that was judged."""
    with serving(settings_for(tmp_path_factory.mktemp("judged"))) as client:
        studio = Studio(client)
        job = studio.add("judged", _short_train())
        assert ended(client, job, seconds=600.0)["state"] == "done"
        yield studio


@pytest.mark.slow
@pytest.mark.parametrize("name", JUDGED)
def test_a_verdict_is_as_the_page_knows_it(
    name: str, judged: Studio, check: Callable[[str, Snapshot], None]
) -> None:
    check(name, judged.ask("GET", JUDGED[name]))


def test_no_file_is_kept_that_no_test_writes() -> None:
    known = {*ANSWERS, "validate", "problem-study", *JUDGED}
    assert {file.stem for file in FOLDER.glob("*.json")} == known
