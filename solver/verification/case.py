"""What a verification case is: quantities computed twice, a tolerance for each, and its reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np

from solver.arrays import Vector

__all__ = ["Case", "Comparison", "Figure", "Findings", "Progress", "Result", "Role", "Series"]

Role: TypeAlias = Literal["reference", "ours", "other"]
"""Who a curve is: figures draw the reference below ours."""
Progress = Callable[[float], None]
"""Takes the fraction of a case that is done, from 0 to 1."""


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One quantity, ours against the reference.

    Attributes:
        case: Name of the case.
        quantity: What is compared.
        unit: Of reference and ours.
        reference: The value to find; for a history its greatest magnitude, with its sign.
        ours: What the solver finds; for a history at the same instant.
        difference: Never negative.
        tolerance: The greatest difference that passes.
        measure: What difference and tolerance are counted in: a unit, or ``of the peak``.
        reason: Why the tolerance is what it is, a sentence.
    """

    case: str
    quantity: str
    unit: str
    reference: float
    ours: float
    difference: float
    tolerance: float
    measure: str
    reason: str

    @property
    def passed(self) -> bool:
        """Whether the difference is within the tolerance; not a number never is."""
        return bool(self.difference <= self.tolerance)


@dataclass(frozen=True, kw_only=True)
class Series:
    """One curve.

    Attributes:
        name: For the legend.
        x: Shape (n,).
        y: Shape (n,).
        role: Who it is.
    """

    name: str
    x: Vector
    y: Vector
    role: Role


@dataclass(frozen=True, kw_only=True)
class Figure:
    """Curves to be drawn beside each other.

    Attributes:
        title: With the number of the thesis's figure, where it has one.
        x_label: With the unit.
        y_label: With the unit.
        series: The curves.
        note: What to look at, or how it differs from the printed figure.
    """

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    note: str = ""


@dataclass(frozen=True, kw_only=True)
class Result:
    """What a case found."""

    comparisons: tuple[Comparison, ...]
    figures: tuple[Figure, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every comparison passed; a case without any does not."""
        return bool(self.comparisons) and all(item.passed for item in self.comparisons)


@dataclass(frozen=True, kw_only=True)
class Case:
    """One verification case.

    Attributes:
        name: As used on the command line.
        title: What people read.
        source: Publication, section or equation.
        weight: ``fast`` cases take seconds, ``slow`` ones up to some minutes.
        run: Computes it.
    """

    name: str
    title: str
    source: str
    weight: Literal["fast", "slow"]
    run: Callable[[Progress], Result]


@dataclass
class Findings:
    """Collects the comparisons and figures of one case.

    Attributes:
        case: Name of the case.
    """

    case: str
    comparisons: list[Comparison] = field(default_factory=list[Comparison])
    figures: list[Figure] = field(default_factory=list[Figure])

    def history(
        self, quantity: str, unit: str, reference: Vector, ours: Vector, tolerance: float,
        reason: str,
    ) -> None:  # fmt: skip
        """Compares histories: the greatest difference over the reference's greatest magnitude."""
        peak = int(np.argmax(np.abs(reference)))
        scale = abs(float(reference[peak]))
        difference = float(np.abs(ours - reference).max()) / scale
        self._add(quantity, unit, float(reference[peak]), float(ours[peak]), difference, tolerance,
                  "of the peak", reason)  # fmt: skip

    def value(
        self, quantity: str, unit: str, reference: float, ours: float, tolerance: float, reason: str
    ) -> None:
        """Compares two numbers, relative to the reference."""
        difference = abs(ours - reference) / abs(reference)
        self._add(quantity, unit, reference, ours, difference, tolerance, "relative", reason)

    def close(
        self, quantity: str, unit: str, reference: float, ours: float, tolerance: float, reason: str
    ) -> None:
        """Compares two numbers by their difference in their own unit."""
        self._add(quantity, unit, reference, ours, abs(ours - reference), tolerance, unit, reason)

    def at_least(self, quantity: str, unit: str, least: float, ours: float, reason: str) -> None:
        """Requires a number that is not below another."""
        self._add(quantity, unit, least, ours, max(0.0, least - ours), 0.0,
                  f"{unit} short of it".lstrip(), reason)  # fmt: skip

    def figure(
        self, title: str, x_label: str, y_label: str, *series: Series, note: str = ""
    ) -> None:
        """Adds a figure."""
        self.figures.append(
            Figure(title=title, x_label=x_label, y_label=y_label, series=series, note=note)
        )

    def result(self) -> Result:
        """Everything found."""
        return Result(comparisons=tuple(self.comparisons), figures=tuple(self.figures))

    def _add(
        self, quantity: str, unit: str, reference: float, ours: float, difference: float,
        tolerance: float, measure: str, reason: str,
    ) -> None:  # fmt: skip
        self.comparisons.append(
            Comparison(
                case=self.case,
                quantity=quantity,
                unit=unit,
                reference=reference,
                ours=ours,
                difference=difference,
                tolerance=tolerance,
                measure=measure,
                reason=reason,
            )
        )
