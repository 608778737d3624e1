"""Figures that share one process: one that dies, hangs or waits is no other one's trouble."""

from __future__ import annotations

import asyncio
import os
import signal
from collections.abc import Coroutine
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from typing import Any

import pytest

from server.errors import Problem
from server.routes import drawing as drawing_module
from server.routes.drawing import DrawingProcess

PATIENCE = 120.0
"""Only what is wrong takes so long. [s]"""


class Pool:
    """Stands for a process that draws when the test says so."""

    made: list[Pool]

    def __init__(self, **_: Any) -> None:
        self.futures: list[Future[bytes]] = []
        self.ended = self.broken = False
        self._processes: dict[int, Any] = {}
        self.made.append(self)

    def submit(self, *_: Any) -> Future[bytes]:
        """What waits to be drawn."""
        if self.broken:
            raise BrokenProcessPool
        self.futures.append(Future())
        return self.futures[-1]

    def shutdown(self, **_: Any) -> None:
        """Nothing more."""
        self.ended = True


@pytest.fixture
def pools(monkeypatch: pytest.MonkeyPatch) -> list[Pool]:
    """The processes in the order in which they were started."""
    Pool.made = []
    monkeypatch.setattr(drawing_module, "ProcessPoolExecutor", Pool)
    return Pool.made


async def began(work: Coroutine[Any, Any, bytes]) -> asyncio.Task[bytes]:
    """A figure that waits to be drawn."""
    task = asyncio.create_task(work)
    await asyncio.sleep(0)
    return task


async def assert_busy(task: asyncio.Task[bytes]) -> None:
    """The answer is 503, and come again."""
    with pytest.raises(Problem) as caught:
        await task
    assert caught.value.status == 503
    assert "Retry-After" in caught.value.headers


def test_a_figure_whose_process_died_does_not_end_the_next_one(pools: list[Pool]) -> None:
    """Of two figures that waited for it one heard later, and ended the process of a third."""

    async def scenario() -> None:
        drawing = DrawingProcess(pending=9, seconds=PATIENCE)
        first, late = await began(drawing.work(bytes)), await began(drawing.work(bytes))
        pools[0].futures[0].set_exception(BrokenProcessPool())
        await assert_busy(first)
        third = await began(drawing.work(bytes))
        pools[0].futures[1].set_exception(BrokenProcessPool())
        await assert_busy(late)
        assert [pool.ended for pool in pools] == [True, False]
        pools[1].futures[0].set_result(b"drawn")
        assert await third == b"drawn"

    asyncio.run(scenario())


def test_a_figure_that_only_waited_too_long_ends_no_process(pools: list[Pool]) -> None:
    async def scenario() -> None:
        drawing = DrawingProcess(pending=9, seconds=0.01)
        await assert_busy(await began(drawing.work(bytes)))
        assert [pool.ended for pool in pools] == [False]
        pools[0].submit = lambda *_: running  # type: ignore[method-assign]
        running: Future[bytes] = Future()
        running.set_running_or_notify_cancel()
        await assert_busy(await began(drawing.work(bytes)))
        assert [pool.ended for pool in pools] == [True]

    asyncio.run(scenario())


def test_a_process_that_ended_while_nobody_drew_is_replaced_at_once(pools: list[Pool]) -> None:
    async def scenario() -> None:
        drawing = DrawingProcess(pending=9, seconds=PATIENCE)
        first = await began(drawing.work(bytes))
        pools[0].futures[0].set_result(b"drawn")
        await first
        pools[0].broken = True
        second = await began(drawing.work(bytes))
        pools[1].futures[0].set_result(b"drawn again")
        assert await second == b"drawn again"

    asyncio.run(scenario())


@pytest.mark.slow
def test_figures_that_wait_for_a_process_that_is_ended_are_answered() -> None:
    """They looked as if their own requests had been cancelled: an internal error each."""

    async def scenario() -> None:
        drawing = DrawingProcess(pending=9, seconds=PATIENCE)
        await drawing.work(os.urandom, 1)
        for_ever: Any = signal.pause
        waiting = [await began(drawing.work(for_ever)) for _ in range(5)]
        drawing.close()
        for task in waiting:
            await assert_busy(task)

    asyncio.run(scenario())
