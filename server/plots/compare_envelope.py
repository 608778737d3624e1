"""Envelopes along the bridge of several runs in one figure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from server.plots.along import acceleration_along, displacement_along
from server.plots.comparison import ComparisonKind, NamedRun
from server.plots.deciding import acceleration_limit
from server.plots.envelope import ACCELERATION, DISPLACEMENT, along_axis, along_line, limit_marks
from server.plots.figure import Figure, value_axis
from server.plots.marks import span_notes
from server.plots.palette import line_style
from server.plots.request import FigureRequest
from server.plots.text import quantity, sentence
from solver.arrays import Vector
from solver.units import Unit, Units

__all__ = ["KIND", "compare_envelope"]


def compare_envelope(runs: Sequence[NamedRun], request: FigureRequest) -> Figure:
    """Overlays the runs' envelopes.

    Args:
        runs: The runs, the baseline first.
        request: ``displacement`` (least and greatest, of the window) or ``acceleration`` (filtered
            where the run is judged, of the whole run).

    Returns:
        The figure.
    """
    accelerations = request.variant == ACCELERATION.name
    unit = Units.acceleration if accelerations else Units.small_length
    traces: list[dict[str, Any]] = []
    rows: list[dict[str, Any]] = []
    missing: list[str] = []
    for number, item in enumerate(runs):
        curves = _accelerations(item) if accelerations else _displacements(item, request)
        if not curves:
            missing.append(item.name)
        traces += _traces(item, number, curves, unit)
        rows += [_row(item, name, x, values, unit) for name, x, values in curves]
    limits = {acceleration_limit(item.source) for item in runs}
    shapes, notes = limit_marks(limits.pop() if accelerations and len(limits) == 1 else None)
    title = "greatest |acceleration| over the slab's width" if accelerations else "displacement"
    return along_axis(
        runs[0].source.plan,
        title=f"Envelopes: {title}",
        y_axis={
            **value_axis("|acceleration| [m/s²]" if accelerations else "displacement [mm]"),
            **({"rangemode": "tozero"} if accelerations else {}),
        },
        traces=traces,
        table=rows,
        summary=_summary(rows, missing),
        shapes=shapes,
        annotations=[*notes, *(span_notes(runs[0].source.plan) if accelerations else ())],
    )


_Curves = list[tuple[str, Vector, Vector]]
"""Name, x and values in display units of each curve."""


def _accelerations(item: NamedRun) -> _Curves:
    found = acceleration_along(item.source)
    if found is None:
        return []
    if found.filtered is None:
        return [("greatest, as computed", found.x, found.raw)]
    return [("greatest", found.x, found.filtered)]


def _displacements(item: NamedRun, request: FigureRequest) -> _Curves:
    found = displacement_along(item.source, request)
    if found is None:
        return []
    scale = Units.small_length.scale
    return [("least", found.x, scale * found.least), ("greatest", found.x, scale * found.greatest)]


def _traces(item: NamedRun, number: int, curves: _Curves, unit: Unit) -> list[dict[str, Any]]:
    """One style a run; the legend names each run once."""
    style = line_style(number)
    drawn: list[dict[str, Any]] = []
    for index, (_, x, values) in enumerate(curves):
        line = along_line(item.name, x, values, unit, style.color, dash=style.dash)
        meta = {**line["meta"], "run": item.run}
        drawn.append({**line, "legendgroup": item.run, "showlegend": index == 0, "meta": meta})
    return drawn


def _row(item: NamedRun, name: str, x: Vector, values: Vector, unit: Unit) -> dict[str, Any]:
    at = int(np.argmin(values) if name == "least" else np.argmax(values))
    return {
        "curve": item.name,
        "extreme": name,
        "value": float(values[at]),
        "unit": "m/s²" if unit is Units.acceleration else unit.shown,
        "x [m]": float(x[at]),
        "run": item.run,
    }


def _summary(rows: Sequence[dict[str, Any]], missing: Sequence[str]) -> str:
    sentences = [
        sentence(f"{row['curve']}: {row['extreme']} {_words(row)} at x = {row['x [m]']:.1f} m")
        for row in rows
    ]
    if missing:
        sentences.append(sentence(f"nothing to draw (yet) of {', '.join(missing)}"))
    return " ".join(sentences)


def _words(row: dict[str, Any]) -> str:
    unit = Units.acceleration if row["unit"] == "m/s²" else Units.small_length
    return quantity(row["value"], unit)


KIND = ComparisonKind(
    name="envelope",
    title="Envelopes along the bridge",
    draw=compare_envelope,
    variants=(DISPLACEMENT, ACCELERATION),
)
