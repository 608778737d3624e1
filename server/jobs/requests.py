"""What people asked for through the database: cancel, retry, delete."""

from __future__ import annotations

from server.jobs.attempts import Attempt, RunOutcome
from server.jobs.decisions import decide_job
from server.jobs.engine import Engine
from server.jobs.ledger import Ledger
from server.jobs.states import ENDED, Event, State
from server.store import Database, Place, job_place, run_place

__all__ = ["Requested"]


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

    def obey(self) -> bool:
        """Looks once; says whether there was anything."""
        requests = self._database.requests()
        for run in requests.cancel_runs:
            self._cancel_run(run)
        for job in requests.cancel_jobs:
            self._cancel_job(job)
        for job in requests.retry_jobs:
            self._retry_job(job)
        for run in requests.retry_runs:
            self._retry_run(run)
        for job in requests.delete_jobs:
            self._delete_job(job)
        return any(vars(requests).values())

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
        attempt.outcomes.update({run: RunOutcome(event=Event.CANCEL) for run in runs})
        self._ledger.settle_runs(attempt)
        if left:
            self._engine.cancel(attempt.key, runs)
        elif not attempt.ending:
            attempt.ending = True
            self._engine.cancel(attempt.key)

    def _retry_job(self, job: str) -> None:
        runs = self._database.runs_of([job])[job]
        again = [run.id for run in runs if State(run.state) in ENDED - {State.DONE}]
        self._database.requeue(job, again, decide=decide_job)

    def _retry_run(self, run: str) -> None:
        record = self._database.run(run)
        if record is not None:
            self._database.requeue(record.job, [run], decide=decide_job)

    def _delete_job(self, job: str) -> None:
        """Files first: a crash between leaves a job to be deleted again, not files of nobody."""
        if self._attempts_of(job):
            return  # Cancelled before; its processes are ending, the next look finds them gone.
        for run in self._database.runs_of([job])[job]:
            run_place(self._store, run.id).remove()
        job_place(self._store, job).remove()
        self._database.remove_job(job)

    def _attempts_of(self, job: str) -> list[Attempt]:
        return [item for item in self._attempts.values() if item.batch.job == job]
