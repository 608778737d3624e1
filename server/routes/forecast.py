"""When a job that waits will begin, from the pace of the last ones: a range, or nothing."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from threading import Lock

from server.store import Database, JobFilter, JobRecord

__all__ = ["Pace", "queue_rates"]

_JOBS = 20
"""Jobs over which the pace is taken."""
_KEPT_SECONDS = 5.0
"""How long a pace is used before it is taken again. [s]"""
_MARGIN = 1.25
"""The pace of the next jobs may differ from that of the last ones by this factor."""


class Pace:
    """The pace of the whole queue, looked up every few seconds at most."""

    def __init__(self, *, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = Lock()
        self._taken = float("-inf")
        self._rates: tuple[float, float] | None = None

    def seconds(self, database: Database, steps: int) -> tuple[float, float] | None:
        """How long the queue takes for so many steps, least and most; None where nobody knows. [s]

        Args:
            database: Knows the last jobs.
            steps: Steps to be done before.
        """
        with self._lock:
            now = self._clock()
            # Where nothing was done yet, the first job that is counts at once.
            if self._rates is None or now - self._taken > _KEPT_SECONDS:
                done = database.jobs(JobFilter(states=("done",), kind="crossing"), limit=_JOBS)
                self._rates, self._taken = queue_rates(done), now
            rates = self._rates
        if rates is None:
            return None
        return steps / rates[1] / _MARGIN, steps / rates[0] * _MARGIN


def queue_rates(jobs: Sequence[JobRecord]) -> tuple[float, float] | None:
    """Slowest and fastest pace of the queue: over all these jobs, and over the newer half.

    Jobs that computed at the same time count their time once, so that a queue with several slots
    has the pace of all of them.

    Args:
        jobs: Jobs that are done, in any order.

    Returns:
        [steps/s], or None where no job took any time.
    """
    timed = [
        (job.started, job.ended, job.steps)
        for job in jobs
        if job.started is not None and job.ended is not None and job.ended > job.started
    ]
    timed.sort(key=lambda item: item[1])
    parts = [timed, timed[len(timed) // 2 :]]
    rates = [_rate(part) for part in parts if part]
    return (min(rates), max(rates)) if rates else None


def _rate(jobs: Iterable[tuple[float, float, int]]) -> float:
    busy, until, steps = 0.0, float("-inf"), 0
    for started, ended, count in sorted(jobs):
        busy += max(0.0, ended - max(started, until))
        until = max(until, ended)
        steps += count
    return max(1, steps) / busy
