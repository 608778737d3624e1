"""Following a job: one connection's events, and reconnecting when it breaks."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, Literal

import httpx

from server.client.failures import ProblemError, away, refusal
from server.routes.schemas import Job, StateName

__all__ = ["ENDED", "WatchEvent", "watch"]

ENDED: frozenset[StateName] = frozenset(
    {"done", "failed", "cancelled", "timed_out", "out_of_memory"}
)
"""States that a job leaves only by a retry."""

_FIRST_PAUSE = 0.1
_LONGEST_PAUSE = 5.0
"""Shortest and longest time between two attempts to reconnect. [s]"""
_PASSING = frozenset({502, 503, 504})
"""Statuses of a server that is busy, and of a proxy whose server restarts."""


@dataclass(frozen=True, kw_only=True)
class WatchEvent:
    """Something that happened to a job.

    Attributes:
        number: Of the event, to begin after it another time.
        kind: ``job`` or ``progress``.
        job: The job as it is now, of a ``job`` event.
        progress: Of a ``progress`` event: ``run``, ``step``, ``steps``, ``fraction``, ``stage``...
    """

    number: int
    kind: Literal["job", "progress"]
    job: Job | None = None
    progress: Mapping[str, Any] | None = None

    @property
    def is_end(self) -> bool:
        """Whether the job has ended."""
        return self.job is not None and self.job.state in ENDED


Connect = Callable[[int], AbstractContextManager[httpx.Response]]
"""Opens the stream of a job after an event."""


def watch(
    connect: Connect, *, url: str, after: int, patience: float, deadline: float | None
) -> Iterator[WatchEvent]:
    """A job's events until it has ended, over as many connections as it takes.

    Args:
        connect: Opens a connection.
        url: The server's, for the words of errors.
        after: Begin after this event.
        patience: How long to try again where the server went away. [s]
        deadline: When to give up, of ``time.monotonic``; None for never. [s]

    Raises:
        ProblemError: The server refuses.
        ServerAwayError: The server is not there, or stayed away for ``patience`` seconds.
        TimeoutError: The deadline has passed.
    """
    last, pause = after, _FIRST_PAUSE
    # Who never answered is not there: only what breaks off is worth waiting for.
    gone: float | None = -math.inf
    while True:
        try:
            with connect(last) as answer:
                if answer.is_success:
                    gone = None
                for event in _job_events(answer, last, deadline):
                    last, pause = event.number, _FIRST_PAUSE
                    yield event
                    if event.is_end:
                        return
        except (httpx.HTTPError, ProblemError) as error:
            _require_time(deadline)
            now = time.monotonic()
            gone = now if gone is None else gone
            passes = isinstance(error, httpx.HTTPError) or error.status in _PASSING
            if now - gone > patience or not passes:
                raise (away(url, error) if isinstance(error, httpx.HTTPError) else error) from error
        _require_time(deadline)
        time.sleep(pause)
        pause = min(2 * pause, _LONGEST_PAUSE)


def _job_events(answer: httpx.Response, last: int, deadline: float | None) -> Iterator[WatchEvent]:
    """One connection's events, the job's end always the last of them.

    A stream begins with the job as it is, before what was missed: an end is held back until the
    server says that nothing more waits.
    """
    if not answer.is_success:
        answer.read()
        raise refusal(answer)
    caught_up, end = False, None
    for number, kind, value in _messages(answer, last):
        _require_time(deadline)
        if kind == "comment":
            caught_up = True
        elif kind == "progress":
            yield WatchEvent(number=number, kind="progress", progress=json.loads(value))
        elif kind == "job":
            event = WatchEvent(number=number, kind="job", job=Job.model_validate_json(value))
            end = event if event.is_end else None
            if end is None:
                yield event
        if caught_up and end is not None:
            yield end
            return


def _messages(answer: httpx.Response, last: int) -> Iterator[tuple[int, str, str]]:
    """(number, kind, data) of each event; of comments the kind is ``comment``."""
    number, kind = last, ""
    for line in answer.iter_lines():
        name, _, value = line.partition(": ")
        if line.startswith(":"):
            yield number, "comment", value
        elif name == "id":
            number = int(value)
        elif name == "event":
            kind = value
        elif name == "data":
            yield number, kind, value


def _require_time(deadline: float | None) -> None:
    if deadline is not None and time.monotonic() > deadline:
        raise TimeoutError("The job has not ended in time.")
