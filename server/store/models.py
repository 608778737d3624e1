"""The tables of the metadata database.

They stand alone, so that a migrations folder can be built on them. ``SCHEMA_VERSION`` changes with
every change of a table.
"""

from __future__ import annotations

from typing import Any

from sqlalchemy import JSON, Float, ForeignKey, Index, Integer, String, Text
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

__all__ = ["SCHEMA_VERSION", "BatchRow", "EventRow", "JobRow", "RunRow", "SchemaRow", "Table"]

SCHEMA_VERSION = 1


class Table(DeclarativeBase):
    """Base of every table."""


class SchemaRow(Table):
    """The version of the tables, in one row."""

    __tablename__ = "schema_version"
    version: Mapped[int] = mapped_column(Integer, primary_key=True)


class JobRow(Table):
    """One submission. Times are seconds since 1970, UTC."""

    __tablename__ = "jobs"
    sequence: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(32), unique=True)
    kind: Mapped[str] = mapped_column(String(32))
    name: Mapped[str] = mapped_column(String(200))
    study: Mapped[Any] = mapped_column(JSON)
    state: Mapped[str] = mapped_column(String(16), index=True)
    cancel_requested: Mapped[bool] = mapped_column(default=False)
    steps: Mapped[int] = mapped_column(Integer)
    error: Mapped[str | None] = mapped_column(Text)
    created: Mapped[float] = mapped_column(Float)
    started: Mapped[float | None] = mapped_column(Float)
    ended: Mapped[float | None] = mapped_column(Float)


class BatchRow(Table):
    """The runs of a job that advance together in one process."""

    __tablename__ = "batches"
    sequence: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(32), unique=True)
    job: Mapped[str] = mapped_column(ForeignKey("jobs.id"), index=True)
    state: Mapped[str] = mapped_column(String(16), index=True)
    attempt: Mapped[int] = mapped_column(Integer, default=0)


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
    error: Mapped[str | None] = mapped_column(Text)
    started: Mapped[float | None] = mapped_column(Float)
    ended: Mapped[float | None] = mapped_column(Float)


class EventRow(Table):
    """What event streams send, in order."""

    __tablename__ = "events"
    __table_args__ = (Index("events_of_a_job", "job", "id"), {"sqlite_autoincrement": True})
    id: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    job: Mapped[str] = mapped_column(ForeignKey("jobs.id"))
    run: Mapped[str | None] = mapped_column(String(32))
    kind: Mapped[str] = mapped_column(String(16))
    data: Mapped[Any] = mapped_column(JSON)
    time: Mapped[float] = mapped_column(Float)
