"""What routes read: lists, places in the queue, repeated requests, on both databases."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from sqlalchemy import event

from server.store import (
    Database,
    DatabaseUrlError,
    JobFilter,
    KeyReusedError,
    NewEvent,
    QueueFullError,
)
from tests.server.database_case import LIMIT, add, compute, end, new_job, start


class Clock:
    """A clock that tests set."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    """At 0."""
    return Clock()


@pytest.fixture
def database(migrated_url: str, clock: Clock, open_database: Callable[..., Database]) -> Database:
    """An empty database."""
    return open_database(migrated_url, clock=clock)


def test_a_filter_finds_jobs_and_pages_follow_each_other(database: Database, clock: Clock) -> None:
    jobs: list[str] = []
    for index, name in enumerate(["KHST 50%", "ICE", "khst 60", "TGV"]):
        clock.now = 10.0 * index
        kind = "modes" if name == "ICE" else "crossing"
        jobs.append(add(database, name=name, kind=kind, source=jobs[0] if index == 3 else None).id)
    compute(database, limit=1)

    def found(limit: int = 50, before: int | None = None, **wanted: Any) -> list[int]:
        records = database.jobs(JobFilter(**wanted), limit, before)
        return [jobs.index(record.id) for record in records]

    assert found() == [3, 2, 1, 0]
    assert found(states=["done"]) == [0]
    assert found(states=["done", "queued"], kind="crossing") == [3, 2, 0]
    assert found(name="khst") == [2, 0]
    # A percent sign stands for itself.
    assert found(name="0%") == [0]
    assert found(created_from=10.0, created_to=30.0) == [2, 1]
    assert found(source=jobs[0]) == [3]
    first = database.jobs(JobFilter(kind="crossing"), 2)
    assert found(2, first[-1].sequence, kind="crossing") == [0]


def test_runs_of_a_job_are_paged_in_the_order_of_the_sweep(database: Database) -> None:
    job = add(database, runs=12)
    assert [run.parameters["speed"] for run in database.runs(job.id)] == [
        50.0 + index for index in range(12)
    ]
    assert [run.index for run in database.runs(job.id, after=9)] == [10, 11]
    assert [run.index for run in database.runs(job.id, after=3, limit=2)] == [4, 5]
    compute(database, limit=1)
    assert [run.index for run in database.runs(job.id, states=["done", "failed"])] == [0]


def test_the_same_key_gives_the_same_job(database: Database) -> None:
    submission = new_job(key="k", body_digest="1")
    first, new = database.add_job(submission, queued_limit=1)
    assert new
    # The queue is full by now: what was accepted before needs no place.
    assert database.add_job(submission, queued_limit=1) == (first, False)
    with pytest.raises(KeyReusedError, match=first.id):
        database.add_job(new_job(key="k", body_digest="2"), queued_limit=LIMIT)
    with pytest.raises(QueueFullError, match="1 jobs"):
        database.add_job(new_job(), queued_limit=1)
    assert len(database.jobs()) == 1


def test_a_job_keeps_all_that_was_submitted(database: Database) -> None:
    source = add(database)
    job = add(
        database,
        name="a\0b",
        steps=10**12,
        disk_bytes=10**13,
        priority=-3,
        source=source.id,
        wants_gather=True,
        model="m" * 32,
    )
    found = database.job(job.id)
    assert found == job
    assert found is not None
    assert (found.steps, found.disk_bytes, found.priority) == (10**12, 10**13, -3)
    assert (found.source, found.wants_gather, found.model) == (source.id, True, "m" * 32)
    # PostgreSQL stores no NUL in a text: both store a sign.
    assert found.name == "a\N{REPLACEMENT CHARACTER}b"
    assert database.reserved_bytes() == 10**13


def test_the_place_in_the_queue_and_the_steps_before_it(database: Database) -> None:
    running = add(database, runs=4, steps=400)
    low, job = add(database, priority=-1, steps=7), add(database, steps=50)
    urgent = add(database, priority=3, steps=1000)
    assert [database.position(item) for item in (urgent, running, job, low)] == [0, 1, 2, 3]
    database.set_priority(running.id, 4)
    batches = database.queued_batches(2)
    started = [start(database, batch) for batch in batches]
    run = started[0].runs[0].id
    database.record({(run, 1): {"step": 30}}, [])
    end(database, started[1])
    # One of four runs is done, one has 70 of 100 steps left, two wait and go first.
    assert database.steps_before(urgent) == 270
    assert database.steps_before(job) == 1270
    assert database.position(job) == 1
    # A run that computes goes on, even where the job's others wait behind this one.
    database.set_priority(running.id, -5)
    assert database.steps_before(job) == 1070


def test_what_is_read_together_is_of_one_moment(
    database: Database, migrated_url: str, open_database: Callable[..., Database]
) -> None:
    """A job that begins while the steps before another one are counted: it is still waiting."""
    add(database, runs=2, steps=200)
    job, coordinator = add(database, steps=50), open_database(migrated_url)
    left = iter(range(2))

    def begin_meanwhile(*_: Any) -> None:
        if next(left, None) == 1:  # The jobs that have begun were looked for; their runs come next.
            start(coordinator, coordinator.queued_batches(1)[0])

    event.listen(database.engine, "after_cursor_execute", begin_meanwhile)
    assert database.steps_before(job) == 200
    assert next(left, None) is None
    assert database.steps_before(job) == 200
    assert database.runs(database.jobs()[1].id)[0].state == "running"


def test_the_log_of_a_job_is_its_newest_lines_in_order(database: Database) -> None:
    job, other = add(database), add(database)
    lines = [NewEvent(job=job.id, kind="log", data={"text": str(index)}) for index in range(5)]
    noise = [NewEvent(job=job.id, kind="progress"), NewEvent(job=other.id, kind="log")]
    database.record({}, [*lines, *noise])
    assert [event.data["text"] for event in database.log_of(job.id, 2)] == ["3", "4"]
    assert [event.kind for event in database.log_of(job.id)] == ["state", *["log"] * 5]
    last = database.last_event()
    assert database.events_after(last) == []
    assert len(database.events_after(0, jobs=[other.id])) == 2


@pytest.mark.parametrize(
    "url", ["mysql://user:secret@host/name", "sqlite://", "postgresql://a:secret@b:c/d", "x://"]
)
def test_another_kind_of_database_is_refused_without_telling_its_password(url: str) -> None:
    with pytest.raises(DatabaseUrlError, match="postgresql://user:password@host/name") as caught:
        Database(url)
    assert "secret" not in str(caught.value)
