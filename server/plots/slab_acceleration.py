"""Vertical acceleration of the upper slab, with the band that the standard allows.

While the run computes, raw histories are drawn. Once it is finished, each raw history lies thin
behind its low-pass filtered one, at the cut-off that decided the verdict; the filtered history of
the point that decides lies over them, and the greatest filtered value is named.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from server.plots.curves import Curve, channel_named, filtered_curve, raw_curve
from server.plots.figure import (
    Figure,
    callout,
    compose,
    horizontal_line,
    horizontal_note,
    table_row,
    trace,
    window,
)
from server.plots.palette import CURVES, LIMIT, PALE_CURVES, WITHIN
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.text import beside, coordinate, quantity, sentence
from solver.results import ChannelSpec
from solver.units import Units

__all__ = ["slab_acceleration"]

FILTERED = " (filtered)"
DECIDING = "deciding point"
DECIDING_COLOR = CURVES[1]
BALLASTED_LIMIT = 3.5
"""EN 1990:2002+A1, A2.4.4.2.1(4): ballasted track. [m/s2]"""


def slab_acceleration(run: RunSource, request: FigureRequest) -> Figure:
    """Slab accelerations at the named points.

    Args:
        run: The run, finished or not.
        request: Window, points, channels; by default the middle of the judged span.

    Returns:
        The figure.

    Raises:
        InputError: A channel is unknown.
    """
    stored = _stored_filtered(run)
    limit, cut_off = _limit(run), _cut_off(run)
    traces: list[dict[str, Any]] = []
    curves: list[Curve] = []
    for number, spec in enumerate(_chosen(run, request)):
        color, pale = CURVES[number % len(CURVES)], PALE_CURVES[number % len(CURVES)]
        place = spec.name.rsplit("/", 1)[0]
        raw = raw_curve(run, spec, request, f"{place}, raw")
        filtered_name = stored.get(spec.name)
        finished = filtered_name is not None
        traces.append(trace(raw, request, pale if finished else color, 0.8 if finished else 1.2))
        curves.append(raw)
        if filtered_name is not None:
            name = f"{place}, {cut_off}" if cut_off else f"{place}, filtered"
            curves.append(filtered_curve(run, spec, filtered_name, request, name))
            traces.append(trace(curves[-1], request, color, 2.2))
    table = [table_row(curve) for curve in curves]
    deciding = None if request.channels else _deciding_curve(run, request, stored)
    if deciding is not None:
        curves.append(deciding)
        traces.append(trace(deciding, request, DECIDING_COLOR, 1.4))
        # No channel holds it: there is nothing to choose or to fetch under its name.
        table.append({**table_row(deciding), "channel": ""})
    judged = [curve for curve in curves if not curve.name.endswith(", raw")] or curves
    return compose(
        plan=run.plan,
        title=f"Vertical acceleration of the {_part(run)}",
        value_title="acceleration [m/s²]",
        traces=traces,
        table=table,
        summary=_summary(run, judged, limit, deciding is not None),
        shapes=_band(limit),
        annotations=[*_limit_notes(limit), *_peak(run, judged, limit, request)],
        request=request,
    )


def _chosen(run: RunSource, request: FigureRequest) -> Sequence[ChannelSpec]:
    if request.channels:
        return [channel_named(run, name) for name in request.channels]
    accelerations = [
        spec
        for spec in run.plan.channels
        if spec.group == "deck" and spec.name.endswith("/acceleration")
    ]
    middle = [spec for spec in accelerations if spec.name.startswith("mid-span 2, axis")]
    return (middle or accelerations)[:1]


def _part(run: RunSource) -> str:
    """What the accelerations are of: a plain beam has no slab that a clause judges."""
    return "slab" if run.plan.slab.judged_spans else "deck"


def _stored_filtered(run: RunSource) -> dict[str, str]:
    """Raw channel to the name under which its filtered history is stored."""
    entries: Sequence[Mapping[str, Any]] = (run.summary or {}).get("filtered", ())
    return {
        str(entry["channel"]).removesuffix(FILTERED): str(entry["channel"]) for entry in entries
    }


def _acceleration_verdict(run: RunSource) -> Mapping[str, Any] | None:
    verdicts: Sequence[Mapping[str, Any]] = (run.summary or {}).get("verdicts", ())
    for verdict in verdicts:
        if "acceleration" in str(verdict.get("rule", "")).lower():
            return verdict
    return None


def _deciding_curve(
    run: RunSource, request: FigureRequest, stored: Mapping[str, str]
) -> Curve | None:
    """The filtered history that holds the verdict's value: it may lie beside the named points."""
    verdict, name = _acceleration_verdict(run), stored.get(f"{DECIDING}/acceleration")
    if verdict is None or name is None:
        return None
    place, like = verdict["place"], _chosen(run, request)[0]
    if like.place is not None and np.allclose(like.place[:2], (place["x"], place["y"]), atol=1e-3):
        return None
    words = f"{DECIDING}, {_where(place)}"
    spec = ChannelSpec(
        name=f"{words}/acceleration",
        unit=like.unit,
        title=f"Vertical acceleration, {words}",
        group="deck",
        place=(place["x"], place["y"], place["z"]),
        time_offset=like.time_offset,
    )
    return filtered_curve(run, spec, name, request, f"{words}, {_cut_off(run)}")


