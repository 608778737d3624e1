"""Rows of the database as plain values: nothing outside the store holds a session."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from server.store.models import BatchRow, EventRow, JobRow, RunRow

__all__ = [
    "BatchRecord",
    "EventRecord",
    "JobRecord",
    "NewEvent",
    "RunRecord",
    "batch_record",
    "event_record",
    "job_record",
    "run_record",
]


@dataclass(frozen=True, kw_only=True)
class JobRecord:
    """One submission. Times are seconds since 1970, UTC."""

    sequence: int
    id: str
    kind: str
    name: str
    study: Mapping[str, Any]
    state: str
    steps: int
    error: str | None
    created: float
    started: float | None
    ended: float | None


@dataclass(frozen=True, kw_only=True)
class RunRecord:
    """One time integration."""

    id: str
    job: str
    batch: str
    index: int
    parameters: Mapping[str, float]
    state: str
    attempt: int
    progress: Mapping[str, Any]
    verdicts: list[dict[str, Any]] | None
    error: str | None
    started: float | None
    ended: float | None


@dataclass(frozen=True, kw_only=True)
class BatchRecord:
    """Runs that advance together in one process, with the job's study."""

    id: str
    job: str
    kind: str
    study: Mapping[str, Any]
    state: str
    attempt: int
    runs: tuple[RunRecord, ...]


@dataclass(frozen=True, kw_only=True)
class NewEvent:
    """An event to be appended."""

    job: str
    kind: str
    run: str | None = None
    data: Mapping[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True, kw_only=True)
class EventRecord:
    """An event with its number."""

    id: int
    job: str
    run: str | None
    kind: str
    data: Mapping[str, Any]
    time: float


def job_record(row: JobRow) -> JobRecord:
    """The row's values."""
    return JobRecord(
        sequence=row.sequence,
        id=row.id,
        kind=row.kind,
        name=row.name,
        study=row.study,
        state=row.state,
        steps=row.steps,
        error=row.error,
        created=row.created,
        started=row.started,
        ended=row.ended,
    )


def run_record(row: RunRow) -> RunRecord:
    """The row's values."""
    return RunRecord(
        id=row.id,
        job=row.job,
        batch=row.batch,
        index=row.index,
        parameters=row.parameters,
        state=row.state,
        attempt=row.attempt,
        progress=row.progress,
        verdicts=row.verdicts,
        error=row.error,
        started=row.started,
        ended=row.ended,
    )


def batch_record(row: BatchRow, job: JobRow, runs: Iterable[RunRow]) -> BatchRecord:
    """The row's values, with those of its job and runs."""
    return BatchRecord(
        id=row.id,
        job=row.job,
        kind=job.kind,
        study=job.study,
        state=row.state,
        attempt=row.attempt,
        runs=tuple(run_record(run) for run in runs),
    )


def event_record(row: EventRow) -> EventRecord:
    """The row's values."""
    return EventRecord(
        id=row.id, job=row.job, run=row.run, kind=row.kind, data=row.data, time=row.time
    )
