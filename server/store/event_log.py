"""Events in the order in which they were committed, and the progress of runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from sqlalchemy import bindparam, delete, func, insert, select, update
from sqlalchemy.orm import Session

from server.store.models import EventRow, JobRow, RunRow
from server.store.records import EventRecord, NewEvent, event_record
from server.store.sessions import Sessions

__all__ = ["EventLog"]


class EventLog(Sessions):
    """Appends events, reads them after a number."""

    def events_after(
        self, last: int, *, jobs: Sequence[str] = (), limit: int = 500
    ) -> list[EventRecord]:
        """Events with greater numbers than ``last``, of these jobs or of all.

        Numbers are committed in their order: an event that is seen later has a greater one.
        """
        query = select(EventRow).where(EventRow.id > last).order_by(EventRow.id).limit(limit)
        if jobs:
            query = query.where(EventRow.job.in_(list(jobs)))
        with self._read() as session:
            return [event_record(row) for row in session.scalars(query)]

    def last_event(self) -> int:
        """Number of the newest event, 0 for none."""
        with self._read() as session:
            return session.scalar(select(func.max(EventRow.id))) or 0

    def log_of(self, job: str, limit: int = 1000) -> list[EventRecord]:
        """The newest events of a job that people read (log and state), oldest first."""
        query = (
            select(EventRow)
            .where(EventRow.job == job, EventRow.kind.in_(["log", "state"]))
            .order_by(EventRow.id.desc())
            .limit(limit)
        )
        with self._read() as session:
            return [event_record(row) for row in session.scalars(query)][::-1]

    def record(
        self,
        progress: Mapping[tuple[str, int], Mapping[str, Any]],
        events: Sequence[NewEvent],
    ) -> None:
        """Stores the newest progress of runs, by (run, attempt), and appends events.

        What concerns another attempt, or a job that was removed meanwhile, is left out.
        """
        with self._write() as session:
            if progress:
                session.connection().execute(
                    update(RunRow)
                    .where(
                        RunRow.id == bindparam("of_run"), RunRow.attempt == bindparam("of_attempt")
                    )
                    .values(progress=bindparam("values")),
                    [
                        {"of_run": run, "of_attempt": attempt, "values": dict(values)}
                        for (run, attempt), values in progress.items()
                    ],
                )
            known = set(
                session.scalars(
                    select(JobRow.id).where(JobRow.id.in_({item.job for item in events}))
                )
            )
            self._append(session, [item for item in events if item.job in known])

    def drop_old_progress(self, before: float) -> None:
        """Forgets progress events from before a time: results and states say what they said."""
        with self._write() as session:
            session.execute(
                delete(EventRow).where(EventRow.kind == "progress", EventRow.time < before)
            )

    def _append(self, session: Session, events: Iterable[NewEvent]) -> None:
        """Appends events in a transaction that holds the right to write."""
        now = self._clock()
        rows = [
            {
                "job": item.job,
                "run": item.run,
                "kind": item.kind,
                "data": dict(item.data),
                "time": now,
            }
            for item in events
        ]
        if rows:
            session.execute(insert(EventRow), rows)
