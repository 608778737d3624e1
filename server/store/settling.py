"""A job's state from those of its parts, in the transaction that changed them."""

from __future__ import annotations

import secrets

from sqlalchemy import select
from sqlalchemy.orm import Session

from server.store.models import LIVE, BatchRow, JobRow, RunRow
from server.store.records import Decide, JobView, NewEvent

__all__ = ["settle_job"]


def settle_job(session: Session, job: JobRow, decide: Decide, now: float) -> list[NewEvent]:
    """Gives a job the state that is decided, and its gather where it is due.

    Args:
        session: The transaction.
        job: The job's row, locked.
        decide: The decision.
        now: The time. [s]

    Returns:
        Events to append: one where the state changed.
    """
    session.flush()
    decision = decide(_view(session, job))
    if decision.insert_gather:
        _insert_gather(session, job)
    if job.state == decision.state:
        return []
    job.state = decision.state
    ended = decision.state not in LIVE
    if decision.state != "queued" and job.started is None:
        job.started = session.scalar(
            select(RunRow.started)
            .where(RunRow.job == job.id, RunRow.started.is_not(None))
            .order_by(RunRow.started)
            .limit(1)
        )
    job.ended = now if ended else None
    job.error = (decision.error or _first_error(session, job)) if ended else None
    session.flush()
    return [NewEvent(job=job.id, kind="state", data={"state": job.state})]


def _view(session: Session, job: JobRow) -> JobView:
    states = select(RunRow.state).where(RunRow.job == job.id).order_by(RunRow.index)
    parts = select(BatchRow.purpose, BatchRow.generation, BatchRow.state).where(
        BatchRow.job == job.id, BatchRow.purpose.in_(["prepare", "gather"])
    )
    found = {(purpose, generation): state for purpose, generation, state in session.execute(parts)}
    return JobView(
        runs=tuple(session.scalars(states)),
        prepare=found.get(("prepare", 0)),
        gather=found.get(("gather", job.generation)),
        wants_gather=job.wants_gather,
        cancel_requested=job.cancel_requested,
    )


def _insert_gather(session: Session, job: JobRow) -> None:
    """Adds the gather of this generation, unless it is there: a constraint lets only one in."""
    # Of the one dialect that is used: both take memory.
    if session.get_bind().dialect.name == "postgresql":
        from sqlalchemy.dialects.postgresql import insert
    else:
        from sqlalchemy.dialects.sqlite import insert
    session.execute(
        insert(BatchRow)
        .values(
            id=secrets.token_hex(8),
            job=job.id,
            state="queued",
            attempt=0,
            purpose="gather",
            generation=job.generation,
        )
        .on_conflict_do_nothing(index_elements=["job", "purpose", "generation"])
    )


def _first_error(session: Session, job: JobRow) -> str | None:
    errors = (
        select(RunRow.error)
        .where(RunRow.job == job.id, RunRow.error.is_not(None), RunRow.error != "")
        .order_by(RunRow.index)
        .limit(1)
    )
    return session.scalar(errors)
