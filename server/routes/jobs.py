"""Jobs: submit, list, look at."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request, Response
from starlette.responses import PlainTextResponse

from server.errors import Problem
from server.jobs.gather import SUMMARY, worst_verdicts
from server.jobs.submission import read_submission
from server.routes.body import parsed_body
from server.routes.documents import job_documents, log_line
from server.routes.enqueue import NO_PLACE, body_digest, enqueue
from server.routes.openapi import SUBMISSION_BODY
from server.routes.schemas import Job, JobList, StateName, VerdictList
from server.routes.service import Service, ServiceDependency
from server.store import JobFilter, JobRecord, job_place

__all__ = ["job_answer", "router"]

router = APIRouter(prefix="/api/v1/jobs", tags=["jobs"])

_LOG_LINES = 10_000
"""Entries of a log that are sent, the newest."""

IdempotencyKey = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        pattern=r"^[!-~]{1,200}$",
        description="A request that is sent twice with the same key makes one job.",
    ),
]


@router.post(
    "",
    status_code=202,
    openapi_extra=SUBMISSION_BODY,
    responses={
        200: {"model": Job, "description": "The job of an earlier request with the same key."},
        **NO_PLACE,
    },
)
def submit_job(
    request: Request,
    response: Response,
    service: ServiceDependency,
    key: IdempotencyKey = None,
) -> Job:
    """Takes a study into the queue: 202, and where to look in ``Location``."""
    body = parsed_body(request)
    digest = None if key is None else body_digest(body)
    job, made = enqueue(service, read_submission(body), key=key, digest=digest)
    if not made:
        response.status_code = 200
    response.headers["Location"] = f"/api/v1/jobs/{job.id}"
    return job_answer(service, job)


@router.get("")
def list_jobs(
    service: ServiceDependency,
    limit: Annotated[int, Query(ge=1, le=200, description="Jobs of one page.")] = 50,
    cursor: Annotated[
        str | None, Query(pattern=r"^[0-9]{1,15}$", description="``next`` of the page before.")
    ] = None,
    state: Annotated[
        list[StateName], Query(max_length=10, description="Only jobs in one of these states.")
    ] = [],  # noqa: B006 (FastAPI copies it)
    kind: Annotated[
        str | None, Query(pattern=r"^[a-z_]{1,40}$", description="Only jobs of this kind.")
    ] = None,
    name: Annotated[
        str | None,
        Query(
            min_length=1,
            max_length=200,
            pattern=r"^[^\x00]+$",
            description="Only jobs whose name contains this.",
        ),
    ] = None,
    created_from: Annotated[
        datetime | None, Query(description="Only jobs submitted then or later; UTC if not said.")
    ] = None,
    created_to: Annotated[
        datetime | None, Query(description="Only jobs submitted before; UTC if not said.")
    ] = None,
) -> JobList:
    """Jobs, newest first."""
    wanted = JobFilter(
        states=tuple(state),
        kind=kind,
        name=name,
        created_from=_seconds(created_from),
        created_to=_seconds(created_to),
    )
    before = None if cursor is None else int(cursor)
    found = service.database.jobs(wanted, limit=limit + 1, before=before)
    page = found[:limit]
    more = str(page[-1].sequence) if len(found) > limit else None
    return JobList.model_validate({"items": job_documents(service, page), "next": more})


@router.get("/{job_id}")
def read_job(job_id: str, service: ServiceDependency) -> Job:
    """A job with its runs."""
    return job_answer(service, service.job(job_id))


@router.get("/{job_id}/study", response_model=None)
def read_job_study(job_id: str, service: ServiceDependency) -> Any:
    """The study as it was submitted, with every default filled in."""
    return service.job(job_id).study


@router.get("/{job_id}/verdicts")
def read_job_verdicts(job_id: str, service: ServiceDependency) -> VerdictList:
    """Of each rule the worst verdict of all runs."""
    job = service.job(job_id)
    runs = service.database.runs_of([job.id])[job.id]
    done = [run for run in runs if run.state == "done"]
    worst = worst_verdicts({"run": run.id, "verdicts": run.verdicts} for run in done)
    return VerdictList(items=worst, judged=len(done), runs=len(runs))


@router.get(
    "/{job_id}/summary",
    response_class=Response,
    responses={200: {"content": {"application/json": {}}}},
)
def read_job_summary(job_id: str, service: ServiceDependency) -> Response:
    """What all runs of a sweep gave together: verdicts and peaks, the worst of each rule."""
    job = service.job(job_id)
    if job.state in ("queued", "running"):
        # A job that is retried still has the summary of before.
        raise Problem(
            409,
            "No summary yet",
            f"The job is {job.state}. Its summary is made when its last run has ended.",
        )
    document = job_place(service.store, job.id).read(SUMMARY)
    if document is None:
        raise Problem(
            409,
            "No summary yet",
            f"The job is {job.state}. A summary is made when every run of a sweep has ended and "
            "one of them at least is done; a job of one run has none, see its run.",
        )
    return Response(document, media_type="application/json")


@router.get(
    "/{job_id}/log",
    response_class=PlainTextResponse,
    responses={200: {"content": {"text/plain": {}}}},
)
def read_job_log(job_id: str, service: ServiceDependency) -> PlainTextResponse:
    """What happened, one line an entry: time, run, what."""
    job = service.job(job_id)
    runs = {run.id: run.index for run in service.database.runs_of([job.id])[job.id]}
    entries = service.database.log_of(job.id, limit=_LOG_LINES)
    return PlainTextResponse(
        "".join(log_line(entry, runs) for entry in entries),
        headers={"Content-Disposition": f'attachment; filename="job-{job.id}.log"'},
    )


def job_answer(service: Service, job: JobRecord) -> Job:
    """A job as the API sends it."""
    [document] = job_documents(service, [job])
    return Job.model_validate(document)


def _seconds(time: datetime | None) -> float | None:
    """Seconds since 1970."""
    if time is None:
        return None
    return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()
