"""EN 1990 A2.4.4.2.1(4): the peak vertical acceleration of the deck under the track.

The deciding value is the greatest magnitude, after the low-pass filter, over every slab point under
the ballast of the spans whose neighbours are modelled too, from the first axle's arrival onwards.
``slab_peaks`` finds these values from the histories.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from solver.arrays import BoolVector, Matrix, Vector
from solver.data import load
from solver.errors import InputError
from solver.results import SlabPeaks, SlabPoints
from solver.standards.low_pass import FILTER_TEXT
from solver.standards.verdict import NamedPeak, Peak, Place, Scope, SpanPeak, Verdict
from solver.standards.wording import deck_notes, deck_statement
from solver.units import Units

__all__ = [
    "CutOff",
    "Fastening",
    "cut_off_frequency",
    "decide",
    "eurocode_cut_off",
    "under_ballast",
]

Fastening = Literal["ballasted", "direct"]
"""Ballasted track, or track fastened directly to the deck."""

BALLAST_HALF_WIDTH = 2.15
"""Slab points with |y| up to this lie under the ballast of the Alverca viaduct. [m]"""


@dataclass(frozen=True, kw_only=True)
class CutOff:
    """The filter's cut-off and where it comes from.

    Attributes:
        frequency: [Hz]
        origin: In words, with its clause.
    """

    frequency: float
    origin: str


def cut_off_frequency(f1: float, f3: float) -> float:
    """Frequency up to which accelerations count.

    Args:
        f1: First natural frequency of the span. [Hz]
        f3: Third natural frequency of the span. [Hz]

    Returns:
        The greatest of 30 Hz, 1.5 f1 and f3. [Hz]

    References:
        EN 1990:2002/A1 A2.4.4.2.1(4).
    """
    rule = load("standards")["frequency_range"]
    return max(float(rule["value"]), float(rule["fundamental_factor"]) * f1, f3)


def eurocode_cut_off(f1: float, f3: float) -> CutOff:
    """The clause's cut-off, with the sentence that explains it.

    Args:
        f1: First natural frequency of the span. [Hz]
        f3: Third natural frequency of the span. [Hz]

    Returns:
        The cut-off.
    """
    rule = load("standards")["frequency_range"]
    factor = rule["fundamental_factor"]
    origin = (
        f"greatest of {rule['value']:g} Hz, {factor:g} f1 = {factor * f1:.2f} Hz and "
        f"f3 = {f3:.2f} Hz ({rule['clause']})"
    )
    return CutOff(frequency=cut_off_frequency(f1, f3), origin=origin)


def under_ballast(coordinates: Matrix, half_width: float = BALLAST_HALF_WIDTH) -> BoolVector:
    """Which slab points lie under the ballast.

    Args:
        coordinates: Shape (n_point, 3). [m]
        half_width: Of the ballast. [m]

    Returns:
        Shape (n_point,).
    """
    within: BoolVector = np.abs(coordinates[:, 1]) <= half_width + 1e-9
    return within


def decide(
    peaks: SlabPeaks,
    *,
    slab: SlabPoints,
    cut_off: CutOff,
    scope: Scope,
    fastening: Fastening = "ballasted",
    line_speed: float | None = None,
    highest_speed: float | None = None,
    bearings_in_tension: tuple[str, ...] = (),
) -> Verdict:
    """Judges one run.

    Args:
        peaks: Greatest accelerations of the points, raw and filtered.
        slab: The points under the track, their spans and names.
        cut_off: The filter's cut-off and its origin.
        scope: Train, speed, irregularity and mesh level of the run.
        fastening: How the track lies on the deck: it sets the limit.
        line_speed: Of the line, if stated. [m/s]
        highest_speed: Reached by the sweep that this run belongs to, if it is one. [m/s]
        bearings_in_tension: Names of bearings that were pulled, dead load included.

    Returns:
        The verdict.

    Raises:
        InputError: No point is judged, or there are no filtered peaks.

    References:
        EN 1990:2002/A1 A2.4.4.2.1(4).
    """
    points = _PointPeaks.of(peaks)
    judged = np.isin(slab.span, np.asarray(slab.judged_spans))
    if not np.any(judged):
        raise InputError(
            "slab.judged_spans",
            slab.judged_spans,
            "no slab point lies on a span that decides",
            "Model the neighbours of at least one span.",
        )
    rule = load("standards")[f"deck_acceleration_{fastening}"]
    deciding, raw = points.greatest(slab, judged)
    spans = points.by_span(slab)
    limit = float(rule["value"])
    return Verdict(
        rule="deck acceleration",
        clause=rule["clause"],
        title=rule["what"],
        limit=limit,
        value=deciding.value,
        unit=Units.acceleration.symbol,
        exceeds=deciding.value > limit,
        place=deciding.place,
        time=deciding.time,
        speed=scope.speed,
        filter=FILTER_TEXT,
        cut_off=cut_off.frequency,
        cut_off_origin=cut_off.origin,
        scope=scope,
        statement=deck_statement(
            deciding, raw, limit, rule["clause"], fastening, cut_off.frequency, scope
        ),
        notes=deck_notes(scope, spans, line_speed, highest_speed, bearings_in_tension),
        raw=raw,
        points=points.by_name(slab),
        spans=spans,
    )


@dataclass(frozen=True, kw_only=True)
class _PointPeaks:
    """Greatest magnitude and its time at every point, shape (n_point,) each."""

    filtered: Vector
    filtered_time: Vector
    raw: Vector
    raw_time: Vector

    @classmethod
    def of(cls, peaks: SlabPeaks) -> _PointPeaks:
        if peaks.filtered is None or peaks.filtered_time is None:
            raise InputError(
                "peaks.filtered", None, "is missing", "Give the filter's cut-off to slab_peaks."
            )
        return cls(
            filtered=peaks.filtered,
            filtered_time=peaks.filtered_time,
            raw=peaks.raw,
            raw_time=peaks.raw_time,
        )

    def at(self, slab: SlabPoints, index: int, *, filtered: bool) -> Peak:
        value = self.filtered if filtered else self.raw
        time = self.filtered_time if filtered else self.raw_time
        place = _place(slab, index)
        return Peak(value=float(value[index]), time=float(time[index]), place=place)

    def greatest(self, slab: SlabPoints, chosen: BoolVector) -> tuple[Peak, Peak]:
        """Filtered and raw peak over the chosen points."""
        indices = np.flatnonzero(chosen)
        filtered = int(indices[np.argmax(self.filtered[indices])])
        raw = int(indices[np.argmax(self.raw[indices])])
        return self.at(slab, filtered, filtered=True), self.at(slab, raw, filtered=False)

    def by_span(self, slab: SlabPoints) -> tuple[SpanPeak, ...]:
        """Peaks of every span; a negative span index means between spans."""
        spans: list[SpanPeak] = []
        for span in sorted({int(span) for span in slab.span if span >= 0}):
            filtered, raw = self.greatest(slab, np.asarray(slab.span == span))
            judged = span in slab.judged_spans
            spans.append(
                SpanPeak(
                    number=span + 1,
                    judged=judged,
                    filtered=filtered,
                    raw=raw,
                    remark="" if judged else "end conditions not modelled",
                )
            )
        return tuple(spans)

    def by_name(self, slab: SlabPoints) -> tuple[NamedPeak, ...]:
        """Peaks of the named points."""
        return tuple(
            NamedPeak(
                name=name,
                filtered=self.at(slab, index, filtered=True),
                raw=self.at(slab, index, filtered=False),
            )
            for name, index in slab.named.items()
        )


def _place(slab: SlabPoints, index: int) -> Place:
    """A point's name and coordinates; unnamed points are called after their span."""
    names = [name for name, point in slab.named.items() if point == index]
    span = int(slab.span[index])
    fallback = f"slab, span {span + 1}" if span >= 0 else "slab, at a joint"
    x, y, z = (float(value) for value in slab.coordinates[index])
    return Place(name=names[0] if names else fallback, x=x, y=y, z=z)
