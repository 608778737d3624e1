"""One server for a data folder: a lock of the operating system, which dies with its holder."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from types import TracebackType

__all__ = ["FolderInUseError", "FolderLock"]


class FolderInUseError(Exception):
    """Another server works in the data folder."""


class FolderLock:
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

    def release(self) -> None:
        """Gives the folder free."""
        os.close(self._file)

    def __enter__(self) -> FolderLock:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.release()


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
