"""Rows of the database as plain values: nothing outside the store holds a session."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from server.store.models import BatchRow, EventRow, JobRow, RunRow

__all__ = [
    "BatchRecord",
    "Decide",
    "EventRecord",
    "JobDecision",
    "JobFilter",
    "JobRecord",
    "JobView",
    "NewEvent",
    "NewJob",
    "Purpose",
    "Requests",
    "RunRecord",
    "batch_record",
    "event_record",
    "job_record",
    "run_record",
]

Purpose = Literal["runs", "prepare", "gather"]
"""What a batch does: compute runs, make the model that they share, gather what they gave."""


@dataclass(frozen=True, kw_only=True)
class NewJob:
    """A submission as it enters the queue.

    Attributes:
        kind: What to compute.
        name: For people.
        study: The study as JSON.
        runs: Parameters of each run, in the order of the sweep.
        steps: Time steps of all runs together.
        disk_bytes: What its results will take at most. [B]
        priority: Greater first.
        source: The job that it was cloned from.
        wants_gather: Whether a gather follows its last run.
        model: Key of the model that its runs share; a batch prepares it first.
        key: The ``Idempotency-Key`` of the request.
        body_digest: Digest of the request that came with the key.
    """

    kind: str
    name: str
    study: Mapping[str, Any]
    runs: Sequence[Mapping[str, float]]
    steps: int
    disk_bytes: int = 0
    priority: int = 0
    source: str | None = None
    wants_gather: bool = False
    model: str | None = None
    key: str | None = None
    body_digest: str | None = None


@dataclass(frozen=True, kw_only=True)
class JobRecord:
    """One submission. Times are seconds since 1970, UTC.

    Attributes:
        priority: Greater first.
        cancel_requested: Whether someone asked to cancel it.
        source: The job that it was cloned from.
        disk_bytes: Estimate of what its results take. [B]
        wants_gather: Whether a gather follows its last run.
        model: Key of the model that its runs share.
    """

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
    priority: int = 0
    cancel_requested: bool = False
    source: str | None = None
    disk_bytes: int = 0
    wants_gather: bool = False
    model: str | None = None


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
    cancel_requested: bool = False


@dataclass(frozen=True, kw_only=True)
class BatchRecord:
    """Runs that advance together in one process, with the job's study.

    Attributes:
        runs: Its runs, ended ones too; none where it prepares or gathers.
        purpose: What it does.
        deaths: Attempts that count against the limit.
        checkpoint_step: Step of the newest checkpoint, -1 for none.
        model: Key of the model that it makes or uses.
        waits_for: The batch that has to be done before it.
    """

    id: str
    job: str
    kind: str
    study: Mapping[str, Any]
    state: str
    attempt: int
    runs: tuple[RunRecord, ...]
    purpose: Purpose = "runs"
    deaths: int = 0
    checkpoint_step: int = -1
    model: str | None = None
    waits_for: str | None = None


@dataclass(frozen=True, kw_only=True)
class NewEvent:
    """An event to be appended; its kind is state, progress, log or checkpoint."""

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


@dataclass(frozen=True, kw_only=True)
class JobFilter:
    """Which jobs a list shows; what is empty or None lets all pass.

    Attributes:
        states: In one of these.
        kind: Of this kind.
        name: With this text in their name, whatever its case.
        created_from: Created then or later. [s]
        created_to: Created before then. [s]
        source: Cloned from this job.
    """

    states: Sequence[str] = ()
    kind: str | None = None
    name: str | None = None
    created_from: float | None = None
    created_to: float | None = None
    source: str | None = None


@dataclass(frozen=True, kw_only=True)
class Requests:
    """What people asked for and has not been settled: identifiers.

    Attributes:
        cancel_jobs: To be cancelled; jobs to be deleted are among them while they live.
        cancel_runs: To be cancelled, of jobs that go on.
        retry_jobs: Whose runs that failed shall be computed again.
        retry_runs: That shall be computed again, of jobs that are not retried as a whole.
        delete_jobs: To be deleted, of which nothing runs any more.
    """

    cancel_jobs: tuple[str, ...] = ()
    cancel_runs: tuple[str, ...] = ()
    retry_jobs: tuple[str, ...] = ()
    retry_runs: tuple[str, ...] = ()
    delete_jobs: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class JobView:
    """What decides about a job's state.

    Attributes:
        runs: States of its runs, in the order of the sweep.
        prepare: State of the batch that prepares its model, None where it has none.
        gather: State of the gather of these results, None where it was not inserted yet.
        wants_gather: Whether a gather follows the last run.
        cancel_requested: Whether someone asked to cancel it.
    """

    runs: tuple[str, ...]
    prepare: str | None
    gather: str | None
    wants_gather: bool
    cancel_requested: bool


@dataclass(frozen=True, kw_only=True)
class JobDecision:
    """A job's state, and whether its gather enters the queue now.

    Attributes:
        state: The state.
        insert_gather: Whether its gather enters the queue, unless it is there.
        error: What is wrong with the job as it ends, instead of the first error of its runs.
    """

    state: str
    insert_gather: bool = False
    error: str | None = None


Decide = Callable[[JobView], JobDecision]
"""The job's state from those of its parts: a pure function of ``server.jobs.states``."""


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
        priority=row.priority,
        cancel_requested=row.cancel_requested,
        source=row.source,
        disk_bytes=row.disk_bytes,
        wants_gather=row.wants_gather,
        model=row.model,
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
        cancel_requested=row.cancel_requested,
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
        purpose=row.purpose,
        deaths=row.deaths,
        checkpoint_step=row.checkpoint_step,
        model=row.model,
        waits_for=row.waits_for,
    )


def event_record(row: EventRow) -> EventRecord:
    """The row's values."""
    return EventRecord(
        id=row.id, job=row.job, run=row.run, kind=row.kind, data=row.data, time=row.time
    )
