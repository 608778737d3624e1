"""Traces of a figure, drawn by matplotlib: lines, markers, maps, contours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from server.plots.text import plain
from solver.arrays import Matrix, Vector

__all__ = ["DASHES", "POINTS_PER_PIXEL", "draw_trace"]

POINTS_PER_PIXEL = 0.75
DASHES: Mapping[str, Any] = {
    "solid": "solid",
    "dash": (0, (5, 3)),
    "dot": (0, (1.2, 1.8)),
    "dashdot": (0, (6, 2, 1.2, 2)),
    "longdash": (0, (10, 3)),
}
"""plotly's dash patterns in matplotlib's words."""
_MARKERS: Mapping[str, str] = {
    "circle": "o",
    "square": "s",
    "diamond": "D",
    "triangle-up": "^",
    "triangle-down": "v",
    "cross": "P",
    "x": "X",
}

Named = tuple[str, Any] | None
"""Words of the legend and what they stand for; None for a trace that the legend leaves out."""


def draw_trace(sheet: Any, axes: Any, trace: Mapping[str, Any]) -> Named:
    """Draws one trace.

    Args:
        sheet: matplotlib's figure, on which a map's colour bar finds its place.
        axes: matplotlib's axes.
        trace: As plotly has it.

    Returns:
        The trace's part of the legend.
    """
    if trace["type"] == "heatmap":
        _draw_map(sheet, axes, trace)
        return None
    draw = _draw_contour if trace["type"] == "contour" else _draw_line
    handle = draw(axes, trace)
    return (plain(trace["name"]), handle) if trace.get("showlegend", True) else None


def _draw_line(axes: Any, trace: Mapping[str, Any]) -> Any:
    mode, line, marker = trace["mode"], trace.get("line", {}), trace.get("marker", {})
    style: dict[str, Any] = {"linestyle": "none"}
    if "lines" in mode:
        style = {
            "color": line["color"],
            "linewidth": line["width"] * POINTS_PER_PIXEL,
            "linestyle": DASHES[line.get("dash", "solid")],
        }
    if "markers" in mode:
        edge = marker.get("line", {})
        style |= {
            "marker": _MARKERS[marker["symbol"]],
            "markersize": marker["size"] * POINTS_PER_PIXEL,
            "markerfacecolor": marker["color"],
            "markeredgecolor": edge.get("color", marker["color"]),
            "markeredgewidth": edge.get("width", 0) * POINTS_PER_PIXEL,
            "zorder": 4,
        }
    [handle] = axes.plot(_gaps(trace["x"]), _gaps(trace["y"]), **style)
    return handle


def _draw_map(sheet: Any, axes: Any, trace: Mapping[str, Any]) -> None:
    from matplotlib.colors import LinearSegmentedColormap

    x, y, z = _grid(trace)
    colors = LinearSegmentedColormap.from_list("map", [tuple(s) for s in trace["colorscale"]])
    # Between the points of a grid without holes values are interpolated, as in the browser.
    smooth = bool(trace.get("zsmooth")) and bool(np.isfinite(z).all()) and min(z.shape) > 1
    drawn = axes.pcolormesh(
        x,
        y,
        z,
        cmap=colors,
        vmin=trace["zmin"],
        vmax=trace["zmax"],
        shading="gouraud" if smooth else "nearest",
        rasterized=True,
    )
    bar = sheet.colorbar(drawn, ax=axes, pad=0.015, fraction=0.04)
    bar.outline.set_visible(False)
    bar.set_label(plain(trace["colorbar"]["title"]["text"]), parse_math=False)
    axes.grid(visible=False)


def _draw_contour(axes: Any, trace: Mapping[str, Any]) -> Any:
    from matplotlib.lines import Line2D

    x, y, z = _grid(trace)
    line = trace["line"]
    style: dict[str, Any] = {
        "linewidth": line["width"] * POINTS_PER_PIXEL,
        "linestyle": DASHES[line.get("dash", "solid")],
    }
    axes.contour(
        x,
        y,
        z,
        levels=[trace["contours"]["start"]],
        colors=[line["color"]],
        linewidths=[style["linewidth"]],
        linestyles=[style["linestyle"]],
    )
    return Line2D([], [], color=line["color"], **style)


def _grid(trace: Mapping[str, Any]) -> tuple[Vector, Vector, Matrix]:
    rows = np.array([_gaps(row) for row in trace["z"]])
    return np.array(trace["x"]), np.array(trace["y"]), rows


def _gaps(values: Sequence[float | None]) -> list[float]:
    """JSON has no not-a-number: nothing stands in its place."""
    return [float("nan") if value is None else value for value in values]
