"""One coordinator for a queue: a lock that dies with its holder.

Of the operating system on a data folder, of the database where that is PostgreSQL.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

from server.settings import Settings
from server.store import AdvisoryLock, Database, Holding, LockHeldError

__all__ = ["DatabaseLock", "FolderInUseError", "FolderLock", "queue_lock"]


_PATIENCE = 3.0
"""The database needs a moment to notice that a holder was killed. [s]"""
_LOOK_AGAIN = 0.2
"""Time between two looks. [s]"""


class FolderInUseError(Exception):
    """Another server works on the data folder or on the database."""


def queue_lock(settings: Settings, database: Database) -> FolderLock | DatabaseLock:
    """Takes the lock of a queue.

    Raises:
        FolderInUseError: Another coordinator holds it.
        sqlalchemy.exc.OperationalError: The database does not answer.
    """
    if database.engine.dialect.name == "postgresql":
        return DatabaseLock(database)
    # Beside the database: two folders of results may share one by mistake.
    file = database.engine.url.database
    return FolderLock(Path(file).absolute().parent if file else settings.data)


class DatabaseLock(Holding):
    """Holds a PostgreSQL database until it is released or the connection is lost."""

    def __init__(self, database: Database) -> None:
        """Takes the lock.

        Raises:
            FolderInUseError: Another coordinator holds it.
        """
        self._database = database
        self._lock: AdvisoryLock | None = None
        limit = time.monotonic() + _PATIENCE
        while self._lock is None:
            try:
                self.ensure()
            except FolderInUseError:
                if time.monotonic() > limit:
                    raise
                time.sleep(_LOOK_AGAIN)

    def ensure(self) -> None:
        """Takes the lock again where its connection was lost.

        Raises:
            FolderInUseError: Another coordinator has it by now.
        """
        if self._lock is not None and self._lock.held():
            return
        try:
            self._lock = AdvisoryLock(self._database)
        except LockHeldError as error:
            raise FolderInUseError(str(error)) from error

    def release(self) -> None:
        """Gives the database free."""
        if self._lock is not None:
            self._lock.release()


class FolderLock(Holding):
    """Holds a data folder until it is released or the process ends."""

    def __init__(self, folder: Path) -> None:
        """Takes the lock, creating the folder.

        Raises:
            FolderInUseError: Another process holds it, or the folder cannot be written.
        """
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = os.open(folder / "lock", os.O_RDWR | os.O_CREAT, 0o600)
        except OSError as error:
            raise FolderInUseError(
                f"The data folder {folder} cannot be written: {error.strerror}. "
                "Give another one with --data."
            ) from error
        if not _try_lock(self._file):
            holder = os.read(self._file, 20).decode(errors="replace").strip()
            os.close(self._file)
            raise FolderInUseError(
                f"Another server{f' (process {holder})' if holder else ''} works in the data "
                f"folder {folder}. Stop it, or give another folder with --data."
            )
        os.ftruncate(self._file, 0)
        os.write(self._file, str(os.getpid()).encode())

    def ensure(self) -> None:
        """Nothing to do: nobody can take the lock of a process that lives."""

    def release(self) -> None:
        """Gives the folder free."""
        os.close(self._file)


def _try_lock(file: int) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
