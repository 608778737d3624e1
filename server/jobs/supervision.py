"""One supervised batch: its process, its limits, and how it ended.

``supervise`` runs wherever a batch computes, in a thread of the server or of a cluster's worker.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Collection
from multiprocessing.connection import wait
from typing import Any

import psutil

from server.jobs.orders import Order, Report
from server.jobs.process import STOPPED, BatchProcess
from server.jobs.states import Event

__all__ = ["Control", "supervise"]

_log = logging.getLogger("trainbridge.jobs")

_MOST_WORDS = 32_000
"""Characters of what a process prints that are held."""
_LAST_WORDS = 4000
"""Characters of it that go into the log."""

_OF_THE_BATCH = {
    "failed": Event.FAIL,
    "out_of_memory": Event.EXHAUST_MEMORY,
    "lost": Event.LOSE,
}
"""Messages that end a batch as a whole."""

Post = Callable[[Report], None]


class Control:
    """What an engine asks of one attempt, from any thread."""

    def __init__(self) -> None:
        self.reader, self._writer = multiprocessing.Pipe(duplex=False)
        self._lock = threading.Lock()
        self._closed = False

    def cancel(self, runs: Collection[str] = ()) -> None:
        """Takes runs out at their next step; ends the attempt where none is named."""
        self._send(("cancel", tuple(runs)))

    def stop(self) -> None:
        """Lets the attempt store a checkpoint and end."""
        self._send(("stop", ()))

    def close(self) -> None:
        """The attempt has ended: what comes later is not heard."""
        with self._lock:
            self._closed = True
            self.reader.close()
            self._writer.close()

    def _send(self, request: tuple[str, tuple[str, ...]]) -> None:
        with self._lock:
            if not self._closed:
                self._writer.send(request)


def supervise(order: Order, post: Post, control: Control) -> None:
    """Computes an order in a process of its own, and tells how it goes.

    Args:
        order: What to compute.
        post: Takes each report; the last one is ``ended``.
        control: Whose requests are obeyed; closed at the end.
    """
    try:
        event, error = _Supervised(order, post, control).until_ended()
    except Exception as failure:
        _log.exception("attempt %s could not be supervised", order.key)
        # Of this machine, not of the run: tried again, and failed if it happens every time.
        event, error = Event.DIE, f"The run could not be supervised: {failure}."
    control.close()
    post(Report(key=order.key, kind="ended", data={"event": str(event), "error": error}))


class _Supervised:
    def __init__(self, order: Order, post: Post, control: Control) -> None:
        self._order = order
        self._post = post
        self._control = control
        self._limits = order.limits
        self._left = {run.id for run in order.runs} if order.purpose == "runs" else set[str]()
        self._told: tuple[Event, str] | None = None
        self._ending: tuple[Event, str] | None = None
        self._asked_at = 0.0
        self._last_words = ""
        self._sources: dict[Any, Callable[[], bool]] = {}

    def until_ended(self) -> tuple[Event, str]:
        """Starts the process and stays with it."""
        memory = self._memory_limit()
        process = BatchProcess(self._order)
        self._post_one("started", data={"process": process.pid})
        started = time.monotonic()
        try:
            self._listen_to(process)
            looked_at = started
            while process.alive or self._hears_more():
                for source in wait([*self._sources, process.sentinel], self._limits.poll_seconds):
                    self._take(source)
                now = time.monotonic()
                if now - looked_at >= self._limits.poll_seconds or self._ending is not None:
                    looked_at = now
                    self._enforce(process, now, now - started, memory)
            return self._outcome(process.exit_code)
        finally:
            process.close()
            if words := _worth_keeping(self._last_words):
                self._post_one("log", data={"text": words})

    def _memory_limit(self) -> int:
        if self._limits.memory_bytes:
            return self._limits.memory_bytes
        return int(self._limits.memory_fraction * psutil.virtual_memory().available)

    # What comes in.

    def _listen_to(self, process: BatchProcess) -> None:
        self._sources = {
            process.messages: lambda: self._take_message(process),
            process.errors: lambda: self._take_words(process),
            self._control.reader: lambda: self._obey(process),
        }

    def _hears_more(self) -> bool:
        """Whether something of the ended process waits to be read."""
        return bool(set(wait(list(self._sources), 0)) - {self._control.reader})

    def _take(self, source: Any) -> None:
        take = self._sources.get(source)
        if take is not None and not take():
            del self._sources[source]

    def _take_message(self, process: BatchProcess) -> bool:
        try:
            kind, run, data = process.messages.recv()
        except (EOFError, OSError):
            return False
        if not run and kind in _OF_THE_BATCH:
            self._told = (_OF_THE_BATCH[kind], data.get("error", ""))
            return True
        if kind in ("finished", "failed", "cancelled"):
            self._left.discard(run)
        self._post_one(kind, run, data)
        return True

    def _take_words(self, process: BatchProcess) -> bool:
        try:
            words = os.read(process.errors.fileno(), 65536)
        except OSError:
            return False
        self._last_words = (self._last_words + words.decode(errors="replace"))[-_MOST_WORDS:]
        return bool(words)

    def _obey(self, process: BatchProcess) -> bool:
        request, runs = self._control.reader.recv()
        wanted = self._left.intersection(runs)
        if request == "stop":
            self._end(process, Event.STOP, "")
        elif wanted and wanted < self._left:
            process.cancel(tuple(wanted))
        elif wanted or not runs:
            process.cancel(tuple(self._left))
            self._end(process, Event.CANCEL, "")
        return True

    # Limits and the end.

    def _enforce(self, process: BatchProcess, now: float, age: float, memory_limit: int) -> None:
        if self._ending is not None:
            if now - self._asked_at >= self._limits.grace_seconds:
                process.kill()
            return
        if age > self._limits.seconds:
            text = f"The run took longer than the limit of {self._limits.seconds:g} s."
            self._end(process, Event.TIME_OUT, f"{text} Try a coarser mesh or a longer time step.")
        elif (memory := process.memory()) > memory_limit:
            text = f"The run took {memory / 1e6:.0f} MB, the limit is {memory_limit / 1e6:.0f} MB."
            self._end(process, Event.EXHAUST_MEMORY, f"{text} Try a coarser mesh.")

    def _end(self, process: BatchProcess, event: Event, reason: str) -> None:
        """Asks the process to end, once."""
        if self._ending is None:
            self._ending = (event, reason)
            self._asked_at = time.monotonic()
            process.terminate()

    def _outcome(self, code: int | None) -> tuple[Event, str]:
        """How the batch ended: what it said itself counts before what was done to it."""
        if self._told is not None:
            return self._told
        if code == 0 and not self._left:
            return Event.FINISH, ""
        if self._ending is not None:
            return self._ending
        if code in (STOPPED, -signal.SIGTERM):
            return Event.STOP, ""
        if code is not None and code < 0:
            text = f"ended by the signal {_signal_name(-code)}"
            if -code == signal.SIGKILL:
                text += ", as the operating system does when memory runs out"
        else:
            text = f"ended without a result (exit code {code})"
        return Event.DIE, f"The computing process was {text}. The job's log may say more."

    def _post_one(self, kind: str, run: str = "", data: Any = None) -> None:
        self._post(Report(key=self._order.key, kind=kind, run=run, data=data or {}))


def _worth_keeping(words: str) -> str:
    """The end of what a process printed, without the modules that a fault report lists."""
    lines = [line for line in words.splitlines() if not line.startswith("Extension modules:")]
    return "\n".join(lines).strip()[-_LAST_WORDS:]


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return str(number)
