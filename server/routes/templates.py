"""Studies ready to submit."""

from __future__ import annotations

from functools import cache
from typing import Any

from fastapi import APIRouter

from server.errors import gone_missing
from server.routes.estimates import scaled_estimate
from server.routes.schemas import TemplateItem, TemplateList
from server.routes.service import Service, ServiceDependency
from solver import studies

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/templates", tags=["templates"])


@router.get("")
def list_templates(service: ServiceDependency) -> TemplateList:
    """All templates, each with its study and what it costs."""
    return TemplateList(items=[_costed(service, _item(name)) for name in studies.templates()])


@router.get(
    "/{name}",
    response_model=None,
    responses={
        200: {"content": {"application/json": {"schema": {"$ref": "#/components/schemas/Study"}}}}
    },
)
def read_template(name: str) -> dict[str, Any]:
    """A study, ready to be sent as ``study`` of a job."""
    if name not in studies.templates():
        raise gone_missing("template", name)
    return studies.to_json(studies.template(name).study)


def _costed(service: Service, item: TemplateItem) -> TemplateItem:
    """With the time that runs alike have taken."""
    report = _report(item.name)
    if report.estimate is None:
        return item
    estimate = scaled_estimate(service, item.kind, report.estimate)
    return item.model_copy(update={"estimate": estimate})


@cache
def _report(name: str) -> studies.Report:
    template = studies.template(name)
    return studies.check(template.study, template.kind)


@cache
def _item(name: str) -> TemplateItem:
    template = studies.template(name)
    report = _report(name)
    return TemplateItem.model_validate(
        {
            "name": name,
            "title": template.title,
            "description": template.description,
            "kind": template.kind,
            "study": studies.to_json(template.study),
            "estimate": report.estimate,
            "notes": [f"{warning.reason}. {warning.remedy}" for warning in report.warnings],
        },
        from_attributes=True,
    )
