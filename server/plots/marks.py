"""Lines, areas and words that stand on a figure, as plain plotly JSON."""

from __future__ import annotations

from typing import Any

from server.plots.curves import Extreme
from server.plots.palette import INK, MUTED, PAPER
from server.plots.source import PlanSource
from server.plots.text import escape

__all__ = [
    "callout",
    "horizontal_line",
    "horizontal_note",
    "pointed",
    "run_in",
    "span_notes",
    "vertical_line",
    "vertical_note",
]

NOTE_HEIGHT = 0.075
"""Of one line of words beside a vertical line, as a part of the figure's height."""


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


def vertical_line(value: float, color: str, dash: str = "dash") -> dict[str, Any]:
    """A line over the whole height at a place, a frequency or a speed."""
    return {
        "type": "line",
        "xref": "x",
        "x0": value,
        "x1": value,
        "yref": "paper",
        "y0": 0,
        "y1": 1,
        "line": {"color": color, "width": 1.2, "dash": dash},
        "layer": "below",
    }


def vertical_note(value: float, text: str, color: str, *, level: int = 0) -> dict[str, Any]:
    """Words beside a vertical line, at its upper end; ``level`` lines below it."""
    return {
        "xref": "x",
        "x": value,
        "xanchor": "left",
        "yref": "paper",
        "y": round(1.0 - NOTE_HEIGHT * level, 4),
        "yanchor": "top",
        "text": escape(text),
        "showarrow": False,
        "bgcolor": PAPER,
        "font": {"size": 11, "color": color},
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
    time = round(extreme.time, 6)
    return pointed(time, extreme.value, text, color, leftwards=leftwards)


def pointed(x: float, y: float, text: str, color: str, *, leftwards: bool) -> dict[str, Any]:
    """An arrow at a value; words stand to its left or right."""
    return {
        "xref": "x",
        "x": x,
        "yref": "y",
        "y": y,
        "text": "<br>".join(escape(line) for line in text.split("\n")),
        "showarrow": True,
        "arrowhead": 2,
        "arrowcolor": color,
        "ax": -48 if leftwards else 48,
        "ay": -34 if y >= 0 else 34,
        "font": {"size": 11, "color": INK},
        "bgcolor": PAPER,
        "align": "left",
        "xanchor": "right" if leftwards else "left",
    }


def span_notes(plan: PlanSource) -> list[dict[str, Any]]:
    """Which spans are judged, above them; nothing where all are, or none is."""
    spans, judged = plan.geometry.spans, plan.slab.judged_spans
    if not judged or len(judged) == len(spans):
        return []
    return [
        {
            "xref": "x",
            "x": round(float(0.5 * (start + stop)), 6),
            "xanchor": "center",
            "yref": "paper",
            "y": 1,
            "yanchor": "top",
            "text": f"span {number + 1}: {'judged' if number in judged else 'shown, not judged'}",
            "showarrow": False,
            "bgcolor": PAPER,
            "font": {"size": 11, "color": INK},
        }
        for number, (start, stop) in enumerate(spans)
    ]
