"""EN 1990 A2.4.4.2.1(4): the peak vertical acceleration of the deck under the track.

The deciding value is the greatest magnitude, after the low-pass filter, over every slab point under
the ballast of the spans whose neighbours are modelled too, from the first axle's arrival onwards.
Histories come in blocks of points, so that memory stays bounded.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from solver.arrays import BoolVector, IntVector, Matrix, Vector
from solver.data import load
from solver.errors import InputError, UnstableError
from solver.results import SlabPoints
from solver.standards.low_pass import FILTER_TEXT, low_pass
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
    blocks: Iterable[tuple[IntVector, Matrix]],
    *,
    slab: SlabPoints,
    times: Vector,
    window_start: float,
    cut_off: CutOff,
    scope: Scope,
    fastening: Fastening = "ballasted",
    line_speed: float | None = None,
    highest_speed: float | None = None,
    bearings_in_tension: tuple[str, ...] = (),
) -> Verdict:
    """Judges one run.

    Args:
        blocks: Pairs of point indices, shape (n_block,), and their raw accelerations, shape
            (n_step, n_block) [m/s2]; together they hold every point once, in any order.
        slab: The points under the track, their spans and names.
        times: Shape (n_step,): of the samples, evenly spaced. [s]
        window_start: Peaks count from this time: the first axle's arrival. [s]
        cut_off: The filter's cut-off and its origin.
        scope: Train, speed, irregularity and mesh level of the run.
        fastening: How the track lies on the deck: it sets the limit.
        line_speed: Of the line, if stated. [m/s]
        highest_speed: Reached by the sweep that this run belongs to, if it is one. [m/s]
        bearings_in_tension: Names of bearings that were pulled, dead load included.

    Returns:
        The verdict.

    Raises:
        InputError: The blocks do not hold every point once, no point is judged, or no sample lies
            in the window.
        UnstableError: A history holds something that is not a number.

    References:
        EN 1990:2002/A1 A2.4.4.2.1(4).
    """
    peaks = _peaks(blocks, slab, times, window_start, cut_off.frequency)
    judged = np.isin(slab.span, np.asarray(slab.judged_spans))
    if not np.any(judged):
        raise InputError(
            "slab.judged_spans",
            slab.judged_spans,
            "no slab point lies on a span that decides",
            "Model the neighbours of at least one span.",
        )
    rule = load("standards")[f"deck_acceleration_{fastening}"]
    deciding, raw = peaks.greatest(slab, judged)
    spans = peaks.by_span(slab)
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
        points=peaks.by_name(slab),
        spans=spans,
    )


@dataclass(frozen=True, kw_only=True)
class _PointPeaks:
    """Greatest magnitude and its time at every point, shape (n_point,) each."""

    filtered: Vector
    filtered_time: Vector
    raw: Vector
    raw_time: Vector

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


def _peaks(
    blocks: Iterable[tuple[IntVector, Matrix]],
    slab: SlabPoints,
    times: Vector,
    window_start: float,
    cut_off: float,
) -> _PointPeaks:
    """Filters block by block and keeps each point's peak inside the window."""
    n_point = len(slab.coordinates)
    # Half a step of slack: a window that starts on a sample includes it in spite of rounding.
    time_step = float(times[-1] - times[0]) / max(len(times) - 1, 1)
    first = int(np.searchsorted(times, window_start - 0.5 * time_step))
    if len(times) < 2 or first >= len(times):
        raise InputError(
            "window_start",
            window_start,
            f"no sample lies in the window: the run ends at t = {times[-1]:.4g} s",
            "Let the run last until the train has crossed.",
        )
    peaks = _PointPeaks(
        filtered=np.zeros(n_point),
        filtered_time=np.zeros(n_point),
        raw=np.zeros(n_point),
        raw_time=np.zeros(n_point),
    )
    seen = np.zeros(n_point, dtype=np.int64)
    for indices, history in blocks:
        _check_finite(history, times)
        seen[indices] += 1
        filtered = low_pass(history, time_step, cut_off)[first:]
        for magnitude, value, time in (
            (np.abs(filtered), peaks.filtered, peaks.filtered_time),
            (np.abs(history[first:]), peaks.raw, peaks.raw_time),
        ):
            step = np.argmax(magnitude, axis=0)
            value[indices] = magnitude[step, np.arange(magnitude.shape[1])]
            time[indices] = times[first + step]
    if np.any(seen != 1):
        raise InputError(
            "blocks",
            int(np.flatnonzero(seen != 1)[0]),
            "this slab point's history is missing or comes twice",
            "Hand every point over in exactly one block.",
        )
    return peaks


def _check_finite(history: Matrix, times: Vector) -> None:
    """A history with NaN has no peak: its verdict would read as within the limit."""
    finite = np.all(np.isfinite(history), axis=1)
    if not np.all(finite):
        raise UnstableError(float(times[int(np.argmin(finite))]), "the slab acceleration")


def _place(slab: SlabPoints, index: int) -> Place:
    """A point's name and coordinates; unnamed points are called after their span."""
    names = [name for name, point in slab.named.items() if point == index]
    span = int(slab.span[index])
    fallback = f"slab, span {span + 1}" if span >= 0 else "slab, at a joint"
    x, y, z = (float(value) for value in slab.coordinates[index])
    return Place(name=names[0] if names else fallback, x=x, y=y, z=z)
