"""What fails around a run: the job says so and goes on, or fails cleanly; nothing else is touched.

Disk full, store read-only, database locked, database gone and back, memory, divergence, quota.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Generator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from server.settings import Limits, Settings
from server.store import Database, RunReader, attempt_place, open_place
from tests.server.outage_batches import AWAY, compute
from tests.server.postgresql_server import PostgresqlServer
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

pytestmark = pytest.mark.slow

BUSY_SECONDS = 1.0
"""Longest wait for the right to write, instead of ten seconds. [s]"""


def names_of(client: Client) -> dict[str, str]:
    """The state of each job, by name."""
    return {job["name"]: job["state"] for job in client.json("jobs")["items"]}


def stored(settings: Settings, run: str, attempt: int = 1) -> RunReader:
    """What an attempt has stored."""
    return RunReader(attempt_place(open_place(settings.data), run, attempt))


def assert_problem(answer: httpx.Response, status: int) -> dict[str, Any]:
    """An error in the one form that errors have."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    return answer.json()


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("disk full", ("no room left in the store", "trainbridge clean", "retry the job")),
        ("store read-only", ("cannot be written", "the right to write there", "retry the job")),
    ],
)
def test_a_store_that_refuses_ends_one_run_until_it_is_tried_again(
    tmp_path: Path, name: str, words: tuple[str, ...]
) -> None:
    settings = settings_for(tmp_path, concurrent_batches=2)
    runs = settings.data / "runs"
    with serving(settings, compute=compute) as client:
        earlier = ended(client, submit(client, short_study(name="earlier"))["id"])
        (settings.data / AWAY).touch()
        runs.chmod(0o555)
        refused = submit(client, short_study(name=name))["id"]
        beside = submit(client, short_study(name="beside"))["id"]
        assert ended(client, beside)["state"] == "done"
        job = ended(client, refused)
        assert job["state"] == "failed"
        for word in words:
            assert word in job["error"]["detail"]
        assert "unexpected" not in job["error"]["detail"]
        assert names_of(client) == {name: "failed", "beside": "done", "earlier": "done"}
        assert stored(settings, earlier["runs"][0]["id"]).done
        assert client.json("health")["status"] == "ok"
        (settings.data / AWAY).unlink()
        runs.chmod(0o755)
        assert client.post(f"/api/v1/jobs/{refused}/retry").status_code == 202
        again = until(lambda: client.json(f"jobs/{refused}"), lambda item: item["state"] == "done")
        [run] = again["runs"]
        assert (run["attempt"], run["error"]) == (2, None)
        assert stored(settings, run["id"], 2).done


def test_a_database_that_is_locked_delays_what_is_told_and_loses_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def open_database(settings: Settings) -> Database:
        return Database(settings.database_url, busy_seconds=BUSY_SECONDS)

    monkeypatch.setattr("server.app.open_database", open_database)
    settings = settings_for(tmp_path)
    with serving(settings) as client, closing(Database(settings.database_url)) as database:
        job = begun(client, settings)
        with locked(settings.data / "trainbridge.sqlite"):
            before = database.last_event()
            problem = assert_problem(
                client.post("/api/v1/jobs", json={"study": short_study()}), 503
            )
            assert "Try again" in problem["detail"]
            # Who only reads sees the job as it was.
            assert client.json(f"jobs/{job['id']}")["state"] == "running"
            until(lambda: stored(settings, job["runs"][0]["id"]).done, bool)
            assert database.last_event() == before
            assert client.json(f"jobs/{job['id']}")["state"] == "running"
        assert_whole(client, database, job["id"])
        assert ended(client, submit(client, short_study())["id"])["state"] == "done"


@contextmanager
def locked(file: Path) -> Generator[None]:
    """Somebody else writes to an SQLite database and does not end."""
    with closing(sqlite3.connect(file, timeout=120, isolation_level=None)) as connection:
        connection.execute("BEGIN IMMEDIATE")
        yield
        connection.execute("ROLLBACK")


