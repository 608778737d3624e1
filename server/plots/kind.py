"""A kind of figure: what it is called, which runs have it, how it is drawn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

from server.plots.figure import Figure
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.theme import themed
from solver.errors import InputError

__all__ = ["FigureKind", "Variant", "chosen_variant"]


@dataclass(frozen=True, kw_only=True)
class Variant:
    """One way to draw a figure.

    Attributes:
        name: As ``variant=`` asks for it.
        title: As a page offers it.
    """

    name: str
    title: str


def _always(_run: RunSource, _variant: str) -> bool:
    return True


@dataclass(frozen=True, kw_only=True)
class FigureKind:
    """A figure of one run.

    Attributes:
        name: In the API.
        title: For people.
        group: ``deck``, ``slab``, ``wheel``, ``vehicle`` or ``spectrum``: where a page shows it.
        axis: What runs along its horizontal axis.
        draw: Draws it; the request's variant is one of ``variants``.
        has: Whether a run has it (or will, once it has got so far).
        variants: Ways to draw it, the first by default.
        offers: Whether a run of which it is drawn has something to show in a variant.
        needs_place: Whether it cannot be drawn without a place.
    """

    name: str
    title: str
    group: Literal["deck", "slab", "wheel", "vehicle", "spectrum"]
    axis: Literal["time", "frequency", "position"]
    draw: Callable[[RunSource, FigureRequest], Figure]
    has: Callable[[RunSource], bool]
    variants: tuple[Variant, ...] = ()
    offers: Callable[[RunSource, str], bool] = _always
    needs_place: bool = False

    def __call__(self, run: RunSource, request: FigureRequest) -> Figure:
        """Draws the figure in the colours asked for.

        Raises:
            InputError: The request does not fit the figure or the run.
        """
        if run.plan.modal:
            remedy = "See the modes of its summary."
            raise InputError("figure", self.name, "is of histories, this run holds shapes", remedy)
        if self.needs_place and request.place is None:
            raise InputError(
                "place", "", "is missing", "Say where, for example place=27.0,0.7,1.3."
            )
        variant = chosen_variant(self.variants, request.variant)
        return themed(self.draw(run, replace(request, variant=variant)), request.theme)

    def document(self, run: RunSource) -> dict[str, Any]:
        """The kind as the API lists it for a run."""
        offered = [item for item in self.variants if self.offers(run, item.name)]
        return {
            "name": self.name,
            "title": self.title,
            "group": self.group,
            "axis": self.axis,
            "variants": [{"name": item.name, "title": item.title} for item in offered],
            "needs_place": self.needs_place,
        }


def chosen_variant(variants: tuple[Variant, ...], asked: str) -> str:
    """The variant asked for, the first by default, empty where a figure has none.

    Raises:
        InputError: There is no such variant.
    """
    names = [item.name for item in variants]
    if not asked:
        return names[0] if names else ""
    if asked not in names:
        remedy = f"Use {', '.join(names)}." if names else "Leave it out."
        raise InputError("variant", asked[:80], "is no variant of this figure", remedy)
    return asked
