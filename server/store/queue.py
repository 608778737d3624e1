"""Batches through the queue: what the coordinator reads, and how it alone changes states.

Every change names the attempt that it belongs to; one that comes too late changes nothing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import (
    JSON,
    ColumnElement,
    and_,
    case,
    exists,
    or_,
    select,
    true,
    update,
)
from sqlalchemy.orm import Session, aliased

from server.store.event_log import EventLog
from server.store.models import LIVE, BatchRow, JobRow, RunRow
from server.store.records import BatchRecord, Decide, NewEvent, batch_record
from server.store.settling import settle_job

__all__ = ["Queue"]


class Queue(EventLog):
    """Batches that wait, run, end, and go back into the queue."""

    def queued_batches(self, limit: int) -> list[BatchRecord]:
        """The next batches that may start: by priority, what gathers and prepares first, age."""
        awaited = aliased(BatchRow)
        rank = case({"gather": 0, "prepare": 1}, value=BatchRow.purpose, else_=2)
        query = (
            select(BatchRow)
            .join(JobRow, JobRow.id == BatchRow.job)
            .outerjoin(awaited, awaited.id == BatchRow.waits_for)
            .where(
                BatchRow.state == "queued",
                or_(BatchRow.waits_for.is_(None), awaited.state == "done"),
                ~JobRow.cancel_requested,
                ~JobRow.delete_requested,
                ~_prepared_elsewhere(),
            )
            .order_by(JobRow.priority.desc(), rank, BatchRow.sequence)
            .limit(limit)
        )
        with self._read() as session:
            return _records(session, session.scalars(query).all())

    def running_batches(self) -> list[BatchRecord]:
        """The batches that were started and have not ended."""
        return self._batches(BatchRow.state == "running")

    def batches_of(self, job: str, state: str | None = None) -> list[BatchRecord]:
        """The batches of a job, of any purpose, in one state or in all."""
        return self._batches(
            BatchRow.job == job, true() if state is None else BatchRow.state == state
        )

    def batch(self, batch: str) -> BatchRecord:
        """A batch.

        Raises:
            LookupError: There is none.
        """
        found = self._batches(BatchRow.id == batch)
        if not found:
            raise LookupError(f"there is no batch {batch}")
        return found[0]

    def start_batch(self, batch: BatchRecord) -> BatchRecord | None:
        """Commits ``running`` with the next attempt, for the batch and those of its runs that live.

        Returns:
            The batch as its attempt begins; None where someone else moved it, where its job is to
            be cancelled or deleted, or where its model is being prepared for another job by now.
        """
        attempt, now = batch.attempt + 1, self._clock()
        wanted = exists().where(
            JobRow.id == BatchRow.job, ~JobRow.cancel_requested, ~JobRow.delete_requested
        )
        move = (
            update(BatchRow)
            .where(_is(batch), BatchRow.state == "queued", wanted, ~_prepared_elsewhere())
            .values(state="running", attempt=attempt)
            .returning(BatchRow.id)
            .execution_options(synchronize_session=False)
        )
        move_runs = (
            update(RunRow)
            .where(RunRow.batch == batch.id, RunRow.state.in_(LIVE))
            .values(state="running", attempt=attempt, started=now, progress={}, error=None)
            .returning(RunRow.id)
        )
        told = {"state": "running", "attempt": attempt}
        with self._write() as session:
            if not session.execute(move).all():
                return None
            moved = session.scalars(move_runs).all()
            events = [NewEvent(job=batch.job, run=run, kind="state", data=told) for run in moved]
            job = session.scalars(_locked(batch.job)).one()
            if job.state == "queued":
                job.state = "running"
                job.started = now if job.started is None else job.started
                events.append(NewEvent(job=job.id, kind="state", data={"state": "running"}))
            self._append(session, events)
            session.flush()
            session.expire_all()
            query = select(BatchRow).where(BatchRow.id == batch.id)
            return _records(session, session.scalars(query).all())[0]

    def change_batch(
        self,
        batch: BatchRecord,
        *,
        values: Mapping[str, Any],
        runs: Mapping[str, Mapping[str, Any]],
        decide: Decide,
    ) -> bool:
        """Moves a batch, runs of its job and the job to new states, all or none.

        Args:
            batch: The batch as its attempt began: every change carries its attempt.
            values: New values of columns of the batch.
            runs: New values of columns, by run; a run that has ended is never changed. ``ended`` is
                filled in where a state ends it.
            decide: The job's state, and whether its gather enters the queue now.

        Returns:
            False where the batch belongs to another attempt by now: nothing was changed.
        """
        with self._write() as session:
            if not _change(session, batch, values):
                return False
            events: list[NewEvent] = []
            for run, changes in runs.items():
                events += _change_run(session, batch.job, run, self._completed(changes))
            job = session.scalars(_locked(batch.job)).one()
            self._append(session, [*events, *settle_job(session, job, decide, self._clock())])
            return True

    def note_checkpoint(self, batch: BatchRecord, step: int) -> bool:
        """Notes that a batch can go on from a step, with an event of kind ``checkpoint``.

        Returns:
            False where the batch belongs to another attempt by now: nothing was changed.
        """
        told = {"batch": batch.id, "attempt": batch.attempt, "step": step}
        with self._write() as session:
            # What died before is forgotten: the batch got further.
            if not _change(session, batch, {"checkpoint_step": step, "deaths": 0}):
                return False
            self._append(session, [NewEvent(job=batch.job, kind="checkpoint", data=told)])
            return True

    def end_queued(
        self, job: str, *, state: str, decide: Decide, error: str | None = None
    ) -> list[str]:
        """Ends everything of a job that waits, in one transaction: hundreds of runs at once.

        Args:
            job: The job.
            state: What becomes of the runs that wait; their batches become ``cancelled``.
            decide: The job's state.
            error: Why, for people.

        Returns:
            The runs that were ended.
        """
        with self._write() as session:
            batches = session.scalars(
                update(BatchRow)
                .where(BatchRow.job == job, BatchRow.state == "queued")
                .values(state="cancelled")
                .returning(BatchRow.id)
            ).all()
            if not batches:
                return []
            changes = self._completed({"state": state, "error": error})
            waiting = and_(RunRow.batch == BatchRow.id, BatchRow.state == "cancelled")
            ended = session.execute(
                update(RunRow)
                .where(RunRow.job == job, RunRow.state.in_(LIVE), exists().where(waiting))
                .values(**changes)
                .returning(RunRow.id, RunRow.attempt)
                .execution_options(synchronize_session=False)
            ).all()
            events = [_state_event(job, run, attempt, changes) for run, attempt in ended]
            row = session.scalars(_locked(job)).one()
            self._append(session, [*events, *settle_job(session, row, decide, self._clock())])
            return [run for run, _ in ended]

    def requeue(self, job: str, run: str | None = None, *, decide: Decide) -> list[str]:
        """Puts what has ended back into the queue, where people asked for it and still do.

        Who cancels after a retry has taken it back. Attempts and checkpoints are kept, deaths are
        forgiven, and a new gather will follow. The request is settled, also where nothing can be
        put back.

        Args:
            job: The job.
            run: Which; None for all, where the whole job was asked for. One that lives, or whose
                batch is running, is left as it is.
            decide: The job's state.

        Returns:
            The runs that were put back.
        """
        with self._write() as session:
            row = session.scalar(_locked(job))
            if row is None or row.delete_requested:
                return []
            if not _take_request(session, row, run):
                return []
            again = _put_back(session, job, run)
            if not again and not _gather_failed(session, row):
                return []
            row.generation += 1
            row.cancel_requested = False
            told = {"state": "queued"}
            events = [_state_event(job, run, attempt, told) for run, attempt in again]
            self._append(session, [*events, *settle_job(session, row, decide, self._clock())])
            return [run for run, _ in again]

    def _batches(self, *conditions: ColumnElement[bool]) -> list[BatchRecord]:
        query = select(BatchRow).where(*conditions).order_by(BatchRow.sequence)
        with self._read() as session:
            return _records(session, session.scalars(query).all())

    def _completed(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """With the time of the end, where a state ends a run."""
        ends = "state" in changes and changes["state"] not in LIVE
        return {**({"ended": self._clock()} if ends else {}), **changes}


def _is(batch: BatchRecord) -> ColumnElement[bool]:
    return and_(BatchRow.id == batch.id, BatchRow.attempt == batch.attempt)


def _locked(job: str) -> Any:
    """A job's row, which nobody else changes before this transaction ends."""
    return select(JobRow).where(JobRow.id == job).with_for_update()


