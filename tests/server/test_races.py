"""What happens at the same time: requests beside each other, and what they read being removed."""

from __future__ import annotations

import asyncio
import logging
import threading
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import httpx
import psycopg
import pytest
from sqlalchemy import text

from server.jobs import submission
from server.jobs.decisions import decide_job
from server.routes import events as events_module
from server.routes import runs as runs_module
from server.routes.changes import Changes
from server.routes.past_runs import PastRuns
from server.routes.service import Service
from server.store import (
    Database,
    EventRecord,
    JobRecord,
    RunReader,
    RunWriter,
    StoreError,
    open_place,
)
from server.viewer.colouring import SurfaceColours
from server.viewer.session import Sessions, ViewerLimits
from solver.results import Frame
from tests.server.database_case import add, decide
from tests.server.server_case import serving, settings_for, short_study, submit, until
from tests.server.store_case import make_plan, samples_of
from tests.server.viewer_small_runs import BeamRun

PATIENCE = 60.0
"""Only what is wrong takes so long. [s]"""


# Learning the study's fields.


def test_two_first_studies_do_not_parse_sources_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python 3.11 lets one of two threads fail that parse at once: the first two requests after a
    start, as a page sends them, met an internal error."""
    inside: list[int] = []
    both = threading.Event()

    def adapter(kind: Any) -> object:
        inside.append(1)
        if len(inside) > 1:
            both.set()
        elif not second.is_alive():
            second.start()
            both.wait(0.2)
        return object()

    submission._made_adapter.cache_clear()  # pyright: ignore[reportPrivateUsage]
    monkeypatch.setattr(submission, "TypeAdapter", adapter)
    second = threading.Thread(target=submission._adapter)  # pyright: ignore[reportPrivateUsage]
    try:
        submission._adapter()  # pyright: ignore[reportPrivateUsage]
        second.join(PATIENCE)
    finally:
        submission._made_adapter.cache_clear()  # pyright: ignore[reportPrivateUsage]
    assert inside == [1]


# Jobs that are removed between two looks.


@pytest.mark.parametrize("what", ["job", "run"])
def test_a_retry_of_what_is_removed_meanwhile_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    with serving(settings_for(tmp_path, coordinator=False)) as client:
        database = client.app.state.service.database
        job = submit(client, short_study())
        database.end_queued(job["id"], state="cancelled", decide=decide_job)
        look = database.runs_of

        def runs_of(jobs: Any) -> Any:
            database.request_delete(job["id"])
            database.remove_job(job["id"])
            return look(jobs)

        monkeypatch.setattr(database, "runs_of", runs_of)
        name = job["id"] if what == "job" else job["runs"][0]["id"]
        assert client.post(f"/api/v1/{what}s/{name}/retry").status_code == 404


# Requests that meet the coordinator while it acts.


@pytest.fixture
def database(migrated_url: str, open_database: Callable[..., Database]) -> Database:
    """An empty database of each kind."""
    return open_database(migrated_url)


@pytest.mark.parametrize("what", ["job", "run"])
def test_a_retry_that_is_cancelled_while_the_coordinator_looks_at_it_is_taken_back(
    database: Database, what: str
) -> None:
    job = add(database)
    database.end_queued(job.id, state="failed", decide=decide)
    (run,) = database.runs(job.id)
    asked = database.request_retry(job.id) if what == "job" else database.request_retry_run(run.id)
    requests = database.requests()
    assert asked
    assert requests.retry_jobs or requests.retry_runs
    assert database.request_cancel(job.id)
    assert database.requeue(job.id, run.id if what == "run" else None, decide=decide) == []
    assert [item.state for item in database.runs(job.id)] == ["failed"]


def test_a_job_is_retried_as_a_whole_though_one_of_its_runs_was_asked_for_before(
    database: Database,
) -> None:
    job = add(database, runs=2)
    database.end_queued(job.id, state="failed", decide=decide)
    first, second = database.runs(job.id)
    database.request_retry_run(first.id)
    assert database.requests().retry_runs == (first.id,)
    database.request_retry(job.id)
    assert database.requeue(job.id, first.id, decide=decide) == [first.id]
    assert database.requests().retry_jobs == (job.id,)
    assert database.requeue(job.id, decide=decide) == [second.id]


# Histories that are removed while they are sent.


@pytest.fixture
def reader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RunReader:
    """A stored run, sent two rows at a time."""
    plan = make_plan(200)
    writer = RunWriter(tmp_path / "run", plan)
    for sample in samples_of(plan):
        writer.append(sample)
    writer.seal()
    found = RunReader(tmp_path / "run")
    monkeypatch.setattr(Service, "open_reader", lambda *_: found)
    monkeypatch.setattr(runs_module, "_CSV_ROWS", 2)
    return found


def removed_at(reader: RunReader, block: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Removes the run just before one of its blocks is read."""
    read, blocks = reader.channel_rows, [block]

    def rows(*arguments: Any) -> Any:
        blocks[0] -= 1
        if blocks[0] == 0:
            open_place(reader.place.url).remove()
        return read(*arguments)

    monkeypatch.setattr(reader, "channel_rows", rows)


