"""Checks a study: bounds, relations between fields, warnings, derived values, cost."""

from __future__ import annotations

from dataclasses import dataclass

from solver.models.ballasted_track import TrackProperties
from solver.studies.bounds import Finding, violations
from solver.studies.crossing import crossing, train_length
from solver.studies.estimate import Estimate, estimate
from solver.studies.rules import relations, warnings
from solver.studies.study import Study
from solver.units import Unit, Units

__all__ = ["Quantity", "Report", "check"]


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A derived value.

    Attributes:
        title: What it is.
        value: In SI.
        unit: Its unit and display unit.
    """

    title: str
    value: float
    unit: Unit


@dataclass(frozen=True, kw_only=True)
class Report:
    """What is known of a study before it runs.

    Attributes:
        errors: Findings that forbid it.
        warnings: Findings that a user should know.
        derived: Values that follow from it, by name.
        estimate: Its cost; None while there are errors.
    """

    errors: tuple[Finding, ...]
    warnings: tuple[Finding, ...]
    derived: dict[str, Quantity]
    estimate: Estimate | None


def check(study: Study) -> Report:
    """Checks a study without allocating anything; all errors are found at once.

    Relations between fields are looked at once every value is within its own bounds.
    """
    errors = list(violations(study)) or relations(study)
    if errors:
        return Report(errors=tuple(errors), warnings=(), derived={}, estimate=None)
    return Report(
        errors=(),
        warnings=tuple(warnings(study)),
        derived=_derived(study),
        estimate=estimate(study),
    )


def _derived(study: Study) -> dict[str, Quantity]:
    """Values that follow from the study."""
    extents = [crossing(study, speed) for speed in study.sweep.speeds]
    longest = max(extents, key=lambda extent: extent.n_step)
    duration = longest.n_step * study.integration.time_step
    derived = {
        "train_length": Quantity(
            title="First to last axle", value=train_length(study), unit=Units.length
        ),
        "duration": Quantity(title="Simulated time", value=duration, unit=Units.time),
        "approach": Quantity(
            title="Approach track needed",
            value=max(extent.approach_needed for extent in extents),
            unit=Units.length,
        ),
    }
    if isinstance(study.track, TrackProperties):
        frequency = max(study.sweep.speeds) / study.track.sleeper_spacing
        derived["sleeper_passing"] = Quantity(
            title="Sleeper-passing frequency", value=frequency, unit=Units.frequency
        )
    return derived
