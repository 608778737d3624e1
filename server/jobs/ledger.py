"""Writes what happens to batches and runs: each event through the pure transitions, into SQL."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from server.jobs.attempts import Attempt, RunOutcome
from server.jobs.decisions import decide_job
from server.jobs.states import (
    BACK_TO_QUEUE,
    ENDED,
    Event,
    State,
    deaths_after,
    next_state,
)
from server.store import (
    BatchRecord,
    Database,
    JobDecision,
    JobView,
    Place,
    RunReader,
    RunRecord,
    StoreError,
    attempt_place,
)

__all__ = ["Ledger"]

_log = logging.getLogger("trainbridge.jobs")

_NO_MODEL = "The model that the runs of the sweep share could not be prepared."


class Ledger:
    """The coordinator's pen. Each method is one transaction, and may be called again."""

    def __init__(self, database: Database, store: Place, attempts_limit: int) -> None:
        """Writes to a database.

        Args:
            database: The truth.
            store: Where results lie: a run whose results are complete is done, whoever died.
            attempts_limit: Deaths in a row, with no new checkpoint between, that a batch is given.
        """
        self._database = database
        self._store = store
        self._attempts_limit = attempts_limit

    def end_queued(self, job: str, event: Event, error: str | None = None) -> None:
        """Ends everything of a job that waits, by CANCEL or FAIL."""
        state = next_state(State.QUEUED, event)
        self._database.end_queued(job, state=str(state), decide=decide_job, error=error)

    def cancel_queued_run(self, batch: BatchRecord, run: str) -> bool:
        """Cancels one run of a batch that waits; the batch waits on for the others."""
        live = [item for item in batch.runs if State(item.state) not in ENDED]
        [record] = [item for item in live if item.id == run]
        values = {"state": str(State.CANCELLED)} if len(live) == 1 else {}
        return self._change(batch, values, {run: _values(record, RunOutcome(event=Event.CANCEL))})

    def cancel_runs(self, attempt: Attempt, runs: set[str]) -> None:
        """Cancels runs that compute: written at once, before their process follows."""
        changes = {
            run.id: _values(run, RunOutcome(event=Event.CANCEL))
            for run in attempt.open_runs
            if run.id in runs
        }
        if changes:
            self._change(attempt.batch, {}, changes)
        attempt.settled |= runs

    def settle_runs(self, attempt: Attempt) -> bool:
        """Writes the ends of runs whose batch goes on."""
        runs = self._ended_runs(attempt)
        written = self._change(attempt.batch, {}, runs) if runs else True
        attempt.settled |= runs.keys()
        attempt.outcomes.clear()
        return written

    def end_attempt(self, attempt: Attempt) -> bool:
        """Writes the end of an attempt: its runs end, or go back into the queue.

        Returns:
            False where the batch was moved by someone else: nothing was changed.
        """
        assert attempt.ended is not None
        event, error = attempt.ended.event, attempt.ended.error
        deaths = deaths_after(attempt.batch.deaths, event, attempt.checkpoint_step >= 0)
        if event is Event.DIE and deaths >= self._attempts_limit:
            event = Event.FAIL
            error += f" It did so {deaths} times in a row with no new checkpoint between."
        runs = self._ended_runs(attempt)
        for run in attempt.open_runs:
            runs[run.id] = _values(run, self._outcome_of(attempt, run, event, error))
        state = self._batch_state(attempt, event, runs)
        if attempt.batch.purpose == "prepare" and state is State.FAILED:
            # Before the batch itself: a crash between leaves nothing waiting for ever.
            self.end_queued(attempt.batch.job, Event.FAIL, f"{_NO_MODEL} {error}")
        values = {"state": str(state), "deaths": deaths}
        return self._change(attempt.batch, values, runs, error)

    def _ended_runs(self, attempt: Attempt) -> dict[str, Mapping[str, Any]]:
        # A run that was cancelled before this coordinator came has its end already.
        by_id = {run.id: run for run in attempt.batch.runs if State(run.state) not in ENDED}
        ended = attempt.outcomes.items()
        return {run: _values(by_id[run], end) for run, end in ended if run in by_id}

    def _outcome_of(self, attempt: Attempt, run: RunRecord, event: Event, error: str) -> RunOutcome:
        """A run whose results are complete is done, even if nobody lived to say so."""
        if event in BACK_TO_QUEUE or event is Event.FINISH:
            verdicts = self._stored_verdicts(run.id, attempt.batch.attempt)
            if verdicts is not None:
                return RunOutcome(event=Event.FINISH, verdicts=verdicts)
        if event is Event.FINISH:
            event, error = Event.FAIL, "The computation ended without storing a result."
        return RunOutcome(event=event, error=error)

    def _stored_verdicts(self, run: str, attempt: int) -> list[dict[str, Any]] | None:
        """Of complete results; None where they are not, or where the store does not say so."""
        reader = RunReader(attempt_place(self._store, run, attempt))
        try:
            summary = reader.summary if reader.done else None
        except StoreError:
            _log.exception("the results of run %s cannot be looked at", run)
            return None
        return None if summary is None else summary.get("verdicts", [])

    def _batch_state(
        self, attempt: Attempt, event: Event, runs: Mapping[str, Mapping[str, Any]]
    ) -> State:
        if attempt.batch.purpose == "runs":
            back = any(values["state"] == State.QUEUED for values in runs.values())
            return State.QUEUED if back else State.DONE
        state = next_state(State.RUNNING, event)
        return state if state in (State.DONE, State.QUEUED, State.CANCELLED) else State.FAILED

    def _change(
        self,
        batch: BatchRecord,
        values: Mapping[str, Any],
        runs: Mapping[str, Mapping[str, Any]],
        error: str = "",
    ) -> bool:
        def decide(view: JobView) -> JobDecision:
            decision = decide_job(view)
            gather_failed = batch.purpose == "gather" and decision.state == State.FAILED
            return replace(decision, error=error) if gather_failed and error else decision

        return self._database.change_batch(batch, values=values, runs=runs, decide=decide)


def _values(run: RunRecord, outcome: RunOutcome) -> dict[str, Any]:
    """Columns of a run after an event."""
    before = State(run.state)
    state = next_state(before, outcome.event)
    values: dict[str, Any] = {"state": str(state), "error": outcome.error or None}
    if state in ENDED:
        values |= {"ended": time.time(), "verdicts": outcome.verdicts}
    elif outcome.event in BACK_TO_QUEUE:
        values["error"] = None
    return values
