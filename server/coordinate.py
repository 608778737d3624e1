"""A coordinator with all that it needs: as a thread of the server, or as a process of its own."""

from __future__ import annotations

import logging
import multiprocessing
import signal
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from types import FrameType
from typing import Any

from sqlalchemy.exc import SQLAlchemyError

from server.jobs.computing import compute_order
from server.jobs.coordinator import Coordinator, Lock
from server.jobs.engine import EngineError
from server.jobs.engines import open_engine
from server.jobs.lock import FolderInUseError, queue_lock
from server.jobs.orders import Compute
from server.jobs.process import end_with_parent
from server.settings import Settings
from server.store import (
    Database,
    Place,
    SchemaVersionError,
    StoreError,
    check_place,
    claim_store,
    open_place,
)

__all__ = [
    "CoordinatorProcess",
    "StartError",
    "new_coordinator",
    "open_database",
    "require_usable",
    "run_coordinator",
]

_log = logging.getLogger("trainbridge.jobs")

_LOOK_SECONDS = 0.2
"""How often a coordinator's process is looked at. [s]"""
_RESTART_SECONDS = 1.0
"""Pause before a coordinator that ended is started again. [s]"""
_FAREWELL = 5.0
"""Time that a coordinator takes to end beyond the grace time, at most. [s]"""


class StartError(Exception):
    """Why a server or a coordinator cannot start; the text says what to do."""


def open_database(settings: Settings) -> Database:
    """The database that the settings name; the data folder is made where it lies there.

    Raises:
        SchemaVersionError: It belongs to another version of this program.
        OSError: The data folder cannot be made.
    """
    if not settings.database:
        settings.data.mkdir(parents=True, exist_ok=True)
    return Database(settings.database_url)


def require_usable(settings: Settings, *, lock: bool) -> None:
    """Finds out before anything starts what would stop it.

    Args:
        settings: The settings.
        lock: Whether the queue has to be free.

    Raises:
        StartError: Database, store or queue cannot be used.
    """
    try:
        database = open_database(settings)
        try:
            if lock:
                queue_lock(settings, database).release()
            store = open_place(settings.store_url)
            check_place(store)
            claim_store(store, database)
        finally:
            database.close()
    except (FolderInUseError, SchemaVersionError, StoreError) as error:
        raise StartError(str(error)) from error
    except SQLAlchemyError as error:
        raise StartError(f"The database cannot be used: {error}. See --database.") from error
    except OSError as error:
        raise StartError(
            f"The data folder {settings.data} cannot be written: {error.strerror}. "
            "Give another one with --data."
        ) from error


def new_coordinator(
    settings: Settings,
    database: Database,
    store: Place,
    lock: Lock,
    *,
    compute: Compute = compute_order,
    on_change: Callable[[], None] = lambda: None,
) -> Coordinator:
    """A coordinator with the engine that the settings name, not started."""
    return Coordinator(
        database,
        store,
        settings,
        open_engine(settings, database.installation()),
        lock,
        compute=compute,
        on_change=on_change,
    )


def run_coordinator(
    settings: Settings,
    *,
    compute: Compute = compute_order,
    tell: Callable[[str], None] = lambda trouble: None,
) -> None:
    """Coordinates until SIGTERM or Ctrl-C, or until another coordinator has taken the queue.

    Args:
        settings: The settings.
        compute: What a batch's process does.
        tell: Told why nothing computes, whenever that changes; empty for no trouble.

    Raises:
        StartError: Database, store or queue cannot be used.
    """
    require_usable(settings, lock=True)
    asked = threading.Event()

    def stop(number: int, frame: FrameType | None) -> None:
        asked.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    database = open_database(settings)
    try:
        with queue_lock(settings, database) as lock:
            coordinator = new_coordinator(
                settings, database, open_place(settings.store_url), lock, compute=compute
            )
            coordinator.start()
            print(f"Trainbridge coordinates with the engine {settings.engine}", flush=True)
            told = ""
            while coordinator.alive and not asked.wait(_LOOK_SECONDS):
                if coordinator.trouble != told:
                    told = coordinator.trouble
                    tell(told)
            trouble = "" if asked.is_set() else coordinator.trouble
            coordinator.stop()
    except (FolderInUseError, EngineError) as error:
        raise StartError(str(error)) from error
    finally:
        database.close()
    if trouble:
        raise StartError(trouble)


class CoordinatorProcess:
    """A coordinator in a process of its own, started again whenever it ends."""

    def __init__(self, settings: Settings, compute: Compute = compute_order) -> None:
        """Does nothing before ``start``."""
        self._settings = settings
        self._compute = compute
        self._process: Any = None
        self.trouble = ""
        """Why nothing computes now, empty for none."""
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._keep, name="coordinator's keeper", daemon=True)

    @property
    def alive(self) -> bool:
        """Whether the keeper keeps: the process itself may be about to start again."""
        return self._thread.is_alive()

    def start(self) -> None:
        """Starts the process and its keeper."""
        self._thread.start()

    def wake(self) -> None:
        """Nothing to do: the process looks by itself."""

    def stop(self) -> None:
        """Ends the process: it lets its batches store checkpoints first."""
        self._stopping.set()
        process = self._process
        if process is not None and process.is_alive():
            process.terminate()
        self._thread.join()

    def _keep(self) -> None:
        # Not forked: this process has threads. Not a daemon: the engine starts workers.
        context = multiprocessing.get_context("spawn")
        while not self._stopping.is_set():
            heard, telling = context.Pipe(duplex=False)
            self._process = context.Process(
                target=_coordinate,
                args=(self._settings, self._compute, telling),
                name="coordinator",
            )
            try:
                self._process.start()
            except OSError as error:
                self.trouble = f"The coordinator could not be started: {error}"
                _log.error("%s", self.trouble)
                self._stopping.wait(_RESTART_SECONDS)
                continue
            finally:
                telling.close()
            while self._process.is_alive() and not self._stopping.is_set():
                self._listen(heard)
            heard.close()
            if self._stopping.is_set():
                self._end()
                return
            self.trouble = "The coordinator ended, and is started again. The log may say more."
            _log.error("the coordinator ended (%s) and is started again", self._process.exitcode)
            self._stopping.wait(_RESTART_SECONDS)

    def _listen(self, heard: Connection) -> None:
        """Takes what the process tells of its troubles; waits a moment for it."""
        try:
            if heard.poll(_LOOK_SECONDS):
                self.trouble = heard.recv()
        except (EOFError, OSError):
            self._process.join(_LOOK_SECONDS)

    def _end(self) -> None:
        self._process.terminate()
        self._process.join(self._settings.grace_seconds + _FAREWELL)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


def _coordinate(settings: Settings, compute: Compute, telling: Connection) -> None:
    """The coordinator's process: it never outlives its server."""
    end_with_parent()
    telling.send("")
    try:
        run_coordinator(settings, compute=compute, tell=telling.send)
    except StartError as error:
        _log.error("%s", error)
        raise SystemExit(1) from None
