"""Amplitude spectra of any channels over the window, with the cut-off of the verdict.

Tapered by default: a crossing is no whole number of vibrations, and without a taper the side lobes
of the greatest peak look like peaks of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from server.plots.curves import Curve, channel_named, raw_curve
from server.plots.deciding import cut_off
from server.plots.decimation import extreme_indices
from server.plots.figure import Figure, chart, line_trace, value_axis
from server.plots.fourier import AmplitudeSpectrum, amplitude_spectrum
from server.plots.kind import FigureKind, Variant
from server.plots.marks import pointed, vertical_line, vertical_note
from server.plots.palette import CURVES, LIMIT, MUTED, line_style
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.text import quantity, sentence, unit_text
from solver.arrays import IntVector
from solver.results import ChannelSpec
from solver.units import Units

__all__ = ["KIND", "spectrum"]

TAPERED = Variant(name="hann", title="Hann taper")
PLAIN = Variant(name="plain", title="Without taper")
PEAKS = 3
"""Peaks of each curve that the table names."""
SHORTEST = 16
"""Samples below which there is no spectrum worth drawing."""
BELOW_NOTES = 110
"""How far below its peak a callout stands: above are the notes of frequencies. [pixel]"""
CUT_OFFS_SHOWN = 3.0
"""The axis reaches at first to so many cut-offs of the verdict: above, nothing is judged."""
ENERGY_SHOWN = 0.99
"""Without a cut-off it reaches as far as this part of the energy does."""


@dataclass(frozen=True, kw_only=True)
class _Drawn:
    curve: Curve
    spectrum: AmplitudeSpectrum


def spectrum(run: RunSource, request: FigureRequest) -> Figure:
    """Spectra of the deck's acceleration at the middle of the judged span, or of what is asked for.

    Args:
        run: The run, finished or not.
        request: Window (from where peaks count, by default), points, channels; ``hann`` or
            ``plain``.

    Returns:
        The figure.

    Raises:
        InputError: A channel is unknown.
    """
    drawn = [
        found
        for spec in _chosen(run, request)
        if (found := _spectrum(run, spec, request)) is not None
    ]
    last = _last_shown(run, drawn)
    marks, notes = _marks(run, last)
    words = "Hann taper" if request.variant == TAPERED.name else "no taper"
    return chart(
        title=f"Amplitude spectrum, {words}",
        x_axis={"title": {"text": "frequency [Hz]"}, "range": [0.0, last]},
        y_axis={**value_axis(_value_title(drawn)), "rangemode": "tozero"},
        traces=[_trace(item, number, last, request) for number, item in enumerate(drawn)],
        table=[row for item in drawn for row in _rows(item)],
        summary=_summary(run, drawn),
        shapes=marks,
        annotations=[*notes, *_peak_note(drawn, last)],
        meta={"axis": "frequency"},
    )


def _chosen(run: RunSource, request: FigureRequest) -> Sequence[ChannelSpec]:
    if request.channels:
        return [channel_named(run, name) for name in request.channels]
    specs = run.plan.channels
    deck = [spec for spec in specs if spec.group == "deck" and spec.name.endswith("/acceleration")]
    middle = [spec for spec in deck if spec.name.startswith("mid-span 2, axis")]
    return (middle or deck or list(specs))[:1]


def _spectrum(run: RunSource, spec: ChannelSpec, request: FigureRequest) -> _Drawn | None:
    """None where the window holds too few samples, or what is no number."""
    curve = raw_curve(run, spec, request)
    start = run.plan.window_start if request.start is None else request.start
    stop = np.inf if request.stop is None else request.stop
    inside = curve.values[(curve.time >= start) & (curve.time <= stop)]
    if inside.size < SHORTEST or not np.isfinite(inside).all():
        return None
    taper = request.variant == TAPERED.name
    return _Drawn(curve=curve, spectrum=amplitude_spectrum(inside, run.plan.time_step, taper=taper))


def _last_shown(run: RunSource, drawn: Sequence[_Drawn]) -> float:
    """End of the frequency axis: round, and not beyond what samples can show. [Hz]"""
    nyquist = 0.5 / run.plan.time_step
    limit = cut_off(run)
    ends = [10.0] if limit is None else [CUT_OFFS_SHOWN * limit]
    for item in drawn if limit is None else ():
        energy = np.cumsum(item.spectrum.amplitude**2)
        if energy[-1] > 0.0:
            index = int(np.searchsorted(energy, ENERGY_SHOWN * energy[-1]))
            ends.append(1.25 * float(item.spectrum.frequency[index]))
    return min(nyquist, float(np.ceil(max(ends) / 10.0) * 10.0))


def _trace(item: _Drawn, number: int, last: float, request: FigureRequest) -> dict[str, Any]:
    found, style = item.spectrum, line_style(number)
    keep = _kept(found, last, request.points)
    line = line_trace(
        f"{item.curve.name} [{unit_text(item.curve.unit)}]",
        np.round(found.frequency[keep], 9).tolist(),
        [float(f"{value:.7g}") for value in found.amplitude[keep].tolist()],
        item.curve.unit,
        color=style.color,
        width=1.4,
        dash=style.dash,
    )
    line["hovertemplate"] = f"%{{x:.3f}} Hz: {line['hovertemplate']}"
    return {**line, "meta": {**line["meta"], "channel": item.curve.spec.name}}


def _kept(found: AmplitudeSpectrum, last: float, points: int) -> IntVector:
    """Every extreme stays; what the axis shows at first is kept at the finest."""
    shown = int(np.searchsorted(found.frequency, last, side="right"))
    inside = extreme_indices(found.amplitude[:shown], max(points - points // 4, 4))
    left = points - inside.size
    if shown == found.amplitude.size or left < 4:
        return inside
    return np.concatenate([inside, shown + extreme_indices(found.amplitude[shown:], left)])


def _value_title(drawn: Sequence[_Drawn]) -> str:
    units = {unit_text(item.curve.unit) for item in drawn}
    return f"amplitude [{units.pop()}]" if len(units) == 1 else "amplitude, each in its unit"


def _marks(run: RunSource, last: float) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """The cut-off of the verdict, and the span's own frequencies where the run knows them."""
    shapes: list[dict[str, Any]] = []
    notes: list[dict[str, Any]] = []
    known: Sequence[float] = run.plan.facts.get("member_frequencies") or ()
    for number, frequency in enumerate(known, start=1):
        if frequency < last:
            shapes.append(vertical_line(float(frequency), MUTED, "dot"))
            words = f"f{number} = {quantity(float(frequency), Units.frequency)}"
            notes.append(vertical_note(float(frequency), words, MUTED, level=number - 1))
    limit = cut_off(run)
    if limit is not None:
        shapes.append(vertical_line(limit, LIMIT))
        words = f"cut-off {quantity(limit, Units.frequency)}"
        notes.append(vertical_note(limit, words, LIMIT, level=0))
    return shapes, notes


