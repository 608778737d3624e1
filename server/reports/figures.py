"""The figures of a report: those that a reader of the file asks for first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from server.plots import Figure, FigureRequest, LowPass, figures_of
from server.plots.text import plain as unmarked
from server.reports.material import Material
from server.store import NotStoredError, plain
from server.viewer import Still
from solver.errors import InputError

__all__ = ["Illustration", "illustrated", "report_figures"]

_ORDER = (
    "slab-acceleration",
    "slab-map",
    "displacement",
    "envelope",
    "contact-force",
    "vehicle-acceleration",
)
"""Names in the API; a run has some of them."""


@dataclass(frozen=True, kw_only=True)
class Illustration:
    """What is drawn for a report, by another process, and the words below it.

    Attributes:
        title: What it shows.
        words: What there is to see, for who cannot see it.
        drawing: A figure without its title, or a picture in space.
    """

    title: str
    words: str
    drawing: Figure | Still


def report_figures(material: Material, low_pass: LowPass | None = None) -> dict[str, Illustration]:
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
    drawn: dict[str, Illustration] = {}
    for name in _ORDER:
        if name not in kinds:
            continue
        try:
            drawn[name] = illustrated(kinds[name](reader, request))
        except (NotStoredError, InputError):
            # A run of before lacks what newer figures show: the others still stand.
            continue
    return drawn


def illustrated(figure: Figure) -> Illustration:
    """A figure whose caption says its title."""
    layout: dict[str, Any] = {**figure["layout"], "title": {"text": ""}}
    return Illustration(
        title=unmarked(str(figure["layout"]["title"]["text"])),
        words=str(figure["summary"]),
        drawing=plain({**figure, "layout": layout}),
    )
