"""Figures: one a file, each a function from a run to plotly JSON, and one renderer for files.

>>> sorted(figures())
['contact-force', 'displacement', 'slab-acceleration']
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from server.plots.contact_force import contact_force
from server.plots.displacement import displacement
from server.plots.figure import Figure
from server.plots.render import MEDIA_TYPES, render
from server.plots.request import FigureRequest
from server.plots.slab_acceleration import slab_acceleration
from server.plots.source import PlanSource, RunSource

__all__ = [
    "MEDIA_TYPES",
    "Figure",
    "FigureRequest",
    "PlanSource",
    "RunSource",
    "figures",
    "render",
]

_FIGURES: Mapping[str, Callable[[RunSource, FigureRequest], Figure]] = MappingProxyType(
    {
        "slab-acceleration": slab_acceleration,
        "contact-force": contact_force,
        "displacement": displacement,
    }
)


def figures() -> Mapping[str, Callable[[RunSource, FigureRequest], Figure]]:
    """Every figure by its name in the API, in the order in which a page shows them."""
    return _FIGURES
