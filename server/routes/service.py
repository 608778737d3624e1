"""What routes work with: settings, database, store, queue, drawing process, changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated

from fastapi import Depends, Request

from server.errors import Problem, gone_missing
from server.jobs.submission import Capacity
from server.routes.changes import Changes
from server.routes.drawing import DrawingProcess
from server.routes.forecast import Pace
from server.routes.past_runs import PastRuns
from server.settings import Settings
from server.store import (
    Database,
    JobRecord,
    Place,
    RunReader,
    RunRecord,
    attempt_place,
)

__all__ = ["Service", "ServiceDependency"]

_LONGEST_ID = 64


@dataclass(frozen=True, kw_only=True)
class Service:
    """The parts of a running server.

    Attributes:
        settings: Of the server.
        database: The truth of the queue.
        store: Where results are.
        drawing: Draws figures as files.
        wake: Tells a coordinator of this process that something is asked of it; does nothing where
            it is elsewhere, for it looks by itself.
        queue_alive: Whether the coordinator of this process works; None where it is elsewhere.
        queue_trouble: Why the coordinator of this process hands out nothing at the moment; empty
            where all is well.
        changes: Wakes event streams.
        pace: How fast the last jobs went.
    """

    settings: Settings
    database: Database
    store: Place
    drawing: DrawingProcess
    wake: Callable[[], None]
    queue_alive: Callable[[], bool] | None = None
    queue_trouble: Callable[[], str] = lambda: ""
    changes: Changes = field(default_factory=Changes)
    pace: Pace = field(default_factory=Pace)

    @cached_property
    def past_runs(self) -> PastRuns:
        """How long runs took beside what was estimated, and what they found."""
        return PastRuns(self.database, self.store)

    def capacity(self) -> Capacity:
        """What a study may take, where it will be computed and stored."""
        settings = self.settings
        here = settings.coordinator and settings.engine in ("local", "dask")
        return Capacity.now(settings.limits, self.store.local, computes_here=here)

    def asked(self) -> None:
        """Tells the coordinator and every stream that the database holds something new."""
        self.wake()
        self.changes.notify()

    def job(self, job: str) -> JobRecord:
        """A job.

        Raises:
            Problem: 404.
        """
        found = self.database.job(job) if _may_be_id(job) else None
        if found is None:
            raise gone_missing("job", job)
        return found

    def run(self, run: str) -> RunRecord:
        """A run.

        Raises:
            Problem: 404.
        """
        found = self.database.run(run) if _may_be_id(run) else None
        if found is None:
            raise gone_missing("run", run)
        return found

    def reader(self, run: RunRecord) -> RunReader:
        """The results of a run's newest attempt that has any.

        An attempt that is about to resume shows what the one before it had.

        Raises:
            Problem: 409 where none has come to its first step.
        """
        for attempt in range(run.attempt, 0, -1):
            reader = RunReader(attempt_place(self.store, run.id, attempt))
            if reader.has_plan:
                return reader
        detail = f"The run is {run.state} and has no histories (yet)."
        raise Problem(409, "No histories yet", detail)

    def open_reader(self, run: str) -> RunReader:
        """The results of a run by its id, for the viewer.

        Raises:
            Problem: 404, 409.
        """
        return self.reader(self.run(run))


def _may_be_id(text: str) -> bool:
    """Whether a text may be asked for at all: not every database takes every character."""
    return text.isascii() and text.isalnum() and len(text) <= _LONGEST_ID


def _service(request: Request) -> Service:
    return request.app.state.service


ServiceDependency = Annotated[Service, Depends(_service)]
