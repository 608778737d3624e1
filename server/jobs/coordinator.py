"""The coordinator: the only one who changes the state of runs.

A thread of the server process. It starts one process a batch, listens to them, ends those that are
cancelled or beyond a limit, and writes what happened to the database. Workers never touch the
database; routes only add jobs and ask for cancellation.
"""

from __future__ import annotations

import logging
import multiprocessing
import shutil
import threading
import time
from collections.abc import Callable, Mapping
from multiprocessing.connection import Connection, wait
from typing import Any

import psutil

from server.jobs.process import BatchProcess, Compute
from server.jobs.states import ENDED, Event, State, job_state, next_state
from server.jobs.supervision import Supervised
from server.jobs.worker import RunTask, Task, run_task
from server.settings import Settings
from server.store import BatchRecord, Database, NewEvent, attempt_folder

__all__ = ["Coordinator"]

_log = logging.getLogger("trainbridge.jobs")

_KEEP_PROGRESS = 600.0
"""Progress events are kept this long, for streams that reconnect. [s]"""
_RETRY_SECONDS = 1.0
"""Pause after the database or the disk refused. [s]"""


class Coordinator:
    """Moves batches from the queue through their processes to their end."""

    def __init__(
        self,
        database: Database,
        settings: Settings,
        *,
        read_study: Callable[[Mapping[str, Any]], Any],
        compute: Compute = run_task,
        on_change: Callable[[], None] = lambda: None,
    ) -> None:
        """Does nothing before ``start``.

        Args:
            database: The queue.
            settings: Limits and intervals.
            read_study: A study from its stored JSON.
            compute: What a batch's process does.
            on_change: Called after events were stored, from the coordinator's thread.
        """
        self._database = database
        self._settings = settings
        self._read_study = read_study
        self._compute = compute
        self._on_change = on_change
        self._running: dict[str, Supervised] = {}
        self._progress: dict[tuple[str, int], Mapping[str, Any]] = {}
        self._events: list[NewEvent] = []
        self._stored_at = 0.0
        self._looked_at = 0.0
        self._stopping = threading.Event()
        self._wake_reader, self._wake_writer = multiprocessing.Pipe(duplex=False)
        self._thread = threading.Thread(target=self._run, name="coordinator", daemon=True)

    def start(self) -> None:
        """Puts lost runs back into the queue and begins."""
        self._recover()
        self._thread.start()

    def wake(self) -> None:
        """Says that there is something new in the queue."""
        if not self._stopping.is_set():
            self._wake_writer.send_bytes(b"!")

    def stop(self) -> None:
        """Ends every process; their runs go back into the queue."""
        self._stopping.set()
        self._wake_writer.send_bytes(b"!")
        self._thread.join()
        for supervised in self._running.values():
            supervised.process.close()
            self._settle(supervised.batch, Event.LOSE)
        self._running.clear()

    @property
    def alive(self) -> bool:
        """Whether the queue works."""
        return self._thread.is_alive()

    @property
    def process_ids(self) -> list[int]:
        """Processes that compute now."""
        return [item.process.pid for item in list(self._running.values())]

    # The loop.

    def _run(self) -> None:
        while not self._stopping.is_set():
            try:
                self._turn()
            except Exception:
                # A full disk or a locked database must not end the queue: say so, and try again.
                _log.exception("the queue met an error and goes on")
                self._stopping.wait(_RETRY_SECONDS)

    def _turn(self) -> None:
        self._dispatch()
        self._listen()
        now = time.monotonic()
        if now - self._looked_at >= self._settings.poll_seconds:
            self._looked_at = now
            self._enforce_limits(now)
        self._cancel_requested()
        if now - self._stored_at >= self._settings.progress_seconds:
            self._store_progress()
        self._collect_ended()

    def _dispatch(self) -> None:
        free = self._settings.concurrent_batches - len(self._running)
        if free <= 0:
            return
        for batch in self._database.queued_batches(free):
            self._start(batch)

    def _start(self, batch: BatchRecord) -> None:
        """Commits ``running`` with the next attempt, then starts the process."""
        attempt = batch.attempt + 1
        if not self._settle(batch, Event.START, attempt=attempt):
            return
        started = self._database.batch(batch.id)
        tasks = tuple(
            RunTask(
                id=run.id,
                index=run.index,
                folder=attempt_folder(self._settings.data, run.id, attempt),
            )
            for run in started.runs
        )
        for task in tasks:
            shutil.rmtree(task.folder.parent, ignore_errors=True)
        try:
            task = Task(
                kind=batch.kind,
                study=self._read_study(batch.study),
                runs=tasks,
                progress_seconds=self._settings.progress_seconds,
            )
            process = BatchProcess(task, self._compute)
        except Exception as error:
            _log.exception("batch %s could not be started", batch.id)
            self._settle(started, Event.FAIL, error=f"The run could not be started: {error}")
            return
        self._running[batch.id] = Supervised(
            batch=started,
            process=process,
            started=time.monotonic(),
            memory_limit=self._memory_limit(),
        )

    def _memory_limit(self) -> int:
        limits = self._settings.limits
        if limits.batch_bytes:
            return limits.batch_bytes
        return int(limits.memory_fraction * psutil.virtual_memory().available)

    def _listen(self) -> None:
        """Waits for messages, ends of processes or a wake-up, and takes what is there."""
        sources: dict[Any, Supervised | None] = {self._wake_reader: None}
        for item in self._running.values():
            sources[item.process.sentinel] = item
            if not item.silent:
                sources[item.process.connection] = item
        pending = bool(self._progress or self._events)
        timeout = self._settings.progress_seconds if pending else self._settings.poll_seconds
        for source in wait(list(sources), timeout):
            item = sources[source]
            if item is None:
                while self._wake_reader.poll():
                    self._wake_reader.recv_bytes()
            elif isinstance(source, Connection):
                self._take_messages(item)

    def _take_messages(self, item: Supervised) -> None:
        for run, report in item.take_messages():
            batch = item.batch
            told = {"attempt": batch.attempt, **report}
            self._events.append(NewEvent(job=batch.job, run=run, kind="progress", data=told))
            self._progress[run, batch.attempt] = {
                name: value for name, value in report.items() if name != "points"
            }

    def _enforce_limits(self, now: float) -> None:
        for item in self._running.values():
            item.enforce(now, self._settings.limits.batch_seconds, self._settings.grace_seconds)

    def _cancel_requested(self) -> None:
        for job in self._database.cancel_requests():
            for batch in self._database.queued_batches_of(job):
                self._settle(batch, Event.CANCEL)
            for item in self._running.values():
                if item.batch.job == job:
                    item.end(Event.CANCEL, "")

    def _collect_ended(self) -> None:
        for item in [item for item in self._running.values() if not item.process.alive]:
            self._take_messages(item)
            self._store_progress()
            event, error = item.outcome()
            item.process.close()
            del self._running[item.batch.id]
            self._settle(item.batch, event, error=error, verdicts=item.verdicts)
            self._database.drop_old_progress(time.time() - _KEEP_PROGRESS)

    # The database.

    def _store_progress(self) -> None:
        self._stored_at = time.monotonic()
        if not (self._progress or self._events):
            return
        self._database.record(self._progress, self._events)
        self._progress, self._events = {}, []
        self._on_change()

    def _settle(
        self,
        batch: BatchRecord,
        event: Event,
        *,
        attempt: int | None = None,
        error: str | None = None,
        verdicts: Mapping[str, Any] | None = None,
    ) -> bool:
        """Moves a batch by an event; False where it was moved by someone else before."""
        state = next_state(State(batch.state), event)
        now = time.time()
        values: dict[str, Any] = {"state": str(state), "error": error or None}
        if state is State.RUNNING:
            values |= {"started": now, "progress": {}}
        if state in ENDED:
            values |= {"ended": now}
        moved = self._database.change_batch(
            batch,
            state=str(state),
            attempt=batch.attempt if attempt is None else attempt,
            runs={
                run.id: values | {"verdicts": (verdicts or {}).get(run.id)} for run in batch.runs
            },
            job_state=lambda states: str(job_state(State(item) for item in states)),
        )
        self._on_change()
        return moved

    def _recover(self) -> None:
        """Runs that were computing when the last server died go back into the queue."""
        for batch in self._database.running_batches():
            self._settle(batch, Event.LOSE)
