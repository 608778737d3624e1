"""The engine of one machine: a thread a batch supervises the batch's process."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Collection, Sequence

from server.jobs.orders import Order, Report
from server.jobs.process import end_forkserver
from server.jobs.supervision import Control, supervise

__all__ = ["LocalEngine"]

_IDLE_SECONDS = 60.0
"""After so long without work the solver's memory is given back. [s]"""
_FAREWELL = 2.0
"""Time that supervisors take after the grace time, at most. [s]"""


class LocalEngine:
    """Computes on this machine, in so many processes at once."""

    def __init__(self, slots: int, grace_seconds: float) -> None:
        """Does nothing before ``start``.

        Args:
            slots: Processes that compute at once.
            grace_seconds: Time between asking a process to end and killing it. [s]
        """
        self._slots = slots
        self._grace = grace_seconds
        self._controls: dict[str, Control] = {}
        self._threads: dict[str, threading.Thread] = {}
        self._reports: queue.SimpleQueue[Report | None] = queue.SimpleQueue()
        self._idle_since: float | None = None

    def start(self) -> None:
        """Nothing to do: the first order loads the solver, once for all children."""

    def free_slots(self) -> int:
        """Processes that may start."""
        return self._slots - len(self._controls)

    def run(self, order: Order) -> None:
        """Starts the order's supervisor."""
        self._idle_since = None
        control = Control()
        thread = threading.Thread(
            target=supervise,
            args=(order, self._reports.put, control),
            name=f"supervisor of {order.key}",
            daemon=True,
        )
        thread.start()
        # Afterwards: a thread that could not start takes no place.
        self._controls[order.key], self._threads[order.key] = control, thread

    def cancel(self, key: str, runs: Collection[str] = ()) -> None:
        """Takes runs out of an attempt, or ends it."""
        if key in self._controls:
            self._controls[key].cancel(runs)

    def reattach(self, orders: Sequence[Order]) -> set[str]:
        """Those that this very object supervises: processes do not outlive their server."""
        return {order.key for order in orders if order.key in self._controls}

    def reports(self, seconds: float) -> list[Report]:
        """What was told since the last call."""
        found: list[Report | None] = []
        try:
            found.append(self._reports.get(timeout=seconds))
            while True:
                found.append(self._reports.get_nowait())
        except queue.Empty:
            pass
        told = [report for report in found if report is not None]
        for report in told:
            if report.kind == "ended":
                del self._controls[report.key]
                self._threads.pop(report.key).join()
                self._idle_since = time.monotonic()
        self._save_memory()
        return told

    def _save_memory(self) -> None:
        """Lets go of the loaded solver where nothing has computed for a while."""
        if self._controls or self._idle_since is None:
            return
        if time.monotonic() - self._idle_since > _IDLE_SECONDS:
            self._idle_since = None
            end_forkserver()

    def wake(self) -> None:
        """Ends the waiting of ``reports``."""
        self._reports.put(None)

    def stop(self) -> None:
        """Lets every process store a checkpoint and end; ``reports`` tells that they have."""
        for control in self._controls.values():
            control.stop()
        limit = time.monotonic() + self._grace + _FAREWELL
        for thread in self._threads.values():
            thread.join(max(0.0, limit - time.monotonic()))
