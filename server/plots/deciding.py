"""What decides on a deck's acceleration: verdict, limit, cut-off, place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from server.plots.source import RunSource
from server.plots.text import coordinate

__all__ = [
    "acceleration_limit",
    "acceleration_verdict",
    "cut_off",
    "cut_off_words",
    "where",
]

BALLASTED_LIMIT = 3.5
"""EN 1990:2002+A1, A2.4.4.2.1(4): ballasted track. [m/s2]"""


def acceleration_verdict(run: RunSource) -> Mapping[str, Any] | None:
    """The verdict on the deck's acceleration, once a run is judged."""
    verdicts: Sequence[Mapping[str, Any]] = (run.summary or {}).get("verdicts", ())
    for verdict in verdicts:
        if "acceleration" in str(verdict.get("rule", "")).lower():
            return verdict
    return None


def acceleration_limit(run: RunSource) -> float | None:
    """The verdict's limit, or before it the one for ballast where a slab is judged. [m/s2]"""
    verdict = acceleration_verdict(run)
    if verdict is not None and isinstance(verdict.get("limit"), int | float):
        return float(verdict["limit"])
    stated = run.plan.facts.get("acceleration_limit")
    if isinstance(stated, int | float):
        return float(stated)
    return BALLASTED_LIMIT if run.plan.slab.judged_spans else None


def cut_off(run: RunSource) -> float | None:
    """Frequency below which the verdict counts. [Hz]"""
    value = (acceleration_verdict(run) or {}).get("cut_off")
    return float(value) if isinstance(value, int | float) else None


def cut_off_words(run: RunSource) -> str:
    """For example ``below 30 Hz``; empty where nothing is judged."""
    value = cut_off(run)
    return "" if value is None else f"below {value:.3g} Hz"


def where(place: Mapping[str, float]) -> str:
    """A place of the slab in words."""
    return f"x = {coordinate(place['x'], 1)} m, y = {coordinate(place['y'], 2)} m"
