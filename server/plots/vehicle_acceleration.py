"""Vertical accelerations in the train: carbodies against the levels of comfort, or bogies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from server.plots.curves import Curve, channel_named, raw_curve
from server.plots.figure import Figure, compose, table_row, trace, window
from server.plots.kind import FigureKind, Variant
from server.plots.marks import callout, horizontal_line, horizontal_note
from server.plots.palette import CURVES, MUTED, line_style
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.text import quantity, sentence
from solver.results import ChannelSpec
from solver.units import Units

__all__ = ["KIND", "vehicle_acceleration"]

QUANTITY = "/acceleration"
CARBODIES = Variant(name="carbodies", title="Carbodies")
BOGIES = Variant(name="bogies", title="Bogies")
_KINDS = {CARBODIES.name: "carbody", BOGIES.name: "bogie"}
IN_SIGHT = 0.3
"""Part of a comfort level that a peak has to reach for the axis to reach up to the level."""
AIR, LEVEL_AIR = 1.35, 1.15
"""Height of the axis over a peak, above which its words stand, and over a level's line."""
IN_ROOM = 0.92
"""Part of the axis up to which a level's words find room."""


def vehicle_acceleration(run: RunSource, request: FigureRequest) -> Figure:
    """Accelerations of the first, the worst and the last carbody (or bogie), or those asked for.

    Args:
        run: The run, finished or not.
        request: Window, points, channels; ``carbodies`` or ``bogies``.

    Returns:
        The figure; the comfort levels are drawn with carbodies, once the run is judged.

    Raises:
        InputError: A channel is unknown.
    """
    kind = _KINDS[request.variant]
    curves = [
        raw_curve(run, spec, request, spec.name.removesuffix(QUANTITY))
        for spec in _chosen(run, request, kind)
    ]
    comfort = _comfort(run) if kind == "carbody" else {}
    of_car = {str(car["name"]): _level(car) for car in comfort.get("cars", ())}
    limits = [float(level["limit"]) for level in comfort.get("levels", ())]
    value_range = _value_range(run, curves, limits)
    shapes, notes = _levels(comfort, value_range)
    return compose(
        plan=run.plan,
        title=f"Vertical acceleration of the {_bodies(curves, kind)}",
        value_title="acceleration [m/s²]",
        traces=[
            trace(curve, request, style.color, 1.4, dash=style.dash)
            for curve, style in zip(curves, map(line_style, range(len(curves))), strict=True)
        ],
        table=[_row(curve, of_car) for curve in curves],
        summary=_summary(run, curves, kind, comfort),
        shapes=shapes,
        annotations=[*notes, *_peak(run, curves, request)],
        value_range=value_range,
        request=request,
    )


def _bodies(curves: Sequence[Curve], kind: str) -> str:
    """What the curves are of: trains of sprung masses have no cars."""
    if kind == "bogie":
        return "bogies"
    return "masses" if curves and curves[0].name.startswith("mass ") else "carbodies"


def _specs(run: RunSource, kind: str) -> list[ChannelSpec]:
    names = {body.name for body in run.plan.geometry.bodies if body.kind == kind}
    return [
        spec
        for spec in run.plan.channels
        if spec.name.endswith(QUANTITY) and spec.name.removesuffix(QUANTITY) in names
    ]


def _chosen(run: RunSource, request: FigureRequest, kind: str) -> Sequence[ChannelSpec]:
    if request.channels:
        return [channel_named(run, name) for name in request.channels]
    specs = _specs(run, kind)
    passengers = str(_comfort(run).get("worst", {}).get("name", ""))
    of_comfort = [spec for spec in specs if spec.name.removesuffix(QUANTITY) == passengers]
    peaks: Mapping[str, Mapping[str, float]] = (run.summary or {}).get("peaks", {})

    def size(spec: ChannelSpec) -> float:
        peak = peaks.get(spec.name)
        return max(-peak["least"], peak["greatest"]) if peak else 0.0

    worst = [max(specs, key=size)] if specs and peaks else []
    return list(
        {spec.name: spec for spec in (*specs[:1], *of_comfort, *worst, *specs[-1:])}.values()
    )


