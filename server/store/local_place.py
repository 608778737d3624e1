"""A place on a local disk: what is written is whole, and still there after a power cut."""

from __future__ import annotations

import os
import shutil
import uuid
from collections.abc import Generator, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from zarr.abc.store import OffsetByteRequest, RangeByteRequest, SuffixByteRequest
from zarr.core.buffer import default_buffer_prototype
from zarr.storage import LocalStore

from server.store.failures import explained, explained_writing

__all__ = ["PARTIAL", "LocalPlace", "checked_name", "is_shard"]

PARTIAL = ".partial"
"""How the names of unfinished files end; those of Zarr's local store end so, too."""


def checked_name(name: str) -> str:
    """The name, if it cannot lead out of its place.

    Raises:
        ValueError: It is empty, or more than one plain name.
    """
    if name in ("", ".", "..") or any(mark in name for mark in "/\\\0"):
        raise ValueError(f"{name!r} is not the name of a document or a place")
    return name


def is_shard(key: str) -> bool:
    """Whether a key of a Zarr store names a shard of a run's arrays.

    Each shard that holds a committed row was written. Zarr would read one that was removed as NaN,
    so that the stores that read raise ``FileNotFoundError`` instead.
    """
    return key.rpartition("/")[2].startswith("c.")


@dataclass(frozen=True)
class LocalPlace:
    """A folder of this machine. Implements ``Place``."""

    folder: Path

    @property
    def url(self) -> str:
        """As a ``file://`` URL."""
        return self.folder.as_uri()

    @property
    def local(self) -> Path | None:
        """The folder."""
        return self.folder

    def child(self, *names: str) -> LocalPlace:
        """The folder below this one."""
        return LocalPlace(self.folder.joinpath(*map(checked_name, names)))

    def read(self, name: str) -> bytes | None:
        """A file's content, None where there is none."""
        with self._explained():
            try:
                return (self.folder / checked_name(name)).read_bytes()
            except (FileNotFoundError, NotADirectoryError):
                return None

    def write(self, name: str, data: bytes) -> None:
        """Replaces a file atomically and durably."""
        target = self.folder / checked_name(name)
        with explained_writing(str(self.folder)), _unfinished(target, data) as unfinished:
            os.replace(unfinished, target)
            _sync(self.folder)

    def create(self, name: str, data: bytes) -> bool:
        """Creates a file unless it exists."""
        target = self.folder / checked_name(name)
        with explained_writing(str(self.folder)), _unfinished(target, data) as unfinished:
            try:
                # A link appears with its whole content, and only where nothing is.
                os.link(unfinished, target)
            except FileExistsError:
                return False
            _sync(self.folder)
            return True

    def exists(self, name: str) -> bool:
        """Whether there is a file of this name."""
        with self._explained():
            return (self.folder / checked_name(name)).is_file()

    def names(self) -> list[str]:
        """Files and folders directly below."""
        with self._explained():
            try:
                return sorted(os.listdir(self.folder))
            except (FileNotFoundError, NotADirectoryError):
                return []

    def remove(self, name: str | None = None) -> None:
        """Removes a file, a folder below, or this folder."""
        target = self.folder if name is None else self.folder / checked_name(name)
        with self._explained():
            if target.is_dir() and not target.is_symlink():
                _remove_tree(target)
            else:
                target.unlink(missing_ok=True)

    def size(self) -> int:
        """Everything below. [B]"""
        with self._explained():
            return sum(_sizes(self.folder))

    def copy(self, source: Any, name: str) -> None:
        """Takes over a file that never changes: as a second name of it where the disk can."""
        if source.local is None:
            data = source.read(name)
            if data is None:
                raise FileNotFoundError(f"{source.url}/{name}")
            self.write(name, data)
            return
        origin, target = source.local / checked_name(name), self.folder / name
        with self._explained():
            _make_folder(self.folder)
            try:
                os.link(origin, target)
            except FileNotFoundError:
                raise
            except OSError:
                shutil.copyfile(origin, target)
                _sync(target)
            _sync(self.folder)

    def sync(self, store: Any) -> None:
        """Makes what was written to one of this place's Zarr stores durable."""
        with self._explained():
            if isinstance(store, _RecordingStore):
                store.sync()

    def zarr(self, name: str, *, read_only: bool) -> Any:
        """A Zarr store in a folder below."""
        path = self.folder / checked_name(name)
        return _ReadingStore(path, read_only=True) if read_only else _RecordingStore(path)

    def _explained(self) -> Any:
        return explained(str(self.folder))


