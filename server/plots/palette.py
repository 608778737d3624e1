"""Colours that everyone can tell apart (Okabe and Ito, 2008), with one role each.

No curve is told by its colour alone: each has a dash pattern or a marker of its own too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, TypeAlias

__all__ = [
    "CURVES",
    "DARK",
    "GRID",
    "INK",
    "LIMIT",
    "MAP_SCALE",
    "MUTED",
    "ON_MAP",
    "PALE_CURVES",
    "PAPER",
    "WITHIN",
    "LineStyle",
    "Theme",
    "line_style",
]

Theme: TypeAlias = Literal["light", "dark"]
"""The ground on which a figure is drawn."""

BLUE, VERMILLION, GREEN = "#0072B2", "#D55E00", "#009E73"
ORANGE, SKY, PURPLE = "#E69F00", "#56B4E9", "#CC79A7"

CURVES = (BLUE, ORANGE, GREEN, PURPLE, SKY)
"""Of curves, in the order in which they are drawn; vermillion is kept for limits."""
PALE_CURVES = ("#8FC1DE", "#F2D08A", "#86CBB7", "#E3BCD2", "#B5DCF3")
"""The same colours where a raw history lies behind its filtered one."""
LIMIT = VERMILLION
"""Of limits and of what exceeds them."""
WITHIN = GREEN
"""Of the range that a limit allows."""
MUTED = "#7A8794"
"""Of reference lines and of what does not count."""
INK = "#22303C"
"""Of words that name a value."""
PAPER = "#FFFFFF"
"""Behind words that lie on curves."""
GRID = "#D9DEE3"
"""Of grid lines and axes."""

ON_MAP = "#F4F6F8"
"""Of lines that lie on a map, on either ground."""

MAP_SCALE: tuple[tuple[float, str], ...] = (
    (0.0, "#00224E"),
    (0.125, "#1A386F"),
    (0.25, "#434E6C"),
    (0.375, "#61656F"),
    (0.5, "#7D7C78"),
    (0.625, "#9B9476"),
    (0.75, "#BCAE6C"),
    (0.875, "#DEC958"),
    (1.0, "#FEE838"),
)
"""Of maps: cividis (Nunez, Anderton and Renslow, 2018): lightness alone tells the value."""

DARK: Mapping[str, str] = MappingProxyType(
    {
        BLUE: "#58B5F0",
        "#8FC1DE": "#2F6486",
        VERMILLION: "#FF9A52",
        GREEN: "#3CCFA2",
        "#86CBB7": "#24715B",
        "#F2D08A": "#7A6328",
        "#E3BCD2": "#7C5168",
        "#B5DCF3": "#3B6580",
        MUTED: "#98A7B4",
        INK: "#E9EFF4",
        PAPER: "#171F27",
        GRID: "#2A3641",
    }
)
"""What the colours turn into on a dark ground, as on the page."""

_DASHES = ("solid", "dash", "dashdot", "longdash", "dot")
_MARKERS = ("circle", "square", "diamond", "triangle-up", "cross")


@dataclass(frozen=True, kw_only=True)
class LineStyle:
    """How one curve is told from the others.

    Attributes:
        color: Of the curve.
        pale: Of its raw history, behind it.
        dash: Dash pattern, as plotly calls it.
        marker: Symbol, as plotly calls it.
    """

    color: str
    pale: str
    dash: str
    marker: str


def line_style(number: int) -> LineStyle:
    """Style of the curve of that number: 25 curves differ, five of them by colour."""
    color = number % len(CURVES)
    form = (number + number // len(CURVES)) % len(_DASHES)
    return LineStyle(
        color=CURVES[color], pale=PALE_CURVES[color], dash=_DASHES[form], marker=_MARKERS[form]
    )
