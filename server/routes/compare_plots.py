"""Figures of several runs beside each other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Annotated

from fastapi import APIRouter, Query
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from server.errors import gone_missing
from server.plots import MAX_RUNS, Figure, FigureRequest, NamedRun, comparisons
from server.routes.figure_query import FIGURE_RESPONSES, FileFormat, RequestedFigure, send_figure
from server.routes.service import Service, ServiceDependency
from server.store import NotStoredError, RunRecord, plain

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/compare/plots", tags=["compare"])

_SHORT = 6
"""Characters of a run's id that tell runs of one name apart."""

Runs = Annotated[
    list[Annotated[str, Query(max_length=64)]],
    Query(min_length=1, max_length=MAX_RUNS, description="Runs; the first is the baseline."),
]


@router.get("/{figure}.{file_format}", response_class=Response, responses={**FIGURE_RESPONSES})
async def read_comparison(
    figure: str,
    file_format: FileFormat,
    service: ServiceDependency,
    run: Runs,
    request: RequestedFigure,
) -> Response:
    """One channel's histories, or envelopes along the bridge, of several runs."""
    drawn = await run_in_threadpool(_figure, service, run, figure, request)
    return await send_figure(service, figure, drawn, file_format)


def _figure(service: Service, runs: Sequence[str], name: str, request: FigureRequest) -> Figure:
    draw = comparisons().get(name)
    if draw is None:
        raise gone_missing("figure", name)
    records = [service.run(run) for run in dict.fromkeys(runs)]
    names = _names(service, records)
    try:
        named = [
            NamedRun(name=words, run=record.id, source=service.reader(record))
            for record, words in zip(records, names, strict=True)
        ]
        return plain(draw(named, request))
    except NotStoredError as error:
        raise gone_missing("history", str(error)) from error


def _names(service: Service, records: Sequence[RunRecord]) -> list[str]:
    """The job's name and the speed, and a part of the id where that does not tell runs apart."""
    names = [_name(service, record) for record in records]
    often = Counter(names)
    return [
        f"{name} ({record.id[:_SHORT]})" if often[name] > 1 else name
        for name, record in zip(names, records, strict=True)
    ]


def _name(service: Service, record: RunRecord) -> str:
    name = service.job(record.job).name
    speed = record.parameters.get("speed")
    return name if speed is None else f"{name}, {3.6 * speed:.4g} km/h"
