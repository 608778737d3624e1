"""What people asked for through the database: cancel, retry, delete."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

from sqlalchemy.exc import SQLAlchemyError

from server.jobs.attempts import Attempt
from server.jobs.decisions import decide_job
from server.jobs.engine import Engine, EngineError
from server.jobs.ledger import Ledger
from server.jobs.states import ENDED, Event, State
from server.store import Database, ModelStore, Place, job_place, model_place, run_place

__all__ = ["Requested"]

_log = logging.getLogger("trainbridge.jobs")

_REMOVED_AT_ONCE = 20
"""Runs whose files are removed at one look."""
_AGAIN_SECONDS = 60.0
"""After so long what could not be done is tried again. [s]"""


class Requested:
    """Obeys the requests that routes have left.

    Args:
        database: Where they are left.
        store: Whose files a deletion removes.
        ledger: Writes the consequences.
        engine: Ends what computes.
        attempts: Those that compute, by key; shared with the coordinator.
    """

    def __init__(
        self,
        database: Database,
        store: Place,
        ledger: Ledger,
        engine: Engine,
        attempts: dict[str, Attempt],
    ) -> None:
        self._database = database
        self._store = store
        self._ledger = ledger
        self._engine = engine
        self._attempts = attempts
        self._later: dict[str, float] = {}
        self._removed: dict[str, int] = {}

    def obey(self) -> bool:
        """Looks once; says whether there was anything."""
        requests = self._database.requests()
        for wanted, settle in (
            (requests.cancel_runs, self._cancel_run),
            (requests.cancel_jobs, self._cancel_job),
            (requests.retry_jobs, self._retry_job),
            (requests.retry_runs, self._retry_run),
            (requests.delete_jobs, self._delete_job),
        ):
            for item in wanted:
                self._settle(item, settle)
        return any(vars(requests).values())

    def _settle(self, item: str, settle: Callable[[str], None]) -> None:
        """One that cannot be settled, as a folder that may not be removed, holds up nobody else."""
        if time.monotonic() < self._later.get(item, 0.0):
            return
        try:
            settle(item)
        except (EngineError, SQLAlchemyError):
            raise
        except Exception:
            _log.exception("what was asked for %s cannot be done now", item)
            self._later[item] = time.monotonic() + _AGAIN_SECONDS
        else:
            self._later.pop(item, None)

    def _cancel_job(self, job: str) -> None:
        self._ledger.end_queued(job, Event.CANCEL)
        for attempt in self._attempts_of(job):
            self._cancel(attempt, {run.id for run in attempt.open_runs})

    def _cancel_run(self, run: str) -> None:
        record = self._database.run(run)
        if record is None or State(record.state) in ENDED:
            return
        for attempt in self._attempts.values():
            if any(item.id == run for item in attempt.open_runs):
                self._cancel(attempt, {run})
                return
        batch = self._database.batch(record.batch)
        if batch.state == State.QUEUED:
            self._ledger.cancel_queued_run(batch, run)

    def _cancel(self, attempt: Attempt, runs: set[str]) -> None:
        """Written at once; the process has the grace time to follow."""
        left = {run.id for run in attempt.open_runs} - runs
        self._ledger.cancel_runs(attempt, runs)
        if left:
            self._engine.cancel(attempt.key, runs)
        elif not attempt.ending:
            attempt.ending = True
            self._engine.cancel(attempt.key)

    def _retry_job(self, job: str) -> None:
        self._database.requeue(job, decide=decide_job)

    def _retry_run(self, run: str) -> None:
        record = self._database.run(run)
        if record is not None:
            self._database.requeue(record.job, run, decide=decide_job)

    def _delete_job(self, job: str) -> None:
        """Files first: a crash between leaves a job to be deleted again, not files of nobody.

        But a model that it shares last: only then it shows whether another job needs it.
        """
        if self._attempts_of(job):
            return  # Cancelled before; its processes are ending, the next look finds them gone.
        runs = self._database.runs_of([job])[job]
        first = self._removed.get(job, 0)
        for run in runs[first : first + _REMOVED_AT_ONCE]:
            run_place(self._store, run.id).remove()
        if first + _REMOVED_AT_ONCE < len(runs):
            # The rest at the next looks: others wait for theirs to be cancelled.
            self._removed[job] = first + _REMOVED_AT_ONCE
            return
        self._removed.pop(job, None)
        job_place(self._store, job).remove()
        models = self._database.known_models()
        self._database.remove_job(job)
        for model in models - self._database.known_models():
            ModelStore(model_place(self._store, model)).remove()

    def _attempts_of(self, job: str) -> list[Attempt]:
        return [item for item in self._attempts.values() if item.batch.job == job]
