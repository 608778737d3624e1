"""What every figure takes in its address, and how it is sent."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from fastapi import Depends, Query
from starlette.responses import JSONResponse, Response

from server.plots import MEDIA_TYPES, Figure, FigureRequest, csv_lines, read_place
from server.routes.runs import From, To
from server.routes.service import Service
from solver.standards.low_pass import low_pass

__all__ = ["FIGURE_RESPONSES", "FileFormat", "RequestedFigure", "send_figure"]

FileFormat: TypeAlias = Literal["json", "png", "svg", "pdf", "csv"]

FIGURE_RESPONSES: Mapping[int | str, dict[str, Any]] = {
    200: {
        "content": {kind: {} for kind in ("application/json", "text/csv", *MEDIA_TYPES.values())}
    },
    503: {"description": "Too many figures wait; ``Retry-After`` says when to come again."},
}


def _requested(
    begin: From = None,
    end: To = None,
    points: Annotated[int, Query(description="Most points of a curve.")] = 2000,
    channels: Annotated[
        list[str], Query(description="Channels to draw instead of the figure's own choice.")
    ] = [],  # noqa: B006 (FastAPI copies it)
    channel: Annotated[list[str], Query(description="Likewise, for those who name one.")] = [],  # noqa: B006
    place: Annotated[
        str, Query(max_length=200, description="Where: x,y,z, for example 27.0,0.7,1.3. [m]")
    ] = "",
    variant: Annotated[
        str, Query(max_length=80, description="One of the variants in the list of figures.")
    ] = "",
    theme: Annotated[
        Literal["light", "dark"], Query(description="The ground on which it is drawn.")
    ] = "light",
) -> FigureRequest:
    """The request that an address makes.

    Raises:
        InputError: A value cannot be used; 422.
    """
    return FigureRequest(
        start=begin,
        stop=end,
        points=points,
        channels=(*channels, *channel),
        place=read_place(place),
        variant=variant,
        theme=theme,
        low_pass=low_pass,
    )


RequestedFigure = Annotated[FigureRequest, Depends(_requested)]


async def send_figure(
    service: Service, name: str, drawn: Figure, file_format: FileFormat
) -> Response:
    """A drawn figure as JSON, as what it shows in a table, or as a file.

    Raises:
        Problem: 503, too many figures wait.
    """
    if file_format == "json":
        return JSONResponse(drawn)
    if file_format == "csv":
        content, media_type = "".join(csv_lines(drawn)).encode(), "text/csv; charset=utf-8"
    else:
        content = await service.drawing.draw(drawn, file_format)
        media_type = MEDIA_TYPES[file_format]
    return Response(
        content,
        media_type=media_type,
        headers={"Content-Disposition": f'attachment; filename="{name}.{file_format}"'},
    )
