"""Checking a study without running it."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request

from server.jobs.submission import read_submission, report_document
from server.routes.body import parsed_body
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
    document: dict[str, Any] = report_document(
        studies.check(submission.study),
        service.settings.limits,
        service.capacity(),
        submission.path,
    )
    return Report.model_validate(document, from_attributes=True)