def _prepared_elsewhere() -> ColumnElement[bool]:
    """A batch that would make a model which another one is making: it finds it made, later."""
    other = aliased(BatchRow)
    return and_(
        BatchRow.purpose == "prepare",
        exists().where(
            other.purpose == "prepare",
            other.state == "running",
            other.model == BatchRow.model,
            other.id != BatchRow.id,
        ),
    )


def _records(session: Session, rows: Sequence[BatchRow]) -> list[BatchRecord]:
    """Batches with their jobs and runs: each study is read once, however many share it."""
    jobs = {
        job.id: job
        for job in session.scalars(select(JobRow).where(JobRow.id.in_({row.job for row in rows})))
    }
    runs: dict[str, list[RunRow]] = {row.id: [] for row in rows}
    query = select(RunRow).where(RunRow.batch.in_(list(runs))).order_by(RunRow.index)
    for run in session.scalars(query):
        runs[run.batch].append(run)
    return [batch_record(row, jobs[row.job], runs[row.id]) for row in rows]


def _change(session: Session, batch: BatchRecord, values: Mapping[str, Any]) -> bool:
    """Changes a batch of this attempt; False where its attempt is another."""
    if not values:
        mine = select(BatchRow.id).where(_is(batch)).with_for_update()
        return session.scalar(mine) is not None
    change = update(BatchRow).where(_is(batch)).values(**values).returning(BatchRow.id)
    return session.scalar(change) is not None


