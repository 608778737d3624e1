"""Finds and removes what no job refers to, and says how much room there is.

Only names that a store makes itself are looked at: everything else in the folder (the database, its
lock, anything that people put there) is not ours to touch.
"""

from __future__ import annotations

import re
import shutil
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from server.store.failures import explained
from server.store.layout import (
    CHECKPOINT,
    DONE,
    JOBS,
    LIVE,
    MODELS,
    RUNS,
    attempt_place,
    run_place,
)
from server.store.local_place import PARTIAL
from server.store.place import Place

__all__ = ["Orphan", "free_bytes", "orphans", "remove_orphans", "used_bytes"]

_ID = re.compile(r"[A-Za-z0-9_-]{1,64}")
_ATTEMPT = re.compile(r"\d{3,}")
_PARTIAL_SECONDS = 3600.0
"""An unfinished file of this age is no longer being written. [s]"""


@dataclass(frozen=True, kw_only=True)
class Orphan:
    """Something in the store that nothing refers to.

    Attributes:
        kind: ``run``, ``job`` or ``model`` (no record of it), ``attempt`` (an earlier one of a
            finished run), ``leftover`` (what a finished attempt no longer needs) or ``partial``
            (a file that a killed process did not finish).
        name: The run, job or model.
        bytes: Its size. [B]
        place: Where it is.
        document: The one document or place in it to remove, None for all of it.
    """

    kind: str
    name: str
    bytes: int
    place: Place
    document: str | None = None


def orphans(
    store: Place, *, runs: Collection[str], jobs: Collection[str], models: Collection[str]
) -> list[Orphan]:
    """What the store holds and no job refers to.

    Args:
        store: The store.
        runs: Runs that are known; a run that is known is left alone but for what it has outlived.
        jobs: Jobs that are known.
        models: Keys of models that jobs may still use.
    """
    found = [*_unknown_runs(store, runs)]
    for run in _ids(store.child(RUNS)):
        if run in runs:
            found += _outlived(store, run)
    for kind, folder, known in (("job", JOBS, jobs), ("model", MODELS, models)):
        below = store.child(folder)
        found += [_whole(kind, name, below.child(name)) for name in _ids(below, known)]
    return [*found, *_partial_files(store, [orphan.place for orphan in found])]


def remove_orphans(
    found: Sequence[Orphan],
    *,
    runs: Collection[str] = (),
    jobs: Collection[str] = (),
    models: Collection[str] = (),
    report: Callable[[Orphan], None] = lambda orphan: None,
) -> int:
    """Removes orphans, but none that has become known meanwhile.

    A job's record exists before its files do: whoever asks the database *again* after ``orphans``
    and passes the answer here removes nothing of a job that came in between.

    Args:
        found: As ``orphans`` gave them.
        runs: Runs that are known now.
        jobs: Jobs that are known now.
        models: Models that are known now.
        report: Called before each is removed.

    Returns:
        Size of what was removed. [B]

    Raises:
        StoreError: The store refused; what was removed before stays removed.
    """
    known = {"run": runs, "job": jobs, "model": models}
    removed = 0
    for orphan in found:
        if orphan.name in known.get(orphan.kind, ()):
            continue
        report(orphan)
        if orphan.document is None:
            orphan.place.remove(DONE)  # first: a half-removed place never looks complete
        orphan.place.remove(orphan.document)
        removed += orphan.bytes
    return removed


def used_bytes(store: Place) -> int:
    """Size of all runs, jobs and models. [B]"""
    return sum(store.child(name).size() for name in (RUNS, JOBS, MODELS))


def free_bytes(store: Place) -> int | None:
    """Room on the store's disk, None for an object store, which does not say. [B]"""
    if store.local is None:
        return None
    folder = store.local
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    with explained(store.url):
        return shutil.disk_usage(folder).free


def _ids(place: Place, known: Collection[str] = ()) -> list[str]:
    """Names below that the store may have given, and that are not known."""
    return [
        name
        for name in place.names()
        if _ID.fullmatch(name) and name not in known and not _is_file(place, name)
    ]


def _is_file(place: Place, name: str) -> bool:
    return place.exists(name)


def _whole(kind: str, name: str, place: Place) -> Orphan:
    return Orphan(kind=kind, name=name, bytes=place.size(), place=place)


def _unknown_runs(store: Place, runs: Collection[str]) -> Iterator[Orphan]:
    for run in _ids(store.child(RUNS), runs):
        place = run_place(store, run)
        # Not a run's folder if anything but attempts lies in it.
        if all(_ATTEMPT.fullmatch(name) for name in place.names()):
            yield _whole("run", run, place)


def _outlived(store: Place, run: str) -> Iterator[Orphan]:
    """Of a finished run: earlier attempts, and what only an unfinished one needs."""
    attempts = sorted(
        int(name) for name in run_place(store, run).names() if _ATTEMPT.fullmatch(name)
    )
    if not attempts:
        return
    last = attempt_place(store, run, attempts[-1])
    names = last.names()
    if DONE not in names:
        return
    for attempt in attempts[:-1]:
        yield _whole("attempt", run, attempt_place(store, run, attempt))
    for name in (LIVE, CHECKPOINT):
        if name in names:
            size = last.child(name).size() or len(last.read(name) or b"")
            yield Orphan(kind="leftover", name=run, bytes=size, place=last, document=name)


def _partial_files(store: Place, removed: Sequence[Place]) -> Iterator[Orphan]:
    """Files that killed processes left; object stores have none, they store whole objects."""
    if store.local is None:
        return
    gone = [place.local for place in removed if place.local is not None]
    oldest = time.time() - _PARTIAL_SECONDS
    for kind in (RUNS, JOBS, MODELS):
        for path in sorted((store.local / kind).rglob(f"*{PARTIAL}")):
            inside = any(path.is_relative_to(folder) for folder in gone)
            if not inside and path.is_file() and path.stat().st_mtime < oldest:
                yield _partial(store, path)


def _partial(store: Place, path: Path) -> Orphan:
    assert store.local is not None
    names = path.relative_to(store.local).parts
    return Orphan(
        kind="partial",
        name=names[1],
        bytes=path.stat().st_size,
        place=store.child(*names[:-1]),
        document=names[-1],
    )
