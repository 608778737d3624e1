"""Jobs and runs as routes see them: they enter, they are listed and looked at."""

from __future__ import annotations

import secrets
from collections.abc import Iterable, Sequence
from typing import Any

from sqlalchemy import ColumnElement, and_, func, insert, or_, select
from sqlalchemy.orm import Session

from server.store.event_log import EventLog
from server.store.models import LIVE, BatchRow, JobRow, RunRow
from server.store.records import (
    JobFilter,
    JobRecord,
    NewEvent,
    NewJob,
    RunRecord,
    job_record,
    run_record,
)

__all__ = ["KeyReusedError", "QueueFullError", "Submissions", "new_id"]

_EVERY_JOB = JobFilter()


class QueueFullError(Exception):
    """As many jobs wait as the server accepts."""


class KeyReusedError(Exception):
    """An ``Idempotency-Key`` came with another request before."""


class Submissions(EventLog):
    """Adds jobs, lists them and their runs. A job whose deletion was requested is not shown."""

    def add_job(self, new: NewJob, *, queued_limit: int) -> tuple[JobRecord, bool]:
        """Adds a job with all its runs, one batch a run, in one transaction.

        Args:
            new: What was submitted.
            queued_limit: Jobs that may wait, this one too.

        Returns:
            The job, and whether it is new: False for the job that came with the same key.

        Raises:
            QueueFullError: ``queued_limit`` jobs are waiting.
            KeyReusedError: The key came with another request.
        """
        with self._write() as session:
            known = self._job_of_key(session, new)
            if known is not None:
                return job_record(known), False
            waiting = select(func.count()).where(JobRow.state == "queued", _shown())
            count = session.scalar(waiting) or 0
            if count >= queued_limit:
                raise QueueFullError(f"{count} jobs are waiting already.")
            job = self._job_row(new)
            session.add(job)
            session.flush()
            # As it is stored: without NUL.
            session.refresh(job, ["name"])
            _add_parts(session, job.id, new)
            self._append(session, [NewEvent(job=job.id, kind="state", data={"state": "queued"})])
            return job_record(job), True

    def _job_of_key(self, session: Session, new: NewJob) -> JobRow | None:
        if new.key is None:
            return None
        known = session.scalar(select(JobRow).where(JobRow.key == new.key))
        if known is not None and known.body_digest != new.body_digest:
            raise KeyReusedError(
                f"The key {new.key!r} came with another request before (job {known.id}). Send a "
                "new key with a new request."
            )
        return known

    def _job_row(self, new: NewJob) -> JobRow:
        return JobRow(
            id=new_id(),
            kind=new.kind,
            name=new.name,
            study=dict(new.study),
            state="queued",
            steps=new.steps,
            created=self._clock(),
            cancel_requested=False,
            priority=new.priority,
            source=new.source,
            disk_bytes=new.disk_bytes,
            wants_gather=new.wants_gather,
            model=new.model,
            key=new.key,
            body_digest=new.body_digest,
        )

    def job(self, job: str) -> JobRecord | None:
        """A job, or None."""
        with self._read() as session:
            row = session.scalar(select(JobRow).where(JobRow.id == job, _shown()))
            return None if row is None else job_record(row)

    def jobs(
        self, wanted: JobFilter = _EVERY_JOB, limit: int = 50, before: int | None = None
    ) -> list[JobRecord]:
        """The newest jobs that pass a filter.

        Args:
            wanted: The filter.
            limit: How many at most.
            before: Only those with a smaller sequence number.
        """
        query = select(JobRow).where(_shown(), *_passes(wanted))
        if before is not None:
            query = query.where(JobRow.sequence < before)
        with self._read() as session:
            rows = session.scalars(query.order_by(JobRow.sequence.desc()).limit(limit))
            return [job_record(row) for row in rows]

    def runs_of(self, jobs: Iterable[str]) -> dict[str, list[RunRecord]]:
        """The runs of each job, in the order of its sweep."""
        wanted = list(jobs)
        query = select(RunRow).where(RunRow.job.in_(wanted)).order_by(RunRow.job, RunRow.index)
        found: dict[str, list[RunRecord]] = {job: [] for job in wanted}
        with self._read() as session:
            for row in session.scalars(query):
                found[row.job].append(run_record(row))
        return found

    def runs(
        self,
        job: str,
        *,
        states: Sequence[str] = (),
        after: int = -1,
        limit: int | None = None,
    ) -> list[RunRecord]:
        """Runs of one job in the order of its sweep.

        Args:
            job: The job.
            states: Only runs in one of these; empty for all.
            after: Only runs with a greater index.
            limit: How many at most.
        """
        query = select(RunRow).where(RunRow.job == job, RunRow.index > after)
        if states:
            query = query.where(RunRow.state.in_(list(states)))
        with self._read() as session:
            rows = session.scalars(query.order_by(RunRow.index).limit(limit))
            return [run_record(row) for row in rows]

    def run(self, run: str) -> RunRecord | None:
        """A run, or None."""
        query = select(RunRow).join(JobRow, JobRow.id == RunRow.job)
        with self._read() as session:
            row = session.scalar(query.where(RunRow.id == run, _shown()))
            return None if row is None else run_record(row)

    def position(self, job: JobRecord) -> int:
        """Jobs that wait and are dispatched before this one, by priority, then age."""
        query = select(func.count()).where(
            JobRow.state == "queued", ~JobRow.cancel_requested, _shown(), _before(job)
        )
        with self._read() as session:
            return session.scalar(query) or 0

    def steps_before(self, job: JobRecord) -> int:
        """Time steps that remain before this job is dispatched.

        Those of jobs that wait before it, of runs that compute, and of runs that wait in jobs that
        have begun and go before it. Steps of a job are taken to be shared evenly by its runs.
        """
        goes_first = and_(_before(job), ~JobRow.cancel_requested, _shown())
        begun = and_(JobRow.state == "running", JobRow.id != job.id)
        waiting = select(func.sum(JobRow.steps)).where(JobRow.state == "queued", goes_first)
        shares = (
            select(JobRow.id, JobRow.steps, func.count().label("runs"))
            .join(RunRow, RunRow.job == JobRow.id)
            .where(begun)
            .group_by(JobRow.id, JobRow.steps)
        )
        queued_runs = (
            select(JobRow.id, func.count())
            .join(RunRow, RunRow.job == JobRow.id)
            .where(begun, goes_first, RunRow.state == "queued")
            .group_by(JobRow.id)
        )
        computing = (
            select(RunRow.job, RunRow.progress)
            .join(JobRow, JobRow.id == RunRow.job)
            .where(begun, RunRow.state == "running")
        )
        with self._read() as session:
            remaining = float(session.scalar(waiting) or 0)
            share = {name: steps / runs for name, steps, runs in session.execute(shares)}
            for name, runs in session.execute(queued_runs):
                remaining += runs * share[name]
            for name, progress in session.execute(computing):
                remaining += max(0.0, share[name] - float(progress.get("step") or 0))
        return round(remaining)

    def jobs_in(self, state: str) -> int:
        """How many jobs are in a state."""
        query = select(func.count()).where(JobRow.state == state, _shown())
        with self._read() as session:
            return session.scalar(query) or 0

    def reserved_bytes(self) -> int:
        """What jobs that have not ended may still need of the disk at most. [B]"""
        query = select(func.sum(JobRow.disk_bytes)).where(JobRow.state.in_(LIVE))
        with self._read() as session:
            return int(session.scalar(query) or 0)


