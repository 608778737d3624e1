"""A figure's colours on another ground: the roles stay, the tones change."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from server.plots.palette import DARK, Theme

__all__ = ["themed"]


def themed(figure: dict[str, Any], theme: Theme) -> dict[str, Any]:
    """The figure in the colours of a theme, which ``layout.meta.theme`` then names.

    Args:
        figure: In light colours; it stays as it is.
        theme: The ground.
    """
    colored = figure if theme == "light" else _recolored(figure)
    layout = colored["layout"]
    return {**colored, "layout": {**layout, "meta": {**layout["meta"], "theme": theme}}}


def _recolored(value: Any) -> Any:
    """Only what stands under a key that names a colour changes: text is never a colour."""
    if isinstance(value, Mapping):
        return {key: _part(str(key), part) for key, part in value.items()}
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        return [_recolored(part) for part in value]
    return value


def _part(key: str, part: Any) -> Any:
    if key.endswith("color") and isinstance(part, str):
        return DARK.get(part, part)
    return part if key in ("table", "x", "y", "z", "customdata") else _recolored(part)
