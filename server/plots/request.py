"""What may be asked of a figure: a time window, a number of points, channels."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from solver.errors import InputError

__all__ = ["MAX_CHANNELS", "MAX_POINTS", "MIN_POINTS", "FigureRequest"]

MIN_POINTS = 50
MAX_POINTS = 50_000
MAX_CHANNELS = 16
MAX_NAME = 200


@dataclass(frozen=True, kw_only=True)
class FigureRequest:
    """One figure as asked for.

    Attributes:
        start: Beginning of the window; the run's when absent. [s]
        stop: End of the window; the run's when absent. [s]
        points: Points a curve may have at most; more are decimated.
        channels: Names of channels; the figure's own choice when empty.

    Raises:
        InputError: The window is empty or not finite, or a count is out of bounds.
    """

    start: float | None = None
    stop: float | None = None
    points: int = 2000
    channels: tuple[str, ...] = ()

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
