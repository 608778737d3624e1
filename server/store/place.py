"""A folder-like place in a store, given by URL: on a local disk or in an object store."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Protocol
from urllib.parse import unquote, urlsplit

from server.store.failures import PlaceError
from server.store.local_place import LocalPlace

__all__ = ["CLAIM", "Place", "as_place", "check_place", "claim", "open_place"]

CLAIM = "CLAIM"
"""Marks an attempt's place as taken by the worker that computes it."""

_OBJECT_SCHEMES = ("s3", "s3a", "gs", "az", "adl", "azure", "abfs", "abfss")
_CHOICES = "Give a folder, file:///folder or s3://bucket/prefix."


class Place(Protocol):
    """Documents and arrays below one name; small, hashable, picklable and cheap to make.

    Making one touches nothing: folders appear with the first file. Every method raises
    ``StoreError`` where the disk or the object store fails, ``StoreFullError`` where it is full.
    """

    @property
    def url(self) -> str:
        """Names the place; ``open_place`` takes it, also on another machine."""
        ...

    @property
    def local(self) -> Path | None:
        """The folder, where it is one."""
        ...

    def child(self, *names: str) -> Place:
        """The place below this one."""
        ...

    def read(self, name: str) -> bytes | None:
        """A document's content, None where there is none."""
        ...

    def write(self, name: str, data: bytes) -> None:
        """Creates or replaces a document, whole or not at all, and survives a power cut."""
        ...

    def create(self, name: str, data: bytes) -> bool:
        """Creates a document unless there is one already: of several callers one sees True."""
        ...

    def exists(self, name: str) -> bool:
        """Whether there is a document of this name."""
        ...

    def names(self) -> list[str]:
        """Documents and places directly below this one, sorted; empty where nothing is."""
        ...

    def remove(self, name: str | None = None) -> None:
        """Removes one document or place below this one, or all of this one; missing is fine."""
        ...

    def size(self) -> int:
        """Everything below. [B]"""
        ...

    def copy(self, source: Place, name: str) -> None:
        """Copies a document that never changes from another place under its own name.

        Raises:
            FileNotFoundError: There is no such document.
        """
        ...

    def sync(self, store: Any) -> None:
        """Makes what was written to a Zarr store of this place survive a power cut."""
        ...

    def zarr(self, name: str, *, read_only: bool) -> Any:
        """A Zarr store below this place."""
        ...


def open_place(url: str | Path) -> Place:
    """The place that a URL names.

    Args:
        url: A folder, ``file:///folder`` or ``s3://bucket/prefix``. Credentials and address of an
            object store come from the ``AWS_*`` variables of the environment.

    Raises:
        PlaceError: Nothing can be stored there; the text says what to give.
    """
    if isinstance(url, Path):
        return LocalPlace(url.absolute())
    if not url.strip() or "\0" in url:
        raise PlaceError(f"The store {url[:80]!r} is no place. {_CHOICES}")
    scheme = re.match(r"([A-Za-z][A-Za-z0-9+.-]*)://", url)
    if scheme is None:
        return LocalPlace(Path(url).absolute())
    if scheme[1].lower() == "file":
        return LocalPlace(_folder_of(url))
    if scheme[1].lower() not in _OBJECT_SCHEMES:
        raise PlaceError(f"Nothing can be stored at {url[:80]!r}. {_CHOICES}")
    # Imported here: obstore takes memory that a server with a local disk does not need.
    from server.store.object_place import ObjectPlace

    return ObjectPlace.of(url)


def as_place(place: Place | Path) -> Place:
    """A place as it is, or that of a folder."""
    return open_place(place) if isinstance(place, Path) else place


def claim(place: Place, text: str) -> bool:
    """Takes an attempt's place; False where another worker has taken it, who alone may write.

    Args:
        place: Of the attempt.
        text: Who takes it, for people who look into the folder.
    """
    return place.create(CLAIM, text.encode())


def check_place(place: Place) -> None:
    """Writes and removes a small document, so that a wrong setting shows at the start.

    Raises:
        StoreError: The place cannot be written.
    """
    probe = ".trainbridge-check"
    place.write(probe, b"")
    place.remove(probe)


def _folder_of(url: str) -> Path:
    parts = urlsplit(url)
    if parts.netloc not in ("", "localhost") or not parts.path.startswith("/"):
        raise PlaceError(
            f"{url[:80]!r} names no folder of this machine. Write three slashes: file:///folder."
        )
    return Path(unquote(parts.path))
