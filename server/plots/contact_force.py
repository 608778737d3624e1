"""Contact forces between wheel and rail, with the static load and the line of lost contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from server.plots.curves import Curve, channel_named, few_on_one_path, raw_curve
from server.plots.figure import Figure, compose, table_row, trace
from server.plots.kind import FigureKind
from server.plots.marks import horizontal_line, horizontal_note
from server.plots.palette import LIMIT, MUTED, line_style
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.text import quantity, sentence
from solver.results import ChannelSpec

__all__ = ["KIND", "contact_force"]

QUANTITY = "/contact force"
NEAR_LOSS = 0.5
"""Part of the static load below which the axis reaches down to zero."""
SAME = 1e-4
"""Relative difference below which two curves cannot be told apart."""
ALIKE = 0.02
"""Relative difference below which the wheels of a train are said to have one static load."""
PULL = 1e-6
"""Tension beyond rounding, as a part of the greatest compression."""
NAMED = 3
"""Wheels that are not drawn and named nevertheless; of more their number is said."""
AIR = 0.12
"""Free height above and below the curves, as a part of theirs."""


def contact_force(run: RunSource, request: FigureRequest) -> Figure:
    """Contact forces of the first axle's wheels (of the masses), or those asked for.

    Args:
        run: The run, finished or not.
        request: Window, points, channels.

    Returns:
        The figure.

    Raises:
        InputError: A channel is unknown.
    """
    chosen = _chosen(run, request)
    curves = [raw_curve(run, spec, request, spec.name.removesuffix(QUANTITY)) for spec in chosen]
    if not request.channels:
        curves = _joined(curves)
    shapes, notes = [horizontal_line(0.0, LIMIT, "solid")], []
    if curves:
        pulled = any(_pulls(curve) for curve in curves)
        words = "0: the contact pulls below" if pulled else "0: contact lost"
        note = horizontal_note(0.0, words, LIMIT)
        notes.append({**note, "yanchor": "top"})
    statics = _static_loads(run, chosen)
    static = statics[0] if statics else None
    if static is not None and curves:
        shapes.append(horizontal_line(static, MUTED))
        alike = max(statics) - min(statics) < ALIKE * static
        whose = "" if alike else f" of {chosen[0].name.removesuffix(QUANTITY)}"
        words = f"static load{whose} {quantity(static, curves[0].unit, 4)}"
        notes.append(horizontal_note(static, words, MUTED))
    return compose(
        plan=run.plan,
        title="Contact force between wheel and rail",
        value_title="contact force [kN]",
        traces=[*_curves(curves, request), *_losses(curves, request)],
        table=[{**table_row(curve), "contact_lost": time_lost(curve)} for curve in curves],
        summary=_summary(run, chosen, curves),
        shapes=shapes,
        annotations=notes,
        value_range=_value_range(curves, static),
        request=request,
    )


def time_lost(curve: Curve) -> float:
    """Time in the window during which the wheel did not touch the rail. [s]"""
    return 0.0 if _pulls(curve) else _time_without_compression(curve)


def _pulls(curve: Curve) -> bool:
    """Whether wheel and rail also hold each other: a contact that was chosen so is never lost."""
    least, greatest = curve.minimum(), curve.maximum()
    return bool(least and greatest and least.value < -PULL * abs(greatest.value))


def _time_without_compression(curve: Curve) -> float:
    if curve.time.size < 2:
        return 0.0
    step = float(curve.time[1] - curve.time[0])
    return int(np.count_nonzero(curve.values <= 0.0)) * step


def _curves(curves: Sequence[Curve], request: FigureRequest) -> list[dict[str, Any]]:
    styles = [line_style(number) for number in range(len(curves))]
    return [
        trace(curve, request, style.color, 1.3, dash=style.dash)
        for curve, style in zip(curves, styles, strict=True)
    ]


def _losses(curves: Sequence[Curve], request: FigureRequest) -> list[dict[str, Any]]:
    """A mark at the beginning of every loss of contact, as far as they can be told apart."""
    times: list[float] = []
    for curve in curves:
        if _pulls(curve):
            continue
        off = curve.values <= 0.0
        begins = np.flatnonzero(off & ~np.concatenate([[False], off[:-1]]))
        times += curve.time[begins].tolist()
    if not times:
        return []
    chosen = sorted(set(times))[:: -(-len(times) // request.points)]
    return [
        {
            "type": "scatter",
            "mode": "markers",
            "name": "contact lost",
            "x": [round(time, 9) for time in chosen],
            "y": [0.0] * len(chosen),
            "marker": {"symbol": "triangle-down", "size": 9, "color": LIMIT},
            "hovertemplate": "contact lost at %{x:.4f} s",
            "meta": {"unit": "kN"},
        }
    ]


def _chosen(run: RunSource, request: FigureRequest) -> Sequence[ChannelSpec]:
    if request.channels:
        return [channel_named(run, name) for name in request.channels]
    forces = [spec for spec in run.plan.channels if spec.name.endswith(QUANTITY)]
    first_axle = [spec for spec in forces if spec.name.startswith("wheel 01 ")]
    if first_axle[1:]:
        return first_axle[:2]
    return few_on_one_path(forces)


def _joined(curves: list[Curve]) -> list[Curve]:
    """On rails without a defect on one side both wheels feel the same: one curve says so."""
    if len(curves) != 2 or not curves[1].name.endswith(" right"):
        return curves
    left, right = curves
    # A run that computes may have come further between the reading of one and of the other.
    common = min(left.values.size, right.values.size)
    one, other = left.values[:common], right.values[:common]
    if not common or not np.allclose(one, other, rtol=SAME, atol=SAME * np.abs(one).max()):
        return curves
    return [replace(left, name=f"{left.name} and right")]


def _static_loads(run: RunSource, chosen: Sequence[ChannelSpec]) -> list[float]:
    """The wheels' loads at the static start, in display units; none before there is a step."""
    if run.committed == 0:
        return []
    return [float(run.channel(spec.name, 0, 1)[0] * spec.unit.scale) for spec in chosen]


