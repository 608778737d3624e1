"""Figures of a run: plotly JSON for the page, files for reports."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Query
from starlette.concurrency import run_in_threadpool
from starlette.responses import JSONResponse, Response

from server.errors import gone_missing
from server.plots import MEDIA_TYPES, Figure, FigureRequest, figures
from server.routes.runs import From, To
from server.routes.service import Service, ServiceDependency
from server.store import NotStoredError, plain

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/runs/{run_id}/plots", tags=["plots"])


@router.get(
    "/{figure}.{file_format}",
    response_class=Response,
    responses={
        200: {"content": {kind: {} for kind in ("application/json", *MEDIA_TYPES.values())}},
        503: {"description": "Too many figures wait; ``Retry-After`` says when to come again."},
    },
)
async def read_figure(
    run_id: str,
    figure: str,
    file_format: Literal["json", "png", "svg", "pdf"],
    service: ServiceDependency,
    begin: From = None,
    end: To = None,
    points: Annotated[int, Query(description="Most points of a curve.")] = 2000,
    channels: Annotated[
        list[str], Query(description="Channels to draw instead of the figure's own choice.")
    ] = [],  # noqa: B006 (FastAPI copies it)
) -> Response:
    """A figure, as JSON for plotly.js or as a file."""
    request = FigureRequest(start=begin, stop=end, points=points, channels=tuple(channels))
    drawn = await run_in_threadpool(_figure, service, run_id, figure, request)
    if file_format == "json":
        return JSONResponse(drawn)
    content = await service.drawing.draw(drawn, file_format)
    return Response(
        content,
        media_type=MEDIA_TYPES[file_format],
        headers={"Content-Disposition": f'attachment; filename="{figure}.{file_format}"'},
    )


def _figure(service: Service, run: str, name: str, request: FigureRequest) -> Figure:
    draw = figures().get(name)
    if draw is None:
        raise gone_missing("figure", name)
    reader = service.open_reader(run)
    try:
        return plain(draw(reader, request))
    except NotStoredError as error:
        raise gone_missing("history", str(error)) from error
