"""The report of a job, for the file: HTML or PDF."""

from __future__ import annotations

import re
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Annotated, Literal

from fastapi import APIRouter, Query
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from server.errors import Problem
from server.plots import FigureRequest, speed_sweep
from server.reports.build import build_report
from server.reports.document import Document
from server.reports.figures import Illustration, illustrated, report_figures
from server.reports.html_writer import POLICY, write_html
from server.reports.material import Material, NothingToReportError, ReportHead
from server.reports.pdf_writer import write_pdf
from server.reports.stills import report_stills
from server.routes.service import Service, ServiceDependency
from server.routes.sweeps import read_sweep
from server.store import JobRecord
from server.version import package_version
from server.viewer import Still, draw_still
from solver.standards.low_pass import low_pass

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/jobs/{job_id}", tags=["reports"])

_LARGEST_SVG = 600_000
"""A figure with more than this is sent as pixels. [B]"""

_TYPES = {"html": "text/html; charset=utf-8", "pdf": "application/pdf"}


@router.get(
    "/report.{file_format}",
    response_class=Response,
    responses={
        200: {"content": {"text/html": {}, "application/pdf": {}}},
        503: {"description": "Too many files wait; ``Retry-After`` says when to come again."},
    },
)
async def read_report(
    job_id: str,
    file_format: Literal["html", "pdf"],
    service: ServiceDependency,
    project: Annotated[
        str, Query(max_length=200, description="Title of the report; the job's name if empty.")
    ] = "",
    author: Annotated[str, Query(max_length=200, description="Who answers for it.")] = "",
    date: Annotated[
        str, Query(max_length=40, description="As it shall be printed; today if empty.")
    ] = "",
    remark: Annotated[str, Query(max_length=2000, description="Anything else.")] = "",
    preview: Annotated[
        bool, Query(description="HTML to be looked at in a page of ours instead of saved.")
    ] = False,
) -> Response:
    """Verdicts, inputs, assumptions, accuracy, figures and identity of a job, in one file."""
    job = await run_in_threadpool(service.job, job_id)
    head = ReportHead(
        project=project.strip() or job.name,
        author=author.strip(),
        date=date.strip() or datetime.now(UTC).date().isoformat(),
        remark=remark.strip(),
    )
    document, figures = await run_in_threadpool(_built, service, job, head)
    if file_format == "html":
        drawn = {name: await _picture(service, item) for name, item in figures.items()}
        content = (await run_in_threadpool(write_html, document, drawn)).encode()
    else:
        pixels = {name: await _pixels(service, item) for name, item in figures.items()}
        content = await service.drawing.work(write_pdf, document, pixels)
    return Response(
        content,
        media_type=_TYPES[file_format],
        headers=_headers(job, file_format, preview=preview),
    )


def _built(
    service: Service, job: JobRecord, head: ReportHead
) -> tuple[Document, Mapping[str, Illustration]]:
    """The document, and its figures ready to be drawn.

    Raises:
        Problem: 409, no run is done.
    """
    records = service.database.runs_of([job.id])[job.id]
    try:
        material = Material.of(job, records, service.store, head, package_version())
    except NothingToReportError as error:
        detail = f"{error} A report needs one that is."
        raise Problem(409, "Nothing to report yet", detail) from None
    figures = {**report_stills(material), **report_figures(material, low_pass)}
    if len(material.runs) > 1 and not material.modal:
        sweep = illustrated(speed_sweep(read_sweep(service, job), FigureRequest()))
        figures = {"speed-sweep": sweep, **figures}
    return build_report(material, figures), figures


async def _picture(service: Service, item: Illustration) -> tuple[str, bytes]:
    """Lines that stay sharp, or pixels where they would be too many."""
    if not isinstance(item.drawing, Still):
        lines = await service.drawing.draw(item.drawing, "svg")
        if len(lines) <= _LARGEST_SVG:
            return "svg", lines
    return "png", await _pixels(service, item)


async def _pixels(service: Service, item: Illustration) -> bytes:
    if isinstance(item.drawing, Still):
        return await service.drawing.work(draw_still, item.drawing)
    return await service.drawing.draw(item.drawing, "png")


def _headers(job: JobRecord, file_format: str, *, preview: bool) -> dict[str, str]:
    kept = re.sub(r"[^A-Za-z0-9]+", "-", job.name).strip("-")[:60].lower()
    name = f"report-{kept or 'job'}-{job.id[:6]}.{file_format}"
    shown = preview and file_format == "html"
    headers = {"Content-Disposition": f'{"inline" if shown else "attachment"}; filename="{name}"'}
    if file_format == "html":
        headers["Content-Security-Policy"] = POLICY
    return headers
