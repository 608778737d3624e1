"""Jobs, batches, runs and events in a SQL database: the truth of the queue.

SQLite with a write-ahead log and ``synchronous=FULL``: what was answered with 202 survives a power
cut. Each method is one transaction. Only the coordinator changes states; routes add jobs and ask
for cancellation.
"""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sqlalchemy import Engine, create_engine, delete, event, func, select, update
from sqlalchemy.orm import Session

from server.store.models import (
    SCHEMA_VERSION,
    BatchRow,
    EventRow,
    JobRow,
    RunRow,
    SchemaRow,
    Table,
)
from server.store.records import (
    BatchRecord,
    EventRecord,
    JobRecord,
    NewEvent,
    RunRecord,
    batch_record,
    event_record,
    job_record,
    run_record,
)

__all__ = ["Database", "QueueFullError", "SchemaVersionError"]


class SchemaVersionError(Exception):
    """The database was written by another version; the text says what to do."""


class QueueFullError(Exception):
    """As many jobs wait as the server accepts."""


class Database:
    """The metadata of one data folder."""

    def __init__(self, path: Path, *, clock: Callable[[], float] = time.time) -> None:
        """Opens or creates the database.

        Raises:
            SchemaVersionError: It belongs to another version of this program.
        """
        self._clock = clock
        self._engine = _open(path)
        self._require_schema()

    def close(self) -> None:
        """Closes every connection."""
        self._engine.dispose()

    # Jobs, as routes see them.

    def add_job(
        self,
        *,
        kind: str,
        name: str,
        study: Mapping[str, Any],
        runs: Sequence[Mapping[str, float]],
        steps: int,
        queued_limit: int,
    ) -> JobRecord:
        """Adds a job with all its runs, one batch a run.

        Raises:
            QueueFullError: ``queued_limit`` jobs are waiting.
        """
        job = JobRow(
            id=_new_id(),
            kind=kind,
            name=name,
            study=dict(study),
            state="queued",
            steps=steps,
            created=self._clock(),
        )
        with self._write() as session:
            waiting = select(func.count()).select_from(JobRow).where(JobRow.state == "queued")
            count = session.scalar(waiting) or 0
            if count >= queued_limit:
                raise QueueFullError(f"{count} jobs are waiting already.")
            session.add(job)
            session.flush()
            batches = [BatchRow(id=_new_id(), job=job.id, state="queued") for _ in runs]
            session.add_all(batches)
            session.flush()
            session.add_all(
                RunRow(
                    id=_new_id(),
                    job=job.id,
                    batch=batch.id,
                    index=index,
                    state="queued",
                    parameters=dict(parameters),
                    progress={},
                    verdicts=None,
                )
                for index, (batch, parameters) in enumerate(zip(batches, runs, strict=True))
            )
            session.add(self._event(NewEvent(job=job.id, kind="state", data={"state": "queued"})))
            session.flush()
            return job_record(job)

    def job(self, job: str) -> JobRecord | None:
        """A job, or None."""
        with self._read() as session:
            row = session.scalar(select(JobRow).where(JobRow.id == job))
            return None if row is None else job_record(row)

    def jobs(
        self, *, limit: int, before: int | None = None, state: str | None = None
    ) -> list[JobRecord]:
        """The newest jobs, those before a sequence number if one is given."""
        query = select(JobRow).order_by(JobRow.sequence.desc()).limit(limit)
        if before is not None:
            query = query.where(JobRow.sequence < before)
        if state is not None:
            query = query.where(JobRow.state == state)
        with self._read() as session:
            return [job_record(row) for row in session.scalars(query)]

    def runs_of(self, jobs: Iterable[str]) -> dict[str, list[RunRecord]]:
        """The runs of each job, in the order of its sweep."""
        wanted = list(jobs)
        query = select(RunRow).where(RunRow.job.in_(wanted)).order_by(RunRow.sequence)
        found: dict[str, list[RunRecord]] = {job: [] for job in wanted}
        with self._read() as session:
            for row in session.scalars(query):
                found[row.job].append(run_record(row))
        return found

    def run(self, run: str) -> RunRecord | None:
        """A run, or None."""
        with self._read() as session:
            row = session.scalar(select(RunRow).where(RunRow.id == run))
            return None if row is None else run_record(row)

    def request_cancel(self, job: str) -> bool:
        """Notes that a job shall be cancelled; False where there is no such job."""
        with self._write() as session:
            row = session.scalar(select(JobRow).where(JobRow.id == job))
            if row is None:
                return False
            row.cancel_requested = True
            return True

    def events_after(
        self, last: int, *, jobs: Sequence[str] = (), limit: int = 500
    ) -> list[EventRecord]:
        """Events with greater numbers than ``last``, of these jobs or of all."""
        query = select(EventRow).where(EventRow.id > last).order_by(EventRow.id).limit(limit)
        if jobs:
            query = query.where(EventRow.job.in_(list(jobs)))
        with self._read() as session:
            return [event_record(row) for row in session.scalars(query)]

    def last_event(self) -> int:
        """Number of the newest event, 0 for none."""
        with self._read() as session:
            return session.scalar(select(func.max(EventRow.id))) or 0

    # What the coordinator does.

    def queued_batches(self, limit: int) -> list[BatchRecord]:
        """The batches that wait, oldest first."""
        query = (
            select(BatchRow)
            .where(BatchRow.state == "queued")
            .order_by(BatchRow.sequence)
            .limit(limit)
        )
        with self._read() as session:
            return [self._batch(session, row) for row in session.scalars(query).all()]

    def running_batches(self) -> list[BatchRecord]:
        """The batches that were started and have not ended."""
        query = select(BatchRow).where(BatchRow.state == "running").order_by(BatchRow.sequence)
        with self._read() as session:
            return [self._batch(session, row) for row in session.scalars(query).all()]

    def batch(self, batch: str) -> BatchRecord:
        """A batch.

        Raises:
            LookupError: There is none.
        """
        with self._read() as session:
            row = session.scalar(select(BatchRow).where(BatchRow.id == batch))
            if row is None:
                raise LookupError(f"there is no batch {batch}")
            return self._batch(session, row)

    def cancel_requests(self) -> list[str]:
        """Jobs that shall be cancelled and have not ended."""
        query = select(JobRow.id).where(
            JobRow.cancel_requested, JobRow.state.in_(["queued", "running"])
        )
        with self._read() as session:
            return list(session.scalars(query))

    def queued_batches_of(self, job: str) -> list[BatchRecord]:
        """The batches of a job that wait."""
        query = select(BatchRow).where(BatchRow.job == job, BatchRow.state == "queued")
        with self._read() as session:
            return [self._batch(session, row) for row in session.scalars(query).all()]

    def change_batch(
        self,
        batch: BatchRecord,
        *,
        state: str,
        attempt: int,
        runs: Mapping[str, Mapping[str, Any]],
        job_state: Callable[[list[str]], str],
    ) -> bool:
        """Moves a batch, its runs and its job to new states, all or none.

        Args:
            batch: The batch as it was when its attempt began: every update carries its attempt.
            state: The batch's new state.
            attempt: The batch's new attempt.
            runs: New values of columns, by run.
            job_state: The job's state from those of all its runs.

        Returns:
            False where the batch belongs to another attempt by now: nothing was changed.
        """
        with self._write() as session:
            changed = session.execute(
                update(BatchRow)
                .where(BatchRow.id == batch.id, BatchRow.attempt == batch.attempt)
                .values(state=state, attempt=attempt)
                .returning(BatchRow.id)
            ).all()
            if not changed:
                return False
            for run, values in runs.items():
                change = update(RunRow).where(RunRow.id == run)
                session.execute(change.values(attempt=attempt, **values))
                told = {"state": values["state"], "attempt": attempt}
                event = NewEvent(job=batch.job, run=run, kind="state", data=told)
                session.add(self._event(event))
            self._settle_job(session, batch.job, job_state)
            return True

    def _settle_job(
        self, session: Session, job: str, job_state: Callable[[list[str]], str]
    ) -> None:
        row = session.scalars(select(JobRow).where(JobRow.id == job)).one()
        runs = session.scalars(
            select(RunRow).where(RunRow.job == job).order_by(RunRow.sequence)
        ).all()
        state = job_state([run.state for run in runs])
        if row.state == state:
            return
        row.state = state
        now = self._clock()
        if row.started is None and any(run.started is not None for run in runs):
            row.started = now
        ended = all(run.ended is not None for run in runs)
        row.ended = now if ended else None
        row.error = next((run.error for run in runs if run.error), None) if ended else None
        session.add(self._event(NewEvent(job=job, kind="state", data={"state": state})))

    def record(
        self,
        progress: Mapping[tuple[str, int], Mapping[str, Any]],
        events: Sequence[NewEvent],
    ) -> None:
        """Stores the newest progress of runs, by (run, attempt), and appends events."""
        with self._write() as session:
            for (run, attempt), values in progress.items():
                session.execute(
                    update(RunRow)
                    .where(RunRow.id == run, RunRow.attempt == attempt)
                    .values(progress=dict(values))
                )
            session.add_all([self._event(item) for item in events])

    def drop_old_progress(self, before: float) -> None:
        """Forgets progress events from before a time: results and states say what they said."""
        with self._write() as session:
            session.execute(
                delete(EventRow).where(EventRow.kind == "progress", EventRow.time < before)
            )

    def position(self, job: JobRecord) -> int:
        """Jobs that wait before this one."""
        query = (
            select(func.count())
            .select_from(JobRow)
            .where(JobRow.state == "queued", JobRow.sequence < job.sequence)
        )
        with self._read() as session:
            return session.scalar(query) or 0

    # Sessions.

    @contextmanager
    def _write(self) -> Generator[Session]:
        connection = self._engine.connect().execution_options(immediate=True)
        with connection, Session(connection, expire_on_commit=False) as session, session.begin():
            yield session

    @contextmanager
    def _read(self) -> Generator[Session]:
        with Session(self._engine, expire_on_commit=False) as session:
            yield session

    def _batch(self, session: Session, row: BatchRow) -> BatchRecord:
        runs = session.scalars(
            select(RunRow).where(RunRow.batch == row.id).order_by(RunRow.sequence)
        )
        job = session.scalars(select(JobRow).where(JobRow.id == row.job)).one()
        return batch_record(row, job, runs)

    def _event(self, item: NewEvent) -> EventRow:
        return EventRow(
            job=item.job, run=item.run, kind=item.kind, data=dict(item.data), time=self._clock()
        )

    def _require_schema(self) -> None:
        Table.metadata.create_all(self._engine)
        with self._write() as session:
            version = session.scalar(select(SchemaRow.version))
            if version is None:
                session.add(SchemaRow(version=SCHEMA_VERSION))
            elif version != SCHEMA_VERSION:
                raise SchemaVersionError(
                    f"The data folder holds a database of schema {version}; this version of "
                    f"trainbridge reads schema {SCHEMA_VERSION}. Use another --data folder, or the "
                    "version of trainbridge that wrote it."
                )


def _new_id() -> str:
    return secrets.token_hex(8)


def _open(path: Path) -> Engine:
    engine = create_engine(f"sqlite:///{path}", connect_args={"timeout": 10.0})

    @event.listens_for(engine, "connect")
    def prepare(connection: Any, _record: Any) -> None:
        # The driver's own transactions begin late and cannot be made to write at once: we begin.
        connection.isolation_level = None
        cursor = connection.cursor()
        for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
            cursor.execute(f"PRAGMA {pragma}")
        cursor.close()

    @event.listens_for(engine, "begin")
    def begin(connection: Any) -> None:
        # A writer that began as a reader could find the database changed under it.
        immediate = connection.get_execution_options().get("immediate", False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if immediate else "BEGIN")

    return engine
