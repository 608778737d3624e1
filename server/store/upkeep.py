"""What becomes of jobs at their end: retention, deletion, and what may not be cleaned away."""

from __future__ import annotations

from sqlalchemy import delete, exists, select

from server.store.models import LIVE, BatchRow, EventRow, InstallationRow, JobRow, RunRow
from server.store.sessions import Sessions

__all__ = ["Upkeep"]


class Upkeep(Sessions):
    """Removes jobs, and names what is still referred to."""

    def remove_job(self, job: str) -> None:
        """Removes every row of a job whose deletion was requested and of which nothing runs.

        Remove its files first: a crash in between leaves a request that is settled later.
        """
        busy = exists().where(BatchRow.job == JobRow.id, BatchRow.state == "running")
        wanted = select(JobRow.id).where(JobRow.id == job, JobRow.delete_requested, ~busy)
        with self._write() as session:
            if session.scalar(wanted.with_for_update()) is None:
                return
            for rows in (EventRow, RunRow, BatchRow):
                session.execute(delete(rows).where(rows.job == job))
            session.execute(delete(JobRow).where(JobRow.id == job))

    def expired_jobs(self, ended_before: float) -> list[str]:
        """Jobs that ended before a time and whose deletion nobody has requested, oldest first."""
        query = (
            select(JobRow.id)
            .where(JobRow.ended < ended_before, JobRow.state.not_in(LIVE), ~JobRow.delete_requested)
            .order_by(JobRow.sequence)
        )
        with self._read() as session:
            return list(session.scalars(query))

    def installation(self) -> str:
        """The name of this database, which no other has."""
        with self._read() as session:
            return session.scalars(select(InstallationRow.id)).one()

    def known_runs(self) -> set[str]:
        """Every run of every job."""
        with self._read() as session:
            return set(session.scalars(select(RunRow.id)))

    def known_jobs(self) -> set[str]:
        """Every job, those to be deleted too."""
        with self._read() as session:
            return set(session.scalars(select(JobRow.id)))

    def known_models(self) -> set[str]:
        """Keys of the models that runs of any job share."""
        query = select(JobRow.model).where(JobRow.model.is_not(None)).distinct()
        with self._read() as session:
            return {model for model in session.scalars(query) if model is not None}
