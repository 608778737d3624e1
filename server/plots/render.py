"""A figure as a file: the very dictionary that the browser draws, drawn by matplotlib.

matplotlib is imported on first use (it is slow and large) and only its object interface is used:
no global state, no display. It is not safe in threads, so the server calls :func:`render` in one
side process.
"""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from typing import Any

from server.plots.figure import Figure
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
_DASHES = {"dash": (0, (5, 3)), "solid": "solid", "dot": "dotted"}
SIZE = (9.0, 4.2)
"""Width and height. [inch]"""
DOTS_PER_INCH = 160
POINTS_PER_PIXEL = 0.75


def render(figure: Figure, file_format: str) -> bytes:
    """Draws a figure to a file's bytes.

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

    with mpl.rc_context(_STYLE):
        sheet = Sheet(figsize=SIZE, layout="constrained")
        FigureCanvasAgg(sheet)
        axes = sheet.add_subplot()
        _draw(axes, figure)
        buffer = BytesIO()
        sheet.savefig(
            buffer, format=file_format, dpi=DOTS_PER_INCH, metadata=_METADATA[file_format]
        )
    return buffer.getvalue()


def _draw(axes: Any, figure: Figure) -> None:
    for curve in figure["data"]:
        values = [float("nan") if value is None else value for value in curve["y"]]
        axes.plot(
            curve["x"],
            values,
            color=curve["line"]["color"],
            linewidth=curve["line"]["width"] * POINTS_PER_PIXEL,
            label=plain(curve["name"]),
        )
    layout = figure["layout"]
    _draw_axes(axes, layout)
    for shape in layout["shapes"]:
        _draw_shape(axes, shape)
    for note in layout["annotations"]:
        _draw_note(axes, note)
    if figure["data"]:
        # Outside the axes: 'best' would search every point of long histories for a free corner.
        legend = axes.legend(
            loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=4, frameon=False, fontsize=8
        )
        for text in legend.get_texts():
            text.set_parse_math(False)


def _draw_axes(axes: Any, layout: Mapping[str, Any]) -> None:
    axes.set_title(plain(layout["title"]["text"]), parse_math=False, loc="left", fontsize=10.5)
    axes.set_xlabel(plain(layout["xaxis"]["title"]["text"]), parse_math=False)
    axes.set_ylabel(plain(layout["yaxis"]["title"]["text"]), parse_math=False)
    start, stop = layout["xaxis"]["range"]
    if stop > start:
        axes.set_xlim(start, stop)
    if "range" in layout["yaxis"]:
        axes.set_ylim(*layout["yaxis"]["range"])
    axes.grid(visible=True, color="#D9DEE3", linewidth=0.5)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _draw_shape(axes: Any, shape: Mapping[str, Any]) -> None:
    if shape["type"] == "line":
        line = shape["line"]
        axes.axhline(
            shape["y0"],
            color=line["color"],
            linewidth=line["width"] * POINTS_PER_PIXEL,
            linestyle=_DASHES[line["dash"]],
        )
        return
    across = axes.axhspan if shape["xref"] == "paper" else axes.axvspan
    low, high = ("y0", "y1") if shape["xref"] == "paper" else ("x0", "x1")
    across(
        shape[low],
        shape[high],
        color=shape["fillcolor"],
        alpha=shape["opacity"],
        linewidth=0,
        zorder=0,
    )


def _draw_note(axes: Any, note: Mapping[str, Any]) -> None:
    style: dict[str, Any] = {
        "color": note["font"]["color"],
        "fontsize": note["font"]["size"] * POINTS_PER_PIXEL,
        "parse_math": False,
    }
    if not note["showarrow"]:
        axes.text(
            0.996,
            note["y"],
            plain(note["text"]),
            ha="right",
            va="bottom",
            clip_on=True,
            bbox=_paper(note),
            transform=axes.get_yaxis_transform(),
            **style,
        )
        return
    axes.annotate(
        plain(note["text"]),
        xy=(note["x"], note["y"]),
        xytext=(note["ax"] * POINTS_PER_PIXEL, -note["ay"] * POINTS_PER_PIXEL),
        textcoords="offset points",
        ha=note["xanchor"],
        va="center",
        arrowprops={"arrowstyle": "->", "color": note["arrowcolor"]},
        bbox=_paper(note),
        **style,
    )


def _paper(note: Mapping[str, Any]) -> dict[str, Any]:
    """What lies behind words, so that curves do not run through them."""
    return {"facecolor": note["bgcolor"], "edgecolor": "none", "alpha": 0.8, "pad": 1.5}
