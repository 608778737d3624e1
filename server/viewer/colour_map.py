"""Colour maps that colour-blind eyes can read, and the bar that explains one.

Sequential: cividis (Nunez, Anderton and Renslow 2018, "Optimizing colormaps with consideration for
color vision deficiency", PLOS ONE 13(7)). Diverging: blue over grey to orange, the two hues of the
Okabe-Ito set that deuteranopes and protanopes tell apart best. Lightness falls from the middle to
both ends alike, so that the size reads without the hue.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from solver.arrays import FloatArray

__all__ = ["DIVERGING", "SEQUENTIAL", "ColourBar", "ColourMap", "rounded_up"]

_ROUND = (1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0)


@dataclass(frozen=True, kw_only=True)
class ColourMap:
    """Colours at equal distances from the least value to the greatest.

    Attributes:
        stops: Hexadecimal sRGB colours, ``#rrggbb``; in between they are interpolated linearly.
    """

    stops: tuple[str, ...]

    def table(self) -> NDArray[np.uint8]:
        """256 colours, shape (256, 3)."""
        return _table(self.stops)


SEQUENTIAL = ColourMap(
    stops=(
        "#00224e",
        "#002e6a",
        "#1a386f",
        "#32436d",
        "#434e6c",
        "#535a6d",
        "#61656f",
        "#6f7073",
        "#7d7c78",
        "#8c8878",
        "#9b9476",
        "#aba072",
        "#bcae6c",
        "#cdbb63",
        "#dec958",
        "#f0d846",
        "#fee838",
    )
)
DIVERGING = ColourMap(
    stops=(
        "#003c6e",
        "#0067a5",
        "#3f93c9",
        "#8fbfe0",
        "#e6e6e6",
        "#f0bd84",
        "#dd8a34",
        "#b85c00",
        "#7c3a00",
    )
)


@dataclass(frozen=True, kw_only=True)
class ColourBar:
    """What the colours mean, in the units that people read.

    Attributes:
        quantity: For example ``vertical acceleration``.
        unit: Display unit.
        minimum: Value of the first colour; lower ones have it too.
        maximum: Value of the last colour; higher ones have it too.
        stops: Places from 0 to 1 and their colours ``#rrggbb``.
    """

    quantity: str
    unit: str
    minimum: float
    maximum: float
    stops: tuple[tuple[float, str], ...]

    @classmethod
    def of(
        cls, colours: ColourMap, quantity: str, unit: str, minimum: float, maximum: float
    ) -> ColourBar:
        """A bar over the whole of a colour map."""
        places = np.linspace(0.0, 1.0, len(colours.stops)).tolist()
        return cls(
            quantity=quantity,
            unit=unit,
            minimum=minimum,
            maximum=maximum,
            stops=tuple(zip(places, colours.stops, strict=True)),
        )

    def table(self) -> NDArray[np.uint8]:
        """256 colours from the least value to the greatest, shape (256, 3)."""
        return _table(tuple(colour for _, colour in self.stops))

    def colours(self, values: FloatArray) -> NDArray[np.uint8]:
        """Colours of values in the display unit.

        Args:
            values: Shape (n,).

        Returns:
            sRGB, shape (n, 3).
        """
        per_value = 255.0 / (self.maximum - self.minimum)
        place = values * per_value + (0.5 - self.minimum * per_value)
        return self.table().take(np.clip(place, 0.0, 255.0).astype(np.uint8), axis=0)


@cache
def _table(stops: tuple[str, ...]) -> NDArray[np.uint8]:
    known = np.array([[int(stop[i : i + 2], 16) for i in (1, 3, 5)] for stop in stops])
    at = np.linspace(0.0, len(known) - 1.0, 256)
    columns = [np.interp(at, np.arange(len(known)), known[:, i]) for i in range(3)]
    return np.round(np.column_stack(columns)).astype(np.uint8)


def rounded_up(value: float) -> float:
    """The next round number, so that a bar reads well and stands still while a run grows.

    Args:
        value: Not negative; zero gives one.
    """
    if value <= 0.0:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(value))
    step = next(step for step in _ROUND if value <= step * decade * (1.0 + 1e-9))
    return float(f"{step * decade:.3g}")