def _peak_note(drawn: Sequence[_Drawn], last: float) -> list[dict[str, Any]]:
    """Names the greatest peak of the first curve."""
    for item in drawn[:1]:
        for index in item.spectrum.peaks(1):
            frequency = float(item.spectrum.frequency[index])
            amplitude = float(item.spectrum.amplitude[index])
            size = quantity(amplitude, item.curve.unit)
            words = f"{size}\n{quantity(frequency, Units.frequency)}"
            note = pointed(frequency, amplitude, words, CURVES[0], leftwards=frequency > 0.5 * last)
            return [{**note, "ay": BELOW_NOTES}]
    return []


def _rows(item: _Drawn) -> list[dict[str, Any]]:
    return [
        {
            "curve": item.curve.name,
            "channel": item.curve.spec.name,
            "frequency [Hz]": float(item.spectrum.frequency[index]),
            "value": float(item.spectrum.amplitude[index]),
            "unit": unit_text(item.curve.unit),
        }
        for index in item.spectrum.peaks(PEAKS)
    ]


def _summary(run: RunSource, drawn: Sequence[_Drawn]) -> str:
    if run.committed == 0:
        return "No step has been computed yet."
    if not drawn:
        return "The window holds too few samples for a spectrum."
    sentences: list[str] = []
    for item in drawn:
        found = item.spectrum
        peaks = [
            f"{quantity(float(found.amplitude[index]), item.curve.unit)} at "
            f"{quantity(float(found.frequency[index]), Units.frequency)}"
            for index in found.peaks(PEAKS)
        ]
        words = f"{item.curve.name}: " + (", ".join(peaks) or "no peak")
        sentences.append(sentence(words))
    resolution = float(drawn[0].spectrum.frequency[1])
    return f"{' '.join(sentences)} Lines lie {resolution:.3g} Hz apart."


def _has(run: RunSource) -> bool:
    return not run.plan.modal and bool(run.plan.channels)


KIND = FigureKind(
    name="spectrum",
    title="Amplitude spectrum",
    group="spectrum",
    axis="frequency",
    draw=spectrum,
    has=_has,
    variants=(TAPERED, PLAIN),
)
