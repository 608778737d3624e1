"""What can be asked of a job or a run that is there: cancel, retry, clone, delete, priority.

Each of these is noted in the database; the coordinator, wherever it is, acts on it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, cast

from fastapi import APIRouter, Depends, Response

from server.errors import Problem, gone_missing
from server.jobs.submission import Submission, stored_study
from server.routes.body import parsed_body
from server.routes.documents import run_document
from server.routes.enqueue import NO_PLACE, enqueue
from server.routes.jobs import job_answer
from server.routes.quota import require_room
from server.routes.schemas import Job, JobChange, Run
from server.routes.service import Service, ServiceDependency
from server.store import RunRecord
from solver.studies import JobKind

__all__ = ["router"]

router = APIRouter(prefix="/api/v1", tags=["jobs"])

_NO_ROOM: dict[int | str, dict[str, Any]] = {507: NO_PLACE[507]}
_ACTIVE = ("queued", "running")
_ACT_SECONDS = 1.0
"""Time that a coordinator takes to act on a retry, at most, unless it is away. [s]"""
_LOOK_SECONDS = 0.02


@router.post("/jobs/{job_id}/cancel", status_code=202)
def cancel_job(job_id: str, service: ServiceDependency) -> Job:
    """Cancels what waits or computes; a job that has ended stays as it is."""
    job = service.job(job_id)
    service.database.request_cancel(job.id)
    service.asked()
    return job_answer(service, service.job(job_id))


@router.post("/jobs/{job_id}/retry", status_code=202, responses=_NO_ROOM)
def retry_job(job_id: str, service: ServiceDependency) -> Job:
    """Queues the runs that ended without a result again; those that are done stay done."""
    job = service.job(job_id)
    if job.state in _ACTIVE:
        raise _conflict(
            f"The job is {job.state}. Wait until it has ended, or cancel it, and retry it then."
        )
    if job.state == "done":
        raise _conflict("Every run of the job is done. Clone it to compute all of them again.")
    runs = _runs_of(service, job.id)
    left = sum(run.state != "done" for run in runs)
    require_room(service, job.disk_bytes * left / len(runs))
    service.database.request_retry(job.id)
    service.asked()
    _await(lambda: service.job(job_id).state in _ACTIVE)
    return job_answer(service, service.job(job_id))


@router.post("/jobs/{job_id}/clone", status_code=202, responses=NO_PLACE)
def clone_job(job_id: str, response: Response, service: ServiceDependency) -> Job:
    """A new job with the same study, kind and priority."""
    job = service.job(job_id)
    kind = cast(JobKind, job.kind)
    submission = Submission(kind=kind, study=stored_study(job.study), priority=job.priority)
    clone, _ = enqueue(service, submission, source=job.id)
    response.headers["Location"] = f"/api/v1/jobs/{clone.id}"
    return job_answer(service, clone)


@router.patch("/jobs/{job_id}", dependencies=[Depends(parsed_body)])
def change_job(job_id: str, change: JobChange, service: ServiceDependency) -> Job:
    """Changes how soon a job's waiting runs begin."""
    job = service.job(job_id)
    if job.state not in _ACTIVE:
        raise _conflict(f"The job is {job.state}: nothing of it waits that could begin sooner.")
    service.database.set_priority(job.id, change.priority)
    service.asked()
    return job_answer(service, service.job(job_id))


@router.delete("/jobs/{job_id}", status_code=202, response_class=Response)
def delete_job(job_id: str, service: ServiceDependency) -> Response:
    """Removes a job with its files: hidden at once, cancelled first where it computes."""
    service.database.request_delete(service.job(job_id).id)
    service.asked()
    return Response(status_code=202)


@router.post("/runs/{run_id}/cancel", status_code=202, tags=["runs"])
def cancel_run(run_id: str, service: ServiceDependency) -> Run:
    """Takes one run out of its job; one that has ended stays as it is."""
    run = service.run(run_id)
    service.database.request_cancel_run(run.id)
    service.asked()
    return Run.model_validate(run_document(service, service.run(run_id)))


@router.post("/runs/{run_id}/retry", status_code=202, tags=["runs"], responses=_NO_ROOM)
def retry_run(run_id: str, service: ServiceDependency) -> Run:
    """Queues one run again that ended without a result."""
    run = service.run(run_id)
    if run.state in _ACTIVE:
        raise _conflict(f"The run is {run.state}. Wait until it has ended, or cancel it first.")
    if run.state == "done":
        raise _conflict("The run is done. Clone its job to compute it again.")
    job = service.job(run.job)
    runs = _runs_of(service, job.id)
    # A job that lives has room for all of its runs.
    if job.state not in _ACTIVE:
        require_room(service, job.disk_bytes / len(runs))
    service.database.request_retry_run(run.id)
    service.asked()
    _await(lambda: service.run(run_id).state in _ACTIVE)
    return Run.model_validate(run_document(service, service.run(run_id)))


def _runs_of(service: Service, job: str) -> list[RunRecord]:
    """The runs of a job.

    Raises:
        Problem: 404: each has some, so that it was deleted and removed since it was looked at.
    """
    runs = service.database.runs_of([job])[job]
    if not runs:
        raise gone_missing("job", job)
    return runs


def _await(is_so: Callable[[], bool]) -> None:
    """Waits for the coordinator to act, so that the answer shows it; not for long.

    Whoever waits for the end of what is retried would otherwise take the old end for the new one.
    """
    limit = time.monotonic() + _ACT_SECONDS
    while not is_so() and time.monotonic() < limit:
        time.sleep(_LOOK_SECONDS)


def _conflict(detail: str) -> Problem:
    return Problem(409, "Not possible now", detail)
