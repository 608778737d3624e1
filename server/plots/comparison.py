"""What a figure of several runs is made of: named runs, and a kind as figures of one run have."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from server.plots.figure import Figure
from server.plots.kind import Variant, chosen_variant
from server.plots.request import FigureRequest
from server.plots.source import RunSource
from server.plots.theme import themed
from solver.errors import InputError

__all__ = ["MAX_RUNS", "ComparisonKind", "NamedRun"]

MAX_RUNS = 12


@dataclass(frozen=True, kw_only=True)
class NamedRun:
    """A run and what it is called beside others.

    Attributes:
        name: For people, different for every run.
        run: Its id.
        source: What it found.
    """

    name: str
    run: str
    source: RunSource


@dataclass(frozen=True, kw_only=True)
class ComparisonKind:
    """A figure of several runs, the first of which is the baseline.

    Attributes:
        name: In the API.
        title: For people.
        draw: Draws it; the request's variant is one of ``variants``.
        variants: Ways to draw it, the first by default.
    """

    name: str
    title: str
    draw: Callable[[Sequence[NamedRun], FigureRequest], Figure]
    variants: tuple[Variant, ...]

    def __call__(self, runs: Sequence[NamedRun], request: FigureRequest) -> Figure:
        """Draws the figure in the colours asked for.

        Raises:
            InputError: The request does not fit the figure or the runs.
        """
        if not 1 <= len(runs) <= MAX_RUNS:
            remedy = f"Name 1 to {MAX_RUNS} runs."
            raise InputError("run", len(runs), "is no number of runs to compare", remedy)
        for item in runs:
            if item.source.plan.modal:
                remedy = "Compare runs of a train over a bridge."
                raise InputError("run", item.run, "holds shapes and no histories", remedy)
        variant = chosen_variant(self.variants, request.variant)
        return themed(self.draw(runs, replace(request, variant=variant)), request.theme)
