"""The library: trains, viaducts, tracks and irregularities that people keep to use again."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Response
from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from server.errors import Finding, Problem, gone_missing
from server.library.built_in import BuiltInEntry, built_in_entries
from server.library.parts import read_part
from server.routes.service import Service, ServiceDependency
from server.store import LibraryFullError, LibraryRecord, NewEntry

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/library", tags=["library"])

Kind = Literal["trains", "viaducts", "tracks", "irregularities"]

_MOST_IMPORTED = 200
_CLONE = "Clone it, and change the clone."

Name = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=120)]
Source = Annotated[str, Field(max_length=1000)]
Confidence = Annotated[str, Field(max_length=500)]


class RemarkItem(BaseModel):
    """What to know of one figure."""

    model_config = ConfigDict(extra="forbid", strict=True, use_attribute_docstrings=True)

    pointer: str = Field(pattern=r"^(/[^\x00]*)?$", max_length=200)
    """JSON pointer into the value."""
    confidence: str = Field(max_length=40)
    """``assumed``, or A (two sources or more), B (one), C (conflicting), D (derived)."""
    text: str = Field(max_length=500)
    """Why."""


class LibraryItem(BaseModel):
    """A part of a study that is kept, by value."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    id: str
    kind: Kind
    name: str
    built_in: bool
    """Comes with the solver and cannot be changed."""
    created: str | None
    changed: str | None
    source: str
    """Where its figures come from."""
    confidence: str
    """How far they can be trusted."""
    remarks: list[RemarkItem]
    """What to know of single figures."""
    value: dict[str, Any]
    """The part as a study holds it, SI."""


class LibraryList(BaseModel):
    """What comes with the solver first, then what people keep, oldest first."""

    items: list[LibraryItem]


class EntryBody(BaseModel):
    """A part to be kept."""

    model_config = ConfigDict(extra="forbid", strict=True, use_attribute_docstrings=True)

    name: Name
    """What people call it."""
    value: Any
    """The part as a study holds it, SI; what is left out takes its default."""
    source: Source = ""
    """Where its figures come from."""
    confidence: Confidence = ""
    """How far they can be trusted."""
    remarks: Annotated[list[RemarkItem], Field(max_length=200)] = []
    """What to know of single figures."""


class ImportedEntry(EntryBody):
    """An entry as it was exported; what belongs to the other library is read over."""

    kind: Kind
    """Which part it is."""
    id: Any = None
    """Of the other library."""
    built_in: Any = None
    """In the other library."""
    created: Any = None
    """In the other library."""
    changed: Any = None
    """In the other library."""


class ImportBody(BaseModel):
    """A library, or some entries of one, as ``GET /library`` gives it."""

    model_config = ConfigDict(extra="forbid", strict=True, use_attribute_docstrings=True)

    items: Annotated[list[ImportedEntry], Field(min_length=1, max_length=_MOST_IMPORTED)]
    """All of them are taken, or none."""


class ImportResult(BaseModel):
    """What became of an import."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    items: list[LibraryItem]
    """The new entries."""
    skipped: list[str]
    """Names of entries that are here already, or came twice, with the same value."""


@router.get("")
def list_library(service: ServiceDependency) -> LibraryList:
    """Every entry; the answer can be imported elsewhere."""
    return LibraryList(items=_items(service, None))


@router.post("", status_code=201)
def import_library(body: ImportBody, service: ServiceDependency) -> ImportResult:
    """Takes exported entries: all of them, or none and why."""
    findings: list[Finding] = []
    read: list[NewEntry] = []
    for index, item in enumerate(body.items):
        entry, wrong = _read(item.kind, item, ("items", index))
        read.append(entry)
        findings += wrong
    if findings:
        raise _unusable(findings)
    known = [(item.kind, item.name, item.value) for item in _items(service, None)]
    new: list[NewEntry] = []
    skipped: list[str] = []
    for entry in read:
        if (entry.kind, entry.name, entry.value) in known:
            skipped.append(entry.name)
            continue
        known.append((entry.kind, entry.name, dict(entry.value)))
        new.append(entry)
    kept = _add(service, new)
    return ImportResult(items=[_kept_item(record) for record in kept], skipped=skipped)


@router.get("/{kind}")
def list_kind(kind: Kind, service: ServiceDependency) -> LibraryList:
    """Every entry of one kind."""
    return LibraryList(items=_items(service, kind))


@router.post("/{kind}", status_code=201)
def add_entry(
    kind: Kind, body: EntryBody, response: Response, service: ServiceDependency
) -> LibraryItem:
    """Keeps a part: 201, and where it is in ``Location``."""
    [record] = _add(service, [_entry(kind, body)])
    response.headers["Location"] = f"/api/v1/library/{kind}/{record.id}"
    return _kept_item(record)


@router.get("/{kind}/{entry_id}")
def read_entry(kind: Kind, entry_id: str, service: ServiceDependency) -> LibraryItem:
    """An entry."""
    built_in = _built_in(kind, entry_id)
    if built_in is not None:
        return _built_in_item(built_in)
    found = service.database.library_entry(kind, entry_id) if _may_be_id(entry_id) else None
    if found is None:
        raise gone_missing("entry", entry_id)
    return _kept_item(found)


@router.put("/{kind}/{entry_id}")
def change_entry(
    kind: Kind, entry_id: str, body: EntryBody, service: ServiceDependency
) -> LibraryItem:
    """Replaces an entry's content. No job changes: jobs hold their parts by value."""
    _require_own(kind, entry_id)
    new = _entry(kind, body)
    changed: LibraryRecord | None = None
    if _may_be_id(entry_id):
        with _room():
            changed = service.database.change_library_entry(entry_id, new)
    if changed is None:
        raise gone_missing("entry", entry_id)
    return _kept_item(changed)


