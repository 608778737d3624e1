"""From a submission to a job in the queue: the same for a new study and for a clone."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import replace
from typing import Any

from server.errors import Finding, Problem
from server.jobs.submission import Submission, admit
from server.routes.quota import require_room
from server.routes.service import Service
from server.store import JobRecord, KeyReusedError, NewJob, QueueFullError
from solver import studies

__all__ = ["NO_PLACE", "body_digest", "enqueue"]

NO_PLACE: dict[int | str, dict[str, Any]] = {
    503: {"description": "The queue is full; ``Retry-After`` says when to come again."},
    507: {"description": "The results would take more disk than this server may use."},
}
"""Answers to what would have made a job, for the API's description."""


def enqueue(
    service: Service,
    submission: Submission,
    *,
    source: str | None = None,
    key: str | None = None,
    digest: str | None = None,
) -> tuple[JobRecord, bool]:
    """Checks a submission and adds its job.

    Args:
        service: Takes the job.
        submission: What to compute.
        source: The job that it is a clone of.
        key: ``Idempotency-Key`` of the request.
        digest: ``body_digest`` of the request.

    Returns:
        The job, and whether it is new: with a key that was used before it is the one of then,
        whatever the disk and the queue look like by now.

    Raises:
        Problem: 422 unusable, or another body under the same key; 503 the queue is full; 507 no
            room.
    """
    new = _new_job(submission, source=source, key=key, digest=digest)
    queued_limit = service.settings.limits.queued_jobs
    try:
        steps, disk_bytes = _admitted(service, submission)
        new = replace(new, steps=steps, disk_bytes=disk_bytes)
        require_room(service, disk_bytes)
        job, made = service.database.add_job(new, queued_limit=queued_limit)
    except KeyReusedError:
        raise _key_reused(key or "") from None
    except QueueFullError as error:
        raise Problem(
            503, "The queue is full", f"{error} Try again later.", headers={"Retry-After": "60"}
        ) from None
    except Problem as problem:
        return _earlier(service, new, problem), False
    service.asked()
    return job, made


def body_digest(body: Any) -> str:
    """Digest of a parsed body: the same for the same values, whatever their order and spaces."""
    text = json.dumps(body, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def _admitted(service: Service, submission: Submission) -> tuple[int, int]:
    """Steps and bytes that a job will take, where it is not refused."""
    estimate = admit(submission, service.settings.limits, service.capacity()).estimate
    return estimate.steps, math.ceil(estimate.disk_bytes)


def _new_job(
    submission: Submission, *, source: str | None, key: str | None, digest: str | None
) -> NewJob:
    study = submission.study
    # Frequencies do not depend on the speed: one run says it all.
    runs = [{}] if submission.kind == "modes" else studies.runs_of(study)
    sweeps = submission.kind == "crossing" and len(runs) > 1
    return NewJob(
        kind=submission.kind,
        name=study.name,
        study=studies.to_json(study),
        runs=runs,
        steps=1,
        priority=submission.priority,
        source=source,
        wants_gather=sweeps,
        # A single run prepares for itself: nobody shares what it makes.
        model=studies.model_key(study) if sweeps else None,
        key=key,
        body_digest=digest,
    )


def _earlier(service: Service, new: NewJob, problem: Problem) -> JobRecord:
    """The job that an earlier request with the same key made, where this one is refused.

    With no place in the queue the database can only give the job that there is.
    """
    if new.key is None:
        raise problem
    try:
        job, _ = service.database.add_job(new, queued_limit=0)
    except QueueFullError:
        raise problem from None
    except KeyReusedError:
        raise _key_reused(new.key) from None
    return job


def _key_reused(key: str) -> Problem:
    finding = Finding(
        pointer="Idempotency-Key",
        value=key[:80],
        reason="was used with another body",
        remedy="Send the same body again to get the job of then, or a new key for a new job",
    )
    detail = f"This {finding.pointer} {finding.reason}. {finding.remedy}."
    return Problem(422, "Key used before", detail, errors=[finding])
