"""Colours of the 3D view, for a light and a dark page."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

__all__ = ["Colour", "Colouring", "Palette", "Theme", "palette"]

Colour: TypeAlias = tuple[int, int, int]
Theme: TypeAlias = Literal["light", "dark"]
Colouring: TypeAlias = Literal["none", "displacement", "velocity", "acceleration", "peak"]
"""What the surface's colours say; ``none`` shows the materials."""

_MATERIALS: dict[str, Colour] = {
    "slab": (176, 182, 190),
    "deck": (176, 182, 190),
    "beam": (146, 155, 167),
    "walls": (128, 138, 151),
    "ballast": (150, 132, 112),
    "sleepers": (214, 208, 196),
    "rails": (92, 74, 64),
}


@dataclass(frozen=True, kw_only=True)
class Palette:
    """Colours by what they mean (blue and orange from the Okabe-Ito set)."""

    outline: Colour
    wheel: Colour = (60, 66, 74)
    lost: Colour = (200, 0, 10)
    axle: Colour = (96, 102, 110)
    bogie: Colour = (72, 84, 98)
    carbody: Colour = (20, 100, 180)
    force: Colour = (230, 120, 0)
    support: Colour

    def layer(self, name: str) -> Colour:
        """Colour of a layer of the displayed surface."""
        return _MATERIALS.get(name, (170, 176, 184))


_LIGHT = Palette(outline=(110, 120, 132), support=(206, 210, 216))
_DARK = Palette(
    outline=(140, 152, 168),
    support=(70, 76, 84),
    wheel=(118, 124, 132),
    axle=(96, 102, 110),
    bogie=(96, 112, 132),
    carbody=(30, 130, 215),
    force=(240, 160, 40),
)


def palette(theme: Theme) -> Palette:
    """Colours for a theme."""
    return _DARK if theme == "dark" else _LIGHT
