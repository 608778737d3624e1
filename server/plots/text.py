"""Text on figures: escaped, in words and units that an engineer reads aloud."""

from __future__ import annotations

import html

from solver.units import Unit

__all__ = [
    "NEGLIGIBLE",
    "beside",
    "coordinate",
    "escape",
    "plain",
    "quantity",
    "sentence",
    "unit_text",
]

_PRETTY = {"m/s2": "m/s²", "rad/s2": "rad/s²", "m2": "m²"}
NEGLIGIBLE = 5e-4
"""Display values below this are noise to whoever reads a figure."""
_MINUS = "\N{MINUS SIGN}"


def escape(text: str) -> str:
    """Text that plotly shows as it stands (plotly reads a kind of HTML)."""
    return html.escape(text, quote=False)


def plain(text: str) -> str:
    """The text that was escaped, line breaks as line breaks."""
    return html.unescape(text.replace("<br>", "\n"))


def unit_text(unit: Unit) -> str:
    """The display unit's symbol."""
    return _PRETTY.get(unit.shown, unit.shown)


def quantity(value: float, unit: Unit, figures: int = 3) -> str:
    """A display value with its unit, for example ``3.98 m/s²``."""
    if abs(value) < NEGLIGIBLE:
        value = 0.0
    digits = f"{value:.{figures}g}"
    if "e" in digits and 1 <= abs(value) < 1e9:
        digits = f"{value:.0f}"
    return f"{digits.replace('-', _MINUS)} {unit_text(unit)}".strip()


def beside(value: float, limit: float | None, unit: Unit) -> str:
    """A display value with as many decimals as it takes not to read as the limit itself.

    It is how a verdict writes its value, so that figure and verdict agree.
    """
    decimals = next(
        (count for count in range(2, 7) if value == limit or round(value, count) != limit), 7
    )
    return f"{value:.{decimals}f} {unit_text(unit)}".replace("-", _MINUS)


def coordinate(value: float, decimals: int) -> str:
    """A coordinate in metres, its sign as people print it."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", _MINUS)


def sentence(text: str) -> str:
    """Words as a sentence."""
    return f"{text[:1].upper()}{text[1:]}."