CSV = "/api/v1/runs/a/channels/wheel 00 right/contact force.csv"


def test_histories_that_are_gone_before_they_are_sent_are_a_conflict(
    tmp_path: Path, reader: RunReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    with serving(settings_for(tmp_path, coordinator=False)) as client:
        whole = client.get(CSV)
        assert whole.status_code == 200
        assert len(whole.text.splitlines()) == 1 + reader.plan.n_sample
        removed_at(reader, 1, monkeypatch)
        assert client.get(CSV).status_code == 409


def test_histories_that_are_removed_while_they_are_sent_break_off_without_a_stack_of_calls(
    tmp_path: Path,
    reader: RunReader,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    with serving(settings_for(tmp_path, coordinator=False)) as client:
        removed_at(reader, 3, monkeypatch)
        with caplog.at_level(logging.WARNING), pytest.raises(httpx.RemoteProtocolError):
            client.get(CSV)
    assert not [record for record in caplog.records if record.exc_info]
    assert any("breaks off" in record.message for record in caplog.records)


# What several threads read of one run.


def test_a_reader_of_two_threads_takes_no_growing_run_for_a_removed_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The thread that draws a view and a request about it read together: the one that had asked
    first found less than the other had seen, and the view ended."""
    plan = make_plan(200)
    writer, reader = RunWriter(tmp_path, plan), RunReader(tmp_path)
    samples = samples_of(plan)

    def grow() -> None:
        for _ in range(50):
            writer.append(next(samples))
        writer.flush()

    grow()
    ask, others = reader._commit, [grow, reader.times]  # pyright: ignore[reportPrivateUsage]

    def asked_first() -> Any:
        found = ask()
        while others:
            others.pop(0)()
        return found

    monkeypatch.setattr(reader, "_commit", asked_first)
    assert len(reader.times()) == 50
    assert len(reader.times()) == 100


def test_two_threads_that_ask_for_colours_get_the_range_of_both() -> None:
    """A greatest value that one had found was lost to the other's smaller one, for good."""
    inside: list[int] = []
    both = threading.Event()

    class Read(BeamRun):
        def frame(self, index: int, **_: Any) -> Frame:
            inside.append(index)
            if len(inside) > 1:
                both.set()
            elif not second.is_alive():
                second.start()
                both.wait(0.2)
                assert inside == [index]
            return super().frame(index)

    colours = SurfaceColours(Read())
    second = threading.Thread(target=colours.bar, args=("displacement",))
    colours.bar("displacement")
    second.join(PATIENCE)
    assert len(inside) == len(set(inside))


def test_a_view_outlives_a_store_that_does_not_answer_for_a_while(
    caplog: pytest.LogCaptureFixture,
) -> None:
    """An object store far away; what was asked for meanwhile is shown afterwards."""
    away, refused = threading.Event(), threading.Semaphore(0)

    class Remote(BeamRun):
        def frame(self, index: int, **_: Any) -> Frame:
            if away.is_set():
                refused.release()
                raise StoreError("the store does not answer")
            return super().frame(index)

    sessions = Sessions(ViewerLimits())
    session = sessions.open("run", Remote(), "light")
    shown = session.player._picture  # pyright: ignore[reportPrivateUsage]
    away.set()
    with session.watched():
        sessions.change(session, time=0.3, playing=True, rate=1e-9)
        for _ in range(2):
            assert refused.acquire(timeout=PATIENCE)
        away.clear()
        until(lambda: session.player._picture, lambda now: now is not shown)  # pyright: ignore[reportPrivateUsage]
        assert not session.ended
    sessions.close_all()
    told = [record.levelname for record in caplog.records if record.name == "trainbridge.viewer"]
    assert told == ["WARNING"]


# Events, estimates and a database that takes no writes.


def test_events_that_wait_for_a_listener_are_sent_in_one_piece(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One by one they were all written to a listener who had left, and each said so in the log."""
    stored = [
        EventRecord(id=number, job="a", run="b", kind="progress", data={}, time=0.0)
        for number in range(1, 101)
    ]

    async def scenario() -> list[str]:
        changes = Changes()
        changes.bind()

        def after(last: int, *, jobs: Any) -> list[EventRecord]:
            changes.ended = True
            return stored[last:]

        service: Any = SimpleNamespace(
            changes=changes,
            database=SimpleNamespace(events_after=after),
            settings=SimpleNamespace(heartbeat_seconds=PATIENCE),
        )
        return [piece async for piece in events_module._events(service, ("a",), 0)]  # pyright: ignore[reportPrivateUsage]

    def told(service: Any, jobs: Any, last: int) -> str:
        return "".join(f"event: job {job} {last}\n\n" for job in jobs)

    monkeypatch.setattr(events_module, "_snapshots", told)
    pieces = asyncio.run(scenario())
    assert [piece.count("event: progress") for piece in pieces if "progress" in piece] == [100]
    assert next(piece for piece in pieces if "event: job" in piece) == "event: job a 0\n\n"


def test_a_stream_of_a_quiet_job_is_heard_of_while_others_are_busy() -> None:
    """Each change of another job began its silence anew: proxies cut it, and it never ended."""

    async def scenario() -> str:
        changes = Changes()
        changes.bind()

        def after(*_: Any, **__: Any) -> list[EventRecord]:
            changes.notify()
            return []

        service: Any = SimpleNamespace(
            changes=changes,
            database=SimpleNamespace(events_after=after, job=lambda _: None, runs_of=lambda _: {}),
            settings=SimpleNamespace(heartbeat_seconds=0.05),
        )
        async with asyncio.timeout(PATIENCE):
            pieces = [piece async for piece in events_module._events(service, ("a",), 0)]  # pyright: ignore[reportPrivateUsage]
        return pieces[-1]

    assert asyncio.run(scenario()).startswith(": ")


def test_a_database_that_does_not_answer_is_waited_for_side_by_side(tmp_path: Path) -> None:
    """Each template's estimate asks it; one after the other they waited minutes."""
    meeting = threading.Barrier(2)

    class Slow:
        def jobs(self, *_: Any, **__: Any) -> list[JobRecord]:
            meeting.wait(PATIENCE)
            return []

    past = PastRuns(Slow(), open_place(tmp_path))  # type: ignore[arg-type]
    both = at_once(lambda: past._measured("crossing"), 2)  # pyright: ignore[reportPrivateUsage]
    assert both == [[], []]


def at_once(work: Callable[[], Any], times: int) -> list[Any]:
    """What several threads get."""
    found, failed = list[Any](), list[Exception]()

    def do() -> None:
        try:
            found.append(work())
        except Exception as error:
            failed.append(error)

    threads = [threading.Thread(target=do) for _ in range(times)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE)
    assert not failed
    return found


def test_a_transaction_that_the_database_has_ended_answers_503(
    tmp_path: Path, postgresql_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """PostgreSQL ends one that is silent for long, as on a machine that was asleep: an internal
    error, as it calls that."""
    settings = settings_for(tmp_path, coordinator=False, database=postgresql_url)
    with serving(settings) as client:
        job = submit(client, short_study())["id"]
        database = client.app.state.service.database
        look = database.job

        def sleepy(name: str) -> Any:
            with database._read() as session:
                session.execute(text("SET idle_in_transaction_session_timeout = 1"))
                process = session.scalar(text("SELECT pg_backend_pid()"))
                until(lambda: is_connected(postgresql_url, process), lambda alive: not alive)
                session.execute(text("SELECT 1"))
            return look(name)

        monkeypatch.setattr(database, "job", sleepy)
        answer = client.get(f"/api/v1/jobs/{job}")
        assert answer.status_code == 503, answer.text
        monkeypatch.undo()
        assert client.json(f"jobs/{job}")["state"] == "queued"


def is_connected(url: str, process: int) -> bool:
    """Whether a process of the database still serves somebody."""
    with psycopg.connect(url, autocommit=True) as connection:
        query = "SELECT 1 FROM pg_stat_activity WHERE pid = %s"
        return connection.execute(query, (process,)).fetchone() is not None
