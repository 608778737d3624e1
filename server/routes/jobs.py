"""Jobs: submit, list, look at, cancel."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response

from server.errors import Problem, gone_missing
from server.jobs.submission import admit, read_submission
from server.routes.body import parsed_body
from server.routes.documents import job_documents, worst_verdicts
from server.routes.openapi import SUBMISSION_BODY
from server.routes.schemas import Job, JobList, StateName, VerdictList
from server.routes.service import Service, ServiceDependency
from server.store import JobRecord, QueueFullError
from solver import studies

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/jobs", tags=["jobs"])


@router.post("", status_code=202, openapi_extra=SUBMISSION_BODY)
def submit_job(request: Request, response: Response, service: ServiceDependency) -> Job:
    """Takes a study into the queue: 202, and where to look in ``Location``."""
    submission = read_submission(parsed_body(request))
    settings = service.settings
    report = admit(submission, settings.limits, settings.data)
    modal = submission.kind == "modes"
    try:
        job = service.database.add_job(
            kind=submission.kind,
            name=submission.study.name,
            study=studies.to_json(submission.study),
            # Frequencies do not depend on the speed: one run says it all.
            runs=[{}] if modal else studies.runs_of(submission.study),
            steps=1 if modal else report.estimate.steps,
            queued_limit=settings.limits.queued_jobs,
        )
    except QueueFullError as error:
        raise Problem(
            503, "The queue is full", f"{error} Try again later.", headers={"Retry-After": "60"}
        ) from None
    service.coordinator.wake()
    service.changes.notify()
    response.headers["Location"] = f"/api/v1/jobs/{job.id}"
    return _job(service, job)


@router.get("")
def list_jobs(
    service: ServiceDependency,
    limit: Annotated[int, Query(ge=1, le=200, description="Jobs of one page.")] = 50,
    cursor: Annotated[
        str | None, Query(pattern=r"^[0-9]{1,15}$", description="``next`` of the page before.")
    ] = None,
    state: Annotated[StateName | None, Query(description="Only jobs in this state.")] = None,
) -> JobList:
    """Jobs, newest first."""
    before = None if cursor is None else int(cursor)
    found = service.database.jobs(limit=limit + 1, before=before, state=state)
    page = found[:limit]
    more = str(page[-1].sequence) if len(found) > limit else None
    return JobList.model_validate({"items": job_documents(service, page), "next": more})


@router.get("/{job_id}")
def read_job(job_id: str, service: ServiceDependency) -> Job:
    """A job with its runs."""
    return _job(service, _found(service, job_id))


@router.get("/{job_id}/study", response_model=None)
def read_job_study(job_id: str, service: ServiceDependency) -> Any:
    """The study as it was submitted, with every default filled in."""
    return _found(service, job_id).study


@router.post("/{job_id}/cancel", status_code=202)
def cancel_job(job_id: str, service: ServiceDependency) -> Job:
    """Cancels what waits or computes; a job that has ended stays as it is."""
    service.database.request_cancel(_found(service, job_id).id)
    service.coordinator.wake()
    return _job(service, _found(service, job_id))


@router.get("/{job_id}/verdicts")
def read_job_verdicts(job_id: str, service: ServiceDependency) -> VerdictList:
    """Of each rule the worst verdict of all runs."""
    job = _found(service, job_id)
    runs = service.database.runs_of([job.id])[job.id]
    done = [run for run in runs if run.state == "done"]
    return VerdictList(items=worst_verdicts(done), judged=len(done), runs=len(runs))


def _found(service: Service, job: str) -> JobRecord:
    found = service.database.job(job)
    if found is None:
        raise gone_missing("job", job)
    return found


def _job(service: Service, job: JobRecord) -> Job:
    [document] = job_documents(service, [job])
    return Job.model_validate(document)