def _comfort(run: RunSource) -> Mapping[str, Any]:
    """What the run says of comfort: clause, levels, cars; empty where it says nothing."""
    return (run.summary or {}).get("comfort") or {}


def _level(car: Mapping[str, Any]) -> str:
    """The level of a car's passengers."""
    return str(car["level"]) if car.get("passengers", True) else "no passengers"


def _levels(
    comfort: Mapping[str, Any], value_range: tuple[float, float] | None
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Lines of the levels of comfort, and their words where there is room for them."""
    shapes: list[dict[str, Any]] = []
    notes: list[dict[str, Any]] = []
    for level in comfort.get("levels", ()):
        limit = float(level["limit"])
        shapes += [horizontal_line(sign * limit, MUTED, "dot") for sign in (1, -1)]
        words = f"{level['name']} up to {quantity(limit, Units.acceleration)}"
        if value_range is None or limit < IN_ROOM * value_range[1]:
            notes.append(horizontal_note(limit, words, MUTED))
    return shapes, notes


def _row(curve: Curve, of_car: Mapping[str, str]) -> dict[str, Any]:
    return {**table_row(curve), "comfort": of_car.get(curve.name, "")}


def _value_range(
    run: RunSource, curves: Sequence[Curve], limits: Sequence[float]
) -> tuple[float, float] | None:
    """The curves, and the next comfort level once they come near to it."""
    peaks = [curve.peak(run.plan.window_start) for curve in curves]
    greatest = max((abs(peak.value) for peak in peaks if peak), default=0.0)
    if greatest <= 0.0:
        return None
    near = [limit for limit in limits if limit >= greatest and greatest >= IN_SIGHT * limit]
    top = max(AIR * greatest, LEVEL_AIR * min(near, default=0.0))
    return -top, top


def _peak(run: RunSource, curves: Sequence[Curve], request: FigureRequest) -> list[dict[str, Any]]:
    """Names the greatest value of the curves."""
    peaks = [(number, curve.peak(run.plan.window_start)) for number, curve in enumerate(curves)]
    known = [(number, peak) for number, peak in peaks if peak is not None]
    if not known:
        return []
    number, peak = max(known, key=lambda pair: abs(pair[1].value))
    curve = curves[number]
    words = f"{quantity(abs(peak.value), curve.unit)}\n{curve.name}\nt = {peak.time:.3f} s"
    start, stop = window(run.plan, request)
    color = CURVES[number % len(CURVES)]
    return [callout(peak, words, color, leftwards=peak.time > 0.5 * (start + stop))]


def _summary(
    run: RunSource,
    curves: Sequence[Curve],
    kind: str,
    comfort: Mapping[str, Any],
) -> str:
    if run.committed == 0:
        return "No step has been computed yet."
    sentences: list[str] = []
    for curve in curves:
        peak = curve.peak(run.plan.window_start)
        if peak is None:
            continue
        size = quantity(abs(peak.value), curve.unit)
        words = f"{curve.name}: greatest magnitude {size} at t = {peak.time:.3f} s"
        sentences.append(sentence(words))
    worst = comfort.get("worst")
    if worst:
        size = quantity(abs(float(worst["peak"])), Units.acceleration)
        sentences.append(
            f"Of the cars with passengers {worst['name']} shakes most, {size}: comfort is "
            f"{worst['level']} ({comfort['clause']})."
        )
    return " ".join(sentences) or f"No {kind} is recorded."


def _has(run: RunSource) -> bool:
    return not run.plan.modal and bool(_specs(run, "carbody") or _specs(run, "bogie"))


KIND = FigureKind(
    name="vehicle-acceleration",
    title="Acceleration of the train",
    group="vehicle",
    axis="time",
    draw=vehicle_acceleration,
    has=_has,
    variants=(CARBODIES, BOGIES),
    offers=lambda run, variant: bool(_specs(run, _KINDS[variant])),
)
