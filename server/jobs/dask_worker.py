"""What runs on a worker of Dask: each task supervises one batch and tells the coordinator.

Reports travel as events of one topic, which the scheduler passes on at once and keeps the last
thousand of. What matters (everything but progress) goes along once more with the last message of an
attempt, and is the task's result too: a coordinator that was away then misses nothing.
"""

from __future__ import annotations

import asyncio
import multiprocessing
import pickle
import threading
import time
from collections.abc import Collection
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from distributed import Worker, get_worker
from distributed.diagnostics.plugin import WorkerPlugin

from server.jobs.orders import Order, Report
from server.jobs.process import child_context
from server.jobs.supervision import Control, supervise

__all__ = [
    "TASK",
    "TOPIC",
    "AttemptsPlugin",
    "Kept",
    "VersionMismatchError",
    "cancel_attempt",
    "compute",
    "describe",
    "installed_version",
    "stop_attempts",
    "told_so_far",
]

TOPIC = "trainbridge"
"""Events of this topic carry the messages of attempts."""
TASK = "trainbridge"
"""First part of every task's key; the second is the attempt's."""

Kept = list[tuple[int, bytes]]
"""Reports, pickled, each with its number in the order they were posted."""

_FAREWELL = 2.0
"""Time that supervisors take after the grace time, at most. [s]"""
_POLL = 0.02
"""How often the end of attempts is looked at while a worker closes. [s]"""


class VersionMismatchError(Exception):
    """Coordinator and worker have different versions of trainbridge."""


@dataclass(frozen=True, kw_only=True)
class _Attempt:
    control: Control
    teller: _Teller
    grace_seconds: float


_attempts: dict[str, _Attempt] = {}
_lock = threading.Lock()


def installed_version() -> str:
    """The version of trainbridge that this process runs."""
    try:
        return version("trainbridge")
    except PackageNotFoundError:
        return "not installed"


def describe() -> dict[str, Any]:
    """What a coordinator asks a worker before it gives it anything."""
    return {
        "version": installed_version(),
        "has_children": not multiprocessing.current_process().daemon,
    }


def compute(coordinator_version: str, payload: bytes) -> Kept:
    """The task: supervises one order, and stays until its process has ended.

    Args:
        coordinator_version: Whose order it is.
        payload: The order, pickled: what is wrong with it comes out here, in words.

    Returns:
        Every report but progress.

    Raises:
        VersionMismatchError: This worker has another version.
    """
    own = installed_version()
    if own != coordinator_version:
        raise VersionMismatchError(
            f"This worker has trainbridge {own}, its coordinator {coordinator_version}. Install "
            "the same version on every machine, and start its workers again."
        )
    order: Order = pickle.loads(payload)
    teller = _Teller(order.key, get_worker())
    grace = order.limits.grace_seconds
    attempt = _Attempt(control=Control(), teller=teller, grace_seconds=grace)
    with _lock:
        _attempts[order.key] = attempt
    try:
        teller.tell({"begun": True})
        supervise(order, teller.post, attempt.control)
    finally:
        with _lock:
            del _attempts[order.key]
    return teller.kept


def cancel_attempt(key: str, runs: Collection[str]) -> bool:
    """Takes runs out of an attempt, or ends it; False where it does not compute here."""
    with _lock:
        attempt = _attempts.get(key)
    if attempt is None:
        return False
    attempt.control.cancel(runs)
    return True


def told_so_far() -> dict[str, Kept]:
    """Every report but progress of the attempts that compute here, by their keys."""
    with _lock:
        return {key: attempt.teller.kept for key, attempt in _attempts.items()}


def stop_attempts() -> float:
    """Lets every attempt of this worker store a checkpoint and end.

    Returns:
        The longest time that this may take. [s]
    """
    with _lock:
        attempts = list(_attempts.values())
    for attempt in attempts:
        attempt.control.stop()
    return max((attempt.grace_seconds for attempt in attempts), default=-_FAREWELL) + _FAREWELL


class AttemptsPlugin(WorkerPlugin):
    """Ends attempts that nobody waits for any more, and stops them when the worker closes."""

    name = "trainbridge"
    idempotent = True

    def setup(self, worker: Worker) -> None:
        """Loads the solver once, for all batches, before the first one comes."""
        if describe()["has_children"]:
            child_context()

    def transition(self, key: Any, start: str, finish: str, **_others: Any) -> None:
        """Ends an attempt whose task was released while it computes."""
        if start == "executing" and finish == "released" and key[0] == TASK:
            cancel_attempt(key[1], ())

    async def teardown(self, worker: Worker) -> None:
        """The worker was asked to end, or has lost its scheduler: attempts store checkpoints."""
        limit = time.monotonic() + stop_attempts()
        while _attempts and time.monotonic() < limit:
            await asyncio.sleep(_POLL)


class _Teller:
    """Sends an attempt's reports to the coordinator."""

    def __init__(self, key: str, worker: Worker) -> None:
        self._key = key
        self._worker = worker
        self._count = 0
        self.kept: Kept = []
        self._checkpoint: tuple[int, bytes] | None = None

    def post(self, report: Report) -> None:
        """Sends one; with the last one, all that matter."""
        if report.kind == "started":
            report = replace(report, data={**report.data, "worker": self._worker.address})
        numbered = (self._count, pickle.dumps(report))
        self._count += 1
        if report.kind == "checkpoint":
            # Only the last one matters.
            self.kept = [item for item in self.kept if item is not self._checkpoint]
            self._checkpoint = numbered
        if report.kind != "progress":
            self.kept = [*self.kept, numbered]
        self.tell({"reports": self.kept if report.kind == "ended" else [numbered]})

    def tell(self, message: dict[str, Any]) -> None:
        """Sends a message of plain values; it is lost where the scheduler is."""
        self._worker.log_event(TOPIC, {"key": self._key, **message})
