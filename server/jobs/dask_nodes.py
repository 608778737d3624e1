"""A scheduler and a worker of a cluster, each a process of its own that a signal ends.

``trainbridge scheduler`` and ``trainbridge worker`` call these.
"""

from __future__ import annotations

import asyncio
import logging
import signal
import time
from collections.abc import Awaitable, Callable
from typing import Any

from distributed import Scheduler, Worker

from server.jobs.dask_clusters import configure
from server.jobs.dask_security import scheduler_security
from server.jobs.dask_worker import AttemptsPlugin
from server.jobs.engine import EngineError
from server.jobs.environment import single_threaded
from server.settings import Settings
from server.settings.addresses import is_loopback, scheduler_address

__all__ = ["run_scheduler", "run_worker"]

_CLOSE_SECONDS = 10.0
"""Time that the end of a node may take after its batches have ended. [s]"""
_AGAIN_SECONDS = 0.5
"""Pause between two tries to reach a scheduler. [s]"""


def run_scheduler(settings: Settings, *, host: str, port: int) -> None:
    """Runs a scheduler until SIGTERM or SIGINT; prints its address when it is ready.

    With the settings ``tls_...`` it takes only encrypted connections.

    Raises:
        EngineError: The address is unsafe or taken.
    """
    configure()
    scheme = "tls" if settings.tls_ca_file else "tcp"
    url = f"{scheme}://{host}:{port or 1}"
    security = scheduler_security(url, settings)

    async def serve(ended: asyncio.Event) -> None:
        try:
            scheduler: Any = await Scheduler(
                host=host,
                port=port,
                protocol=f"{scheme}://",
                security=security,
                dashboard=False,
                dashboard_address="127.0.0.1:0",
            )
        except (OSError, RuntimeError) as error:
            raise EngineError(
                f"The scheduler cannot listen on {host}:{port} ({error}). Give another --port."
            ) from error
        print(f"scheduler ready at {scheduler.address}", flush=True)
        await ended.wait()
        await scheduler.close(reason="asked to end")

    _run_until_signal(serve)


def run_worker(settings: Settings, *, scheduler: str, slots: int, name: str | None = None) -> None:
    """Runs a worker until SIGTERM or SIGINT: its batches then store checkpoints and end.

    Where the scheduler goes away its batches do so too, and the worker connects again.

    Args:
        settings: Certificates, time-outs.
        scheduler: Its address.
        slots: Batches at once.
        name: What the scheduler calls it; none for its address.

    Raises:
        EngineError: The scheduler is unsafe, or stays away for ``engine_seconds``.
    """
    single_threaded()
    configure()
    security = scheduler_security(scheduler, settings)

    async def serve(ended: asyncio.Event) -> None:
        while not ended.is_set():
            worker = await _connect(
                scheduler,
                ended,
                settings.engine_seconds,
                nthreads=slots,
                security=security,
                name=name,
            )
            if worker is None:
                return
            print(f"worker ready at {worker.address} for {scheduler}", flush=True)
            finished = asyncio.ensure_future(worker.finished())
            await _first_of(finished, ended)
            await worker.close(timeout=_CLOSE_SECONDS, reason="asked to end")
            await finished

    _run_until_signal(serve)


async def _connect(scheduler: str, ended: asyncio.Event, seconds: float, **options: Any) -> Any:
    """A worker that the scheduler has accepted; None where the process was asked to end."""
    limit = time.monotonic() + seconds
    while not ended.is_set():
        worker: Any = Worker(
            scheduler,
            host="127.0.0.1" if _is_near(scheduler) else None,
            memory_limit=0,
            death_timeout=seconds,
            dashboard=False,
            dashboard_address="127.0.0.1:0",
            plugins=(AttemptsPlugin(),),
            **options,
        )
        started = asyncio.ensure_future(_start(worker))
        await _first_of(started, ended)
        if not started.done():
            started.cancel()
        elif (error := started.result()) is None:
            return worker
        elif time.monotonic() > limit:
            raise EngineError(
                f"The scheduler {scheduler} stays away ({error}). Start it (trainbridge "
                "scheduler), or correct the address and the settings tls_..."
            ) from error
        await worker.close(nanny=False, reason="no scheduler")
        await asyncio.sleep(_AGAIN_SECONDS)
    return None


async def _start(worker: Any) -> Exception | None:
    """Starts a worker; what went wrong, if anything."""
    try:
        await worker
    except (OSError, TimeoutError, RuntimeError) as error:
        return error
    return None


async def _first_of(task: asyncio.Future[Any], event: asyncio.Event) -> None:
    """Waits until a task has ended or an event came."""
    asked = asyncio.ensure_future(event.wait())
    await asyncio.wait({task, asked}, return_when=asyncio.FIRST_COMPLETED)
    asked.cancel()


def _is_near(scheduler: str) -> bool:
    """Whether only this machine reaches the scheduler, and so need reach its workers."""
    address = scheduler_address(scheduler)
    return address is not None and is_loopback(address[1])


def _run_until_signal(serve: Callable[[asyncio.Event], Awaitable[None]]) -> None:
    """Runs a node; SIGTERM or SIGINT sets the event that it is given."""
    logging.getLogger("distributed").setLevel(logging.ERROR)

    async def run() -> None:
        ended = asyncio.Event()
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, ended.set)
        await serve(ended)

    asyncio.run(run())