class _ReadingStore(LocalStore):
    """Zarr's local store without a change of threads for each read.

    A history in a hundred short shards takes two hundred small reads of files that the system
    holds in memory: handing each to a thread would cost more than the read itself.
    """

    async def get(self, key: str, prototype: Any = None, byte_range: Any = None) -> Any:
        try:
            with (self.root / key).open("rb") as file:
                begin, count = _extent(file, byte_range)
                file.seek(begin)
                data = file.read(count)
        except (FileNotFoundError, IsADirectoryError, NotADirectoryError):
            if is_shard(key):
                raise
            return None
        return (prototype or default_buffer_prototype()).buffer.from_bytes(data)


def _extent(file: BinaryIO, byte_range: Any) -> tuple[int, int]:
    """Where a part of a file begins, and its length (-1: to the end)."""
    match byte_range:
        case RangeByteRequest():
            return byte_range.start, byte_range.end - byte_range.start
        case OffsetByteRequest():
            return byte_range.offset, -1
        case SuffixByteRequest():
            return max(0, os.fstat(file.fileno()).st_size - byte_range.suffix), -1
        case _:
            return 0, -1


class _RecordingStore(LocalStore):
    """Zarr's local store (which replaces files atomically) that knows what is not yet durable.

    Waiting for the disk once a flush, when all of its shards are written, is quicker than once a
    shard.
    """

    def __init__(self, root: Path | str, *, read_only: bool = False) -> None:
        super().__init__(root, read_only=read_only)
        self._files: set[Path] = set()
        self._durable_folders: set[Path] = set()

    async def set(self, key: str, value: Any) -> None:
        await super().set(key, value)
        self._files.add(self.root / key)

    async def set_if_not_exists(self, key: str, value: Any) -> None:
        await super().set_if_not_exists(key, value)
        self._files.add(self.root / key)

    def set_sync(self, key: str, value: Any) -> None:
        super().set_sync(key, value)
        self._files.add(self.root / key)

    def sync(self) -> None:
        """Waits until everything written so far is on the disk."""
        files = sorted(self._files)
        folders: set[Path] = set()
        for path in files:
            _sync(path)
            folders.add(path.parent)
            above = [self.root.parent, *_between(self.root, path.parent)]
            folders |= set(above) - self._durable_folders
        for folder in sorted(folders, reverse=True):
            _sync(folder)
        self._durable_folders |= folders
        self._files.difference_update(files)


def _between(root: Path, folder: Path) -> list[Path]:
    return [folder, *(above for above in folder.parents if above.is_relative_to(root))]


@contextmanager
def _unfinished(target: Path, data: bytes) -> Generator[Path]:
    """A durable file with the content beside the target, gone afterwards."""
    _make_folder(target.parent)
    path = target.with_name(f".{target.name}.{uuid.uuid4().hex}{PARTIAL}")
    try:
        with path.open("xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        yield path
    finally:
        path.unlink(missing_ok=True)


def _make_folder(folder: Path) -> None:
    """Creates a folder and those above it, durably."""
    if folder.is_dir():
        return
    _make_folder(folder.parent)
    folder.mkdir(exist_ok=True)
    _sync(folder.parent)


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _remove_tree(folder: Path) -> None:
    """Removes a folder, though someone else may remove or still write parts of it."""
    for _ in range(3):
        shutil.rmtree(folder, ignore_errors=True)
        if not folder.exists():
            return
    with suppress(FileNotFoundError):
        shutil.rmtree(folder)


def _sizes(folder: Path) -> Iterator[int]:
    """Sizes of all files below; a file of two names counts once."""
    seen: set[tuple[int, int]] = set()
    for parent, _, files in os.walk(folder):
        for name in files:
            try:
                found = os.lstat(os.path.join(parent, name))
            except FileNotFoundError:
                continue
            key = (found.st_dev, found.st_ino)
            if found.st_nlink == 1 or key not in seen:
                seen.add(key)
                yield found.st_size
