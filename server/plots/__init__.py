"""Figures: one a file, each a function from a run to plotly JSON, and one renderer for files.

>>> list(figures())[:3]
['slab-acceleration', 'displacement', 'envelope']
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from server.plots import (
    compare_envelope,
    compare_histories,
    contact_force,
    displacement,
    envelope,
    point_acceleration,
    point_displacement,
    slab_acceleration,
    slab_map,
    spectrum,
    vehicle_acceleration,
)
from server.plots.comparison import MAX_RUNS, ComparisonKind, NamedRun
from server.plots.deciding import MidSpanPeak, mid_span_peak
from server.plots.figure import Figure
from server.plots.kind import FigureKind
from server.plots.render import MEDIA_TYPES, render
from server.plots.request import FigureRequest, LowPass, read_place
from server.plots.source import PlanSource, RunSource
from server.plots.speed_sweep import Sweep, SweepPoint, speed_sweep
from server.plots.spreadsheet import csv_lines

__all__ = [
    "MAX_RUNS",
    "MEDIA_TYPES",
    "ComparisonKind",
    "Figure",
    "FigureKind",
    "FigureRequest",
    "LowPass",
    "MidSpanPeak",
    "NamedRun",
    "PlanSource",
    "RunSource",
    "Sweep",
    "SweepPoint",
    "comparisons",
    "csv_lines",
    "figures",
    "figures_of",
    "mid_span_peak",
    "read_place",
    "render",
    "speed_sweep",
]

_KINDS = (
    slab_acceleration.KIND,
    displacement.KIND,
    envelope.KIND,
    point_acceleration.KIND,
    point_displacement.KIND,
    slab_map.KIND,
    contact_force.KIND,
    vehicle_acceleration.KIND,
    spectrum.KIND,
)
_COMPARED = (compare_histories.KIND, compare_envelope.KIND)
_FIGURES: Mapping[str, FigureKind] = MappingProxyType({kind.name: kind for kind in _KINDS})
_COMPARISONS: Mapping[str, ComparisonKind] = MappingProxyType(
    {kind.name: kind for kind in _COMPARED}
)


def figures() -> Mapping[str, FigureKind]:
    """Every figure of one run by its name in the API, in the order in which a page shows them."""
    return _FIGURES


def figures_of(run: RunSource) -> list[FigureKind]:
    """The figures that a run has, or will have once it has got so far."""
    return [kind for kind in _KINDS if kind.has(run)]


def comparisons() -> Mapping[str, ComparisonKind]:
    """Every figure of several runs by its name in the API."""
    return _COMPARISONS