def new_id() -> str:
    """A name that nobody guesses: 64 random bits."""
    return secrets.token_hex(8)


def _add_parts(session: Session, job: str, new: NewJob) -> None:
    """The batches and runs of a new job; those of runs wait for the one that prepares."""
    prepare = new_id() if new.model is not None else None
    if prepare is not None:
        session.execute(
            insert(BatchRow).values(
                id=prepare,
                job=job,
                state="queued",
                attempt=0,
                purpose="prepare",
                generation=0,
                model=new.model,
            )
        )
    batches = [new_id() for _ in new.runs]
    rows: list[dict[str, Any]] = [
        {"id": batch, "job": job, "state": "queued", "model": new.model, "waits_for": prepare}
        for batch in batches
    ]
    runs: list[dict[str, Any]] = [
        {
            "id": new_id(),
            "job": job,
            "batch": batch,
            "index": index,
            "state": "queued",
            "parameters": dict(parameters),
            "progress": {},
            "verdicts": None,
        }
        for index, (batch, parameters) in enumerate(zip(batches, new.runs, strict=True))
    ]
    # As lists of values: objects would cost ten times as much for hundreds of runs.
    if rows:
        session.execute(insert(BatchRow), rows)
        session.execute(insert(RunRow), runs)


def _shown() -> ColumnElement[bool]:
    return ~JobRow.delete_requested


def _before(job: JobRecord) -> ColumnElement[bool]:
    """Jobs that are dispatched before a job."""
    older = and_(JobRow.priority == job.priority, JobRow.sequence < job.sequence)
    return or_(JobRow.priority > job.priority, older)


def _passes(wanted: JobFilter) -> list[ColumnElement[bool]]:
    """The conditions of a filter."""
    conditions: list[ColumnElement[bool]] = []
    if wanted.states:
        conditions.append(JobRow.state.in_(list(wanted.states)))
    if wanted.kind is not None:
        conditions.append(JobRow.kind == wanted.kind)
    if wanted.name:
        conditions.append(JobRow.name.icontains(wanted.name, autoescape=True))
    if wanted.created_from is not None:
        conditions.append(JobRow.created >= wanted.created_from)
    if wanted.created_to is not None:
        conditions.append(JobRow.created < wanted.created_to)
    if wanted.source is not None:
        conditions.append(JobRow.source == wanted.source)
    return conditions