def _change_run(session: Session, job: str, run: str, changes: Mapping[str, Any]) -> list[NewEvent]:
    """Changes a run that has not ended; an event where its state was set."""
    live = and_(RunRow.id == run, RunRow.job == job, RunRow.state.in_(LIVE))
    change = update(RunRow).where(live).values(**changes).returning(RunRow.attempt)
    attempt = session.scalar(change)
    if attempt is None or "state" not in changes:
        return []
    return [_state_event(job, run, attempt, changes)]


def _state_event(job: str, run: str, attempt: int, changes: Mapping[str, Any]) -> NewEvent:
    told = {"state": changes["state"], "attempt": attempt}
    if changes.get("error"):
        told["error"] = changes["error"]
    return NewEvent(job=job, run=run, kind="state", data=told)


def _gather_failed(session: Session, job: JobRow) -> bool:
    """Whether the runs are there and only what should bring them together failed."""
    gather = and_(BatchRow.purpose == "gather", BatchRow.generation == job.generation)
    query = select(BatchRow.id).where(BatchRow.job == job.id, gather, BatchRow.state == "failed")
    return session.scalar(query) is not None


def _take_request(session: Session, job: JobRow, run: str | None) -> bool:
    """Settles the retry of a run, or of a job with all of its runs; False where nobody asks."""
    if run is None and not job.retry_requested:
        return False
    asked = and_(RunRow.job == job.id, RunRow.retry_requested)
    which = asked if run is None else and_(asked, RunRow.id == run)
    settle = update(RunRow).where(which).values(retry_requested=False).returning(RunRow.id)
    settled = session.scalars(settle).all()
    if run is None:
        job.retry_requested = False
    return run is None or bool(settled)


def _put_back(session: Session, job: str, run: str | None) -> list[tuple[str, int]]:
    """Moves ended runs, their batches and a prepare that failed to ``queued``."""
    ended = (
        select(RunRow.id, RunRow.attempt, RunRow.batch)
        .join(BatchRow, BatchRow.id == RunRow.batch)
        .where(
            RunRow.job == job,
            true() if run is None else RunRow.id == run,
            # One that is done stays done, however often somebody asks.
            RunRow.state.not_in((*LIVE, "done")),
            BatchRow.state != "running",
        )
        .order_by(RunRow.index)
    )
    found = session.execute(ended).all()
    if not found:
        return []
    session.execute(
        update(RunRow)
        .where(RunRow.id.in_([run for run, _, _ in found]))
        .values(
            state="queued",
            error=None,
            started=None,
            ended=None,
            verdicts=JSON.NULL,
            progress={},
            cancel_requested=False,
        )
    )
    failed = and_(BatchRow.purpose == "prepare", BatchRow.state.in_(["failed", "cancelled"]))
    batches = or_(BatchRow.id.in_({batch for _, _, batch in found}), failed)
    session.execute(
        update(BatchRow).where(BatchRow.job == job, batches).values(state="queued", deaths=0)
    )
    # A gather of what was there before would come too early.
    old = and_(BatchRow.purpose == "gather", BatchRow.state == "queued")
    session.execute(update(BatchRow).where(BatchRow.job == job, old).values(state="cancelled"))
    return [(run, attempt) for run, attempt, _ in found]
