"""What the API does with jobs beyond submitting them: keys, pages, requests, log, quota."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from server.jobs.gather import SUMMARY
from server.routes.documents import log_line
from server.routes.forecast import queue_rates
from server.settings import Limits
from server.store import EventRecord, JobRecord, attempt_place, job_place
from tests.server import odd_batches
from tests.server.server_case import (
    Client,
    beam_study,
    ended,
    serving,
    settings_for,
    short_study,
    submit,
    until,
)


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """Every run is done at once."""
    settings = settings_for(tmp_path_factory.mktemp("server"))
    with serving(settings, compute=odd_batches.finish) as client:
        yield client


@pytest.fixture(scope="module")
def busy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """The first job never ends, so that the others wait."""
    settings = settings_for(tmp_path_factory.mktemp("busy"))
    with serving(settings, compute=odd_batches.hang) as client:
        submit(client, short_study(name="in front"))
        until(lambda: client.json("jobs", state="running")["items"], lambda found: len(found) == 1)
        yield client


def post(client: Client, path: str, status: int, **parts: Any) -> Any:
    answer = client.post(f"/api/v1/{path}", **parts)
    assert answer.status_code == status, answer.text
    return answer.json()


def test_a_key_makes_one_job(client: Client) -> None:
    body = {"study": short_study(name="once"), "kind": "crossing"}
    key = {"Idempotency-Key": "a key of visible characters!"}
    answers = [client.post("/api/v1/jobs", json=body, headers=key) for _ in range(2)]
    assert [answer.status_code for answer in answers] == [422, 422]  # spaces are no key
    key = {"Idempotency-Key": "a-key-of-visible-characters!"}
    first = client.post("/api/v1/jobs", json=body, headers=key)
    # The same values in another order are the same body.
    again = client.post("/api/v1/jobs", json=dict(reversed(body.items())), headers=key)
    assert (first.status_code, again.status_code) == (202, 200)
    assert first.json()["id"] == again.json()["id"]
    assert first.headers["location"] == again.headers["location"]
    assert len(client.json("jobs", name="once")["items"]) == 1
    other = client.post("/api/v1/jobs", json={**body, "priority": 1}, headers=key)
    assert other.status_code == 422
    [finding] = other.json()["errors"]
    assert finding["pointer"] == "Idempotency-Key"
    assert "another body" in finding["reason"]


@pytest.mark.parametrize("key", ["", "k" * 201, "tab\there", "\u00fc".encode()])
def test_a_key_has_a_form(client: Client, key: str | bytes) -> None:
    headers = {"Idempotency-Key": key}
    answer = client.post("/api/v1/jobs", json={"study": short_study()}, headers=headers)  # type: ignore[arg-type]
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "Idempotency-Key"


@pytest.mark.slow
def test_a_key_outlives_a_queue_that_is_full(tmp_path: Path) -> None:
    settings = settings_for(tmp_path)
    settings = replace(settings, limits=replace(settings.limits, queued_jobs=1))
    with serving(settings, compute=odd_batches.hang) as client:
        running = submit(client, short_study())["id"]
        until(lambda: client.json(f"jobs/{running}")["state"], lambda state: state == "running")
        key = {"Idempotency-Key": "k"}
        waits = client.post("/api/v1/jobs", json={"study": short_study()}, headers=key)
        assert waits.status_code == 202
        assert client.post("/api/v1/jobs", json={"study": short_study()}).status_code == 503
        again = client.post("/api/v1/jobs", json={"study": short_study()}, headers=key)
        assert (again.status_code, again.json()["id"]) == (200, waits.json()["id"])


def test_pages_show_every_job_once(client: Client) -> None:
    made = [submit(client, short_study(name=f"page {index}"))["id"] for index in range(5)]
    seen: list[str] = []
    cursor: dict[str, Any] = {}
    while True:
        page = client.json("jobs", name="PAGE", limit=2, **cursor)
        assert len(page["items"]) <= 2
        seen += [item["id"] for item in page["items"]]
        if page["next"] is None:
            break
        # What is submitted meanwhile moves nothing.
        submit(client, short_study(name="page, later"))
        cursor = {"cursor": page["next"]}
    assert seen == made[::-1]


def test_filters_go_together(client: Client) -> None:
    first = submit(client, short_study(name="filter a"))
    second = submit(client, short_study(name="filter b"), kind="modes")
    for job in (first, second):
        ended(client, job["id"])

    def names(**wanted: Any) -> list[str]:
        return [item["name"] for item in client.json("jobs", **wanted)["items"]]

    assert names(name="filter") == ["filter b", "filter a"]
    assert names(name="filter", kind="modes") == ["filter b"]
    assert names(name="filter", state=["done", "failed"]) == ["filter b", "filter a"]
    assert names(name="filter", state="cancelled") == []
    assert names(name="filter", created_from=second["created"]) == ["filter b"]
    assert names(name="filter", created_to=second["created"]) == ["filter a"]
    assert names(name="filter", created_from="2000-01-01", created_to="2000-01-02") == []
    assert names(name="100%_") == []  # characters of a pattern are taken as they are


@pytest.mark.parametrize(
    "query",
    [
        "name=",
        "name=%00",
        "name=" + "n" * 201,
        "kind=A",
        "state=done&state=asleep",
        "created_from=yesterday",
        "created_to=99999-01-01",
    ],
)
def test_unusable_filters_are_pointed_at(client: Client, query: str) -> None:
    answer = client.get(f"/api/v1/jobs?{query}")
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == query.split("=")[0]


def test_priority_moves_a_job_in_the_queue(busy: Client) -> None:
    first, second, third = (
        submit(busy, short_study(name=name))["id"] for name in ("first", "second", "third")
    )
    before = [busy.json(f"jobs/{job}")["position"] for job in (first, second, third)]
    changed = busy.patch(f"/api/v1/jobs/{third}", json={"priority": 5})
    assert changed.status_code == 200
    assert changed.json()["priority"] == 5
    after = [busy.json(f"jobs/{job}")["position"] for job in (first, second, third)]
    assert before[2] - after[2] >= 2
    assert [a - b for a, b in zip(after, before, strict=True)][:2] == [1, 1]
    # Submitted with it, it counts at once.
    urgent = submit(busy, short_study(), priority=100)
    assert urgent["position"] == 0
    for wrong in ({"priority": 101}, {"priority": "1"}, {"priority": 1.5}, {"speed": 1}, {}):
        answer = busy.patch(f"/api/v1/jobs/{third}", json=wrong)
        assert answer.status_code == 422, wrong
    # Nobody knows the pace: nothing is done yet.
    assert busy.json(f"jobs/{third}")["estimated_start"] is None


def test_a_job_that_waits_can_be_deleted(busy: Client) -> None:
    job = submit(busy, short_study(name="unwanted"))
    assert busy.delete(f"/api/v1/jobs/{job['id']}").status_code == 202
    assert busy.get(f"/api/v1/jobs/{job['id']}").status_code == 404
    assert busy.get(f"/api/v1/runs/{job['runs'][0]['id']}").status_code == 404
    assert busy.json("jobs", name="unwanted")["items"] == []
    for method, path in (
        ("DELETE", ""),
        ("PATCH", ""),
        ("POST", "/cancel"),
        ("POST", "/retry"),
        ("POST", "/clone"),
    ):
        body = {"json": {"priority": 1}} if method == "PATCH" else {}
        answer = busy.request(method, f"/api/v1/jobs/{job['id']}{path}", **body)
        assert answer.status_code == 404


def test_a_job_that_runs_is_cancelled_and_deleted_with_its_files(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        study = beam_study()
        study["integration"]["time_step"] = 2e-5
        job = submit(client, study)
        folder = tmp_path / "data" / "runs" / job["runs"][0]["id"]
        until(folder.exists, bool)
        assert client.delete(f"/api/v1/jobs/{job['id']}").status_code == 202
        assert client.json("jobs")["items"] == []
        until(folder.exists, lambda there: not there)
        until(lambda: client.app.state.service.database.known_jobs(), lambda known: not known)


def test_a_clone_says_where_it_comes_from(client: Client) -> None:
    job = submit(client, short_study(name="source"), kind="modes", priority=7)
    ended(client, job["id"])
    answer = client.post(f"/api/v1/jobs/{job['id']}/clone")
    assert answer.status_code == 202
    clone = answer.json()
    assert answer.headers["location"] == f"/api/v1/jobs/{clone['id']}"
    assert clone["id"] != job["id"]
    assert (clone["source"], job["source"]) == (job["id"], None)
    assert [clone[key] for key in ("name", "kind", "priority")] == ["source", "modes", 7]
    studies = [client.json(f"jobs/{item['id']}/study") for item in (job, clone)]
    assert studies[0] == studies[1]
    ended(client, clone["id"])


def test_what_failed_is_retried_and_what_is_done_is_not(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path), compute=odd_batches.fail) as client:
        job = submit(client, short_study(sweep={"speeds": [20.0, 30.0]}))["id"]
        failed = ended(client, job)
        assert failed["state"] == "failed"
        assert [run["attempt"] for run in failed["runs"]] == [1, 1]
        again = post(client, f"jobs/{job}/retry", 202)
        assert again["state"] in ("queued", "running", "failed")
        until(
            lambda: [run["attempt"] for run in client.json(f"jobs/{job}")["runs"]],
            lambda attempts: attempts == [2, 2],
        )
        ended(client, job)
        run = failed["runs"][1]["id"]
        post(client, f"runs/{run}/retry", 202)
        until(
            lambda: [run["attempt"] for run in client.json(f"jobs/{job}")["runs"]],
            lambda attempts: attempts == [2, 3],
        )


def test_what_cannot_be_asked_for_now_is_a_conflict(client: Client, busy: Client) -> None:
    done = ended(client, submit(client, short_study())["id"])
    assert "Clone it" in post(client, f"jobs/{done['id']}/retry", 409)["detail"]
    assert "Clone its job" in post(client, f"runs/{done['runs'][0]['id']}/retry", 409)["detail"]
    answer = client.patch(f"/api/v1/jobs/{done['id']}", json={"priority": 1})
    assert answer.status_code == 409
    [running] = busy.json("jobs", state="running")["items"]
    assert "cancel it" in post(busy, f"jobs/{running['id']}/retry", 409)["detail"]
    post(busy, f"runs/{running['runs'][0]['id']}/retry", 409)
    # A summary is there when a sweep was gathered.
    answer = client.get(f"/api/v1/jobs/{done['id']}/summary")
    assert answer.status_code == 409
    assert "one run has none" in answer.json()["detail"]
    # That of before a retry is no summary of what computes now.
    job_place(busy.app.state.service.store, running["id"]).write(SUMMARY, b"{}")
    answer = busy.get(f"/api/v1/jobs/{running['id']}/summary")
    assert answer.status_code == 409
    assert "The job is running" in answer.json()["detail"]


def test_one_run_leaves_its_job(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path), compute=odd_batches.hang) as client:
        job = submit(client, short_study(sweep={"speeds": [20.0, 30.0]}))
        until(lambda: client.json(f"jobs/{job['id']}")["state"], lambda state: state == "running")
        first, second = (run["id"] for run in job["runs"])
        post(client, f"runs/{second}/cancel", 202)
        until(lambda: client.json(f"runs/{second}")["state"], lambda state: state == "cancelled")
        assert client.json(f"runs/{first}")["state"] in ("queued", "running")
        post(client, f"runs/{first}/cancel", 202)
        assert ended(client, job["id"])["state"] == "cancelled"


@pytest.mark.slow
def test_a_sweep_is_gathered_into_one_document(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        job = submit(client, short_study(sweep={"speeds": [20.0, 30.0]}))
        ended(client, job["id"])
        summary = client.json(f"jobs/{job['id']}/summary")
    assert [run["run"] for run in summary["runs"]] == [run["id"] for run in job["runs"]]
    assert [run["parameters"]["speed"] for run in summary["runs"]] == [20.0, 30.0]
    assert summary["judged"] == 2
    assert all(run["peaks"] for run in summary["runs"])


def test_the_log_has_a_line_for_each_thing_that_happened(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path), compute=odd_batches.fail) as client:
        job = submit(client, short_study(name="first\nsecond"))
        ended(client, job["id"])
        answer = client.get(f"/api/v1/jobs/{job['id']}/log")
    assert answer.headers["content-type"].startswith("text/plain")
    assert answer.headers["content-disposition"].startswith("attachment")
    lines = answer.text.splitlines()
    assert all(line.startswith("20") for line in lines)
    times = [line.split("  ")[0] for line in lines]
    assert times == sorted(times)
    run = job["runs"][0]["id"]
    states = [line.split("  ")[2].split(";")[0] for line in lines if f"run 0 ({run})" in line]
    assert [state for state in states if state in ("running", "failed")] == ["running", "failed"]
    assert any("  job  queued" in line for line in lines)


def test_the_log_keeps_what_can_be_read() -> None:
    text = "peak 3.5 m/s² \u2265 2,5 Brücke\nnext\u2028line\x1b[31m\ud800"
    entry = EventRecord(id=1, job="a", run=None, kind="log", time=0.0, data={"text": text})
    line = log_line(entry, {})
    assert "peak 3.5 m/s² \u2265 2,5 Brücke\\nnext\\u2028line\\x1b[31m\\ud800" in line
    assert len(line.splitlines()) == 1
    line.encode()


def test_the_description_tells_when_there_is_no_place(client: Client) -> None:
    paths = client.json("openapi.json")["paths"]
    for path in ("/jobs", "/jobs/{job_id}/clone"):
        assert {"503", "507"} <= set(paths[f"/api/v1{path}"]["post"]["responses"])


def test_a_quota_is_kept(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path, quota_bytes=1_000_000)) as client:
        answer = client.post("/api/v1/jobs", json={"study": beam_study()})
        assert answer.status_code == 507
        document = answer.json()
        assert answer.headers["content-type"] == "application/problem+json"
        [finding] = document["errors"]
        assert finding["pointer"] == "/study/outputs"
        assert "quota_bytes" in finding["reason"]
        assert "trainbridge clean" in finding["remedy"]
        assert client.json("jobs")["items"] == []
    estimate = disk_bytes(tmp_path)
    # Two fit while both still may need all of it, a third does not.
    settings = settings_for(tmp_path, quota_bytes=int(2.5 * estimate))
    with serving(settings, compute=odd_batches.hang) as client:
        for _ in range(2):
            submit(client, beam_study())
        assert client.post("/api/v1/jobs", json={"study": beam_study()}).status_code == 507
        [job, _] = client.json("jobs")["items"]
        post(client, f"jobs/{job['id']}/clone", 507)


def test_a_retry_keeps_the_quota(tmp_path: Path) -> None:
    estimate = disk_bytes(tmp_path)
    settings = settings_for(tmp_path, quota_bytes=int(1.5 * estimate))
    with serving(settings, compute=odd_batches.fail) as client:
        job = ended(client, submit(client, beam_study())["id"])
        store = client.app.state.service.store
        attempt_place(store, job["runs"][0]["id"], 1).write("much", bytes(int(0.8 * estimate)))
        post(client, f"jobs/{job['id']}/retry", 507)
        post(client, f"runs/{job['runs'][0]['id']}/retry", 507)
        assert client.json(f"jobs/{job['id']}")["state"] == "failed"


def test_frequencies_are_not_held_to_the_limits_of_a_crossing(tmp_path: Path) -> None:
    # A megabyte: room for 24 shapes of a beam, not for the histories of two crossings.
    fraction = 1e6 / shutil.disk_usage(tmp_path).free
    limits = Limits(runs_per_job=1, steps_per_job=1, disk_fraction=fraction)
    settings = settings_for(tmp_path, limits=limits, quota_bytes=2_000_000)
    with serving(settings, compute=odd_batches.finish) as client:
        study = beam_study(sweep={"speeds": [20.0, 30.0]})
        refused = post(client, "jobs", 422, json={"study": study})
        assert {item["pointer"] for item in refused["errors"]} == {
            "/study/sweep/speeds",
            "/study/integration/time_step",
            "/study/outputs/frame_interval",
        }
        job = submit(client, study, kind="modes")
        assert client.app.state.service.database.job(job["id"]).disk_bytes <= 1_000_000
        assert ended(client, job["id"])["state"] == "done"


def disk_bytes(folder: Path) -> float:
    with serving(settings_for(folder / "measure")) as client:
        report = client.post("/api/v1/studies/validate", json={"study": beam_study()}).json()
    return report["estimate"]["disk_bytes"]


@pytest.mark.slow
def test_an_attempt_that_resumes_shows_what_the_one_before_had(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        job = ended(client, submit(client, short_study())["id"])
        service = client.app.state.service
        run = service.run(job["runs"][0]["id"])
        resumed = replace(run, attempt=3, state="running")
        assert service.reader(resumed).plan.n_sample == service.reader(run).plan.n_sample
        # As soon as the new attempt has begun, it is shown.
        third = attempt_place(service.store, run.id, 3)
        shutil.copytree(attempt_place(service.store, run.id, 1).local, third.local)
        assert service.reader(resumed).place == third


def test_health_tells_whose_coordinator_it_is(client: Client, tmp_path: Path) -> None:
    here = {"status": "ok", "coordinator": "here", "trouble": None}
    assert client.json("health") == here
    with serving(settings_for(tmp_path, coordinator=False)) as alone:
        assert alone.json("health") == {**here, "coordinator": "elsewhere"}
        # Jobs are taken all the same: they wait for whoever coordinates.
        job = submit(alone, short_study())
        assert alone.json(f"jobs/{job['id']}")["state"] == "queued"


def test_health_tells_why_nothing_computes(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path), compute=odd_batches.finish) as client:
        service = client.app.state.service
        trouble = "No scheduler answers at tcp://127.0.0.1:1."
        client.app.state.service = replace(service, queue_trouble=lambda: trouble)
        assert client.json("health") == {
            "status": "ok",
            "coordinator": "here",
            "trouble": trouble,
        }


def record(started: float, ended: float, steps: int) -> JobRecord:
    return JobRecord(
        sequence=1,
        id="a",
        kind="crossing",
        name="a",
        study={},
        state="done",
        steps=steps,
        error=None,
        created=0.0,
        started=started,
        ended=ended,
    )


def test_the_pace_is_that_of_the_whole_queue() -> None:
    assert queue_rates([]) is None
    assert queue_rates([record(0.0, 10.0, 1000)]) == (100.0, 100.0)
    # Two at once: 2000 steps in 10 s; then one alone, half as fast.
    jobs = [record(0.0, 10.0, 1000), record(0.0, 10.0, 1000), record(20.0, 30.0, 1000)]
    low, high = queue_rates(jobs) or (0.0, 0.0)
    assert (low, high) == pytest.approx((3000 / 20, 3000 / 20), rel=0.5)
    assert low <= 3000 / 20 <= high


@pytest.mark.slow
def test_a_start_is_estimated_from_the_last_jobs(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        ended(client, submit(client, short_study())["id"])
        long = beam_study()
        long["integration"]["time_step"] = 2e-5
        submit(client, long)
        waits = submit(client, short_study())
        early, late = client.json(f"jobs/{waits['id']}")["estimated_start"]
        assert waits["created"] < early < late
