"""What can go wrong with a store, in words that say what to do.

StoreError            the store cannot be read or written
|-- StoreFullError    there is no room left in it
`-- PlaceError        its URL cannot be used
"""

from __future__ import annotations

import errno
from collections.abc import Generator
from contextlib import contextmanager
from typing import Any

__all__ = [
    "CheckpointError",
    "PlaceError",
    "StoreError",
    "StoreFullError",
    "explained",
    "explained_writing",
]

_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
_FORBIDDEN = {errno.EROFS, errno.EACCES, errno.EPERM}
_FULL_CODES = ("XMinioStorageFull", "QuotaExceeded", "InsufficientStorage", "507 ")
"""How object stores say that there is no room (they have no common code for it)."""
_FORBIDDEN_CODES = ("PermissionDeniedError", "UnauthenticatedError")


class StoreError(Exception):
    """The store cannot be read or written; the text says why and what to do."""


class StoreFullError(StoreError):
    """There is no room left in the store."""


class CheckpointError(StoreError):
    """A checkpoint cannot be gone on from; an earlier one, or the run's beginning, may do."""


class PlaceError(StoreError):
    """The store's URL cannot be used; the text says what to give instead."""


@contextmanager
def explained(url: str) -> Generator[None]:
    """Turns what disks and object stores raise inside it into errors of this module.

    A missing file stays a ``FileNotFoundError``: only the caller knows whether it had to be there.

    Args:
        url: The place that is used, for the text.

    Raises:
        StoreFullError: There is no room left.
        StoreError: Anything else that the disk or the object store refused.
    """
    try:
        yield
    except (StoreError, FileNotFoundError):
        raise
    except OSError as error:
        raise _of_disk(url, error) from error
    except Exception as error:
        if not type(error).__module__.startswith("obstore"):
            raise
        raise _of_object_store(url, error) from error


@contextmanager
def explained_writing(url: str) -> Generator[None]:
    """As ``explained``, for what is written: a folder that is missing is an error, too."""
    try:
        with explained(url):
            yield
    except FileNotFoundError as error:
        raise StoreError(
            f"The store's folder at {url} was removed or cannot be made ({error}). Check the "
            "store's place and retry the job."
        ) from error


def _of_disk(url: str, error: OSError) -> StoreError:
    reason = error.strerror or str(error)
    if error.errno in _FULL:
        return _full(url, reason)
    if error.errno in _FORBIDDEN:
        return StoreError(
            f"The store cannot be written at {url} ({reason}). Give the server's user the right "
            "to write there, or another store, and retry the job."
        )
    return StoreError(f"The store failed at {url} ({reason}). Check the disk and retry the job.")


def _of_object_store(url: str, error: Any) -> StoreError:
    reason = str(error).strip().splitlines()[0][:300]
    if any(code in str(error) for code in _FULL_CODES):
        return _full(url, reason)
    if type(error).__name__ in _FORBIDDEN_CODES:
        return StoreError(
            f"The object store refused access to {url} ({reason}). Check AWS_ACCESS_KEY_ID, "
            "AWS_SECRET_ACCESS_KEY and the rights of that key."
        )
    return StoreError(
        f"The object store does not answer as it should at {url} ({reason}). Check that it runs, "
        "that AWS_ENDPOINT_URL names it and that the bucket is there; then retry the job."
    )


def _full(url: str, reason: str) -> StoreFullError:
    return StoreFullError(
        f"There is no room left in the store at {url} ({reason}). What was stored before can be "
        "read. Delete jobs or run `trainbridge clean` to make room, then retry the job."
    )