def test_a_database_that_is_gone_and_back_loses_nothing(
    tmp_path: Path, postgresql_url: str, postgresql: PostgresqlServer
) -> None:
    settings = settings_for(tmp_path, database=postgresql_url)
    settings.data.mkdir()
    with serving(settings) as client, closing(Database(postgresql_url)) as database:
        job = begun(client, settings)
        postgresql.stop()
        try:
            problem = assert_problem(client.get(f"/api/v1/jobs/{job['id']}"), 503)
            assert "Try again" in problem["detail"]
            assert_problem(client.post("/api/v1/jobs", json={"study": short_study()}), 503)
            until(lambda: stored(settings, job["runs"][0]["id"]).done, bool)
        finally:
            postgresql.start()
        assert_whole(client, database, job["id"])
        assert ended(client, submit(client, short_study())["id"])["state"] == "done"


def begun(client: Client, settings: Settings) -> dict[str, Any]:
    """A job of a second or two that has taken some steps, most of them still to come."""
    study = beam_study()
    study["integration"]["time_step"] = 1e-4
    job = submit(client, study)
    until(
        lambda: client.json(f"jobs/{job['id']}")["progress"],
        lambda progress: progress is not None and progress["step"] > 0,
    )
    assert not stored(settings, job["runs"][0]["id"]).done
    return job


def assert_whole(client: Client, database: Database, job: str) -> None:
    """Done in the first attempt, and told to its last step, each state once."""
    found = ended(client, job)
    assert found["state"] == "done", found
    [run] = found["runs"]
    assert run["attempt"] == 1
    assert run["progress"]["step"] == run["progress"]["steps"] > 0
    events = database.events_after(0, jobs=(job,), limit=100_000)
    states = [event.data["state"] for event in events if event.kind == "state" and event.run]
    assert states == ["running", "done"]
    told = [event.data["step"] for event in events if event.kind == "progress"]
    assert told == sorted(told)
    assert told[-1] == run["progress"]["steps"]


def test_what_eats_memory_or_diverges_fails_alone(tmp_path: Path) -> None:
    settings = settings_for(
        tmp_path, concurrent_batches=2, limits=Limits(batch_bytes=600 * 1024 * 1024)
    )
    with serving(settings, compute=compute) as client:
        hungry = submit(client, short_study(name="hungry"))["id"]
        sweep = short_study(name="diverging", sweep={"speeds": [20.0, 25.0, 30.0]})
        diverging = submit(client, sweep)["id"]
        healthy = submit(client, short_study(name="healthy"))["id"]
        assert ended(client, healthy)["state"] == "done"
        job = ended(client, hungry)
        assert job["state"] == "out_of_memory"
        assert "629 MB" in job["error"]["detail"]
        job = ended(client, diverging)
        assert [run["state"] for run in job["runs"]] == ["done", "failed", "done"]
        assert "wheel 07 right" in job["runs"][1]["error"]["detail"]
        assert job["state"] == "failed"
        # What the others gave is brought together all the same.
        assert client.json(f"jobs/{diverging}/summary")["judged"] == 2
        runs = [run for item in client.json("jobs")["items"] for run in item["runs"]]
        assert {run["attempt"] for run in runs} == {1}
        assert client.json("health")["status"] == "ok"


def test_a_refusal_by_quota_touches_nothing_and_room_can_be_made(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path / "measure")) as client:
        report = client.post("/api/v1/studies/validate", json={"study": short_study()}).json()
    quota = int(1.5 * report["estimate"]["disk_bytes"])
    with serving(settings_for(tmp_path, quota_bytes=quota)) as client:
        first = submit(client, short_study(name="first"))["id"]
        problem = assert_problem(client.post("/api/v1/jobs", json={"study": short_study()}), 507)
        assert "quota_bytes" in problem["detail"]
        assert ended(client, first)["state"] == "done"
        assert names_of(client) == {"first": "done"}
        assert client.delete(f"/api/v1/jobs/{first}").status_code == 202
        body = {"study": short_study(name="second")}
        until(
            lambda: client.post("/api/v1/jobs", json=body).status_code,
            lambda status: status == 202,
        )
        second = client.json("jobs")["items"][0]["id"]
        assert ended(client, second)["state"] == "done"
        assert names_of(client) == {"second": "done"}
