"""The machine that computes, and how busy it is: for the home page."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import psutil
from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict

from server.routes.service import Service, ServiceDependency
from server.settings import Settings
from server.version import package_version

__all__ = ["Machine", "router"]

router = APIRouter(prefix="/api/v1", tags=["meta"])

_STANDS_STILL = "The queue stands still. Restart the server; its log says more."


class Machine(BaseModel):
    """The machine that answers, its engine and its queue."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    cores: int
    """Processors that this process may use."""
    memory_bytes: int
    """[B]"""
    memory_available_bytes: int
    """That can be taken without swapping. [B]"""
    disk_free_bytes: int | None
    """Of the disk that takes the results; null where they go to an object store. [B]"""
    engine: str
    """Where runs compute: local, dask, slurm, or the kind of scheduler that is used."""
    workers: int | None
    """Runs that compute at once; null where another scheduler decides."""
    running: int
    """Jobs that compute."""
    queued: int
    """Jobs that wait."""
    version: str
    trouble: str
    """Why the queue hands out nothing at the moment; empty where all is well."""


@router.get("/machine")
def read_machine(service: ServiceDependency) -> Machine:
    """Processors, memory, disk and queue at this moment."""
    memory = psutil.virtual_memory()
    settings = service.settings
    return Machine(
        cores=usable_cores(),
        memory_bytes=memory.total,
        memory_available_bytes=memory.available,
        disk_free_bytes=_free_bytes(service.store.local),
        # Its address is nobody's business who only looks.
        engine=settings.engine.partition(":")[0],
        workers=_workers(settings),
        running=service.database.jobs_in("running"),
        queued=service.database.jobs_in("queued"),
        version=package_version(),
        trouble=_trouble(service),
    )


def usable_cores() -> int:
    """Processors that this process may use: containers and batch systems give it a part of all."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _workers(settings: Settings) -> int | None:
    if settings.engine in ("local", "dask"):
        return settings.concurrent_batches
    return settings.slurm_jobs * settings.slurm_cores if settings.engine == "slurm" else None


def _free_bytes(folder: Path | None) -> int | None:
    return None if folder is None else shutil.disk_usage(folder).free


def _trouble(service: Service) -> str:
    if service.queue_alive is not None and not service.queue_alive():
        return _STANDS_STILL
    return service.queue_trouble()
