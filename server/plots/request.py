"""What may be asked of a figure: a time window, points, channels, a place, a variant, a theme."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import TypeAlias

from server.plots.palette import Theme
from solver.arrays import Matrix
from solver.errors import InputError

__all__ = [
    "MAX_CHANNELS",
    "MAX_POINTS",
    "MIN_POINTS",
    "FigureRequest",
    "LowPass",
    "Place",
    "read_place",
]

MIN_POINTS = 50
MAX_POINTS = 50_000
MAX_CHANNELS = 16
MAX_NAME = 200
_FARTHEST = 1e6
_PLACE = "Give x,y or x,y,z in metres, for example 27.0,0.7,1.3."

Place: TypeAlias = tuple[float, float, float]
"""x, y, z. [m]"""
LowPass: TypeAlias = Callable[[Matrix, float, float], Matrix]
"""The standards' filter: histories (n_sample, n), time step [s], cut-off [Hz] to histories."""


@dataclass(frozen=True, kw_only=True)
class FigureRequest:
    """One figure as asked for.

    Attributes:
        start: Beginning of the window; the run's when absent. [s]
        stop: End of the window; the run's when absent. [s]
        points: Points a curve may have at most; more are decimated.
        channels: Names of channels; the figure's own choice when empty.
        place: Where somebody pointed. [m]
        variant: One of the figure's variants; its first when empty.
        theme: The ground on which it is drawn.
        low_pass: Filters a history that is not stored filtered. The layer above hands it in, for
            figures know results and no standards; without it such a history is drawn raw.

    Raises:
        InputError: The window is empty or not finite, or a count is out of bounds.
    """

    start: float | None = None
    stop: float | None = None
    points: int = 2000
    channels: tuple[str, ...] = ()
    place: Place | None = None
    variant: str = ""
    theme: Theme = "light"
    low_pass: LowPass | None = None

    def __post_init__(self) -> None:
        for field, value in (("from", self.start), ("to", self.stop)):
            if value is not None and not isfinite(value):
                raise InputError(field, value, "is not a finite time", "Give seconds.")
        if self.start is not None and self.stop is not None and self.start >= self.stop:
            raise InputError(
                "from", self.start, "does not come before 'to'", "Give a window that has a length."
            )
        if not MIN_POINTS <= self.points <= MAX_POINTS:
            raise InputError(
                "points",
                self.points,
                f"is not between {MIN_POINTS} and {MAX_POINTS}",
                "Leave it out for 2000.",
            )
        if len(self.channels) > MAX_CHANNELS:
            raise InputError(
                "channels",
                len(self.channels),
                f"more than {MAX_CHANNELS} channels in one figure",
                "Ask for several figures.",
            )
        for name in self.channels:
            if len(name) > MAX_NAME:
                raise InputError("channels", name[:80], "is too long", "See the run's channels.")


def read_place(text: str) -> Place | None:
    """A place as an address carries it, ``x,y,z`` or ``x,y``; None where it is empty.

    Raises:
        InputError: It is none.
    """
    if not text:
        return None
    parts = text.split(",")
    if len(parts) not in (2, 3):
        raise InputError("place", text[:80], "is not two or three numbers", _PLACE)
    try:
        values = [float(part) for part in parts]
    except ValueError:
        raise InputError("place", text[:80], "holds what is no number", _PLACE) from None
    if not all(isfinite(value) and abs(value) <= _FARTHEST for value in values):
        raise InputError("place", text[:80], "is farther away than anything that is built", _PLACE)
    x, y, *rest = values
    return x, y, rest[0] if rest else 0.0
