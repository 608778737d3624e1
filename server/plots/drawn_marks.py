"""Lines, areas and words of a figure, drawn by matplotlib."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from server.plots.drawn_traces import DASHES, POINTS_PER_PIXEL
from server.plots.text import plain

__all__ = ["draw_note", "draw_shape"]

_BELOW, _ABOVE = 0, 3
_LOWERED = 0.015
"""Of the axes' height: letters of an SVG are the reader's own, and would lose their heads."""


def draw_shape(axes: Any, shape: Mapping[str, Any]) -> None:
    """Draws a line or an area over the whole width or height."""
    across = shape["xref"] == "paper"
    depth = _BELOW if shape.get("layer") == "below" else _ABOVE
    if shape["type"] == "line":
        line = shape["line"]
        draw = axes.axhline if across else axes.axvline
        draw(
            shape["y0"] if across else shape["x0"],
            color=line["color"],
            linewidth=line["width"] * POINTS_PER_PIXEL,
            linestyle=DASHES[line["dash"]],
            # Reference lines lie on areas and below curves.
            zorder=max(depth, 1),
        )
        return
    draw = axes.axhspan if across else axes.axvspan
    low, high = ("y0", "y1") if across else ("x0", "x1")
    draw(
        shape[low],
        shape[high],
        color=shape["fillcolor"],
        alpha=shape["opacity"],
        linewidth=0,
        zorder=depth,
    )


def draw_note(axes: Any, note: Mapping[str, Any]) -> None:
    """Draws words, with an arrow where the figure asks for one."""
    style: dict[str, Any] = {
        "color": note["font"]["color"],
        "fontsize": note["font"]["size"] * POINTS_PER_PIXEL,
        "parse_math": False,
        "zorder": 6,
    }
    if not note["showarrow"]:
        _draw_words(axes, note, style)
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


def _draw_words(axes: Any, note: Mapping[str, Any], style: Mapping[str, Any]) -> None:
    across = note["xref"] == "paper"
    standing = note["yref"] == "paper" or note["yref"].endswith(" domain")
    transform = axes.get_yaxis_transform() if across else axes.transData
    if standing:
        transform = axes.get_xaxis_transform()
    axes.text(
        0.996 * note["x"] if across else note["x"],
        note["y"] - _LOWERED if standing else note["y"],
        f" {plain(note['text'])}"
        if standing and note["xanchor"] == "left"
        else plain(note["text"]),
        ha=note["xanchor"],
        va=note["yanchor"],
        clip_on=True,
        bbox=_paper(note),
        transform=transform,
        **style,
    )


def _paper(note: Mapping[str, Any]) -> dict[str, Any]:
    """What lies behind words, so that curves do not run through them."""
    return {"facecolor": note["bgcolor"], "edgecolor": "none", "alpha": 0.8, "pad": 1.5}
