"""A database that is locked, full, gone and back: nothing is half done, nothing hangs."""

from __future__ import annotations

import sqlite3
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from sqlalchemy import text
from sqlalchemy.exc import OperationalError

from server.store import (
    AdvisoryLock,
    Database,
    DatabaseUrlError,
    JobDecision,
    JobView,
    LockHeldError,
    NewEvent,
    sessions,
)
from server.store.sessions import take_right_to_write
from tests.server.database_case import add, end, new_job, start
from tests.server.postgresql_server import PostgresqlServer

BUSY = 0.2
BOUND = 30.0
"""Far beyond what four times ``BUSY`` takes on a busy machine, below four waits of the usual ten
seconds each. [s]"""


Open = Callable[..., Database]


@pytest.fixture
def database(migrated_url: str, open_database: Open) -> Database:
    """An empty database with little patience."""
    return open_database(migrated_url, busy_seconds=BUSY)


@contextmanager
def writing(database: Database) -> Iterator[None]:
    """Someone else who writes and does not come to an end."""
    connection = database.engine.connect().execution_options(immediate=True)
    with connection, connection.begin():
        take_right_to_write(connection)
        yield


def kill_connections(database: Database) -> int:
    """Ends all connections to a PostgreSQL database but the one that asks."""
    with database.engine.connect() as connection:
        ended = connection.execute(
            text(
                "SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity "
                "WHERE datname = current_database() AND pid <> pg_backend_pid()"
            )
        )
        return len(ended.all())


@pytest.mark.slow
def test_a_locked_database_is_told_in_time_and_nothing_is_half_done(
    database: Database, migrated_url: str, open_database: Open
) -> None:
    job = add(database)
    (batch,) = database.queued_batches(1)
    other = open_database(migrated_url)
    with writing(other):
        began = time.monotonic()
        for write in (
            lambda: add(database, runs=20),
            lambda: database.start_batch(batch),
            lambda: database.request_cancel(job.id),
            lambda: database.record({}, [NewEvent(job=job.id, kind="log")]),
        ):
            with pytest.raises(OperationalError):
                write()
        assert time.monotonic() - began < BOUND
        # Who only reads waits for nobody.
        assert [item.id for item in database.jobs()] == [job.id]
    assert database.known_jobs() == {job.id}
    assert database.last_event() == 1
    assert database.start_batch(batch) is not None


def test_what_fails_in_the_middle_leaves_no_trace(database: Database) -> None:
    job = add(database)
    batch = start(database, database.queued_batches(1)[0])
    before = database.last_event()

    def fail(_view: JobView) -> JobDecision:
        raise RuntimeError("no decision")

    runs = {batch.runs[0].id: {"state": "done"}}
    with pytest.raises(RuntimeError):
        database.change_batch(batch, values={"state": "done"}, runs=runs, decide=fail)
    assert database.batch(batch.id) == batch
    assert database.runs(job.id)[0].state == "running"
    assert database.last_event() == before
    assert end(database, batch)


def test_a_full_disk_is_told_and_nothing_is_half_done(tmp_path: Path, open_database: Open) -> None:
    database = open_database(tmp_path / "trainbridge.sqlite")
    job = add(database)

    def allow(pages: int) -> None:
        with database.engine.connect() as connection:
            connection.exec_driver_sql(f"PRAGMA max_page_count = {pages}")

    allow(1)  # SQLite takes what is there already for the least.
    with pytest.raises(OperationalError, match="full"):
        database.add_job(new_job(500, study={"text": "x" * 100_000}), queued_limit=9)
    assert database.known_jobs() == {job.id}
    allow(10_000)
    database.add_job(new_job(500, study={"text": "x" * 100_000}), queued_limit=9)
    assert len(database.known_runs()) == 501


def test_events_are_numbered_in_the_order_in_which_they_are_committed(
    database_url: str, open_database: Open
) -> None:
    """A reader that remembers the last number it saw misses none of two writers' events."""
    writers = [open_database(database_url) for _ in range(2)]
    reader = open_database(database_url)
    jobs = [add(writers[0]).id, add(writers[0]).id]
    seen = reader.last_event()
    first = seen
    count = 60

    def write(index: int) -> None:
        for number in range(count):
            event = NewEvent(job=jobs[index], kind="log", data={"number": number})
            writers[index].record({}, [event, event])

    threads = [threading.Thread(target=write, args=(index,)) for index in range(2)]
    for thread in threads:
        thread.start()
    found: list[int] = []
    while True:
        writes = any(thread.is_alive() for thread in threads)
        events = reader.events_after(seen, limit=10_000)
        found += [event.id for event in events]
        seen = events[-1].id if events else seen
        if not writes and not events:
            break
    assert found == [event.id for event in reader.events_after(first, limit=10_000)]
    assert len(found) == 4 * count


