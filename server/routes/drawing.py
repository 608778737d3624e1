"""Figures as files: drawn by one side process with a short queue, never by the event loop."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from typing import Any

from server.errors import Problem
from server.jobs.process import end_with_parent
from server.plots import render

__all__ = ["DrawingProcess"]


class DrawingProcess:
    """Starts its process when the first figure is asked for."""

    def __init__(self, *, pending: int, seconds: float) -> None:
        """Lets ``pending`` figures wait, and each take at most ``seconds``. [s]"""
        self._pending = pending
        self._seconds = seconds
        self._waiting = 0
        self._pool: ProcessPoolExecutor | None = None

    async def draw(self, figure: dict[str, Any], file_format: str) -> bytes:
        """A figure as PNG, SVG or PDF.

        Raises:
            Problem: 503 with ``Retry-After``: too many figures wait, or this one took too long.
        """
        return await self.work(render, figure, file_format)

    async def work(self, write: Callable[..., bytes], *arguments: Any) -> bytes:
        """A file's bytes, made in the process by a function that can be imported there.

        Raises:
            Problem: 503 with ``Retry-After``: too many files wait, or this one took too long.
        """
        if self._waiting >= self._pending:
            raise _busy("Too many figures wait to be drawn.")
        self._waiting += 1
        try:
            return await self._drawn(write, arguments)
        finally:
            self._waiting -= 1

    async def _drawn(self, write: Callable[..., bytes], arguments: tuple[Any, ...]) -> bytes:
        pool = self._open()
        try:
            drawing = pool.submit(write, *arguments)
        except BrokenProcessPool:
            # Its process ended while nobody drew.
            pool = self._another(pool)
            drawing = pool.submit(write, *arguments)
        try:
            return await asyncio.wait_for(asyncio.wrap_future(drawing), self._seconds)
        except TimeoutError:
            # One that only waited for its turn holds up nobody.
            if not drawing.cancel():
                self._end(pool)
            raise _busy("The figure took too long to draw.") from None
        except BrokenProcessPool:
            self._end(pool)
            raise _busy("The drawing process ended unexpectedly.") from None

    def close(self) -> None:
        """Ends the process; the next figure starts another."""
        if self._pool is not None:
            self._end(self._pool)

    def _end(self, pool: ProcessPoolExecutor) -> None:
        """Ends a process, unless another has taken its place: several figures may have waited."""
        if pool is not self._pool:
            return
        self._pool = None
        processes = list((pool._processes or {}).values())  # pyright: ignore[reportPrivateUsage]
        # Without cancelling what waits: a cancelled future would look as if its request were.
        pool.shutdown(wait=False)
        # Waiting for a figure that takes too long is what we do not want.
        for process in processes:
            process.kill()

    def _another(self, pool: ProcessPoolExecutor) -> ProcessPoolExecutor:
        self._end(pool)
        return self._open()

    def _open(self) -> ProcessPoolExecutor:
        if self._pool is None:
            # Not of the forkserver of runs, which comes and goes with them.
            self._pool = ProcessPoolExecutor(
                max_workers=1, mp_context=get_context("spawn"), initializer=end_with_parent
            )
        return self._pool


def _busy(detail: str) -> Problem:
    return Problem(
        503, "Drawing is busy", f"{detail} Try again in a moment.", headers={"Retry-After": "2"}
    )