def _limit(run: RunSource) -> float | None:
    """The verdict's limit, or before it the one for ballast where a slab is judged. [m/s2]"""
    verdict = _acceleration_verdict(run)
    if verdict is not None and isinstance(verdict.get("limit"), int | float):
        return float(verdict["limit"])
    stated = run.plan.facts.get("acceleration_limit")
    if isinstance(stated, int | float):
        return float(stated)
    return BALLASTED_LIMIT if run.plan.slab.judged_spans else None


def _cut_off(run: RunSource) -> str:
    value = (_acceleration_verdict(run) or {}).get("cut_off")
    return f"below {value:.3g} Hz" if isinstance(value, int | float) else ""


def _band(limit: float | None) -> list[dict[str, Any]]:
    if limit is None:
        return []
    allowed = {
        "type": "rect",
        "xref": "paper",
        "x0": 0,
        "x1": 1,
        "yref": "y",
        "y0": -limit,
        "y1": limit,
        "line": {"width": 0},
        "fillcolor": WITHIN,
        "opacity": 0.09,
        "layer": "below",
    }
    return [allowed, horizontal_line(limit, LIMIT), horizontal_line(-limit, LIMIT)]


def _limit_notes(limit: float | None) -> list[dict[str, Any]]:
    if limit is None:
        return []
    return [horizontal_note(limit, f"±{quantity(limit, Units.acceleration)}", LIMIT)]


def _where(place: Mapping[str, float]) -> str:
    return f"x = {coordinate(place['x'], 1)} m, y = {coordinate(place['y'], 2)} m"


def _peak(
    run: RunSource, judged: Sequence[Curve], limit: float | None, request: FigureRequest
) -> list[dict[str, Any]]:
    """Names the greatest value of the judged curves."""
    peaks = [(curve, curve.peak(run.plan.window_start)) for curve in judged]
    known = [(curve, peak) for curve, peak in peaks if peak is not None]
    if not known:
        return []
    curve, peak = max(known, key=lambda pair: abs(pair[1].value))
    size = beside(abs(peak.value), limit, curve.unit)
    place = curve.spec.name.rsplit("/", 1)[0]
    words = f"{size}\n{place}\nt = {peak.time:.3f} s"
    start, stop = window(run.plan, request)
    color = DECIDING_COLOR if place.startswith(DECIDING) else CURVES[0]
    return [callout(peak, words, color, leftwards=peak.time > 0.5 * (start + stop))]


def _summary(run: RunSource, judged: Sequence[Curve], limit: float | None, deciding: bool) -> str:
    if run.committed == 0:
        return "No step has been computed yet."
    sentences: list[str] = []
    for curve in judged:
        peak = curve.peak(run.plan.window_start)
        if peak is None:
            continue
        size = beside(abs(peak.value), limit, curve.unit)
        words = f"{curve.name}: greatest magnitude {size} at t = {peak.time:.3f} s"
        if limit is not None and not curve.name.endswith(", raw"):
            side = "within" if abs(peak.value) <= limit else "outside"
            words += f", {side} ±{quantity(limit, curve.unit)}"
        sentences.append(sentence(words))
    if not deciding:
        sentences += _deciding(run, limit)
    return " ".join(sentences) or "The train has not reached the bridge yet."


def _deciding(run: RunSource, limit: float | None) -> list[str]:
    """The verdict's value, where its own history is not drawn."""
    verdict = _acceleration_verdict(run)
    if verdict is None or "place" not in verdict:
        return []
    place = verdict["place"]
    size = beside(float(verdict["value"]), limit, Units.acceleration)
    return [
        f"The verdict's value, the greatest over the judged slab, is {size} at "
        f"{_where(place)}, t = {verdict['time']:.3f} s."
    ]