@router.delete("/{kind}/{entry_id}", status_code=204)
def delete_entry(kind: Kind, entry_id: str, service: ServiceDependency) -> None:
    """Forgets an entry. No job changes: jobs hold their parts by value."""
    _require_own(kind, entry_id)
    if not _may_be_id(entry_id) or not service.database.delete_library_entry(kind, entry_id):
        raise gone_missing("entry", entry_id)


def _entry(kind: Kind, body: EntryBody) -> NewEntry:
    entry, findings = _read(kind, body, ())
    if findings:
        raise _unusable(findings)
    return entry


def _read(
    kind: Kind, body: EntryBody, path: tuple[str | int, ...]
) -> tuple[NewEntry, list[Finding]]:
    value, findings = read_part(kind, body.value, (*path, "value"))
    entry = NewEntry(
        kind=kind,
        name=body.name,
        source=body.source,
        confidence=body.confidence,
        remarks=[remark.model_dump() for remark in body.remarks],
        value=value,
    )
    return entry, findings


def _add(service: Service, entries: Sequence[NewEntry]) -> list[LibraryRecord]:
    with _room():
        return service.database.add_library_entries(entries)


@contextmanager
def _room() -> Generator[None]:
    """What to say where the library is full: 409."""
    try:
        yield
    except LibraryFullError as error:
        raise Problem(
            409, "The library is full", f"{error} Delete some that are no longer needed."
        ) from None


def _unusable(findings: Sequence[Finding]) -> Problem:
    detail = "; ".join(f"{item.pointer or 'the body'} {item.reason}" for item in findings[:3])
    return Problem(422, "The entry cannot be used", detail, errors=findings)


def _require_own(kind: Kind, entry: str) -> None:
    found = _built_in(kind, entry)
    if found is not None:
        detail = f"{found.name} comes with the solver and cannot be changed or deleted. {_CLONE}"
        raise Problem(409, "Built in", detail)


def _built_in(kind: Kind, entry: str) -> BuiltInEntry | None:
    return next(
        (item for item in built_in_entries() if (item.kind, item.id) == (kind, entry)), None
    )


def _items(service: Service, kind: Kind | None) -> list[LibraryItem]:
    built_in = [item for item in built_in_entries() if kind in (None, item.kind)]
    kept = service.database.library_entries(kind)
    return [*map(_built_in_item, built_in), *map(_kept_item, kept)]


def _built_in_item(entry: BuiltInEntry) -> LibraryItem:
    document = {**asdict(entry), "built_in": True, "created": None, "changed": None}
    return LibraryItem.model_validate(document)


def _kept_item(record: LibraryRecord) -> LibraryItem:
    times = {"created": _time(record.created), "changed": _time(record.changed)}
    return LibraryItem.model_validate({**asdict(record), **times, "built_in": False})


def _time(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat()


def _may_be_id(text: str) -> bool:
    """Whether a text may be asked for at all: not every database takes every character."""
    return text.isascii() and text.isalnum() and len(text) <= 32
