"""The parts every time-history figure is made of, as plain plotly JSON.

A figure is ``{"data", "layout", "table", "summary"}``: the browser hands ``data`` and ``layout`` to
plotly.js, :mod:`server.plots.render` draws the same dictionary for files, and ``table`` and
``summary`` say in words and numbers what the curves show.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

from server.plots.curves import Curve, Extreme
from server.plots.palette import INK, MUTED, PAPER
from server.plots.request import FigureRequest
from server.plots.source import PlanSource
from server.plots.text import escape, unit_text

__all__ = [
    "Figure",
    "callout",
    "compose",
    "horizontal_line",
    "horizontal_note",
    "run_in",
    "table_row",
    "trace",
    "window",
]

Figure: TypeAlias = dict[str, Any]
"""JSON object with ``data``, ``layout``, ``table`` and ``summary``."""


def trace(
    curve: Curve, request: FigureRequest, color: str, width: float, *, name: str | None = None
) -> dict[str, Any]:
    """One curve as a plotly trace, decimated."""
    time, values = curve.decimated(request.points)
    return {
        "type": "scatter",
        "mode": "lines",
        "name": escape(name or curve.name),
        "x": time,
        "y": values,
        "line": {"color": color, "width": width},
        "hovertemplate": f"%{{y:.4~g}} {escape(unit_text(curve.unit))}",
    }


def horizontal_line(value: float, color: str, dash: str = "dash") -> dict[str, Any]:
    """A line over the whole width at a value."""
    return {
        "type": "line",
        "xref": "paper",
        "x0": 0,
        "x1": 1,
        "yref": "y",
        "y0": value,
        "y1": value,
        "line": {"color": color, "width": 1.2, "dash": dash},
        "layer": "below",
    }


def horizontal_note(value: float, text: str, color: str) -> dict[str, Any]:
    """Words that stand on a horizontal line, at its right end."""
    return {
        "xref": "paper",
        "x": 1,
        "xanchor": "right",
        "yref": "y",
        "y": value,
        "yanchor": "bottom",
        "text": escape(text),
        "showarrow": False,
        "bgcolor": PAPER,
        "font": {"size": 11, "color": color},
    }


def run_in(plan: PlanSource) -> list[dict[str, Any]]:
    """The time before the window that counts, shaded."""
    if plan.window_start <= 0.0:
        return []
    return [
        {
            "type": "rect",
            "xref": "x",
            "x0": 0.0,
            "x1": round(plan.window_start, 6),
            "yref": "paper",
            "y0": 0,
            "y1": 1,
            "line": {"width": 0},
            "fillcolor": MUTED,
            "opacity": 0.12,
            "layer": "below",
        }
    ]


def callout(extreme: Extreme, text: str, color: str, *, leftwards: bool) -> dict[str, Any]:
    """An arrow in a curve's colour at one of its values; words stand to its left or right."""
    return {
        "xref": "x",
        "x": round(extreme.time, 6),
        "yref": "y",
        "y": extreme.value,
        "text": "<br>".join(escape(line) for line in text.split("\n")),
        "showarrow": True,
        "arrowhead": 2,
        "arrowcolor": color,
        "ax": -48 if leftwards else 48,
        "ay": -34 if extreme.value >= 0 else 34,
        "font": {"size": 11, "color": INK},
        "bgcolor": PAPER,
        "align": "left",
        "xanchor": "right" if leftwards else "left",
    }


def table_row(curve: Curve) -> dict[str, Any]:
    """The extremes of one curve over the window, before decimation."""
    least, greatest = curve.minimum(), curve.maximum()
    return {
        "curve": curve.name,
        "channel": curve.spec.name,
        "unit": unit_text(curve.unit),
        "minimum": least.value if least else None,
        "minimum_time": least.time if least else None,
        "maximum": greatest.value if greatest else None,
        "maximum_time": greatest.time if greatest else None,
    }


def window(plan: PlanSource, request: FigureRequest) -> list[float]:
    """The time axis: the window asked for, else the whole run, so that live curves grow into it."""
    end = (plan.n_sample - 1) * plan.time_step
    return [
        0.0 if request.start is None else request.start,
        round(end, 9) if request.stop is None else request.stop,
    ]


def compose(
    *,
    plan: PlanSource,
    title: str,
    value_title: str,
    traces: Sequence[dict[str, Any]],
    table: Sequence[dict[str, Any]],
    summary: str,
    shapes: Sequence[dict[str, Any]] = (),
    annotations: Sequence[dict[str, Any]] = (),
    value_range: tuple[float, float] | None = None,
    request: FigureRequest,
) -> Figure:
    """Puts traces, lines and words together on one time axis over the whole run."""
    value_axis: dict[str, Any] = {
        "title": {"text": escape(value_title)},
        "zeroline": True,
        "exponentformat": "none",
    }
    if value_range is not None:
        value_axis["range"] = list(value_range)
    return {
        "data": list(traces),
        "layout": {
            "title": {"text": escape(title)},
            "xaxis": {"title": {"text": "time [s]"}, "range": window(plan, request)},
            "yaxis": value_axis,
            "shapes": [*run_in(plan), *shapes],
            "annotations": list(annotations),
            "showlegend": True,
            "hovermode": "x unified",
            "meta": {
                "speed": plan.speed,
                "start_position": plan.start_position,
                "window_start": plan.window_start,
                "end": (plan.n_sample - 1) * plan.time_step,
            },
        },
        "table": list(table),
        "summary": summary,
    }
