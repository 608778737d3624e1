"""A figure as a file: the very dictionary that the browser draws, drawn by matplotlib.

matplotlib is imported on first use (it is slow and large) and only its object interface is used:
no global state, no display. It is not safe in threads, so the server calls :func:`render` in one
side process.
"""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from typing import Any

from server.plots.drawn_marks import draw_note, draw_shape
from server.plots.drawn_traces import draw_trace
from server.plots.figure import Figure
from server.plots.palette import DARK, GRID, INK, PAPER
from server.plots.text import plain
from solver.errors import InputError

__all__ = ["MEDIA_TYPES", "render"]

MEDIA_TYPES: Mapping[str, str] = {
    "png": "image/png",
    "svg": "image/svg+xml",
    "pdf": "application/pdf",
}
"""File formats and their media types."""

_METADATA: Mapping[str, dict[str, None]] = {
    "png": {},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
}
"""Files carry no date, so that equal results give equal files."""
_STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "trainbridge",
    "pdf.fonttype": 42,
    "path.simplify": False,
    "font.size": 9.0,
    "agg.path.chunksize": 10_000,
}
WIDTH, HEIGHT, MORE_HEIGHT = 9.0, 4.2, 2.4
"""Of a figure, and what a second panel adds to the height. [inch]"""
DOTS_PER_INCH = 160


def render(figure: Figure, file_format: str) -> bytes:
    """Draws a figure to a file's bytes, in the colours that it has.

    Args:
        figure: What a function of :func:`server.plots.figures` returned.
        file_format: ``png``, ``svg`` or ``pdf``.

    Returns:
        The file.

    Raises:
        InputError: The format is none of these.
    """
    if file_format not in MEDIA_TYPES:
        raise InputError("format", file_format, "is no file format", "Use png, svg or pdf.")
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Sheet

    layout = figure["layout"]
    panels = [name for name in ("yaxis", "yaxis2") if name in layout]
    with mpl.rc_context({**_STYLE, **_ground(layout)}):
        size = (WIDTH, HEIGHT + MORE_HEIGHT * (len(panels) - 1))
        sheet = Sheet(figsize=size, layout="constrained")
        FigureCanvasAgg(sheet)
        drawn = sheet.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
        _draw(sheet, dict(zip(panels, drawn, strict=True)), figure)
        buffer = BytesIO()
        sheet.savefig(
            buffer, format=file_format, dpi=DOTS_PER_INCH, metadata=_METADATA[file_format]
        )
    return buffer.getvalue()


def _ground(layout: Mapping[str, Any]) -> dict[Any, Any]:
    """matplotlib's colours for the figure's theme."""
    tones = DARK if layout["meta"].get("theme") == "dark" else {}
    paper, ink, grid = (tones.get(color, color) for color in (PAPER, INK, GRID))
    return {
        "figure.facecolor": paper,
        "savefig.facecolor": paper,
        "axes.facecolor": paper,
        "axes.edgecolor": ink,
        "axes.labelcolor": ink,
        "axes.titlecolor": ink,
        "text.color": ink,
        "xtick.color": ink,
        "ytick.color": ink,
        "grid.color": grid,
        "grid.linewidth": 0.5,
    }


def _draw(sheet: Any, panels: Mapping[str, Any], figure: Figure) -> None:
    layout = figure["layout"]

    def panel(part: Mapping[str, Any], key: str) -> Any:
        """Axes of a trace, shape or note: plotly calls the second ones ``y2``."""
        return panels["yaxis2" if str(part.get(key)).startswith("y2") else "yaxis"]

    for name, axes in panels.items():
        _draw_axes(axes, layout[name])
    named = [draw_trace(sheet, panel(part, "yaxis"), part) for part in figure["data"]]
    for name, axes in panels.items():
        _set_ranges(axes, layout["xaxis"], layout[name])
    for shape in layout["shapes"]:
        across = shape["yref"] == "paper"
        for axes in panels.values() if across else (panel(shape, "yref"),):
            draw_shape(axes, shape)
    for note in layout["annotations"]:
        draw_note(panel(note, "yref"), note)
    first, *_, last = (*panels.values(), *panels.values())
    title = plain(layout["title"]["text"])
    first.set_title(title, parse_math=False, loc="left", fontsize=10.5)
    last.set_xlabel(plain(layout["xaxis"]["title"]["text"]), parse_math=False)
    handles = dict(filter(None, named))
    if handles and layout["showlegend"]:
        # Outside the axes: 'best' would search every point of long histories for a free corner.
        legend = sheet.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower center",
            ncols=4 if max(map(len, handles)) < 34 else 2,
            frameon=False,
            fontsize=8,
            handlelength=3.2,
        )
        for text in legend.get_texts():
            text.set_parse_math(False)


def _draw_axes(axes: Any, value_axis: Mapping[str, Any]) -> None:
    axes.set_ylabel(plain(value_axis["title"]["text"]), parse_math=False)
    axes.grid(visible=True)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _set_ranges(axes: Any, x_axis: Mapping[str, Any], value_axis: Mapping[str, Any]) -> None:
    """The ranges that the figure states; what it leaves open follows from the traces."""
    for axis, limits in ((x_axis, axes.set_xlim), (value_axis, axes.set_ylim)):
        low, high = axis.get("range", (0.0, 0.0))
        if high > low:
            limits(low, high)
    if value_axis.get("rangemode") == "tozero" and "range" not in value_axis:
        axes.set_ylim(0.0, 1.05 * axes.get_ylim()[1])
