"""The figures of a report: those that a reader of the file asks for first."""

from __future__ import annotations

from server.plots import Figure, FigureRequest, LowPass, figures_of
from server.reports.material import Material
from server.store import NotStoredError, plain
from solver.errors import InputError

__all__ = ["report_figures", "untitled"]

_ORDER = (
    "slab-acceleration",
    "slab-map",
    "displacement",
    "envelope",
    "contact-force",
    "vehicle-acceleration",
)
"""Names in the API; a run has some of them."""


def report_figures(material: Material, low_pass: LowPass | None = None) -> dict[str, Figure]:
    """Figures of the deciding run, by name, in the order of the report.

    Args:
        material: What is known of the job.
        low_pass: The standards' filter.
    """
    if material.modal:
        return {}
    reader = material.deciding.reader
    kinds = {kind.name: kind for kind in figures_of(reader) if not kind.needs_place}
    request = FigureRequest(low_pass=low_pass)
    drawn: dict[str, Figure] = {}
    for name in _ORDER:
        if name not in kinds:
            continue
        try:
            drawn[name] = plain(kinds[name](reader, request))
        except (NotStoredError, InputError):
            # A run of before lacks what newer figures show: the others still stand.
            continue
    return drawn


def untitled(figure: Figure) -> Figure:
    """The figure without its title, which the caption says."""
    return {**figure, "layout": {**figure["layout"], "title": {"text": ""}}}
