"""Rows of the database as the API sends them."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime, timedelta
from typing import Any

from server.jobs.progress import job_progress
from server.routes.service import Service
from server.store import EventRecord, JobRecord, RunReader, RunRecord, attempt_place

__all__ = ["channel_document", "job_documents", "log_line", "run_document"]

_TITLES = {
    "failed": "The computation failed",
    "timed_out": "The run took too long",
    "out_of_memory": "The run took too much memory",
}

_UNSEEN = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode's categories of what steers text or breaks it, and of halves of characters."""


def job_documents(service: Service, jobs: Sequence[JobRecord]) -> list[dict[str, Any]]:
    """Jobs with their runs."""
    runs = service.database.runs_of([job.id for job in jobs])
    return [_job_document(service, job, runs[job.id]) for job in jobs]


def _job_document(service: Service, job: JobRecord, runs: Sequence[RunRecord]) -> dict[str, Any]:
    waiting = job.state == "queued"
    return {
        "id": job.id,
        "kind": job.kind,
        "name": job.name,
        "state": job.state,
        "progress": None if waiting else _progress(job, runs),
        "created": _time(job.created),
        "started": _time(job.started),
        "ended": _time(job.ended),
        "error": _trouble(job.state, job.error),
        "priority": job.priority,
        "position": service.database.position(job) if waiting else None,
        "estimated_start": _estimated_start(service, job) if waiting else None,
        "source": job.source,
        "runs": [_run_item(run) for run in runs],
    }


def _progress(job: JobRecord, runs: Sequence[RunRecord]) -> dict[str, Any]:
    progress = job_progress((run.progress for run in runs), job.steps)
    states = {run.state for run in runs}
    if job.state == "running" and states == {"queued"} and job.model:
        progress["stage"] = "preparing the model that the runs share"
    elif job.state == "running" and not states & {"queued", "running"}:
        progress["stage"] = "gathering the results"
    return progress


def _estimated_start(service: Service, job: JobRecord) -> tuple[str, str] | None:
    seconds = service.pace.seconds(service.database, service.database.steps_before(job))
    if seconds is None:
        return None
    now = datetime.now(UTC)
    try:
        earliest, latest = (now + timedelta(seconds=part) for part in seconds)
    except OverflowError:
        return None
    return earliest.isoformat(), latest.isoformat()


def run_document(service: Service, run: RunRecord) -> dict[str, Any]:
    """A run with what it found."""
    reader = RunReader(attempt_place(service.store, run.id, run.attempt))
    return {
        **_run_item(run),
        "job": run.job,
        "index": run.index,
        "summary": reader.summary if run.state == "done" else None,
        "verdicts": run.verdicts or [],
    }


def log_line(entry: EventRecord, indices: Mapping[str, int]) -> str:
    """An event as a line of text: time, run, what; whatever it says, it stays one line.

    Args:
        entry: Of kind ``state`` or ``log``.
        indices: Place of each run in its job's sweep, by run.
    """
    who = "job" if entry.run is None else f"run {indices.get(entry.run, 0)} ({entry.run})"
    data = dict(entry.data)
    words = [str(data.pop(key)) for key in ("state", "text") if data.get(key)]
    words += [f"{name} {value}" for name, value in data.items() if value not in (None, "")]
    what = "".join(map(_visible, "; ".join(words)))
    return f"{_time(entry.time)}  {who}  {what}\n"


def _visible(character: str) -> str:
    """A character as it is, one that breaks lines, steers or cannot be sent as an escape."""
    if unicodedata.category(character) in _UNSEEN:
        return character.encode("unicode_escape").decode("ascii")
    return character


def channel_document(channel: Any) -> dict[str, Any]:
    """A channel with the unit that people read."""
    unit = channel.unit
    return {
        **asdict(channel),
        "unit": {"symbol": unit.symbol, "display": unit.shown, "scale": unit.scale},
    }


def _run_item(run: RunRecord) -> dict[str, Any]:
    return {
        "id": run.id,
        "parameters": run.parameters,
        "state": run.state,
        "attempt": run.attempt,
        "progress": run.progress or None,
        "error": _trouble(run.state, run.error),
    }


def _trouble(state: str, detail: str | None) -> dict[str, str] | None:
    if not detail:
        return None
    return {"title": _TITLES.get(state, "It ended without a result"), "detail": detail}


def _time(seconds: float | None) -> str | None:
    """A time of day, cut after the microsecond: what happened then or later includes it."""
    if seconds is None:
        return None
    whole = math.floor(seconds)
    second = datetime.fromtimestamp(whole, UTC)
    return second.replace(microsecond=math.floor(1e6 * (seconds - whole))).isoformat()
