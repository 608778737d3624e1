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
from server.plots.deciding import (
    acceleration_limit,
    acceleration_verdict,
    cut_off_words,
    where,
)
from server.plots.figure import Figure, compose, table_row, trace
from server.plots.kind import FigureKind
from server.plots.limit_band import (
    DECIDING,
    DECIDING_COLOR,
    limit_band,
    limit_notes,
    peak_callout,
    room_for_callout,
)
from server.plots.palette import line_style
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.text import beside, quantity, sentence
from solver.results import ChannelSpec
from solver.units import Units

__all__ = ["KIND", "slab_acceleration"]

FILTERED = " (filtered)"
LEAST = 0.01
"""Smaller accelerations are not stretched over the whole chart. [m/s²]"""


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
    limit, cut_off = acceleration_limit(run), cut_off_words(run)
    traces: list[dict[str, Any]] = []
    curves: list[Curve] = []
    for number, spec in enumerate(_chosen(run, request)):
        style = line_style(number)
        place = spec.name.rsplit("/", 1)[0]
        raw = raw_curve(run, spec, request, f"{place}, raw")
        filtered_name = stored.get(spec.name)
        finished = filtered_name is not None
        color, width = (style.pale, 0.8) if finished else (style.color, 1.2)
        traces.append(trace(raw, request, color, width))
        curves.append(raw)
        if filtered_name is not None:
            name = f"{place}, {cut_off}" if cut_off else f"{place}, filtered"
            curves.append(filtered_curve(run, spec, filtered_name, request, name))
            traces.append(trace(curves[-1], request, style.color, 2.2, dash=style.dash))
    table = [table_row(curve) for curve in curves]
    deciding = None if request.channels else _deciding_curve(run, request, stored)
    if deciding is not None:
        curves.append(deciding)
        traces.append(trace(deciding, request, DECIDING_COLOR, 1.4, dash="dash"))
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
        shapes=limit_band(limit),
        value_range=room_for_callout(run, curves, judged, limit),
        annotations=[*limit_notes(limit), *peak_callout(run, judged, limit, request)],
        least=LEAST,
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


def _deciding_curve(
    run: RunSource, request: FigureRequest, stored: Mapping[str, str]
) -> Curve | None:
    """The filtered history that holds the verdict's value: it may lie beside the named points."""
    verdict, name = acceleration_verdict(run), stored.get(f"{DECIDING}/acceleration")
    if verdict is None or name is None:
        return None
    place, like = verdict["place"], _chosen(run, request)[0]
    if like.place is not None and np.allclose(like.place[:2], (place["x"], place["y"]), atol=1e-3):
        return None
    words = f"{DECIDING}, {where(place)}"
    spec = ChannelSpec(
        name=f"{words}/acceleration",
        unit=like.unit,
        title=f"Vertical acceleration, {words}",
        group="deck",
        place=(place["x"], place["y"], place["z"]),
        time_offset=like.time_offset,
    )
    return filtered_curve(run, spec, name, request, f"{words}, {cut_off_words(run)}")


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
    verdict = acceleration_verdict(run)
    if verdict is None or "place" not in verdict:
        return []
    place = verdict["place"]
    size = beside(float(verdict["value"]), limit, Units.acceleration)
    return [
        f"The verdict's value, the greatest over the judged slab, is {size} at "
        f"{where(place)}, t = {verdict['time']:.3f} s."
    ]


def _has(run: RunSource) -> bool:
    return not run.plan.modal and bool(_chosen(run, FigureRequest()))


KIND = FigureKind(
    name="slab-acceleration",
    title="Acceleration of the deck",
    group="deck",
    axis="time",
    draw=slab_acceleration,
    has=_has,
)
