"""Event streams: jobs as they change, one stream a tab.

Two kinds of events. ``job`` carries a job exactly as ``GET /jobs/{id}`` does: at once on
connecting, then at every change, at most four a second. ``progress`` carries each report of a run
as soon as it is stored, with the points that its live curves gain. Ids number the stored events; a
stream that reconnects with ``Last-Event-ID`` misses none of the last ten minutes; a comment says
when what it missed has been told. A stream of named jobs ends when all of them are deleted.
"""

from __future__ import annotations

import asyncio
import json
import logging
import time
from collections.abc import AsyncIterator, Iterable, Sequence
from contextlib import suppress
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query
from starlette.concurrency import run_in_threadpool
from starlette.responses import StreamingResponse

from server.errors import Problem
from server.routes.documents import job_documents
from server.routes.outages import DATABASE_AWAY
from server.routes.service import Service, ServiceDependency
from server.store import EventRecord, JobFilter

__all__ = ["router"]

router = APIRouter(prefix="/api/v1", tags=["events"])

_log = logging.getLogger("trainbridge.events")

_SNAPSHOT_SECONDS = 0.25
"""Least time between two snapshots of a stream. [s]"""
_PROGRESS_SECONDS = 0.02
"""Least time between two looks at the database while events come. [s]"""
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
        await run_in_threadpool(service.job, job)
    if service.changes.listeners >= service.settings.limits.event_streams:
        raise Problem(
            503,
            "Too many streams",
            "Too many event streams are open. Close some tabs.",
            headers={"Retry-After": "10"},
        )
    newest = await run_in_threadpool(service.database.last_event)
    # A number from before the database was replaced would keep the stream silent.
    last = newest if after is None else min(after, newest)
    return StreamingResponse(
        _events(service, tuple(jobs), last),
        media_type="text/event-stream",
        headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"},
    )


async def _events(service: Service, jobs: Sequence[str], last: int) -> AsyncIterator[str]:
    """The stream's text: progress at once, snapshots of what it touched a few times a second."""
    rationed, told_all = _Snapshots(service, jobs), False
    beat = time.monotonic() + service.settings.heartbeat_seconds
    try:
        async with service.changes.listen() as changed:
            yield "retry: 1000\n\n"
            if text := await rationed.first(last):
                yield text
            while not service.changes.ended:
                changed.clear()
                events = await run_in_threadpool(service.database.events_after, last, jobs=jobs)
                last = events[-1].id if events else last
                # In one piece: between pieces the loop cannot notice that the listener has left.
                if text := "".join(map(_progress, events)):
                    yield text
                rationed.touch(event.job for event in events)
                if text := await rationed.due(last):
                    yield text
                if events:
                    await asyncio.sleep(_PROGRESS_SECONDS)
                    continue
                if not told_all and not rationed.wait:
                    told_all = True
                    yield ": nothing more waits\n\n"
                await _woken(changed, rationed.wait or beat - time.monotonic())
                # Also where other jobs' changes wake it all the time.
                if not rationed.wait and time.monotonic() >= beat:
                    beat = time.monotonic() + service.settings.heartbeat_seconds
                    yield f": {time.time():.0f}\n\n"
                    if jobs and not await run_in_threadpool(_exists, service, jobs):
                        return
    except DATABASE_AWAY:
        # Who listens comes again by itself and says where it was.
        _log.warning("an event stream ends: the database does not answer")


class _Snapshots:
    """Jobs that were touched since they were last told, and when they may be told again."""

    def __init__(self, service: Service, jobs: Sequence[str]) -> None:
        self._service = service
        self._jobs = jobs
        self._touched: dict[str, None] = {}
        self._next = 0.0

    @property
    def wait(self) -> float:
        """Time until the next ones are due; 0 where none is. [s]"""
        return max(0.001, self._next - time.monotonic()) if self._touched else 0.0

    def touch(self, jobs: Iterable[str]) -> None:
        """Notes jobs that changed."""
        self._touched |= dict.fromkeys(jobs)

    async def first(self, last: int) -> str:
        """What a stream begins with."""
        return await self._told(self._jobs, last)

    async def due(self, last: int) -> str:
        """Events of the jobs that changed, where it is time to tell them."""
        if not self._touched or time.monotonic() < self._next:
            return ""
        touched, self._touched = list(self._touched), {}
        return await self._told(touched, last)

    async def _told(self, jobs: Sequence[str], last: int) -> str:
        begin = time.monotonic()
        text = await run_in_threadpool(_snapshots, self._service, jobs, last)
        end = time.monotonic()
        # Jobs of many runs take long to write out: a tab must not keep the server busy.
        self._next = end + max(_SNAPSHOT_SECONDS, 4.0 * (end - begin))
        return text


def _exists(service: Service, jobs: Sequence[str]) -> bool:
    """Whether any of these jobs is still there."""
    return any(service.database.job(job) is not None for job in jobs)


def _snapshots(service: Service, jobs: Sequence[str], last: int) -> str:
    """Jobs as events: those given, or the newest ones where none is."""
    if jobs:
        found = [service.database.job(job) for job in jobs]
        records = [job for job in found if job is not None]
    else:
        records = service.database.jobs(JobFilter(), limit=_RECENT)[::-1]
    documents = job_documents(service, records)
    return "".join(_event("job", document, last) for document in documents)


def _progress(event: EventRecord) -> str:
    """An event as it is told at once; nothing where only a snapshot tells it."""
    if event.kind != "progress":
        return ""
    return _event("progress", {"job": event.job, "run": event.run, **event.data}, event.id)


def _event(kind: str, data: Any, number: int) -> str:
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return f"id: {number}\nevent: {kind}\ndata: {text}\n\n"


async def _woken(changed: asyncio.Event, seconds: float) -> None:
    """Waits for a change, not longer."""
    with suppress(TimeoutError):
        await asyncio.wait_for(changed.wait(), seconds)
