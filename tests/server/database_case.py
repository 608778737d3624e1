"""What the tests of the database share: jobs, a decision about their state, runs that end."""

from __future__ import annotations

import secrets
import sqlite3
import tempfile
from collections.abc import Iterable
from contextlib import closing
from functools import cache
from pathlib import Path
from typing import Any

from server.store import BatchRecord, Database, JobDecision, JobRecord, JobView, NewJob

LIMIT = 1000


@cache
def _migrated() -> bytes:
    """A new SQLite database as the migrations leave it."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "new.sqlite"
        Database(file).close()
        return file.read_bytes()


def lay_database(file: Path) -> None:
    """A new SQLite database, copied: one that is migrated takes thirty milliseconds of every test.

    What migrations do to new and old databases is the matter of test_database_schema.
    """
    file.write_bytes(_migrated())
    with closing(sqlite3.connect(file)) as connection, connection:
        # No two databases have the same.
        connection.execute("UPDATE installation SET id = ?", (secrets.token_hex(16),))


def new_job(runs: int = 1, **changes: Any) -> NewJob:
    """A job of some runs."""
    values: dict[str, Any] = {
        "kind": "crossing",
        "name": "KHST",
        "study": {"name": "KHST"},
        "runs": [{"speed": 50.0 + index} for index in range(runs)],
        "steps": 100 * runs,
    }
    return NewJob(**{**values, **changes})


def add(database: Database, runs: int = 1, **changes: Any) -> JobRecord:
    """Adds a job."""
    return database.add_job(new_job(runs, **changes), queued_limit=LIMIT)[0]


def decide(view: JobView) -> JobDecision:
    """Done when every run is; a gather comes after the last run."""
    states = set(view.runs)
    if states <= {"queued"}:
        return JobDecision(state="queued")
    if states & {"queued", "running"}:
        return JobDecision(state="running")
    if view.cancel_requested:
        return JobDecision(state="cancelled")
    if view.wants_gather and view.gather != "done":
        return JobDecision(state="running", insert_gather=view.gather is None)
    return JobDecision(state=next(iter(states - {"done"}), "done"))


def start(database: Database, batch: BatchRecord) -> BatchRecord:
    """Starts a batch that can be started."""
    started = database.start_batch(batch)
    assert started is not None
    return started


def end(
    database: Database, batch: BatchRecord, state: str = "done", error: str | None = None
) -> bool:
    """Ends a running batch and all its runs."""
    values = {"state": state, "error": error, "verdicts": [{"rule": "deck"}]}
    runs = {run.id: values for run in batch.runs}
    return database.change_batch(batch, values={"state": "done"}, runs=runs, decide=decide)


def compute(database: Database, state: str = "done", *, limit: int = LIMIT) -> int:
    """Starts and ends everything that is eligible, once; how many batches."""
    batches = database.queued_batches(limit)
    for batch in batches:
        end(database, start(database, batch), state)
    return len(batches)


def names(batches: Iterable[BatchRecord]) -> list[tuple[str, str]]:
    """Job and purpose of batches."""
    return [(batch.job, batch.purpose) for batch in batches]
