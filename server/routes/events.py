"""Event streams: jobs as they change, one stream a tab.

Two kinds of events. ``job`` carries a job exactly as ``GET /jobs/{id}`` does: at once on
connecting, then at every change, at most four a second. ``progress`` carries each report of a run,
with the points that its live curves gain. Ids number the stored events; a stream that reconnects
with ``Last-Event-ID`` misses none of the last ten minutes.
"""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import AsyncIterator, Sequence
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query
from starlette.concurrency import run_in_threadpool
from starlette.responses import StreamingResponse

from server.errors import Problem, gone_missing
from server.routes.documents import job_documents
from server.routes.service import Service, ServiceDependency
from server.store import EventRecord

__all__ = ["router"]

router = APIRouter(prefix="/api/v1", tags=["events"])

_SNAPSHOT_SECONDS = 0.25
"""Least time between two snapshots of a stream. [s]"""
_RECENT = 50
"""Jobs that a stream of all jobs begins with."""
_LARGEST_ID = 2**62

LastEvent = Annotated[
    str | None, Header(alias="Last-Event-ID", description="Sent by browsers that reconnect.")
]
After = Annotated[
    int | None,
    Query(ge=0, le=_LARGEST_ID, description="Begin after this event; 0 for all that are kept."),
]
_RESPONSES: dict[int | str, dict[str, Any]] = {
    200: {"content": {"text/event-stream": {}}},
}


@router.get("/events", response_class=StreamingResponse, responses=_RESPONSES)
async def follow_jobs(
    service: ServiceDependency,
    job: Annotated[
        list[str], Query(max_length=100, description="Jobs to follow; none for all.")
    ] = [],  # noqa: B006 (FastAPI copies it)
    after: After = None,
    last_event: LastEvent = None,
) -> StreamingResponse:
    """Changes of some jobs, or of all."""
    return await _stream(service, job, _begin(after, last_event))


@router.get("/jobs/{job_id}/events", response_class=StreamingResponse, responses=_RESPONSES)
async def follow_job(
    job_id: str,
    service: ServiceDependency,
    after: After = 0,
    last_event: LastEvent = None,
) -> StreamingResponse:
    """Changes of one job, from its beginning."""
    return await _stream(service, [job_id], _begin(after, last_event))


def _begin(after: int | None, last_event: str | None) -> int | None:
    if last_event and last_event.isascii() and last_event.isdigit() and len(last_event) < 19:
        return int(last_event)
    return after


async def _stream(service: Service, jobs: Sequence[str], after: int | None) -> StreamingResponse:
    for job in jobs:
        if await run_in_threadpool(service.database.job, job) is None:
            raise gone_missing("job", job)
    if service.changes.listeners >= service.settings.limits.event_streams:
        raise Problem(
            503,
            "Too many streams",
            "Too many event streams are open. Close some tabs.",
            headers={"Retry-After": "10"},
        )
    last = after
    if last is None:
        last = await run_in_threadpool(service.database.last_event)
    return StreamingResponse(
        _events(service, tuple(jobs), last),
        media_type="text/event-stream",
        headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"},
    )


async def _events(service: Service, jobs: Sequence[str], last: int) -> AsyncIterator[str]:
    heartbeat = service.settings.heartbeat_seconds
    async with service.changes.listen() as changed:
        yield "retry: 1000\n\n"
        for text in await run_in_threadpool(_snapshots, service, jobs, None, last):
            yield text
        while not service.changes.ended:
            changed.clear()
            events = await run_in_threadpool(service.database.events_after, last, jobs=jobs)
            for event in events:
                last = event.id
                if event.kind == "progress":
                    yield _progress(event)
            if events:
                touched = list(dict.fromkeys(event.job for event in events))
                for text in await run_in_threadpool(_snapshots, service, touched, touched, last):
                    yield text
                await _pause(service, _SNAPSHOT_SECONDS)
                continue
            if not await _woken(changed, heartbeat):
                yield f": {time.time():.0f}\n\n"


def _snapshots(
    service: Service, jobs: Sequence[str], touched: Sequence[str] | None, last: int
) -> list[str]:
    """Jobs as events: those given, or the newest ones where none is."""
    wanted = touched or jobs
    if wanted:
        found = [service.database.job(job) for job in wanted]
        records = [job for job in found if job is not None]
    else:
        records = service.database.jobs(limit=_RECENT)[::-1]
    return [_event("job", document, last) for document in job_documents(service, records)]


def _progress(event: EventRecord) -> str:
    return _event("progress", {"job": event.job, "run": event.run, **event.data}, event.id)


def _event(kind: str, data: Any, number: int) -> str:
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return f"id: {number}\nevent: {kind}\ndata: {text}\n\n"


async def _woken(changed: asyncio.Event, seconds: float) -> bool:
    try:
        await asyncio.wait_for(changed.wait(), seconds)
    except TimeoutError:
        return False
    return True


async def _pause(service: Service, seconds: float) -> None:
    """Waits, but not when the server stops."""
    end = time.monotonic() + seconds
    while not service.changes.ended and (left := end - time.monotonic()) > 0:
        await asyncio.sleep(min(left, 0.05))
