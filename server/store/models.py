"""The tables of the metadata database, as the newest migration leaves them.

A change here needs a migration in ``migrations/versions``: a test compares the two.
"""

from __future__ import annotations

from typing import Any, Literal

from sqlalchemy import (
    JSON,
    BigInteger,
    Dialect,
    Float,
    ForeignKey,
    Index,
    Integer,
    String,
    Text,
    TypeDecorator,
    UniqueConstraint,
    false,
)
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

__all__ = [
    "LIVE",
    "BatchRow",
    "EventRow",
    "InstallationRow",
    "JobRow",
    "LibraryRow",
    "RunRow",
    "SchemaRow",
    "Table",
]

LIVE = ("queued", "running")
"""States of a job, a batch or a run that has not ended."""

_Count = BigInteger().with_variant(Integer, "sqlite")
"""Numbers beyond 2^31. SQLite numbers rows only in a column called INTEGER, which holds 64 bits."""


class _WrittenText(TypeDecorator[str]):
    """Text that people or programs wrote: PostgreSQL takes no NUL in a text."""

    impl = Text
    cache_ok = True

    def process_bind_param(self, value: str | None, dialect: Dialect) -> str | None:
        """The text, with a sign for each NUL."""
        return None if value is None else value.replace("\0", "\N{REPLACEMENT CHARACTER}")


class _WrittenName(_WrittenText):
    """A short text."""

    impl = String
    cache_ok = True


class Table(DeclarativeBase):
    """Base of every table."""


class SchemaRow(Table):
    """A number for versions of this program from before migrations: they refuse any but 1."""

    __tablename__ = "schema_version"
    version: Mapped[int] = mapped_column(Integer, primary_key=True)


class InstallationRow(Table):
    """One row: a random name that the database was given when it was made."""

    __tablename__ = "installation"
    id: Mapped[str] = mapped_column(String(32), primary_key=True)


class JobRow(Table):
    """One submission. Times are seconds since 1970, UTC."""

    __tablename__ = "jobs"
    __table_args__ = (
        UniqueConstraint("key", name="jobs_key"),
        Index("jobs_in_order", "state", "priority", "sequence"),
        Index("ix_jobs_created", "created"),
        Index("ix_jobs_source", "source"),
    )
    sequence: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(32), unique=True)
    kind: Mapped[str] = mapped_column(String(32))
    name: Mapped[str] = mapped_column(_WrittenName(200))
    study: Mapped[Any] = mapped_column(JSON)
    state: Mapped[str] = mapped_column(String(16), index=True)
    cancel_requested: Mapped[bool] = mapped_column(default=False)
    steps: Mapped[int] = mapped_column(_Count)
    error: Mapped[str | None] = mapped_column(_WrittenText)
    created: Mapped[float] = mapped_column(Float)
    started: Mapped[float | None] = mapped_column(Float)
    ended: Mapped[float | None] = mapped_column(Float)
    priority: Mapped[int] = mapped_column(Integer, default=0, server_default="0")
    source: Mapped[str | None] = mapped_column(String(32))
    disk_bytes: Mapped[int] = mapped_column(_Count, default=0, server_default="0")
    wants_gather: Mapped[bool] = mapped_column(default=False, server_default=false())
    model: Mapped[str | None] = mapped_column(String(64))
    generation: Mapped[int] = mapped_column(Integer, default=0, server_default="0")
    """How often runs of it were put back by people: each time needs a gather of its own."""
    retry_requested: Mapped[bool] = mapped_column(default=False, server_default=false(), index=True)
    delete_requested: Mapped[bool] = mapped_column(
        default=False, server_default=false(), index=True
    )
    key: Mapped[str | None] = mapped_column(String(200))
    body_digest: Mapped[str | None] = mapped_column(String(64))


class BatchRow(Table):
    """The runs of a job that advance together in one process, or what comes before or after."""

    __tablename__ = "batches"
    __table_args__ = (UniqueConstraint("job", "purpose", "generation", name="one_a_generation"),)
    sequence: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(32), unique=True)
    job: Mapped[str] = mapped_column(ForeignKey("jobs.id"), index=True)
    state: Mapped[str] = mapped_column(String(16), index=True)
    attempt: Mapped[int] = mapped_column(Integer, default=0)
    purpose: Mapped[Literal["runs", "prepare", "gather"]] = mapped_column(
        String(16), default="runs", server_default="runs"
    )
    generation: Mapped[int | None] = mapped_column(Integer)
    """Of a gather, the job's; of a prepare 0; of runs None, which the constraint lets pass."""
    deaths: Mapped[int] = mapped_column(Integer, default=0, server_default="0")
    checkpoint_step: Mapped[int] = mapped_column(_Count, default=-1, server_default="-1")
    model: Mapped[str | None] = mapped_column(String(64))
    waits_for: Mapped[str | None] = mapped_column(String(32))


class RunRow(Table):
    """One time integration."""

    __tablename__ = "runs"
    sequence: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(32), unique=True)
    job: Mapped[str] = mapped_column(ForeignKey("jobs.id"), index=True)
    batch: Mapped[str] = mapped_column(ForeignKey("batches.id"), index=True)
    index: Mapped[int] = mapped_column(Integer)
    parameters: Mapped[Any] = mapped_column(JSON)
    state: Mapped[str] = mapped_column(String(16))
    attempt: Mapped[int] = mapped_column(Integer, default=0)
    progress: Mapped[Any] = mapped_column(JSON)
    verdicts: Mapped[Any] = mapped_column(JSON)
    error: Mapped[str | None] = mapped_column(_WrittenText)
    started: Mapped[float | None] = mapped_column(Float)
    ended: Mapped[float | None] = mapped_column(Float)
    cancel_requested: Mapped[bool] = mapped_column(
        default=False, server_default=false(), index=True
    )
    retry_requested: Mapped[bool] = mapped_column(default=False, server_default=false(), index=True)


class EventRow(Table):
    """What event streams send, in order."""

    __tablename__ = "events"
    __table_args__ = (
        Index("events_of_a_job", "job", "id"),
        Index("events_of_a_kind", "kind", "time"),
        {"sqlite_autoincrement": True},
    )
    id: Mapped[int] = mapped_column(_Count, primary_key=True, autoincrement=True)
    job: Mapped[str] = mapped_column(ForeignKey("jobs.id"))
    run: Mapped[str | None] = mapped_column(String(32))
    kind: Mapped[str] = mapped_column(String(16))
    data: Mapped[Any] = mapped_column(JSON)
    time: Mapped[float] = mapped_column(Float)


class LibraryRow(Table):
    """A part of a study that somebody keeps. Times are seconds since 1970, UTC."""

    __tablename__ = "library"
    sequence: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(32), unique=True)
    kind: Mapped[str] = mapped_column(String(16), index=True)
    name: Mapped[str] = mapped_column(_WrittenName(200))
    source: Mapped[str] = mapped_column(_WrittenText)
    confidence: Mapped[str] = mapped_column(_WrittenText)
    remarks: Mapped[Any] = mapped_column(JSON)
    value: Mapped[Any] = mapped_column(JSON)
    created: Mapped[float] = mapped_column(Float)
    changed: Mapped[float] = mapped_column(Float)
