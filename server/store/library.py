"""The library of one installation: parts of studies that people keep to use again.

An entry holds its part by value, and a job holds a copy of it: changing or deleting an entry never
changes a job. What is built in is not stored here.
"""

from __future__ import annotations

import secrets
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Text, cast, delete, func, select
from sqlalchemy.orm import Session

from server.store.models import LibraryRow
from server.store.sessions import Sessions

__all__ = [
    "LARGEST_LIBRARY",
    "MOST_ENTRIES",
    "Library",
    "LibraryFullError",
    "LibraryRecord",
    "NewEntry",
]

MOST_ENTRIES = 2000
"""Entries that one installation keeps."""
LARGEST_LIBRARY = 32 * 1024 * 1024
"""Of all entries' values and remarks as JSON: the whole library is listed in one answer. [B]"""


class LibraryFullError(Exception):
    """As many entries are kept, or as large ones, as the library holds."""


@dataclass(frozen=True, kw_only=True)
class NewEntry:
    """A part as somebody wants it kept.

    Attributes:
        kind: ``trains``, ``viaducts``, ``tracks`` or ``irregularities``.
        name: What people call it.
        source: Where its figures come from.
        confidence: How far they can be trusted, in words.
        remarks: What to know of single figures: ``pointer``, ``confidence``, ``text`` of each.
        value: The part of a study, as JSON, SI.
    """

    kind: str
    name: str
    source: str
    confidence: str
    remarks: Sequence[Mapping[str, Any]]
    value: Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class LibraryRecord(NewEntry):
    """A part that is kept. Times are seconds since 1970, UTC."""

    id: str
    created: float
    changed: float


class Library(Sessions):
    """Keeps, lists, changes and forgets entries."""

    def library_entries(self, kind: str | None = None) -> list[LibraryRecord]:
        """Entries of a kind, or of all, oldest first."""
        query = select(LibraryRow).order_by(LibraryRow.sequence)
        if kind is not None:
            query = query.where(LibraryRow.kind == kind)
        with self._read() as session:
            return [_record(row) for row in session.scalars(query)]

    def library_entry(self, kind: str, entry: str) -> LibraryRecord | None:
        """An entry, or None."""
        with self._read() as session:
            row = session.scalar(_one(kind, entry))
            return None if row is None else _record(row)

    def add_library_entries(self, entries: Sequence[NewEntry]) -> list[LibraryRecord]:
        """Keeps entries: all of them or none.

        Raises:
            LibraryFullError: They are more than the library holds.
        """
        with self._write() as session:
            added = [_record(row) for row in self._added(session, entries)]
            _require_room(session)
            return added

    def change_library_entry(self, entry: str, new: NewEntry) -> LibraryRecord | None:
        """Replaces an entry's content; None where there is no such entry of its kind.

        Raises:
            LibraryFullError: It is larger than what is left.
        """
        with self._write() as session:
            row = session.scalar(_one(new.kind, entry))
            if row is None:
                return None
            for name, content in _content(new).items():
                setattr(row, name, content)
            row.changed = self._clock()
            session.flush()
            _require_room(session)
            # As it is stored: without NUL.
            session.refresh(row)
            return _record(row)

    def delete_library_entry(self, kind: str, entry: str) -> bool:
        """Forgets an entry; False where there is no such entry."""
        gone = delete(LibraryRow).where(LibraryRow.kind == kind, LibraryRow.id == entry)
        with self._write() as session:
            return bool(session.execute(gone.returning(LibraryRow.id)).all())

    def _added(self, session: Session, entries: Iterable[NewEntry]) -> list[LibraryRow]:
        now = self._clock()
        rows = [
            LibraryRow(id=secrets.token_hex(8), created=now, changed=now, **_content(entry))
            for entry in entries
        ]
        session.add_all(rows)
        session.flush()
        for row in rows:
            session.refresh(row)
        return rows


def _require_room(session: Session) -> None:
    """Looks at what is there after a change; raising undoes the change.

    Raises:
        LibraryFullError: It is too much.
    """
    value, remarks = (
        func.coalesce(func.sum(func.length(cast(column, Text))), 0)
        for column in (LibraryRow.value, LibraryRow.remarks)
    )
    count, total = session.execute(select(func.count(LibraryRow.id), value + remarks)).one()
    if count > MOST_ENTRIES:
        raise LibraryFullError(f"The library holds {MOST_ENTRIES} entries at most.")
    if int(total) > LARGEST_LIBRARY:
        raise LibraryFullError(f"The library holds {LARGEST_LIBRARY // 1024**2} MiB at most.")


def _one(kind: str, entry: str) -> Any:
    return select(LibraryRow).where(LibraryRow.kind == kind, LibraryRow.id == entry)


def _content(entry: NewEntry) -> dict[str, Any]:
    return {
        "kind": entry.kind,
        "name": entry.name,
        "source": entry.source,
        "confidence": entry.confidence,
        "remarks": [dict(remark) for remark in entry.remarks],
        "value": dict(entry.value),
    }


def _record(row: LibraryRow) -> LibraryRecord:
    return LibraryRecord(
        id=row.id,
        kind=row.kind,
        name=row.name,
        source=row.source or "",
        confidence=row.confidence or "",
        remarks=row.remarks,
        value=row.value,
        created=row.created,
        changed=row.changed,
    )
