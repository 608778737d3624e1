"""One channel of several runs in one figure, over time or over the train's position."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from server.plots.comparison import ComparisonKind, NamedRun
from server.plots.curves import Curve, channel_named, filtered_curve, raw_curve
from server.plots.deciding import acceleration_limit, cut_off_words
from server.plots.figure import Figure, chart, table_row, trace, value_axis
from server.plots.kind import Variant
from server.plots.limit_band import limit_band, limit_notes
from server.plots.palette import line_style
from server.plots.request import FigureRequest
from server.plots.text import quantity, sentence, unit_text
from solver.errors import InputError
from solver.results import ChannelSpec

__all__ = ["KIND", "compare_histories"]

FILTERED = Variant(name="filtered", title="Low-pass filtered where it is stored")
RAW = Variant(name="raw", title="As computed")
POSITION = Variant(name="position", title="Over the train's position")
_STORED = " (filtered)"
_SPEEDS_DIFFER = 1e-3


@dataclass(frozen=True, kw_only=True)
class _Drawn:
    run: NamedRun
    curve: Curve
    filtered: str


def compare_histories(runs: Sequence[NamedRun], request: FigureRequest) -> Figure:
    """Overlays one channel of every run that has it.

    Args:
        runs: The runs, the baseline first.
        request: Window, points, one channel (the deck's acceleration by default); ``filtered``,
            ``raw``, or ``position``: over the place of the first axle, which lays runs of
            different speeds over one another.

    Returns:
        The figure; ``change`` in its table is relative to the first run.

    Raises:
        InputError: More than one channel, or one that no run has.
    """
    name = _channel(runs, request)
    drawn = [item for run in runs if (item := _drawn(run, name, request)) is not None]
    if not drawn:
        raise InputError(
            "channel", name[:80], "is no channel of these runs", "See the runs' channels."
        )
    spec = drawn[0].curve.spec
    unit = unit_text(drawn[0].curve.unit)
    limits = {acceleration_limit(item.run.source) for item in drawn}
    slab = spec.group == "deck" and spec.name.endswith("/acceleration") and len(limits) == 1
    limit = limits.pop() if slab else None
    return chart(
        title=spec.title,
        x_axis=_abscissa(runs, request),
        y_axis=value_axis(f"{spec.name.rsplit('/', 1)[-1]} [{unit}]"),
        traces=[_trace(item, number, request) for number, item in enumerate(drawn)],
        table=[_row(item, drawn[0]) for item in drawn],
        summary=_summary(runs, drawn),
        shapes=limit_band(limit),
        annotations=limit_notes(limit),
        hover="x unified",
        meta={"axis": "position" if request.variant == POSITION.name else "time"},
    )


def _channel(runs: Sequence[NamedRun], request: FigureRequest) -> str:
    if len(request.channels) > 1:
        raise InputError(
            "channel", len(request.channels), "more than one channel", "Compare one at a time."
        )
    if request.channels:
        return request.channels[0]
    specs = runs[0].source.plan.channels
    deck = [spec for spec in specs if spec.group == "deck" and spec.name.endswith("/acceleration")]
    middle = [spec for spec in deck if spec.name.startswith("mid-span 2, axis")]
    return (*middle, *deck, *specs)[0].name


def _drawn(item: NamedRun, name: str, request: FigureRequest) -> _Drawn | None:
    """The run's curve; None where it has no such channel."""
    try:
        spec = channel_named(item.source, name)
    except InputError:
        return None
    stored = name + _STORED
    entries: Sequence[Mapping[str, Any]] = (item.source.summary or {}).get("filtered", ())
    if request.variant != RAW.name and any(entry["channel"] == stored for entry in entries):
        words = cut_off_words(item.source) or "filtered"
        curve = filtered_curve(item.source, spec, stored, request, item.name)
    else:
        words, curve = "", raw_curve(item.source, spec, request, item.name)
    return _Drawn(run=item, curve=curve, filtered=words)


def _trace(item: _Drawn, number: int, request: FigureRequest) -> dict[str, Any]:
    style, plan, curve = line_style(number), item.run.source.plan, item.curve
    if request.variant == POSITION.name:
        curve = replace(curve, time=plan.start_position + plan.speed * curve.time)
    drawn = trace(curve, request, style.color, 1.5, dash=style.dash)
    return {**drawn, "meta": {**drawn["meta"], "run": item.run.run}}


def _abscissa(runs: Sequence[NamedRun], request: FigureRequest) -> dict[str, Any]:
    plans = [item.source.plan for item in runs]
    start = 0.0 if request.start is None else request.start
    ends = [(plan.n_sample - 1) * plan.time_step for plan in plans]
    stops = ends if request.stop is None else [request.stop] * len(ends)
    if request.variant != POSITION.name:
        return {"title": {"text": "time [s]"}, "range": [start, round(max(stops), 9)]}
    low = min(plan.start_position + plan.speed * start for plan in plans)
    pairs = zip(plans, stops, strict=True)
    high = max(plan.start_position + plan.speed * stop for plan, stop in pairs)
    title = {"text": "x of the first axle [m]"}
    return {"title": title, "range": [round(low, 6), round(high, 6)]}


def _magnitude(item: _Drawn) -> float | None:
    peak = item.curve.peak(item.run.source.plan.window_start)
    return None if peak is None else abs(peak.value)


def _row(item: _Drawn, baseline: _Drawn) -> dict[str, Any]:
    own, first = _magnitude(item), _magnitude(baseline)
    change = own / first - 1.0 if own is not None and first else None
    return {**table_row(item.curve), "run": item.run.run, "peak": own, "change": change}


def _summary(runs: Sequence[NamedRun], drawn: Sequence[_Drawn]) -> str:
    sentences: list[str] = []
    for item in drawn:
        peak = item.curve.peak(item.run.source.plan.window_start)
        if peak is None:
            sentences.append(sentence(f"{item.run.name}: no step yet"))
            continue
        kind = f" {item.filtered}" if item.filtered else ""
        size = quantity(abs(peak.value), item.curve.unit)
        words = f"{item.run.name}: greatest magnitude{kind} {size} at t = {peak.time:.3f} s"
        change = _row(item, drawn[0])["change"]
        if item is not drawn[0] and change is not None:
            words += f" ({100 * change:+.1f} percent)"
        sentences.append(sentence(words))
    missing = [run.name for run in runs if all(item.run is not run for item in drawn)]
    if missing:
        sentences.append(sentence(f"without this channel: {', '.join(missing)}"))
    if any(_elsewhere(item.curve.spec, drawn[0].curve.spec) for item in drawn):
        sentences.append("The channel does not lie at the same place in all runs.")
    speeds = np.array([item.run.source.plan.speed for item in drawn])
    if np.ptp(speeds) > _SPEEDS_DIFFER * speeds.max():
        sentences.append("The speeds differ: over the train's position the crossings lie together.")
    return " ".join(sentences)


def _elsewhere(one: ChannelSpec, other: ChannelSpec) -> bool:
    """Whether two channels of one name are measured at different places."""
    if one.place is None or other.place is None:
        return False
    return not np.allclose(one.place, other.place, rtol=0.0, atol=0.05)


KIND = ComparisonKind(
    name="histories",
    title="Histories of one channel",
    draw=compare_histories,
    variants=(FILTERED, RAW, POSITION),
)
