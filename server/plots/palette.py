"""Colours that everyone can tell apart (Okabe and Ito, 2008), with one role each."""

from __future__ import annotations

__all__ = ["CURVES", "INK", "LIMIT", "MUTED", "PALE_CURVES", "PAPER", "WITHIN"]

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
