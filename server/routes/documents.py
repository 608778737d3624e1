"""Rows of the database as the API sends them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any

from server.jobs.progress import job_progress
from server.routes.service import Service
from server.store import JobRecord, RunReader, RunRecord

__all__ = ["channel_document", "job_documents", "run_document", "worst_verdicts"]

_TITLES = {
    "failed": "The computation failed",
    "timed_out": "The run took too long",
    "out_of_memory": "The run took too much memory",
}


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
        "progress": None if waiting else job_progress((run.progress for run in runs), job.steps),
        "created": _time(job.created),
        "started": _time(job.started),
        "ended": _time(job.ended),
        "error": _trouble(job.state, job.error),
        "position": service.database.position(job) if waiting else None,
        "runs": [_run_item(run) for run in runs],
    }


def run_document(run: RunRecord, reader: RunReader) -> dict[str, Any]:
    """A run with what it found."""
    summary = reader.summary if run.state == "done" else None
    return {
        **_run_item(run),
        "job": run.job,
        "index": run.index,
        "attempt": run.attempt,
        "summary": summary,
        "verdicts": run.verdicts or [],
    }


def worst_verdicts(runs: Iterable[RunRecord]) -> list[dict[str, Any]]:
    """Of each rule the verdict that is furthest beyond its limit, or nearest to it."""
    worst: dict[str, dict[str, Any]] = {}
    for run in runs:
        for verdict in run.verdicts or []:
            rule = str(verdict.get("rule"))
            if rule not in worst or _severity(verdict) > _severity(worst[rule]):
                worst[rule] = {**verdict, "run": run.id}
    return list(worst.values())


def channel_document(channel: Any) -> dict[str, Any]:
    """A channel with the unit that people read."""
    unit = channel.unit
    return {
        **asdict(channel),
        "unit": {"symbol": unit.symbol, "display": unit.shown, "scale": unit.scale},
    }


def _severity(verdict: dict[str, Any]) -> tuple[bool, float]:
    limit = abs(float(verdict.get("limit") or 0.0)) or 1.0
    return bool(verdict.get("exceeds")), abs(float(verdict.get("value") or 0.0)) / limit


def _run_item(run: RunRecord) -> dict[str, Any]:
    return {
        "id": run.id,
        "parameters": run.parameters,
        "state": run.state,
        "progress": run.progress or None,
        "error": _trouble(run.state, run.error),
    }


def _trouble(state: str, detail: str | None) -> dict[str, str] | None:
    if not detail:
        return None
    return {"title": _TITLES.get(state, "It ended without a result"), "detail": detail}


def _time(seconds: float | None) -> str | None:
    return None if seconds is None else datetime.fromtimestamp(seconds, UTC).isoformat()
