"""Wakes event streams when something was stored, by this process or by another."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncGenerator, Callable
from contextlib import asynccontextmanager

from starlette.concurrency import run_in_threadpool

__all__ = ["Changes"]

_RETRY_SECONDS = 1.0
"""Time between two looks at a database that does not answer. [s]"""

_log = logging.getLogger("trainbridge.events")


class Changes:
    """Wakes event streams; ends them when the server stops.

    Where the coordinator is a thread of this process it calls ``notify``. Where it is elsewhere,
    ``follow`` makes this process look for new events, but only while somebody listens.
    """

    def __init__(self) -> None:
        self._loop: asyncio.AbstractEventLoop | None = None
        self._waiting: set[asyncio.Event] = set()
        self._last_event: Callable[[], int] | None = None
        self._seconds = 0.0
        self._poller: asyncio.Task[None] | None = None
        self.ended = False

    @property
    def listeners(self) -> int:
        """Streams that are open."""
        return len(self._waiting)

    def bind(self) -> None:
        """Takes the running event loop as the one whose streams are woken."""
        self._loop = asyncio.get_running_loop()

    def follow(self, last_event: Callable[[], int], seconds: float) -> None:
        """Looks for events that another process stores.

        Args:
            last_event: Number of the newest event; may block.
            seconds: How often it is asked while somebody listens. [s]
        """
        self._last_event = last_event
        self._seconds = seconds

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
        if self._last_event is not None and self._poller is None:
            self._poller = asyncio.create_task(self._poll(self._last_event))
        try:
            yield changed
        finally:
            self._waiting.discard(changed)
            if not self._waiting and self._poller is not None:
                self._poller.cancel()
                self._poller = None

    def _wake(self) -> None:
        for changed in self._waiting:
            changed.set()

    async def _poll(self, last_event: Callable[[], int]) -> None:
        known, answers = -1, True
        while not self.ended:
            try:
                newest = await run_in_threadpool(last_event)
            except Exception:
                # Whatever it is, the database may come back: streams go on then.
                if answers:
                    _log.exception("the database does not tell its newest event")
                answers = False
                await asyncio.sleep(_RETRY_SECONDS)
                continue
            answers = True
            if newest != known:
                known = newest
                self._wake()
            await asyncio.sleep(self._seconds)
