"""The engine of a cluster: one task of Dask a batch, on a worker with a free thread."""

from __future__ import annotations

import logging
import pickle
import queue
import time
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

from distributed import Future
from distributed.client import FutureCancelledError
from distributed.scheduler import KilledWorker

from server.jobs.dask_clusters import OwnCluster, open_local_cluster
from server.jobs.dask_connection import SchedulerConnection
from server.jobs.dask_security import scheduler_security
from server.jobs.dask_slots import WorkerSlots
from server.jobs.dask_worker import (
    Kept,
    cancel_attempt,
    compute,
    installed_version,
    stop_attempts,
    told_so_far,
)
from server.jobs.engine import EngineError
from server.jobs.orders import Order, Report
from server.jobs.slurm import open_slurm_cluster
from server.jobs.states import Event
from server.settings import Settings

__all__ = ["DaskEngine"]

_log = logging.getLogger("trainbridge.jobs")

_SLICE_SECONDS = 0.25
"""Longest wait for a report before the scheduler is looked at. [s]"""


@dataclass(kw_only=True)
class _Attempt:
    """An attempt that computes, as far as is known here.

    Attributes:
        future: Its task.
        worker: Where it computes.
        told: Numbers of the reports that were passed on.
        wishes: Cancellations that its worker has not heard yet.
    """

    future: Future
    worker: str
    told: set[int] = field(default_factory=set[int])
    wishes: list[tuple[str, ...]] = field(default_factory=list[tuple[str, ...]])


