"""One supervised batch: its process, its limits, and how it ended."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from server.jobs.process import BatchProcess
from server.jobs.states import Event
from server.store import BatchRecord

__all__ = ["Supervised"]


@dataclass(kw_only=True)
class Supervised:
    """A batch that computes.

    Attributes:
        batch: The batch as this attempt began.
        process: Its process.
        started: When, by the monotonic clock. [s]
        memory_limit: Resident memory at which it is ended. [B]
        verdicts: Of the runs that finished, by run.
        silent: Whether the process has closed its end of the pipe.
    """

    batch: BatchRecord
    process: BatchProcess
    started: float
    memory_limit: int
    verdicts: dict[str, Any] = field(default_factory=dict[str, Any])
    silent: bool = False
    _told: tuple[Event, str] | None = None
    _ending: tuple[Event, str] | None = None
    _asked_at: float = 0.0

    def take_messages(self) -> Iterator[tuple[str, Mapping[str, Any]]]:
        """Takes what the process has sent; yields progress as (run, report)."""
        while not self.silent:
            try:
                if not self.process.connection.poll():
                    return
                message = self.process.connection.recv()
            except (EOFError, OSError):
                self.silent = True
                return
            kind = message[0]
            if kind == "progress":
                yield message[1], message[2]
            elif kind == "finished":
                self.verdicts[message[1]] = message[2].get("verdicts", [])
            else:
                event = Event.EXHAUST_MEMORY if kind == "out_of_memory" else Event.FAIL
                self._told = (event, message[1])

    def enforce(self, now: float, seconds: float, grace: float) -> None:
        """Ends the process where it is beyond a limit; kills it where it does not end.

        Args:
            now: Monotonic time. [s]
            seconds: Wall-clock limit of a batch. [s]
            grace: Time between asking and killing. [s]
        """
        if self._ending is not None:
            if now - self._asked_at >= grace:
                self.process.kill()
            return
        if now - self.started > seconds:
            text = f"The run took longer than the limit of {seconds:g} s."
            self.end(Event.TIME_OUT, f"{text} Try a coarser mesh or a longer time step.")
        elif (memory := self.process.memory()) > self.memory_limit:
            text = f"The run took {memory / 1e6:.0f} MB, the limit is {self.memory_limit / 1e6:.0f}"
            self.end(Event.EXHAUST_MEMORY, f"{text} MB. Try a coarser mesh.")

    def end(self, event: Event, reason: str) -> None:
        """Asks the process to end, once."""
        if self._ending is None:
            self._ending = (event, reason)
            self._asked_at = time.monotonic()
            self.process.terminate()

    def outcome(self) -> tuple[Event, str]:
        """How the batch ended: what it said itself counts before what was done to it."""
        if self._told is not None:
            return self._told
        if len(self.verdicts) == len(self.batch.runs):
            return Event.FINISH, ""
        if self._ending is not None:
            return self._ending
        code = self.process.exit_code
        if code is not None and code < 0:
            text = f"ended by the signal {_signal_name(-code)}"
            if -code == signal.SIGKILL:
                text += ", as the operating system does when memory runs out"
        else:
            text = f"ended without a result (exit code {code})"
        return Event.FAIL, f"The computing process was {text}. The server's log may say more."


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return str(number)
