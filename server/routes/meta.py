"""What the page needs to know, and whether the server is well."""

from __future__ import annotations

from fastapi import APIRouter

from server.errors import Problem
from server.routes.schemas import Health, Meta
from server.routes.service import ServiceDependency
from server.vendor import plotly_url
from server.version import package_version

__all__ = ["OPENAPI_URL", "router"]

OPENAPI_URL = "/api/v1/openapi.json"

router = APIRouter(prefix="/api/v1", tags=["meta"])


@router.get("/meta")
def read_meta() -> Meta:
    """Version and addresses."""
    return Meta(version=package_version(), plotly_url=plotly_url(), openapi_url=OPENAPI_URL)


@router.get("/health")
def read_health(service: ServiceDependency) -> Health:
    """200 while the database answers and the queue works."""
    service.database.last_event()
    if service.queue_alive is None:
        return Health(status="ok", coordinator="elsewhere")
    if not service.queue_alive():
        raise Problem(503, "The queue stands still", "Restart the server; its log says more.")
    return Health(status="ok", coordinator="here", trouble=service.queue_trouble() or None)
