"""The parts every figure is made of, as plain plotly JSON.

A figure is ``{"data", "layout", "table", "summary"}``: the browser hands ``data`` and ``layout`` to
plotly.js, :mod:`server.plots.render` draws the same dictionary for files, and ``table`` and
``summary`` say in words and numbers what the curves show.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeAlias

from server.plots.curves import Curve
from server.plots.marks import run_in
from server.plots.request import FigureRequest
from server.plots.source import PlanSource
from server.plots.text import escape, unit_text
from solver.units import Unit

__all__ = [
    "Figure",
    "chart",
    "compose",
    "line_trace",
    "table_row",
    "trace",
    "value_axis",
    "window",
]

Figure: TypeAlias = dict[str, Any]
"""JSON object with ``data``, ``layout``, ``table`` and ``summary``."""


def trace(
    curve: Curve, request: FigureRequest, color: str, width: float, *, dash: str = "solid"
) -> dict[str, Any]:
    """One curve as a plotly trace, decimated."""
    time, values = curve.decimated(request.points)
    line = line_trace(curve.name, time, values, curve.unit, color=color, width=width, dash=dash)
    return {**line, "meta": {**line["meta"], "channel": curve.spec.name}}


def line_trace(
    name: str,
    x: Sequence[float],
    y: Sequence[float | None],
    unit: Unit,
    *,
    color: str,
    width: float = 1.6,
    dash: str = "solid",
) -> dict[str, Any]:
    """A line through values in display units, as a plotly trace."""
    return {
        "type": "scatter",
        "mode": "lines",
        "name": escape(name),
        "x": list(x),
        "y": list(y),
        "line": {"color": color, "width": width, "dash": dash},
        "hovertemplate": f"%{{y:.4~g}} {escape(unit_text(unit))}",
        "meta": {"unit": unit.shown},
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
    least: float = 0.0,
    request: FigureRequest,
) -> Figure:
    """Puts traces, lines and words together on one time axis over the whole run.

    Values that all lie within +-``least`` are drawn on that range: before the train arrives, noise
    is no picture.
    """
    if _greatest(traces) < least:
        value_range = (-least, least)
    return chart(
        title=title,
        x_axis={"title": {"text": "time [s]"}, "range": window(plan, request)},
        y_axis=value_axis(value_title, value_range),
        traces=traces,
        table=table,
        summary=summary,
        shapes=[*run_in(plan), *shapes],
        annotations=annotations,
        hover="x unified",
        meta={
            "axis": "time",
            "speed": plan.speed,
            "start_position": plan.start_position,
            "window_start": plan.window_start,
            "end": (plan.n_sample - 1) * plan.time_step,
        },
    )


def _greatest(traces: Sequence[dict[str, Any]]) -> float:
    """Greatest magnitude that is drawn, 0 where nothing is; gaps are None."""
    return max((abs(y) for trace in traces for y in trace["y"] if y is not None), default=0.0)


def value_axis(title: str, value_range: tuple[float, float] | None = None) -> dict[str, Any]:
    """A vertical axis of values, with the line of zero."""
    axis: dict[str, Any] = {
        "title": {"text": escape(title)},
        "zeroline": True,
        "exponentformat": "none",
    }
    return axis if value_range is None else {**axis, "range": list(value_range)}


def chart(
    *,
    title: str,
    x_axis: Mapping[str, Any],
    y_axis: Mapping[str, Any],
    traces: Sequence[dict[str, Any]],
    table: Sequence[dict[str, Any]],
    summary: str,
    shapes: Sequence[dict[str, Any]] = (),
    annotations: Sequence[dict[str, Any]] = (),
    hover: str = "closest",
    meta: Mapping[str, Any],
    more: Mapping[str, Any] = MappingProxyType({}),
) -> Figure:
    """Puts traces, axes, lines and words together.

    Args:
        title: Of the figure, plain text.
        x_axis: As plotly has it, its words escaped.
        y_axis: Likewise.
        traces: What is drawn.
        table: One row a curve.
        summary: What the figure says, in words.
        shapes: Lines and areas.
        annotations: Words.
        hover: plotly's ``hovermode``.
        meta: What a page has to know of the figure; ``axis`` among it.
        more: More of the layout, a second vertical axis for example.
    """
    return {
        "data": list(traces),
        "layout": {
            "title": {"text": escape(title)},
            "xaxis": dict(x_axis),
            "yaxis": dict(y_axis),
            "shapes": list(shapes),
            "annotations": list(annotations),
            "showlegend": True,
            "hovermode": hover,
            "meta": dict(meta),
            **more,
        },
        "table": list(table),
        "summary": summary,
    }
