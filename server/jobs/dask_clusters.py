"""Schedulers of Dask that this process starts itself, and how all of ours behave."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import dask.config
from distributed import LocalCluster
from distributed.security import Security

from server.jobs.engine import EngineError
from server.jobs.environment import SINGLE_THREAD
from server.settings import Settings

__all__ = ["OwnCluster", "configure", "open_local_cluster"]

_CONFIGURATION: dict[str, Any] = {
    # SQL alone counts attempts, and no task moves to another worker.
    "distributed.scheduler.allowed-failures": 0,
    "distributed.scheduler.work-stealing": False,
    "distributed.scheduler.active-memory-manager.start": False,
    # No pages of information: they have no password.
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    # Workers start processes.
    "distributed.worker.daemon": False,
    "distributed.worker.profile.enabled": False,
    "distributed.nanny.pre-spawn-environ": SINGLE_THREAD,
}

_START_SECONDS = 120.0
"""Time that the workers of this machine may take to start, busy as it may be. [s]"""


class OwnCluster:
    """A scheduler in this process, with its workers.

    Attributes:
        cluster: The cluster of Dask.
        security: Its certificates.
    """

    def __init__(
        self,
        cluster: Any,
        security: Security,
        *,
        seconds: float,
        keep_up: Callable[[], None] = lambda: None,
    ) -> None:
        self.cluster = cluster
        self.security = security
        self.keep_up = keep_up
        self._seconds = seconds

    def close(self) -> None:
        """Ends the workers and the scheduler."""
        with suppress(Exception):
            self.cluster.close(timeout=self._seconds)


def configure() -> None:
    """Sets how schedulers and workers of this process and of its children behave.

    For good, because workers that are started again later read it too.
    """
    dask.config.set(_CONFIGURATION)


def open_local_cluster(settings: Settings) -> OwnCluster:
    """A scheduler in this process and workers on this machine, with certificates of their own.

    Everyone on the machine may reach a loopback port: only those who hold the certificate, made
    for this cluster and kept in memory, may use it.

    Raises:
        EngineError: The workers do not start.
    """
    configure()
    security = Security.temporary()
    cluster = LocalCluster(
        n_workers=0,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        protocol="tls://",
        security=security,
        dashboard_address="127.0.0.1:0",
        scheduler_kwargs={"dashboard": False},
        # Each batch's own limit counts.
        memory_limit=0,
        # Else its first task would wait for it, and everything else of the worker as well.
        preload=["server.jobs.dask_worker"],
        silence_logs=logging.ERROR,
    )
    own = OwnCluster(cluster, security, seconds=settings.engine_seconds)
    cluster.scale(settings.concurrent_batches)
    try:
        cluster.wait_for_workers(settings.concurrent_batches, timeout=_START_SECONDS)
    except TimeoutError as error:
        own.close()
        raise EngineError(
            f"The {settings.concurrent_batches} workers did not start within "
            f"{_START_SECONDS:g} s. Set a smaller concurrent_batches, or see the log."
        ) from error
    return own
