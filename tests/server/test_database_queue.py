"""The queue's transactions, on SQLite and on PostgreSQL."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest
from sqlalchemy import event, insert
from sqlalchemy.exc import IntegrityError

from server.store import BatchRecord, Database, NewEvent, Requests
from server.store.models import BatchRow
from tests.server.database_case import add, compute, decide, end, names, new_job, start

Open = Callable[..., Database]


@pytest.fixture
def database(migrated_url: str, open_database: Open) -> Database:
    """An empty database."""
    return open_database(migrated_url, clock=lambda: 1000.0)


def told(database: Database, job: str) -> list[tuple[bool, str, int | None]]:
    """The state events of a job: whether of a run, the state, the attempt."""
    return [
        (event.run is not None, event.data["state"], event.data.get("attempt"))
        for event in database.events_after(0, jobs=[job])
        if event.kind == "state"
    ]


def test_a_run_from_the_queue_to_its_end(database: Database) -> None:
    job = add(database)
    (batch,) = database.queued_batches(5)
    started = start(database, batch)
    assert (started.state, started.attempt, started.runs[0].state) == ("running", 1, "running")
    assert database.queued_batches(5) == []
    assert names(database.running_batches()) == [(job.id, "runs")]
    assert end(database, started)
    found = database.job(job.id)
    assert found is not None
    assert (found.state, found.started, found.ended, found.error) == ("done", 1000.0, 1000.0, None)
    (run,) = database.runs(job.id)
    assert (run.state, run.attempt, run.ended) == ("done", 1, 1000.0)
    assert run.verdicts == [{"rule": "deck"}]
    assert told(database, job.id) == [
        (False, "queued", None),
        (True, "running", 1),
        (False, "running", None),
        (True, "done", 1),
        (False, "done", None),
    ]


def test_a_batch_is_started_once(database: Database) -> None:
    add(database)
    (batch,) = database.queued_batches(1)
    assert database.start_batch(batch) is not None
    assert database.start_batch(batch) is None


def test_what_an_older_attempt_tells_changes_nothing(database: Database) -> None:
    job = add(database)
    first = start(database, database.queued_batches(1)[0])
    run = first.runs[0].id
    lost = {run: {"state": "queued"}}
    assert database.change_batch(first, values={"state": "queued"}, runs=lost, decide=decide)
    second = start(database, database.queued_batches(1)[0])
    assert second.attempt == 2
    before = database.last_event()
    assert not end(database, first, "failed")
    assert not database.note_checkpoint(first, 9)
    database.record({(run, 1): {"step": 99}}, [])
    (record,) = database.runs(job.id)
    assert (record.state, record.attempt, record.progress) == ("running", 2, {})
    assert database.last_event() == before
    database.record({(run, 2): {"step": 7}}, [])
    assert database.runs(job.id)[0].progress == {"step": 7}


def test_a_run_that_has_ended_is_never_changed(database: Database) -> None:
    job = add(database, runs=2)
    first, second = (start(database, batch) for batch in database.queued_batches(2))
    end(database, first, "failed", "diverged\0 at 3 s")
    ended = first.runs[0].id
    changes = {ended: {"state": "done"}, second.runs[0].id: {"state": "done"}}
    assert database.change_batch(second, values={"state": "done"}, runs=changes, decide=decide)
    assert [run.state for run in database.runs(job.id)] == ["failed", "done"]
    found = database.job(job.id)
    assert found is not None
    # PostgreSQL stores no NUL: it is shown as a sign on both.
    assert found.error == "diverged\N{REPLACEMENT CHARACTER} at 3 s"


def test_batches_come_by_priority_then_purpose_then_age(database: Database) -> None:
    gathering = add(database, wants_gather=True)
    compute(database)
    old, urgent = add(database), add(database, priority=5)
    prepared = add(database, runs=2, model="m")
    assert names(database.queued_batches(9)) == [
        (urgent.id, "runs"),
        (gathering.id, "gather"),
        (prepared.id, "prepare"),
        (old.id, "runs"),
    ]
    assert database.set_priority(old.id, 9)
    assert names(database.queued_batches(1)) == [(old.id, "runs")]


def test_runs_wait_for_the_model_that_they_share(database: Database) -> None:
    job, other = add(database, runs=2, model="m"), add(database, model="m")
    prepare, elsewhere = database.queued_batches(9)
    assert (prepare.purpose, prepare.model, prepare.runs) == ("prepare", "m", ())
    started = start(database, prepare)
    # Another job needs the same model: nobody makes it twice at once.
    assert database.queued_batches(9) == []
    assert database.start_batch(elsewhere) is None
    database.change_batch(started, values={"state": "done"}, runs={}, decide=decide)
    assert names(database.queued_batches(9)) == [
        (other.id, "prepare"),
        (job.id, "runs"),
        (job.id, "runs"),
    ]


def test_the_last_runs_end_at_once_and_one_gather_follows(
    migrated_url: str, open_database: Open
) -> None:
    first, second = open_database(migrated_url), open_database(migrated_url)
    for _ in range(5):
        job = add(first, runs=2, wants_gather=True)
        batches = [start(first, batch) for batch in first.queued_batches(2)]
        together = threading.Barrier(2)

        def finish(
            database: Database, batch: BatchRecord, together: threading.Barrier = together
        ) -> None:
            together.wait()
            end(database, batch)

        threads = [
            threading.Thread(target=finish, args=(database, batch))
            for database, batch in zip((first, second), batches, strict=True)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(240)
        assert names(second.queued_batches(9)) == [(job.id, "gather")]
        gather = start(first, second.queued_batches(9)[0])
        assert second.change_batch(gather, values={"state": "done"}, runs={}, decide=decide)
        assert [record.state for record in first.jobs(limit=1)] == ["done"]
        assert len(first.batches_of(job.id, "done")) == 3


def test_the_tables_themselves_refuse_a_second_gather(database: Database) -> None:
    job = add(database, wants_gather=True)
    compute(database)
    again = {"job": job.id, "state": "queued", "attempt": 0, "purpose": "gather", "generation": 0}
    with pytest.raises(IntegrityError), database.engine.begin() as connection:
        connection.execute(insert(BatchRow).values(id="second", **again))


def test_a_retry_where_nothing_failed_is_settled(database: Database) -> None:
    job = add(database)
    compute(database)
    before = database.job(job.id)
    assert database.request_retry(job.id)
    assert database.requests().retry_jobs == (job.id,)
    assert database.requeue(job.id, decide=decide) == []
    assert database.requests().retry_jobs == ()
    assert database.job(job.id) == before


def test_a_retry_of_a_job_that_is_being_cancelled_waits_for_its_end(database: Database) -> None:
    job = add(database)
    database.request_cancel(job.id)
    database.request_retry(job.id)
    assert database.requests().retry_jobs == ()
    ended = database.end_queued(job.id, state="cancelled", decide=decide)
    assert database.requests().retry_jobs == (job.id,)
    assert database.requeue(job.id, decide=decide) == ended
    assert names(database.queued_batches(9)) == [(job.id, "runs")]


def test_a_retry_waits_until_the_process_of_its_run_has_ended(database: Database) -> None:
    """Cancelled is written at once; the process has its grace time, and the user is quick."""
    jobs = [add(database), add(database)]
    batches = [start(database, batch) for batch in database.queued_batches(2)]
    for batch in batches:
        gone = {batch.runs[0].id: {"state": "cancelled"}}
        database.change_batch(batch, values={}, runs=gone, decide=decide)
    database.request_retry(jobs[0].id)
    database.request_retry_run(batches[1].runs[0].id)
    assert database.requests() == Requests()
    for batch in batches:
        database.change_batch(batch, values={"state": "done"}, runs={}, decide=decide)
    requests = database.requests()
    assert requests.retry_jobs == (jobs[0].id,)
    assert requests.retry_runs == (batches[1].runs[0].id,)


def test_a_retry_keeps_attempt_and_checkpoint_and_is_gathered_anew(database: Database) -> None:
    job = add(database, runs=2, wants_gather=True)
    good, bad = (start(database, batch) for batch in database.queued_batches(2))
    database.note_checkpoint(bad, 40)
    end(database, good)
    run = bad.runs[0].id
    values = {"state": "done", "deaths": 2}
    failed = {run: {"state": "failed", "error": "no"}}
    database.change_batch(bad, values=values, runs=failed, decide=decide)
    compute(database)
    assert database.request_retry_run(run)
    assert database.requests().retry_runs == (run,)
    assert database.requeue(job.id, run, decide=decide) == [run]
    assert database.requests().retry_runs == ()
    (batch,) = database.queued_batches(9)
    assert (batch.attempt, batch.deaths, batch.checkpoint_step) == (1, 0, 40)
    (again,) = batch.runs
    assert (again.state, again.error, again.ended, again.verdicts) == ("queued", None, None, None)
    found = database.job(job.id)
    assert found is not None
    assert (found.state, found.ended, found.error) == ("running", None, None)
    started = start(database, batch)
    assert started.attempt == 2
    # A run that lives is left as it is.
    assert database.request_retry_run(run)
    assert database.requeue(job.id, run, decide=decide) == []
    end(database, started)
    purposes = [item.purpose for item in database.batches_of(job.id)]
    assert purposes == ["runs", "runs", "gather", "gather"]


def test_hundreds_that_wait_are_ended_in_one_transaction(database: Database) -> None:
    job = add(database, runs=500, wants_gather=True, model="m")
    prepare = start(database, database.queued_batches(1)[0])
    database.change_batch(prepare, values={"state": "done"}, runs={}, decide=decide)
    running = start(database, database.queued_batches(1)[0])
    database.request_cancel(job.id)
    assert database.requests().cancel_jobs == (job.id,)
    assert len(database.end_queued(job.id, state="cancelled", decide=decide)) == 499
    states = [run.state for run in database.runs(job.id)]
    assert states == ["running", *["cancelled"] * 499]
    end(database, running, "cancelled")
    assert database.requests().cancel_jobs == ()
    assert database.end_queued(job.id, state="cancelled", decide=decide) == []
    events = database.events_after(0, jobs=[job.id], limit=5000)
    assert sum(event.data.get("state") == "cancelled" for event in events) == 501


def test_a_job_to_be_cancelled_is_not_started(database: Database) -> None:
    job = add(database)
    (batch,) = database.queued_batches(1)
    database.request_cancel(job.id)
    assert database.queued_batches(1) == []
    assert database.start_batch(batch) is None


def test_one_run_is_cancelled_and_its_job_goes_on(database: Database) -> None:
    job = add(database, runs=2)
    run = database.runs(job.id)[1].id
    assert database.request_cancel_run(run)
    assert not database.request_cancel_run("nothing")
    assert database.requests().cancel_runs == (run,)
    (batch,) = (item for item in database.queued_batches(9) if item.runs[0].id == run)
    gone = {run: {"state": "cancelled"}}
    database.change_batch(batch, values={"state": "cancelled"}, runs=gone, decide=decide)
    assert database.requests().cancel_runs == ()
    assert len(database.queued_batches(9)) == 1


def test_a_deleted_job_disappears_at_once_and_its_rows_later(database: Database) -> None:
    job = add(database, key="a", body_digest="1")
    run = database.runs(job.id)[0].id
    started = start(database, database.queued_batches(1)[0])
    assert database.request_delete(job.id)
    assert database.job(job.id) is None
    assert database.run(run) is None
    assert database.jobs() == []
    assert not database.request_retry(job.id)
    # It still computes: first it is cancelled.
    assert database.requests().cancel_jobs == (job.id,)
    assert database.requests().delete_jobs == ()
    database.remove_job(job.id)
    assert database.known_runs() == {run}
    end(database, started, "cancelled")
    assert database.requests().delete_jobs == (job.id,)
    database.remove_job(job.id)
    assert database.known_jobs() == database.known_runs() == set()
    assert database.events_after(0) == []
    # What comes late of it hinders nobody, and its key is free.
    other = add(database, key="a", body_digest="2")
    late = [NewEvent(job=job.id, kind="log"), NewEvent(job=other.id, kind="log")]
    database.record({(run, 1): {"step": 1}}, late)
    assert [event.kind for event in database.log_of(other.id)] == ["state", "log"]


@pytest.mark.slow
def test_retention_and_cleaning_know_what_is_needed(migrated_url: str, open_database: Open) -> None:
    now = [100.0]
    database = open_database(migrated_url, clock=lambda: now[0])
    old = add(database, model="m")
    while compute(database):
        pass
    now[0] = 200.0
    add(database)
    assert database.expired_jobs(150.0) == [old.id]
    assert database.expired_jobs(50.0) == []
    assert database.known_models() == {"m"}
    database.record({}, [NewEvent(job=old.id, kind="progress")])
    database.drop_old_progress(150.0)
    kinds = {event.kind for event in database.events_after(0)}
    assert kinds == {"state", "progress"}
    database.drop_old_progress(250.0)
    assert {event.kind for event in database.events_after(0)} == {"state"}


def test_hundreds_of_runs_are_added_and_dispatched_quickly(database: Database) -> None:
    statements: list[str] = []

    def note(_connection: object, _cursor: object, statement: str, *_rest: object) -> None:
        statements.append(statement)

    event.listen(database.engine, "before_cursor_execute", note)
    job, _ = database.add_job(new_job(500, study={"text": "x" * 50_000}), queued_limit=9)
    # Rows by the hundred, not one by one: 0.01 to 0.08 s on two cores busy with other things.
    assert len(statements) < 20
    statements.clear()
    assert len(database.queued_batches(2)) == 2
    assert len(database.batches_of(job.id)) == 500
    # Of each call: its batches, their jobs with the study once, their runs.
    assert sum(statement.startswith("SELECT") for statement in statements) == 6
