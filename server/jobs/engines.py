"""The engine that a setting names."""

from __future__ import annotations

from server.jobs.engine import Engine
from server.jobs.local_engine import LocalEngine
from server.settings import Settings

__all__ = ["open_engine"]


def open_engine(settings: Settings, installation: str) -> Engine:
    """The engine of ``settings.engine``, not started.

    Args:
        settings: The settings.
        installation: Names the database whose batches compute: others may use the same cluster.

    Raises:
        EngineError: The settings do not fit together.
    """
    if settings.engine == "local":
        return LocalEngine(settings.concurrent_batches, settings.grace_seconds)
    # Imported here: a server that computes by itself need not hold it in memory.
    from server.jobs.dask_engine import DaskEngine

    return DaskEngine(settings, installation)
