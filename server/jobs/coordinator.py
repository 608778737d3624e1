"""The coordinator: the only one who changes the state of runs.

It takes batches from the queue to an engine, listens to what the engine tells, and writes what
happened to the database. Workers never touch the database; routes only add jobs and leave requests
there. A thread of the server, or a process of its own (``trainbridge coordinator``).
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, Protocol

from server.jobs.attempts import Attempt, RunOutcome, order_for
from server.jobs.computing import compute_order
from server.jobs.engine import Engine, EngineError
from server.jobs.ledger import Ledger
from server.jobs.lock import FolderInUseError
from server.jobs.orders import Compute, Order, Report
from server.jobs.requests import Requested
from server.jobs.states import Event
from server.settings import Settings
from server.store import BatchRecord, Database, NewEvent, Place

__all__ = ["Coordinator", "Lock"]

_log = logging.getLogger("trainbridge.jobs")

_KEEP_PROGRESS = 600.0
"""Progress events are kept this long, for streams that reconnect. [s]"""
_RETRY_SECONDS = 1.0
"""Pause after the database, the disk or the engine refused. [s]"""
_HOUSEKEEPING_SECONDS = 5.0
"""How often the lock, old events and old jobs are looked at. [s]"""
_LOG_ENTRIES = 10_000
"""Newest entries of a job's log that are looked through when an attempt is reattached."""
_MOST_PROGRESS = 1000
"""Progress reports that are kept for a database that is away: the oldest go first."""


class Lock(Protocol):
    """Holds the queue for one coordinator."""

    def ensure(self) -> None:
        """Makes sure that it is still held, or takes it again.

        Raises:
            FolderInUseError: Another coordinator has it.
        """
        ...


