"""Which workers there are, and how many orders each still takes."""

from __future__ import annotations

import logging
import time
from collections import Counter
from collections.abc import Iterable, Mapping

from server.jobs.dask_connection import SchedulerConnection
from server.jobs.dask_worker import describe, installed_version

__all__ = ["WorkerSlots"]

_log = logging.getLogger("trainbridge.jobs")

_LOOK_SECONDS = 0.5
"""How often the scheduler is asked for its workers. [s]"""
_SILENT_SECONDS = 30.0
"""Pause before a worker that did not answer is asked again. [s]"""


class WorkerSlots:
    """The workers of a scheduler: one slot a thread.

    A worker is used after it has said that it has our version and may start processes. One that
    has been missing in two looks is gone: what it told before arrived between them.

    Attributes:
        refusals: Why a worker is not used, by its address.
    """

    def __init__(self, connection: SchedulerConnection) -> None:
        self._connection = connection
        self._looked_at = 0.0
        self._threads: dict[str, int] = {}
        self._present: set[str] = set()
        self._missing: set[str] = set()
        self._accepted: set[str] = set()
        self._silent: dict[str, float] = {}
        self.refusals: dict[str, str] = {}

    def look(self, *, at_once: bool = False) -> bool:
        """Asks the scheduler, if that is due; whether it was."""
        now = time.monotonic()
        if not at_once and now - self._looked_at < _LOOK_SECONDS:
            return False
        self._looked_at = now
        present, running = self._connection.threads()
        silent = {name for name, at in self._silent.items() if now - at < _SILENT_SECONDS}
        self._ask_new(set(running) - self._accepted - set(self.refusals) - silent)
        self._missing = self._present - set(present)
        self._present = set(present)
        self._threads = {name: running[name] for name in running if name in self._accepted}
        self._accepted &= self._present
        self.refusals = {
            name: text for name, text in self.refusals.items() if name in self._present
        }
        return True

    @property
    def threads(self) -> Mapping[str, int]:
        """Threads of each worker that may be used."""
        return self._threads

    def suspect(self, worker: str) -> None:
        """Gives a worker nothing before the next look has seen it again."""
        self._threads.pop(worker, None)

    def gone(self, workers: Iterable[str]) -> set[str]:
        """Those of some workers that are away for good."""
        return set(workers) - self._present - self._missing

    def free(self, busy: Counter[str]) -> int:
        """Slots that are free, by how many orders each worker has."""
        return sum(max(0, threads - busy[name]) for name, threads in self._threads.items())

    def roomiest(self, busy: Counter[str]) -> str | None:
        """The worker with most free slots; None where all are taken."""
        free = {name: threads - busy[name] for name, threads in self._threads.items()}
        best = max(free, key=lambda name: free[name], default=None)
        return best if best is not None and free[best] > 0 else None

    def _ask_new(self, workers: set[str]) -> None:
        if not workers:
            return
        for name, answer in self._connection.ask(sorted(workers), describe).items():
            if isinstance(answer, OSError):
                # It has just gone, or is frozen.
                self._silent[name] = time.monotonic()
                continue
            trouble = _trouble(name, answer)
            if trouble:
                self.refusals[name] = trouble
                _log.warning("%s", trouble)
            else:
                self._accepted.add(name)


def _trouble(worker: str, answer: object) -> str:
    """Why a worker cannot be used, by what it answered; empty where it can."""
    if not isinstance(answer, dict):
        return (
            f"The worker {worker} cannot be used ({type(answer).__name__}: {answer}). Install "
            f"trainbridge {installed_version()} there, and start it with trainbridge worker."
        )
    if answer["version"] != installed_version():
        return (
            f"The worker {worker} has trainbridge {answer['version']}, this machine "
            f"{installed_version()}. Install the same version on every machine, and start its "
            "workers again."
        )
    if not answer["has_children"]:
        return (
            f"The worker {worker} may not start processes. Start it with trainbridge worker, or "
            "with dask worker --no-nanny."
        )
    return ""
