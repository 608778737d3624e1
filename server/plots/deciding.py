"""What decides on a deck's acceleration: verdict, limit, cut-off, place."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from server.plots.source import RunSource
from server.plots.text import coordinate

__all__ = [
    "MidSpanPeak",
    "acceleration_limit",
    "acceleration_verdict",
    "cut_off",
    "cut_off_words",
    "mid_span_peak",
    "where",
]

BALLASTED_LIMIT = 3.5
"""EN 1990:2002+A1, A2.4.4.2.1(4): ballasted track. [m/s2]"""

_MID_SPAN = re.compile(r"mid-span (\d+)\b")


@dataclass(frozen=True, kw_only=True)
class MidSpanPeak:
    """The greatest magnitude at the middle of a span.

    Attributes:
        place: For example ``mid-span 2, axis``.
        value: Greatest magnitude, SI.
        time: [s]
    """

    place: str
    value: float
    time: float


def mid_span_peak(summary: Mapping[str, Any], quantity: str) -> MidSpanPeak | None:
    """The greatest magnitude at the middle of the judged spans; of all where nothing is judged.

    Args:
        summary: Of a run that is done.
        quantity: ``displacement`` or ``acceleration``.
    """
    peaks: Mapping[str, Mapping[str, float]] = summary.get("peaks") or {}
    judged = _judged_spans(summary)
    found: list[MidSpanPeak] = []
    for name, peak in peaks.items():
        place, _, what = name.rpartition("/")
        span = _MID_SPAN.match(place)
        if what == quantity and span and (judged is None or int(span[1]) in judged):
            side = "greatest" if peak["greatest"] >= -peak["least"] else "least"
            time = peak[f"time_of_{side}"]
            found.append(MidSpanPeak(place=place, value=abs(peak[side]), time=time))
    return max(found, key=lambda peak: peak.value, default=None)


def _judged_spans(summary: Mapping[str, Any]) -> set[int] | None:
    """Numbers of the spans that are judged, None where nothing is."""
    verdicts: Sequence[Mapping[str, Any]] = summary.get("verdicts") or ()
    judged = [span for verdict in verdicts for span in verdict["spans"] if span["judged"]]
    return {int(span["number"]) for span in judged} if verdicts else None


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
