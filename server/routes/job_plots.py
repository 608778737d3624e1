"""Figures of a whole job: peaks against the speed of its runs."""

from __future__ import annotations

from fastapi import APIRouter
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from server.errors import gone_missing
from server.plots import Figure, FigureRequest, speed_sweep
from server.routes.figure_query import FIGURE_RESPONSES, FileFormat, RequestedFigure, send_figure
from server.routes.service import Service, ServiceDependency
from server.routes.sweeps import read_sweep
from server.store import plain

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/jobs/{job_id}/plots", tags=["plots"])

SPEED_SWEEP = "speed-sweep"


@router.get("/{figure}.{file_format}", response_class=Response, responses={**FIGURE_RESPONSES})
async def read_job_figure(
    job_id: str,
    figure: str,
    file_format: FileFormat,
    service: ServiceDependency,
    request: RequestedFigure,
) -> Response:
    """A figure of what has ended of a job; it grows while other runs go on."""
    drawn = await run_in_threadpool(_figure, service, job_id, figure, request)
    return await send_figure(service, figure, drawn, file_format)


def _figure(service: Service, job: str, name: str, request: FigureRequest) -> Figure:
    record = service.job(job)
    # Modes have no speed.
    if name != SPEED_SWEEP or record.kind == "modes":
        raise gone_missing("figure", name)
    return plain(speed_sweep(read_sweep(service, record), request))
