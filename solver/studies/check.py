"""Checks a study: bounds, relations between fields, warnings, derived values, cost."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from solver.factorisation import back_end_name
from solver.irregularities import IsolatedDefect
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.train import ArticulatedTrain
from solver.models.viaduct import ViaductProperties
from solver.studies.bounds import Finding, violations
from solver.studies.crossing import crossing, element_length, train_length
from solver.studies.estimate import Estimate, estimate
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
    """Checks a study without allocating anything; all errors are found at once."""
    errors = list(violations(study))
    if not errors:
        errors = list(_relations(study))
    if errors:
        return Report(errors=tuple(errors), warnings=(), derived={}, estimate=None)
    return Report(
        errors=(),
        warnings=tuple(_warnings(study)),
        derived=_derived(study),
        estimate=estimate(study),
    )


def _relations(study: Study) -> Iterator[Finding]:
    """Rules between fields."""
    if isinstance(study.viaduct, ViaductProperties) != isinstance(study.track, TrackProperties):
        yield Finding(
            path=("track", "type"),
            value=study.track.type,
            reason=f'does not go with a viaduct of type "{study.viaduct.type}"',
            remedy='Use "ballasted" with "u_girder", "none" with "beam".',
        )
        return
    if isinstance(study.viaduct, BeamBridge) and isinstance(study.train, ArticulatedTrain):
        yield Finding(
            path=("train", "type"),
            value=study.train.type,
            reason="has two rails; a plain beam has one path",
            remedy='Use a train of type "sprung_masses", or a viaduct of type "u_girder".',
        )
        return
    yield from _joints(study)
    yield from _time_step(study)
    yield from _approach(study)
    yield from _defect(study)


def _joints(study: Study) -> Iterator[Finding]:
    """Sprung masses on rails need both rails; that is no vehicle of this version."""
    if isinstance(study.viaduct, ViaductProperties) and not isinstance(
        study.train, ArticulatedTrain
    ):
        yield Finding(
            path=("train", "type"),
            value=study.train.type,
            reason="rolls on one path; a ballasted track has two rails",
            remedy='Use a train of type "articulated", or a viaduct of type "beam".',
        )


def _time_step(study: Study) -> Iterator[Finding]:
    """A wheel must meet every rail element at least twice."""
    step, length = study.integration.time_step, element_length(study)
    fastest = max(study.sweep.speeds)
    if fastest * step > 0.5 * length * (1.0 + 1e-9):
        allowed = 0.5 * length / fastest
        yield Finding(
            path=("integration", "time_step"),
            value=step,
            reason=(
                f"a wheel at {3.6 * fastest:.0f} km/h moves {fastest * step:.3g} m a step, more "
                f"than half of a rail element of {length:.3g} m"
            ),
            remedy=f"Use at most {allowed:.3g} s.",
        )


def _approach(study: Study) -> Iterator[Finding]:
    """An approach length given by hand must hold the train."""
    given = study.approach.length
    if given <= 0.0:
        return
    needed = max(crossing(study, speed).approach_needed for speed in study.sweep.speeds)
    if given < needed:
        yield Finding(
            path=("approach", "length"),
            value=given,
            reason=(
                f"is shorter than the {needed:.1f} m that the train of {train_length(study):.1f} m "
                "needs before or after the structure"
            ),
            remedy=f"Use at least {math.ceil(needed)} m, or 0 to let it follow from the train.",
        )


def _defect(study: Study) -> Iterator[Finding]:
    """A defect must lie on the path, away from the train's start."""
    defect = study.irregularity
    if not isinstance(defect, IsolatedDefect):
        return
    half_width = 4.0 / defect.wave_number
    start = -study.extent.run_in
    if defect.position - half_width < start:
        yield Finding(
            path=("irregularity", "position"),
            value=defect.position,
            reason=f"reaches the train's start at x = {start:.1f} m",
            remedy=f"Place it beyond x = {start + half_width:.1f} m.",
        )
    last = study.viaduct.length + train_length(study)
    if defect.position > last:
        yield Finding(
            path=("irregularity", "position"),
            value=defect.position,
            reason="lies beyond the end of the crossing",
            remedy=f"Place it before x = {study.viaduct.length:.1f} m.",
        )


def _warnings(study: Study) -> Iterator[Finding]:
    """What a user should know before running."""
    if study.mesh_level == "coarse" and isinstance(study.viaduct, ViaductProperties):
        yield Finding(
            path=("mesh_level",),
            value="coarse",
            reason="is a screening mesh",
            remedy="Confirm the verdict on the standard mesh.",
        )
    if back_end_name() == "SuperLU" and study.mesh_level != "coarse":
        cost = estimate(study)
        yield Finding(
            path=("mesh_level",),
            value=study.mesh_level,
            reason=(
                "MKL PARDISO is not installed; with SuperLU this mesh needs about "
                f"{cost.seconds / 3600.0:.1f} h and {cost.memory_bytes / 1e9:.1f} GB"
            ),
            remedy="Use the coarse mesh, or install pypardiso.",
        )
    articulated = isinstance(study.train, ArticulatedTrain)
    if articulated and study.extent.run_in < 58.0:
        yield Finding(
            path=("extent", "run_in"),
            value=study.extent.run_in,
            reason="leaves less than 40 m for the start's transient to die out before x = -18 m",
            remedy="Use 66 m or more.",
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
