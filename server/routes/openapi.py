"""The study's schema in OpenAPI: units, bounds, descriptions come from the solver's fields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from annotated_types import Ge, Le
from fastapi import FastAPI
from pydantic import TypeAdapter

from server.jobs.submission import READING_SOURCES
from server.settings import LARGEST_PRIORITY
from solver import studies
from solver.studies import Study

__all__ = ["SUBMISSION_BODY", "describe_studies"]

SUBMISSION_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {"application/json": {"schema": {"$ref": "#/components/schemas/Submission"}}},
    }
}
"""For routes that parse their body strictly instead of leaving it to FastAPI."""

_REFERENCES = "#/components/schemas/{model}"


@dataclass(frozen=True, kw_only=True)
class Submission:
    """A study, what to compute of it, and how soon."""

    study: Study
    kind: Literal["crossing", "modes"] = "crossing"
    priority: Annotated[int, Ge(-LARGEST_PRIORITY), Le(LARGEST_PRIORITY)] = 0


def describe_studies(app: FastAPI) -> None:
    """Adds the study's schema, with an example, to the document of the API."""
    plain = app.openapi

    def described() -> dict[str, Any]:
        if app.openapi_schema is None:
            document = plain()
            with READING_SOURCES:
                schema = TypeAdapter(Submission).json_schema(ref_template=_REFERENCES)
            parts = document.setdefault("components", {}).setdefault("schemas", {})
            parts |= schema.pop("$defs")
            example = studies.to_json(studies.template("sprung-mass-beam").study)
            schema["examples"] = [{"kind": "crossing", "study": example}]
            parts["Submission"] = schema
            app.openapi_schema = document
        return app.openapi_schema

    app.openapi = described