class Coordinator:
    """Moves batches from the queue through an engine to their end."""

    def __init__(
        self,
        database: Database,
        store: Place,
        settings: Settings,
        engine: Engine,
        lock: Lock,
        *,
        compute: Compute = compute_order,
        on_change: Callable[[], None] = lambda: None,
    ) -> None:
        """Does nothing before ``start``.

        Args:
            database: The queue.
            store: Where results lie.
            settings: Limits and intervals.
            engine: Where batches compute.
            lock: Of this queue, held.
            compute: What a batch's process does.
            on_change: Called after events were stored, from the coordinator's thread.
        """
        self._database = database
        self._settings = settings
        self._engine = engine
        self._lock = lock
        self._compute = compute
        self._on_change = on_change
        self._ledger = Ledger(database, store, settings.attempts_limit)
        self._attempts: dict[str, Attempt] = {}
        self._requested = Requested(database, store, self._ledger, engine, self._attempts)
        self._progress: dict[tuple[str, int], Mapping[str, Any]] = {}
        self._events: list[NewEvent] = []
        self._checkpoints: dict[str, Attempt] = {}
        self._stored_at = self._looked_at = self._kept_house_at = 0.0
        self._begun = False
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="coordinator", daemon=True)
        self.trouble = ""
        """Why nothing computes now, empty for none."""

    def start(self) -> None:
        """Begins, in a thread: the engine may take seconds to be ready."""
        self._thread.start()

    def wake(self) -> None:
        """Says that there is something new in the queue."""
        self._looked_at = 0.0
        self._engine.wake()

    def stop(self) -> None:
        """Lets go of the engine; what it stopped goes back into the queue."""
        self._stopping.set()
        self._engine.wake()
        self._thread.join()

    @property
    def alive(self) -> bool:
        """Whether the queue works."""
        return self._thread.is_alive()

    @property
    def process_ids(self) -> list[int]:
        """Processes that compute now."""
        return [item.process for item in list(self._attempts.values()) if item.process]

    # The loop.

    def _run(self) -> None:
        while not self._stopping.is_set():
            try:
                if not self._begun:
                    self._begin()
                self._turn()
                self.trouble = ""
            except FolderInUseError as error:
                self.trouble = str(error)
                _log.error("the coordinator ends: %s", error)
                break
            except EngineError as error:
                self._pause("the engine is away", error)
                self._begun = False
                with suppress(Exception):
                    # What only waits can be cancelled and deleted all the same.
                    self._requested.obey()
            except Exception as error:
                # A full disk or a locked database must not end the queue: say so, and try again.
                self._pause("the queue met an error and goes on", error)
                self._hear_out()
        self._let_go()

    def _pause(self, what: str, error: Exception) -> None:
        if str(error) != self.trouble:
            _log.error("%s: %s", what, error, exc_info=not isinstance(error, EngineError))
        self.trouble = str(error)
        # What was begun just then may be written or not, may have reached the engine or not.
        self._kept_house_at = 0.0
        self._stopping.wait(_RETRY_SECONDS)

    def _hear_out(self) -> None:
        """Takes what the engine tells meanwhile: it must not pile up where nobody bounds it."""
        with suppress(EngineError):
            self._take_reports(0.0)
        progress = [event for event in self._events if event.kind == "progress"]
        others = [event for event in self._events if event.kind != "progress"]
        self._events = [*others, *progress[-_MOST_PROGRESS:]]

    def _begin(self) -> None:
        """Connects the engine, and finds out what of earlier attempts still computes."""
        # First: a coordinator that was cut off must not touch what its successor began.
        self._lock.ensure()
        self._engine.start()
        lost = self._reattach([*self._attempts.values(), *self._unknown_attempts()])
        for attempt in lost:
            self._end(attempt, RunOutcome(event=Event.LOSE))
        for attempt in self._attempts.values():
            if attempt.batch.purpose == "runs" and not attempt.open_runs:
                # Cancelled by a coordinator that did not live to say so to the engine.
                self._engine.cancel(attempt.key)
        self._begun = True
        self._settle_ended()

    def _unknown_attempts(self) -> list[Attempt]:
        """Attempts that the database has and this coordinator does not know."""
        found = [
            Attempt(batch=batch, order=self._order(batch))
            for batch in self._database.running_batches()
        ]
        return [attempt for attempt in found if attempt.key not in self._attempts]

    def _reattach(self, attempts: list[Attempt]) -> list[Attempt]:
        alive = self._engine.reattach([attempt.order for attempt in attempts])
        self._attempts.update({attempt.key: attempt for attempt in attempts})
        for attempt in attempts:
            attempt.logged = self._logged(attempt) if attempt.key in alive else set()
        return [attempt for attempt in attempts if attempt.key not in alive]

    def _logged(self, attempt: Attempt) -> set[tuple[str | None, str]]:
        """What the log says since an attempt began: its engine tells all of it again."""
        entries = self._database.log_of(attempt.batch.job, limit=_LOG_ENTRIES)
        told = [(entry.run, entry.data["text"]) for entry in entries if entry.kind == "log"]
        begins = f"attempt {attempt.batch.attempt} begins"
        runs = {None, *(run.id for run in attempt.batch.runs)}
        own = [(run, text) for run, text in told if run in runs]
        first = (i for i, (_, text) in enumerate(own) if text.startswith(begins))
        return set(own[next(first, len(own)) :])

    def _turn(self) -> None:
        now = time.monotonic()
        if now - self._kept_house_at >= _HOUSEKEEPING_SECONDS:
            self._keep_house()
            self._kept_house_at = now
        if now - self._looked_at >= self._settings.queue_poll_seconds:
            self._looked_at = now
            if self._requested.obey():
                self._on_change()
            self._dispatch()
        self._listen()
        if time.monotonic() - self._stored_at >= self._settings.progress_seconds:
            self._store_progress()
        self._settle_ended()

    def _keep_house(self) -> None:
        self._lock.ensure()
        for attempt in self._reattach(self._unknown_attempts()):
            self._end(attempt, RunOutcome(event=Event.LOSE))
        self._database.drop_old_progress(time.time() - _KEEP_PROGRESS)
        if self._settings.retention_days:
            for job in self._database.expired_jobs(
                time.time() - 86400 * self._settings.retention_days
            ):
                self._database.request_delete(job)

    def _dispatch(self) -> None:
        free = self._engine.free_slots()
        if free <= 0:
            return
        for batch in self._database.queued_batches(free):
            # `running` with the next attempt is committed before anything computes.
            started = self._database.start_batch(batch)
            if started is None:
                continue
            order = self._order(started)
            attempt = self._attempts[order.key] = Attempt(batch=started, order=order)
            try:
                self._engine.run(order)
            except EngineError:
                raise  # Started anew, the engine says what it knows of it.
            except Exception as error:
                _log.exception("attempt %s could not be begun", order.key)
                text = f"It could not be begun: {error}"
                self._end(attempt, RunOutcome(event=Event.LOSE, error=text))
            self._on_change()

    def _order(self, batch: BatchRecord) -> Order:
        gathered = ()
        if batch.purpose == "gather":
            gathered = self._database.runs_of([batch.job])[batch.job]
        return order_for(batch, self._settings, self._compute, gathered)

    # What the engine tells.

    def _listen(self) -> None:
        pending = bool(self._progress or self._events)
        poll = self._settings.queue_poll_seconds
        timeout = self._settings.progress_seconds if pending else poll
        left = self._looked_at + poll - time.monotonic()
        self._take_reports(max(0.0, min(timeout, left)))

    def _take_reports(self, seconds: float) -> None:
        for report in self._engine.reports(seconds):
            attempt = self._attempts.get(report.key)
            if attempt is not None:
                self._take(attempt, report)

    def _take(self, attempt: Attempt, report: Report) -> None:
        data, run = report.data, report.run
        if report.kind == "started":
            attempt.process = data.get("process", 0)
            where = data.get("worker", "this machine")
            self._note(attempt, run, f"attempt {attempt.batch.attempt} begins on {where}")
        elif report.kind == "progress":
            self._take_progress(attempt, run, data)
        elif report.kind == "checkpoint":
            attempt.checkpoint_step = data["step"]
            self._checkpoints[attempt.key] = attempt
            self._note(attempt, run, f"checkpoint of step {data['step']} stored")
        elif report.kind == "log":
            self._note(attempt, run, data["text"])
        elif report.kind == "ended":
            self._end(attempt, RunOutcome(event=Event(data["event"]), error=data["error"]))
        else:
            attempt.outcomes[run] = _outcome(report)

    def _end(self, attempt: Attempt, outcome: RunOutcome) -> None:
        if attempt.ended is None:
            attempt.ended = outcome
            self._note(attempt, "", _last_note(outcome))

    def _take_progress(self, attempt: Attempt, run: str, report: Mapping[str, Any]) -> None:
        batch = attempt.batch
        told = {"attempt": batch.attempt, **report}
        self._events.append(NewEvent(job=batch.job, run=run, kind="progress", data=told))
        self._progress[run, batch.attempt] = {
            name: value for name, value in report.items() if name != "points"
        }
        if attempt.stages.get(run) != report["stage"]:
            attempt.stages[run] = report["stage"]
            self._note(attempt, run, report["stage"])

    def _note(self, attempt: Attempt, run: str, text: str) -> None:
        batch = attempt.batch
        owner = run or (batch.runs[0].id if len(batch.runs) == 1 else None)
        if (owner, text) in attempt.logged:
            return
        self._events.append(NewEvent(job=batch.job, run=owner, kind="log", data={"text": text}))

    # The database.

    def _store_progress(self) -> None:
        self._stored_at = time.monotonic()
        for attempt in list(self._attempts.values()):
            # A batch of one run is settled as a whole: its process ends with its run.
            if attempt.outcomes and len(attempt.batch.runs) > 1 and attempt.ended is None:
                self._ledger.settle_runs(attempt)
        for attempt in list(self._checkpoints.values()):
            self._database.note_checkpoint(attempt.batch, attempt.checkpoint_step)
        self._checkpoints.clear()
        if not (self._progress or self._events):
            return
        self._database.record(self._progress, self._events)
        self._progress, self._events = {}, []
        self._on_change()

    def _settle_ended(self) -> None:
        ended = [attempt for attempt in self._attempts.values() if attempt.ended is not None]
        if not ended:
            return
        self._store_progress()
        for attempt in ended:
            assert attempt.ended is not None
            self._ledger.end_attempt(attempt)
            del self._attempts[attempt.key]
        self._looked_at = 0.0
        self._on_change()

    def _let_go(self) -> None:
        try:
            self._engine.stop()
            self._listen()
            self._settle_ended()
        except Exception:
            # The database says `running`: whoever comes next finds out what became of it.
            _log.exception("the coordinator could not write its last word")


def _outcome(report: Report) -> RunOutcome:
    if report.kind == "finished":
        return RunOutcome(event=Event.FINISH, verdicts=report.data.get("verdicts", []))
    if report.kind == "cancelled":
        return RunOutcome(event=Event.CANCEL)
    return RunOutcome(event=Event.FAIL, error=report.data.get("error", ""))


def _last_note(ended: RunOutcome) -> str:
    return f"the attempt ended: {ended.event}{f' ({ended.error})' if ended.error else ''}"
