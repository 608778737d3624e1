"""Studies ready to submit."""

from __future__ import annotations

from functools import cache
from typing import Any

from fastapi import APIRouter

from server.errors import gone_missing
from server.routes.schemas import TemplateItem, TemplateList
from solver import studies

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/templates", tags=["templates"])


@router.get("")
def list_templates() -> TemplateList:
    """All templates, each with its study and what it costs."""
    return TemplateList(items=[_item(name) for name in studies.templates()])


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


@cache
def _item(name: str) -> TemplateItem:
    template = studies.template(name)
    report = studies.check(template.study)
    return TemplateItem.model_validate(
        {
            "name": name,
            "title": template.title,
            "description": template.description,
            "study": studies.to_json(template.study),
            "estimate": report.estimate,
            "notes": [f"{warning.reason}. {warning.remedy}" for warning in report.warnings],
        },
        from_attributes=True,
    )
