"""Figures of a run: plotly JSON for the page, files for reports, tables for spreadsheets."""

from __future__ import annotations

from http import HTTPStatus
from typing import Literal

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from server.errors import Problem, gone_missing
from server.plots import Figure, FigureRequest, figures, figures_of
from server.routes.figure_query import FIGURE_RESPONSES, FileFormat, RequestedFigure, send_figure
from server.routes.service import Service, ServiceDependency
from server.store import NotStoredError, plain

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/runs/{run_id}/plots", tags=["plots"])


class FigureVariant(BaseModel):
    """One way to draw a figure."""

    name: str
    title: str


class FigureItem(BaseModel):
    """A figure that a run has."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    name: str
    title: str
    group: Literal["deck", "slab", "wheel", "vehicle", "spectrum"]
    axis: Literal["time", "frequency", "position"]
    """What runs along its horizontal axis."""
    variants: list[FigureVariant]
    """Values of ``variant``, the first by default."""
    needs_place: bool
    """Whether it cannot be drawn without ``place``."""


class FigureList(BaseModel):
    """In the order in which a page shows them."""

    items: list[FigureItem]


@router.get("")
def list_figures(run_id: str, service: ServiceDependency) -> FigureList:
    """The figures that this run has, or will have once it has got so far."""
    try:
        reader = service.open_reader(run_id)
    except Problem as problem:
        if problem.status != HTTPStatus.CONFLICT:
            raise
        return FigureList(items=[])  # not one step so far: there is nothing to draw
    items = [kind.document(reader) for kind in figures_of(reader)]
    return FigureList.model_validate({"items": items})


@router.get("/{figure}.{file_format}", response_class=Response, responses={**FIGURE_RESPONSES})
async def read_figure(
    run_id: str,
    figure: str,
    file_format: FileFormat,
    service: ServiceDependency,
    request: RequestedFigure,
) -> Response:
    """A figure, as JSON for plotly.js, as CSV of what it shows, or as a file."""
    drawn = await run_in_threadpool(_figure, service, run_id, figure, request)
    return await send_figure(service, figure, drawn, file_format)


def _figure(service: Service, run: str, name: str, request: FigureRequest) -> Figure:
    draw = figures().get(name)
    if draw is None:
        raise gone_missing("figure", name)
    reader = service.open_reader(run)
    try:
        return plain(draw(reader, request))
    except NotStoredError as error:
        raise gone_missing("history", str(error)) from error
