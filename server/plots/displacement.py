"""Vertical displacements of deck and train, in millimetres, upward positive."""

from __future__ import annotations

from collections.abc import Sequence

from server.plots.curves import Curve, channel_named, few_on_one_path, raw_curve
from server.plots.figure import Figure, compose, table_row, trace
from server.plots.kind import FigureKind
from server.plots.palette import line_style
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.text import NEGLIGIBLE, quantity, sentence
from solver.results import ChannelSpec

__all__ = ["KIND", "displacement"]

QUANTITY = "/displacement"
MAX_DEFAULT = 6
LEAST = 0.01
"""Smaller displacements are not stretched over the whole chart. [mm]"""


def displacement(run: RunSource, request: FigureRequest) -> Figure:
    """Displacements of the spans' middles (and of sprung masses), or of what is asked for.

    Args:
        run: The run, finished or not.
        request: Window, points, channels.

    Returns:
        The figure.

    Raises:
        InputError: A channel is unknown.
    """
    curves = [
        raw_curve(run, spec, request, spec.name.removesuffix(QUANTITY))
        for spec in _chosen(run, request)
    ]
    return compose(
        plan=run.plan,
        title="Vertical displacement, upward positive",
        value_title="displacement [mm]",
        traces=[
            trace(curve, request, style.color, 1.6, dash=style.dash)
            for curve, style in zip(curves, map(line_style, range(len(curves))), strict=True)
        ],
        table=[table_row(curve) for curve in curves],
        summary=_summary(run, curves),
        least=LEAST,
        request=request,
    )


def _chosen(run: RunSource, request: FigureRequest) -> Sequence[ChannelSpec]:
    if request.channels:
        return [channel_named(run, name) for name in request.channels]
    moves = [spec for spec in run.plan.channels if spec.name.endswith(QUANTITY)]
    deck = [spec for spec in moves if spec.group == "deck" and "rail" not in spec.name]
    masses = [spec for spec in moves if spec.name.startswith("mass ")]
    telling = few_on_one_path(masses)
    return [*deck[: MAX_DEFAULT - len(telling)], *telling]


def _summary(run: RunSource, curves: Sequence[Curve]) -> str:
    if run.committed == 0:
        return "No step has been computed yet."
    sentences: list[str] = []
    for curve in curves:
        peak = curve.peak(0.0)
        if peak is None or abs(peak.value) < NEGLIGIBLE:
            continue
        way = "down" if peak.value < 0 else "up"
        size = quantity(abs(peak.value), curve.unit)
        words = f"{curve.name}: at most {size} {way}, at t = {peak.time:.3f} s"
        sentences.append(sentence(words))
    return " ".join(sentences) or "Nothing has moved yet."


def _has(run: RunSource) -> bool:
    return not run.plan.modal and bool(_chosen(run, FigureRequest()))


KIND = FigureKind(
    name="displacement",
    title="Vertical displacement",
    group="deck",
    axis="time",
    draw=displacement,
    has=_has,
)
