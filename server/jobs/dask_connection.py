"""A connection to a scheduler of Dask on which nothing waits for ever."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Collection, Sequence
from contextlib import suppress
from typing import Any

from distributed import Client, Future
from distributed.client import ClosedClientError
from distributed.security import Security

from server.jobs.dask_worker import TASK, TOPIC, AttemptsPlugin
from server.jobs.engine import EngineError

__all__ = ["SchedulerConnection"]

_WORKERS_SHARE = 0.3
"""Share of a call's time-out that a worker may take to answer."""

_log = logging.getLogger("trainbridge.jobs")


class SchedulerConnection:
    """One client of one scheduler.

    A scheduler that went away makes every call raise: the client would connect again by itself,
    but it forgets its futures, so that a new connection that reattaches is needed anyway.
    """

    def __init__(
        self,
        target: Any,
        *,
        scope: str,
        security: Security | None,
        seconds: float,
        on_message: Callable[[dict[str, Any]], None],
        on_end: Callable[[str], None],
    ) -> None:
        """Connects.

        Args:
            target: Address of a scheduler, or a cluster.
            scope: Whose tasks these are, where several coordinators share a scheduler.
            security: Certificates, if it has TLS.
            seconds: Time-out of each call. [s]
            on_message: Takes what attempts tell; called by the connection's thread.
            on_end: Takes the key of an attempt whose task has ended; called by another thread.

        Raises:
            EngineError: It does not answer.
        """
        self.address = target if isinstance(target, str) else str(target.scheduler_address)
        self._prefix = f"trainbridge/{scope}/"
        self._seconds = seconds
        self._on_end = on_end
        try:
            # Its types promise less than it has: ``Any`` here instead of a cast at every call.
            self._client: Any = Client(
                target, security=security, timeout=seconds, set_as_default=False, name="trainbridge"
            )
        except (OSError, ImportError, ValueError, TypeError) as error:
            raise EngineError(
                f"The Dask scheduler {self.address} does not answer ({error}). Start it "
                "(trainbridge scheduler), or correct the settings engine and tls_..."
            ) from error
        self._client.subscribe_topic(TOPIC, lambda event: on_message(event[1]))
        self._install()

    def _install(self) -> None:
        """Gives every worker, and those to come, what watches over attempts."""
        plugin = AttemptsPlugin()
        install = self._client._register_worker_plugin
        try:
            self.call(install, plugin, plugin.name, plugin.idempotent)
        except Exception as error:
            # A worker that is frozen or does not know us: it is refused when it is asked who it is.
            _log.info("a worker of %s cannot be used: %s", self.address, error)

    def require(self) -> None:
        """Makes sure that the connection stands.

        Raises:
            EngineError: It does not.
        """
        if self._client.status != "running":
            raise EngineError(
                f"The Dask scheduler {self.address} went away. Start it again; runs go on from "
                "their checkpoints."
            )

    def call(self, function: Callable[..., Awaitable[Any]], *args: Any, **named: Any) -> Any:
        """What a coroutine function of the client gives, in time.

        Raises:
            EngineError: The scheduler is lost, or took too long.
        """
        self.require()
        try:
            return self._client.sync(function, *args, callback_timeout=self._seconds, **named)
        except (OSError, TimeoutError, ClosedClientError, RuntimeError, AttributeError) as error:
            # AttributeError: a client that closes meanwhile has no scheduler.
            reason = str(error) or type(error).__name__
            raise EngineError(
                f"The Dask scheduler {self.address} did not answer ({reason})."
            ) from error

    # Workers.

    def threads(self) -> tuple[dict[str, int], dict[str, int]]:
        """Threads of each worker that is there, and of each that takes tasks."""
        scheduler = self._client.scheduler
        return self.call(_threads, scheduler)

    def ask(
        self, workers: Sequence[str], function: Callable[..., Any], *args: Any
    ) -> dict[str, Any]:
        """What a function of ours gives on each worker, or the exception that it met there.

        A worker that is frozen answers with ``TimeoutError`` and keeps nobody else waiting.
        """
        seconds = _WORKERS_SHARE * self._seconds

        async def ask_one(worker: str) -> Any:
            asked = self._client._run(function, *args, workers=[worker], on_error="return")
            try:
                return (await asyncio.wait_for(asked, seconds))[worker]
            except TimeoutError as error:
                return error

        async def ask_all() -> list[Any]:
            return await asyncio.gather(*map(ask_one, workers))

        return dict(zip(workers, self.call(ask_all), strict=True))

    # Tasks.

    def submit(self, key: str, worker: str, function: Callable[..., Any], *args: Any) -> Future:
        """Gives a task to a worker, under a name that outlives this process."""
        self.require()
        future = self._client.submit(
            function,
            *args,
            key=(TASK, key),
            workers=[worker],
            allow_other_workers=False,
            retries=0,
            pure=False,
        )
        self.call(self._client._publish_dataset, future, name=self._prefix + key, override=True)
        self._watch(key, future)
        return future

    def published(self) -> set[str]:
        """Keys of the attempts that were submitted and not forgotten, by whomever."""
        names = self.call(_published, self._client.scheduler)
        length = len(self._prefix)
        return {name[length:] for name in names if str(name).startswith(self._prefix)}

    def places(self, keys: Collection[str]) -> dict[str, str]:
        """The worker of each attempt that computes; empty for one that has ended.

        What waits for a worker that has gone is left out.
        """
        tasks = [(TASK, key) for key in keys]
        states, processing = self.call(_states, self._client.scheduler, tasks)
        workers = {task: worker for worker, found in processing.items() for task in found}
        return {
            task[1]: workers.get(task, "")
            for task in tasks
            if task in workers or states[task] in ("memory", "erred")
        }

    def adopt(self, key: str) -> Future:
        """The task of an attempt that another coordinator submitted."""
        future = self.call(self._client._get_dataset, self._prefix + key)
        self._watch(key, future)
        return future

    def result(self, future: Future) -> Any:
        """What a task gave.

        Raises:
            Exception: What the task met; ``TimeoutError`` where it cannot be had any more.
        """
        return future.result(timeout=self._seconds)

    def forget(self, keys: Sequence[str]) -> None:
        """Takes back the names of attempts that have ended and were reported."""
        self.call(self._client._unpublish_dataset, [self._prefix + key for key in keys])

    def close(self) -> None:
        """Lets go; what was submitted goes on."""
        with suppress(Exception):
            self._client.close(timeout=self._seconds)

    def _watch(self, key: str, future: Future) -> None:
        future.add_done_callback(lambda _: self._on_end(key))


async def _threads(scheduler: Any) -> tuple[dict[str, int], dict[str, int]]:
    return await scheduler.ncores(workers=None), await scheduler.ncores_running(workers=None)


async def _states(scheduler: Any, tasks: list[Any]) -> tuple[Any, Any]:
    return (
        await scheduler.get_task_status(keys=tasks),
        await scheduler.processing(workers=None),
    )


async def _published(scheduler: Any) -> Any:
    return await scheduler.publish_list()