def test_a_number_is_given_only_after_the_smaller_ones_are_committed(
    database: Database, migrated_url: str, open_database: Open
) -> None:
    """The same without chance: while one writer holds a number, no other gets the next."""
    job = add(database)
    other = open_database(migrated_url)
    with writing(other), pytest.raises(OperationalError):
        database.record({}, [NewEvent(job=job.id, kind="log")])


@pytest.mark.slow
def test_many_that_open_a_new_database_at_once(
    tmp_path: Path, database_url: str, open_database: Open
) -> None:
    # Again and again for SQLite: in a loop it turned one of six away in every fifth file, but not
    # every time; the next test is about what follows.
    urls = [database_url]
    if "://" not in database_url:
        urls += [str(tmp_path / f"{number}.sqlite") for number in range(15)]
    for url in urls:
        together = threading.Barrier(6)
        opened: list[Database] = []

        def open_it(
            url: str = url,
            together: threading.Barrier = together,
            opened: list[Database] = opened,
        ) -> None:
            together.wait()
            opened.append(open_database(url))

        threads = [threading.Thread(target=open_it) for _ in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(240)
        assert len(opened) == 6
        add(opened[0])
        assert len(opened[-1].jobs()) == 1


def test_who_is_turned_away_from_a_new_file_looks_again() -> None:
    """SQLite does so in the moment in which another connection begins the write-ahead log."""

    class Cursor:
        refusals = 3

        def execute(self, statement: str) -> None:
            assert statement == "PRAGMA journal_mode=WAL"
            self.refusals -= 1
            if self.refusals >= 0:
                raise sqlite3.OperationalError("database is locked")

    sessions._use_write_ahead_log(Cursor(), 5.0)
    with pytest.raises(sqlite3.OperationalError, match="locked"):
        sessions._use_write_ahead_log(Cursor(), 0.0)


def test_after_lost_connections_the_next_call_works(
    postgresql_url: str, open_database: Open
) -> None:
    database, killer = open_database(postgresql_url), open_database(postgresql_url)
    job = add(database)
    batch = start(database, database.queued_batches(1)[0])
    assert kill_connections(killer) > 0
    assert database.job(job.id) is not None
    before = database.last_event()

    def lose(_view: JobView) -> JobDecision:
        assert kill_connections(killer) > 0
        return JobDecision(state="done")

    runs = {batch.runs[0].id: {"state": "done"}}
    with pytest.raises(OperationalError):
        database.change_batch(batch, values={"state": "done"}, runs=runs, decide=lose)
    assert database.batch(batch.id) == batch
    assert database.last_event() == before
    assert end(database, batch)


def test_a_server_that_is_gone_and_comes_back(
    postgresql_url: str, postgresql: PostgresqlServer, open_database: Open
) -> None:
    database = open_database(postgresql_url)
    job = add(database)
    lock = AdvisoryLock(database)
    postgresql.stop()
    try:
        began = time.monotonic()
        with pytest.raises(OperationalError):
            database.jobs()
        with pytest.raises(OperationalError):
            add(database)
        with pytest.raises(OperationalError):
            open_database(postgresql_url)
        assert not lock.held()
        assert time.monotonic() - began < BOUND
    finally:
        postgresql.start()
    assert [item.id for item in database.jobs()] == [job.id]
    # The lock died with its connection: it is not taken again in silence.
    assert not lock.held()
    with AdvisoryLock(database) as anew:
        assert anew.held()


def test_one_coordinator_holds_the_lock_until_its_connection_ends(
    postgresql_url: str, open_database: Open
) -> None:
    database, other = open_database(postgresql_url), open_database(postgresql_url)
    lock = AdvisoryLock(database)
    assert lock.held()
    with pytest.raises(LockHeldError, match=r"127\.0\.0\.1.*Stop it"):
        AdvisoryLock(other)
    # Writers are not held up by it.
    add(other)
    lock.release()
    lock.release()
    assert not lock.held()
    with AdvisoryLock(other) as second:
        with pytest.raises(LockHeldError):
            AdvisoryLock(database)
        kill_connections(database)
        assert not second.held()
        with AdvisoryLock(database) as third:
            assert third.held()


def test_a_lock_is_of_one_database(
    postgresql_url: str, postgresql: PostgresqlServer, tmp_path: Path, open_database: Open
) -> None:
    elsewhere = postgresql.new_database()
    first, second = open_database(postgresql_url), open_database(elsewhere)
    with AdvisoryLock(first), AdvisoryLock(second) as other:
        assert other.held()
    postgresql.drop(elsewhere)
    local = open_database(tmp_path / "trainbridge.sqlite")
    with pytest.raises(DatabaseUrlError, match="PostgreSQL"):
        AdvisoryLock(local)