def _value_range(curves: Sequence[Curve], static: float | None) -> tuple[float, float] | None:
    """The curves and the static load with some air; zero too, once a wheel comes near to it."""
    lows = [extreme.value for extreme in (curve.minimum() for curve in curves) if extreme]
    highs = [extreme.value for extreme in (curve.maximum() for curve in curves) if extreme]
    if static is None or not lows:
        return None
    low, high = min(*lows, static), max(*highs, static)
    if low < NEAR_LOSS * static:
        low = min(low, 0.0)
    air = AIR * max(high - low, 0.02 * static)
    return low - air, high + air


def _summary(run: RunSource, chosen: Sequence[ChannelSpec], curves: Sequence[Curve]) -> str:
    if run.committed == 0:
        return "No step has been computed yet."
    sentences: list[str] = []
    for curve in curves:
        least, greatest = curve.minimum(), curve.maximum()
        if least is None or greatest is None:
            continue
        sentences.append(
            sentence(
                f"{curve.name}: between {quantity(least.value, curve.unit)} and "
                f"{quantity(greatest.value, curve.unit)}, {_state(curve)}"
            )
        )
    if sentences:
        sentences += _others(run, chosen, any(map(_pulls, curves)))
    return " ".join(sentences) or "No wheel is recorded."


def _others(run: RunSource, chosen: Sequence[ChannelSpec], pull: bool) -> list[str]:
    """What wheels do that are not drawn, where it is known; nothing where all press."""
    peaks: Mapping[str, Mapping[str, float]] = (run.summary or {}).get("peaks", {})
    drawn = {spec.name for spec in chosen}
    names = [
        name.removesuffix(QUANTITY)
        for name, peak in peaks.items()
        if name.endswith(QUANTITY) and name not in drawn and peak["least"] <= 0.0
    ]
    if not names:
        return []
    whose = ", ".join(names) if len(names) <= NAMED else f"{len(names)} more wheels"
    return [sentence(f"Not drawn: {whose}, where {'it pulls' if pull else 'contact is lost'} too")]


def _state(curve: Curve) -> str:
    duration = f"{_time_without_compression(curve) * 1e3:.3g} ms"
    if _pulls(curve):
        return f"pulls for {duration}: this contact cannot be lost"
    return f"contact lost for {duration}" if time_lost(curve) > 0.0 else "always in contact"


def _has(run: RunSource) -> bool:
    return not run.plan.modal and bool(_chosen(run, FigureRequest()))


KIND = FigureKind(
    name="contact-force",
    title="Contact force between wheel and rail",
    group="wheel",
    axis="time",
    draw=contact_force,
    has=_has,
)
