"""What people ask for, as flags that the coordinator settles: routes change no state."""

from __future__ import annotations

from sqlalchemy import ColumnElement, and_, exists, select, update
from sqlalchemy.orm import InstrumentedAttribute, Session

from server.store.models import LIVE, BatchRow, JobRow, RunRow
from server.store.records import Requests
from server.store.sessions import Sessions

__all__ = ["RequestFlags"]

_Condition = ColumnElement[bool] | InstrumentedAttribute[bool]


class RequestFlags(Sessions):
    """Notes requests, and tells which have not been settled."""

    def request_cancel(self, job: str) -> bool:
        """Notes that a job shall be cancelled; False where there is no such job."""
        change = update(JobRow).where(JobRow.id == job, ~JobRow.delete_requested)
        change = change.values(cancel_requested=True, retry_requested=False)
        # A retry of one of its runs that was not settled yet must not come to life afterwards.
        forget = update(RunRow).where(RunRow.job == job).values(retry_requested=False)
        with self._write() as session:
            if not session.execute(change.returning(JobRow.id)).all():
                return False
            session.execute(forget)
            return True

    def request_cancel_run(self, run: str) -> bool:
        """Notes that one run shall be cancelled; False where there is no such run."""
        return self._note_run(run, cancel_requested=True, retry_requested=False)

    def request_retry(self, job: str) -> bool:
        """Notes that a job's runs that failed shall be computed again; False for no such job."""
        return self._note(job, retry_requested=True)

    def request_retry_run(self, run: str) -> bool:
        """Notes that one run shall be computed again; False where there is no such run."""
        return self._note_run(run, retry_requested=True)

    def request_delete(self, job: str) -> bool:
        """Notes that a job shall be deleted: it is cancelled if it lives, and shown no more.

        Its ``Idempotency-Key`` is free again at once. False where there is no such job.
        """
        return self._note(job, delete_requested=True, cancel_requested=True, key=None)

    def set_priority(self, job: str, priority: int) -> bool:
        """Changes a job's place in the queue; False where there is no such job."""
        return self._note(job, priority=priority)

    def requests(self) -> Requests:
        """Everything that was asked for and is not settled.

        A retry waits until what it is about has ended for good: no job that is being cancelled, and
        no run or prepared model whose process is still ending.
        """
        live = JobRow.state.in_(LIVE)
        ends = and_(live, JobRow.cancel_requested)
        running = BatchRow.state == "running"
        busy = exists().where(BatchRow.job == JobRow.id, running)
        failed = RunRow.state.not_in([*LIVE, "done"])
        of_job = and_(RunRow.job == JobRow.id, BatchRow.id == RunRow.batch)
        ending = exists().where(of_job, failed, running)
        preparing = busy.where(BatchRow.purpose == "prepare")
        again = and_(~JobRow.delete_requested, ~ends, ~preparing)
        with self._read() as session:
            return Requests(
                cancel_jobs=_jobs(session, ends),
                cancel_runs=_runs(
                    session,
                    RunRow.cancel_requested,
                    RunRow.state.in_(LIVE),
                    ~JobRow.cancel_requested,
                ),
                retry_jobs=_jobs(session, JobRow.retry_requested, again, ~ending),
                retry_runs=_runs(
                    session,
                    RunRow.retry_requested,
                    failed,
                    ~JobRow.retry_requested,
                    again,
                    ~exists().where(BatchRow.id == RunRow.batch, running),
                ),
                delete_jobs=_jobs(session, JobRow.delete_requested, ~busy),
            )

    def _note(self, job: str, **values: object) -> bool:
        with self._write() as session:
            change = update(JobRow).where(JobRow.id == job, ~JobRow.delete_requested)
            return bool(session.execute(change.values(**values).returning(JobRow.id)).all())

    def _note_run(self, run: str, **values: object) -> bool:
        shown = exists().where(JobRow.id == RunRow.job, ~JobRow.delete_requested)
        with self._write() as session:
            change = update(RunRow).where(RunRow.id == run, shown)
            return bool(session.execute(change.values(**values).returning(RunRow.id)).all())


def _jobs(session: Session, *conditions: _Condition) -> tuple[str, ...]:
    """Jobs, oldest first."""
    query = select(JobRow.id).where(*conditions).order_by(JobRow.sequence)
    return tuple(session.scalars(query))


def _runs(session: Session, *conditions: _Condition) -> tuple[str, ...]:
    """Runs, under conditions on them and on their jobs, oldest first."""
    query = select(RunRow.id).join(JobRow, JobRow.id == RunRow.job).where(*conditions)
    return tuple(session.scalars(query.order_by(RunRow.sequence)))