class DaskEngine:
    """Computes on the workers of a Dask scheduler: one of its own, or one that exists.

    An order is given to a worker that has a free thread, so that nothing waits inside Dask, where
    it could not be reordered. The scheduler keeps each task under a published name until its end
    was reported, so that a coordinator that starts anew finds it.
    """

    def __init__(self, settings: Settings, installation: str) -> None:
        """Does nothing before ``start``.

        Args:
            settings: ``engine`` is dask, slurm, or a scheduler's address.
            installation: Tells the tasks of one database from those of others on the same
                scheduler.
        """
        self._settings = settings
        self._installation = installation
        self._cluster: OwnCluster | None = None
        self._connection: SchedulerConnection | None = None
        self._slots: WorkerSlots | None = None
        self._attempts: dict[str, _Attempt] = {}
        self._reported: list[str] = []
        self._ready: list[Report] = []
        # Every connection has an inbox of its own: what a lost one still says is not heard.
        self._inbox: queue.SimpleQueue[_Message | None] = queue.SimpleQueue()

    def start(self) -> None:
        """Connects, after having let go of what was there.

        Raises:
            EngineError: The scheduler does not answer, or its workers cannot be used.
        """
        self._let_go()
        inbox = self._inbox = queue.SimpleQueue()
        target: Any = self._settings.engine
        if target in ("dask", "slurm"):
            open_cluster = open_local_cluster if target == "dask" else open_slurm_cluster
            self._cluster = open_cluster(self._settings)
            target, security = self._cluster.cluster, self._cluster.security
        else:
            security = scheduler_security(target, self._settings)
        self._connection = SchedulerConnection(
            target,
            scope=self._installation,
            security=security,
            seconds=self._settings.engine_seconds,
            on_message=lambda message: inbox.put(_Message(key=message["key"], told=message)),
            on_end=lambda key: inbox.put(_Message(key=key)),
        )
        self._slots = WorkerSlots(self._connection)
        self._slots.look(at_once=True)
        if self._slots.refusals and not self._slots.threads:
            raise EngineError(next(iter(self._slots.refusals.values())))

    def free_slots(self) -> int:
        """Threads of workers that have no order."""
        _, slots = self._connected()
        self._look()
        return slots.free(self._busy())

    def run(self, order: Order) -> None:
        """Gives an order to the worker with most free threads."""
        connection, slots = self._connected()
        try:
            payload = pickle.dumps(order)
        except Exception as error:
            self._end(order.key, Event.FAIL, f"The run cannot be sent to a worker: {error}")
            return
        worker = slots.roomiest(self._busy())
        if worker is None:
            self._end(order.key, Event.LOSE, "No worker was free any more.")
            return
        future = connection.submit(order.key, worker, compute, installed_version(), payload)
        self._attempts[order.key] = _Attempt(future=future, worker=worker)

    def cancel(self, key: str, runs: Collection[str] = ()) -> None:
        """Takes runs out of an attempt, or ends it."""
        self._connected()
        attempt = self._attempts.get(key)
        wish = tuple(runs)
        if attempt is not None and wish not in attempt.wishes:
            attempt.wishes.append(wish)
            self._pass_on_wishes(key, attempt)

    def reattach(self, orders: Sequence[Order]) -> set[str]:
        """Finds the tasks that an earlier coordinator submitted.

        Those of this database that are neither among the orders nor known here are let go of:
        nobody waits for them.
        """
        connection, _ = self._connected()
        wanted = {order.key for order in orders}
        untold = {report.key for report in self._ready}
        found = connection.published() - set(self._attempts) - untold
        places = connection.places(found & wanted)
        for key, worker in places.items():
            self._attempts[key] = _Attempt(future=connection.adopt(key), worker=worker)
        self._hear_again(set(places.values()) - {""})
        # What waits for a worker that has gone, and what nobody asks for.
        self._reported += found - set(places)
        return wanted & set(self._attempts)

    def reports(self, seconds: float) -> list[Report]:
        """What attempts told, and what became of those that cannot tell any more."""
        if self._connection is None:
            return self._take_ready()
        self._connected()
        self._forget_reported()
        limit = time.monotonic() + seconds
        while not self._ready:
            self._look()
            left = limit - time.monotonic()
            heard = self._hear(max(0.0, min(left, _SLICE_SECONDS)))
            if heard or left <= 0:
                break
        return self._take_ready()

    def wake(self) -> None:
        """Ends the waiting of ``reports``."""
        self._inbox.put(None)

    def stop(self) -> None:
        """Stops what a cluster of our own computes; lets an existing one go on."""
        try:
            if self._connection is not None:
                self._forget_reported()
                if self._cluster is not None:
                    self._stop_attempts()
        except EngineError as error:
            _log.warning("%s", error)
        if self._cluster is not None:
            for key in list(self._attempts):
                self._end(key, Event.LOSE, "The server was asked to stop.")
        self._let_go()

    # What is heard.

    def _hear(self, seconds: float) -> bool:
        """Takes every message that is there; waits at most so long for the first. [s]"""
        heard = False
        try:
            message = self._inbox.get(timeout=seconds)
            while True:
                heard = True
                if message is not None:
                    self._take(message)
                message = self._inbox.get_nowait()
        except queue.Empty:
            return heard

    def _take(self, message: _Message) -> None:
        attempt = self._attempts.get(message.key)
        if attempt is None:
            return
        try:
            if message.told is None:
                self._take_end(message.key, attempt)
            elif "begun" in message.told:
                self._pass_on_wishes(message.key, attempt)
            else:
                self._pass_on(message.key, attempt, message.told["reports"])
        except EngineError:
            raise
        except Exception as error:
            _log.exception("a report of attempt %s cannot be read", message.key)
            self._end(message.key, Event.FAIL, f"What the worker told cannot be read: {error}")

    def _pass_on(self, key: str, attempt: _Attempt, numbered: Kept) -> None:
        for number, pickled in numbered:
            if number in attempt.told:
                continue
            report: Report = pickle.loads(pickled)
            attempt.told.add(number)
            if report.kind == "ended":
                del self._attempts[key]
            self._ready.append(report)

    def _take_end(self, key: str, attempt: _Attempt) -> None:
        """The task has ended, and what it told has not said so."""
        connection, _ = self._connected()
        if attempt.future.status in ("cancelled", "lost"):
            self._lose(key, attempt)
            return
        try:
            kept: Kept = connection.result(attempt.future)
        except (KilledWorker, FutureCancelledError, TimeoutError, OSError):
            self._connected()
            self._lose(key, attempt)
        except Exception as error:
            self._end(key, Event.FAIL, f"The worker could not compute the run: {error}")
        else:
            self._pass_on(key, attempt, kept)

    def _hear_again(self, workers: set[str]) -> None:
        """Takes what attempts told an earlier coordinator, before they tell more."""
        connection, _ = self._connected()
        if not workers:
            return
        for told in connection.ask(sorted(workers), told_so_far).values():
            if isinstance(told, dict):
                for key in set(told) & set(self._attempts):
                    self._take(_Message(key=key, told={"reports": told[key]}))

    # What is known.

    def _connected(self) -> tuple[SchedulerConnection, WorkerSlots]:
        if self._connection is None or self._slots is None:
            raise EngineError("The engine was not started.")
        self._connection.require()
        return self._connection, self._slots

    def _busy(self) -> Counter[str]:
        return Counter(attempt.worker for attempt in self._attempts.values())

    def _look(self) -> None:
        """Looks at the workers now and then; what computed on a lost one is lost."""
        _, slots = self._connected()
        if not slots.look():
            return
        if self._cluster is not None:
            self._cluster.keep_up()
        for key, attempt in list(self._attempts.items()):
            # Their worker did not answer when it was asked.
            self._pass_on_wishes(key, attempt)
        gone = slots.gone(attempt.worker for attempt in self._attempts.values() if attempt.worker)
        if not gone:
            return
        self._hear(0.0)
        for key, attempt in list(self._attempts.items()):
            if attempt.worker in gone and not attempt.future.done():
                self._lose(key, attempt)

    def _pass_on_wishes(self, key: str, attempt: _Attempt) -> None:
        """Tells a worker what to cancel; one that has not begun the attempt is told when it has."""
        connection, slots = self._connected()
        workers = [attempt.worker] if attempt.worker else sorted(slots.threads)
        for wish in list(attempt.wishes):
            answers = connection.ask(workers, cancel_attempt, key, wish)
            if any(answer is True for answer in answers.values()):
                attempt.wishes.remove(wish)

    def _stop_attempts(self) -> None:
        """Asks for checkpoints, and hears the attempts out."""
        connection, _ = self._connected()
        workers = sorted({attempt.worker for attempt in self._attempts.values()})
        if not workers:
            return
        answers = connection.ask(workers, stop_attempts).values()
        grace = max((answer for answer in answers if isinstance(answer, float)), default=0.0)
        limit = time.monotonic() + grace
        while self._attempts and time.monotonic() < limit:
            self._look()
            self._hear(_SLICE_SECONDS)

    # The end of an attempt.

    def _lose(self, key: str, attempt: _Attempt) -> None:
        _, slots = self._connected()
        slots.suspect(attempt.worker)
        self._end(key, Event.LOSE, "Its worker went away.")

    def _end(self, key: str, event: Event, error: str) -> None:
        self._attempts.pop(key, None)
        data = {"event": str(event), "error": error}
        self._ready.append(Report(key=key, kind="ended", data=data))

    def _take_ready(self) -> list[Report]:
        ready, self._ready = self._ready, []
        self._reported += [report.key for report in ready if report.kind == "ended"]
        return ready

    def _forget_reported(self) -> None:
        """Takes back the names of what ``reports`` gave before: its receiver has stored it now."""
        connection, _ = self._connected()
        if self._reported:
            connection.forget(self._reported)
            self._reported = []

    def _let_go(self) -> None:
        self._attempts = {}
        if self._connection is not None:
            self._connection.close()
            self._connection = self._slots = None
        if self._cluster is not None:
            self._cluster.close()
            self._cluster = None


@dataclass(frozen=True, kw_only=True)
class _Message:
    """What came in from an attempt: something told, or nothing but the end of its task."""

    key: str
    told: dict[str, Any] | None = None
