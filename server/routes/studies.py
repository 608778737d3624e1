"""Checking a study without running it."""

from __future__ import annotations

from fastapi import APIRouter, Request

from server.jobs.submission import read_submission, report_document
from server.routes.body import parsed_body
from server.routes.estimates import scaled_estimate
from server.routes.openapi import SUBMISSION_BODY
from server.routes.schemas import Report
from server.routes.service import ServiceDependency
from solver import studies

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/studies", tags=["studies"])


@router.post("/validate", openapi_extra=SUBMISSION_BODY)
def validate_study(request: Request, service: ServiceDependency) -> Report:
    """Errors, warnings, derived values and an estimate of steps, unknowns, time, memory, disk."""
    submission = read_submission(parsed_body(request))
    study, kind = submission.study, submission.kind
    found = studies.check(study, kind, service.past_runs.first_frequency(study))
    limits, capacity = service.settings.limits, service.capacity()
    document = report_document(found, limits, capacity, submission.path)
    if found.estimate is not None:
        document["estimate"] = scaled_estimate(service, kind, found.estimate)
    return Report.model_validate(document, from_attributes=True)
