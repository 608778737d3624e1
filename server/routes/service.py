"""What routes work with: settings, database, queue, drawing process, changes."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Annotated

from fastapi import Depends, Request

from server.errors import Problem, gone_missing
from server.jobs.coordinator import Coordinator
from server.routes.drawing import DrawingProcess
from server.settings import Settings
from server.store import Database, NotStoredError, RunReader, RunRecord, attempt_folder

__all__ = ["Changes", "Service", "ServiceDependency"]


class Changes:
    """Wakes event streams when something was stored; ends them when the server stops."""

    def __init__(self) -> None:
        self._loop: asyncio.AbstractEventLoop | None = None
        self._waiting: set[asyncio.Event] = set()
        self.ended = False

    @property
    def listeners(self) -> int:
        """Streams that are open."""
        return len(self._waiting)

    def bind(self) -> None:
        """Takes the running event loop as the one whose streams are woken."""
        self._loop = asyncio.get_running_loop()

    def notify(self) -> None:
        """Wakes every stream; from any thread."""
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._wake)

    def end(self) -> None:
        """Ends every stream; from any thread or signal handler."""
        self.ended = True
        self.notify()

    @asynccontextmanager
    async def listen(self) -> AsyncGenerator[asyncio.Event]:
        """An event that is set at each change."""
        changed = asyncio.Event()
        self._waiting.add(changed)
        try:
            yield changed
        finally:
            self._waiting.discard(changed)

    def _wake(self) -> None:
        for changed in self._waiting:
            changed.set()


@dataclass(frozen=True, kw_only=True)
class Service:
    """The parts of a running server."""

    settings: Settings
    database: Database
    coordinator: Coordinator
    drawing: DrawingProcess
    changes: Changes = field(default_factory=Changes)

    def run(self, run: str) -> RunRecord:
        """A run.

        Raises:
            Problem: 404.
        """
        found = self.database.run(run)
        if found is None:
            raise gone_missing("run", run)
        return found

    def reader(self, run: RunRecord) -> RunReader:
        """The results of a run's newest attempt.

        Raises:
            Problem: 409 where it has not come to its first step.
        """
        reader = RunReader(attempt_folder(self.settings.data, run.id, run.attempt))
        try:
            _ = reader.plan
        except NotStoredError:
            raise Problem(
                409, "No histories yet", f"The run is {run.state} and has no histories (yet)."
            ) from None
        return reader

    def open_reader(self, run: str) -> RunReader:
        """The results of a run by its id, for the viewer.

        Raises:
            Problem: 404, 409.
        """
        return self.reader(self.run(run))


def _service(request: Request) -> Service:
    return request.app.state.service


ServiceDependency = Annotated[Service, Depends(_service)]
