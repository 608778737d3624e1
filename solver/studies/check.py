"""Checks a study: bounds, relations between fields, warnings, derived values, cost."""

from __future__ import annotations

from dataclasses import dataclass

from solver.irregularities import IsolatedDefect, MeasuredProfile
from solver.models.ballasted_track import TrackProperties
from solver.studies.advice import warnings
from solver.studies.bounds import Finding, violations
from solver.studies.crossing import crossing, train_length
from solver.studies.estimate import Estimate, estimate
from solver.studies.profile_advice import shortest_wave
from solver.studies.resonance import (
    SpanFrequency,
    first_frequency,
    regular_spacing,
    resonance_speeds,
)
from solver.studies.rules import relations
from solver.studies.study import JobKind, Study
from solver.units import Unit, Units

__all__ = ["Quantity", "Report", "check"]

DEFECT_REACH = 3.0
"""Three of its widths 1/k from its top a defect is 1 percent of its height."""


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


def check(study: Study, kind: JobKind = "crossing", known: SpanFrequency | None = None) -> Report:
    """Checks a study without allocating anything; all errors are found at once.

    Relations between fields are looked at once every value is within its own bounds.

    Args:
        study: The study.
        kind: What is to be computed of it; a modal analysis needs only the part that it is of.
        known: The deck's first frequency where it was computed before; None takes a closed form.

    Returns:
        What is known of it.
    """
    errors = list(violations(study)) or relations(study, kind)
    if errors:
        return Report(errors=tuple(errors), warnings=(), derived={}, estimate=None)
    cost = estimate(study, kind)
    derived = _derived(study, known) if kind == "crossing" else {}
    derived["unknowns"] = Quantity(title="Unknowns", value=cost.unknowns, unit=Units.none)
    return Report(errors=(), warnings=tuple(warnings(study, kind)), derived=derived, estimate=cost)


def _derived(study: Study, known: SpanFrequency | None) -> dict[str, Quantity]:
    """Values that follow from a crossing."""
    first = known or first_frequency(study)
    return {**_lengths_and_times(study), **_frequencies(study, first), **_irregularity(study)}


def _lengths_and_times(study: Study) -> dict[str, Quantity]:
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
    if len(study.sweep.speeds) == 1:
        derived["steps"] = Quantity(title="Time steps", value=longest.n_step, unit=Units.none)
    else:
        total = sum(extent.n_step for extent in extents)
        derived["steps"] = Quantity(title="Time steps of all runs", value=total, unit=Units.none)
    fastest = max(study.sweep.speeds)
    derived["wheel_step"] = Quantity(
        title=f"Way of a wheel in one step at {3.6 * fastest:.4g} km/h",
        value=fastest * study.integration.time_step,
        unit=Units.small_length,
    )
    return derived


def _frequencies(study: Study, first: SpanFrequency) -> dict[str, Quantity]:
    """The first frequency of the deck, and the speeds that excite it."""
    derived = {
        "first_frequency": Quantity(
            title=f"First frequency of span {first.span}: {first.origin}",
            value=first.frequency,
            unit=Units.frequency,
        )
    }
    spacing = regular_spacing(study)
    if spacing is not None:
        derived["regular_spacing"] = Quantity(
            title="Regular distance d of the train's axle groups", value=spacing, unit=Units.length
        )
    for order, speed in resonance_speeds(study, first.frequency):
        derived[f"resonance_{order}"] = Quantity(
            title=f"Resonance speed f d / {order} at f = {first.frequency:.2f} Hz",
            value=speed,
            unit=Units.speed,
        )
    if isinstance(study.track, TrackProperties):
        derived["sleeper_passing"] = Quantity(
            title="Sleeper-passing frequency",
            value=max(study.sweep.speeds) / study.track.sleeper_spacing,
            unit=Units.frequency,
        )
    return derived


def _irregularity(study: Study) -> dict[str, Quantity]:
    """How long a defect is, and how often a wheel meets it a second; what a profile holds."""
    defect = study.irregularity
    if isinstance(defect, MeasuredProfile):
        return _profile(defect, max(study.sweep.speeds))
    if not isinstance(defect, IsolatedDefect):
        return {}
    length = 2.0 * DEFECT_REACH / defect.wave_number
    return {
        "defect_length": Quantity(
            title="Length of the defect, to 1 percent of its height", value=length,
            unit=Units.length,
        ),
        "defect_frequency": Quantity(
            title="Frequency at which a wheel feels the defect",
            value=max(study.sweep.speeds) / length,
            unit=Units.frequency,
        ),
    }  # fmt: skip


def _profile(measured: MeasuredProfile, fastest: float) -> dict[str, Quantity]:
    """What the samples of a profile can hold."""
    wave = shortest_wave(measured)
    return {
        "profile_wave": Quantity(
            title="Shortest wave of the profile, two spacings", value=wave, unit=Units.length
        ),
        "profile_frequency": Quantity(
            title=f"Highest frequency that the profile holds at {3.6 * fastest:.4g} km/h",
            value=fastest / wave,
            unit=Units.frequency,
        ),
    }
