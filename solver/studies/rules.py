"""Rules between the fields of a study: what forbids it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from solver.errors import InputError
from solver.irregularities import IsolatedDefect
from solver.models.axle_table import axle_table_errors
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.train import ArticulatedTrain, AxleTable, SprungMasses
from solver.models.viaduct import ViaductProperties
from solver.standards.low_pass import DESIGN_FACTOR
from solver.studies.bounds import Finding
from solver.studies.crossing import crossing, element_length, train_length
from solver.studies.estimate import structure_unknowns
from solver.studies.profile_rules import profile, sample_order_of
from solver.studies.study import JobKind, Study

__all__ = ["allowed_time_step", "relations", "rounded_down"]

_SLOWEST = 1e-3
"""Slower trains need no dynamics, and their steps cannot be counted. [m/s]"""
_HIGHEST_CUT_OFF = 100.0
"""Room for a cut-off that is only known from the modes of the deciding span. [Hz]"""
_DEFECT_REACH = 4.0
"""Beyond four of its widths 1/k a defect is 3e-4 of its height."""

Rule = Callable[[Study], Iterator[Finding]]
"""Looks at one thing."""


def relations(study: Study, kind: JobKind = "crossing") -> list[Finding]:
    """Everything that forbids a study whose values are each within their bounds.

    Args:
        study: The study.
        kind: What is computed: a modal analysis only needs the part that it is of.
    """
    if kind == "modes":
        return list(_MODAL_RULES[study.modes.part](study))
    parts = list(_parts(study))
    if parts:
        # They would only set off the rules that follow; a sample's row is wrong beside any part.
        return [*parts, *sample_order_of(study)]
    return [found for rule in _RULES for found in rule(study)]


def _parts(study: Study) -> Iterator[Finding]:
    """Train, viaduct and track that go together and can be built."""
    mismatch = list(_deck(study))
    if mismatch:
        yield from mismatch
    elif isinstance(study.viaduct, BeamBridge) and isinstance(study.train, ArticulatedTrain):
        yield Finding(
            path=("train", "type"),
            value=study.train.type,
            reason="has two rails; a plain beam has one path",
            remedy=(
                'Use a train of type "sprung_masses" or "axle_table", or a viaduct of type '
                '"u_girder".'
            ),
        )
    elif not isinstance(study.viaduct, BeamBridge) and isinstance(study.train, SprungMasses):
        yield Finding(
            path=("train", "type"),
            value=study.train.type,
            reason="rolls on one path; a ballasted track has two rails",
            remedy=(
                'Use a train of type "articulated" or "axle_table", or a viaduct of type "beam".'
            ),
        )
    else:
        yield from _train_layout(study)
        yield from _deck_layout(study)


def _deck(study: Study) -> Iterator[Finding]:
    """Viaduct and track that go together."""
    if isinstance(study.viaduct, ViaductProperties) != isinstance(study.track, TrackProperties):
        yield Finding(
            path=("track", "type"),
            value=study.track.type,
            reason=f'does not go with a viaduct of type "{study.viaduct.type}"',
            remedy='Use "ballasted" with "u_girder", "none" with "beam".',
        )


def _train_layout(study: Study) -> Iterator[Finding]:
    """What the train's model itself refuses: an unknown car, axles that are not in order."""
    if isinstance(study.train, AxleTable):
        yield from map(Finding.of, axle_table_errors(study.train))
    else:
        yield from _refusal(lambda: train_length(study))


def _deck_layout(study: Study) -> Iterator[Finding]:
    """What the structure's model itself refuses: a ballast wider than its trough."""
    viaduct, track = study.viaduct, study.track
    if isinstance(viaduct, ViaductProperties) and isinstance(track, TrackProperties):
        yield from _refusal(lambda: structure_unknowns(viaduct, track, study.mesh_level))


def _refusal(build: Callable[[], object]) -> Iterator[Finding]:
    try:
        build()
    except InputError as error:
        yield Finding.of(error)


def _slow(study: Study) -> Iterator[Finding]:
    """A crossing must end."""
    for index, speed in enumerate(study.sweep.speeds):
        if speed < _SLOWEST:
            yield Finding(
                path=("sweep", "speeds", index),
                value=speed,
                reason=f"is less than {_SLOWEST:g} m/s: the crossing would hardly ever end",
                remedy=f"Use at least {_SLOWEST:g} m/s.",
            )


def rounded_down(value: float, digits: int = 3) -> float:
    """A limit as people read it, never beyond the limit itself.

    Args:
        value: The limit, positive.
        digits: Significant digits.
    """
    unit = 10.0 ** (math.floor(math.log10(value)) - digits + 1)
    return math.floor(value / unit * (1.0 + 1e-12)) * unit


def allowed_time_step(study: Study, steps: float) -> float | None:
    """The time step in which the fastest wheel takes so many steps over a rail element.

    Args:
        study: The study.
        steps: Steps to take over each element.

    Returns:
        What to use, rounded down; None where the study's own step is short enough. [s]
    """
    longest = element_length(study) / (steps * max(study.sweep.speeds))
    if study.integration.time_step <= longest * (1.0 + 1e-9):
        return None
    return rounded_down(longest)


def _time_step(study: Study) -> Iterator[Finding]:
    """A wheel must meet every rail element at least twice."""
    allowed = allowed_time_step(study, 2.0)
    if allowed is not None:
        step, length = study.integration.time_step, element_length(study)
        fastest = max(study.sweep.speeds)
        yield Finding(
            path=("integration", "time_step"),
            value=step,
            reason=(
                f"a wheel at {3.6 * fastest:.0f} km/h moves {fastest * step:.3g} m a step, more "
                f"than half of a rail element of {length:.3g} m"
            ),
            remedy=f"Use at most {allowed:.3g} s.",
        )


def _cut_off(study: Study) -> Iterator[Finding]:
    """A verdict's filter needs samples close enough: better said now than after the run."""
    if isinstance(study.viaduct, BeamBridge):
        return
    chosen = study.outputs.cut_off_frequency
    frequency = chosen or _HIGHEST_CUT_OFF
    longest = 0.5 / (DESIGN_FACTOR * frequency)
    if study.integration.time_step < longest:
        return
    whose = "the chosen cut-off" if chosen else "cut-offs up to"
    yield Finding(
        path=("integration", "time_step"),
        value=study.integration.time_step,
        reason=f"is too long to filter the deck's acceleration at {whose} {frequency:g} Hz",
        remedy=f"Use at most {rounded_down(longest, 2):.2g} s"
        + (", or a lower cut-off." if chosen else "."),
    )


def _approach(study: Study) -> Iterator[Finding]:
    """An approach length given by hand must hold the train."""
    given = study.approach.length
    if given <= 0.0 or min(study.sweep.speeds) < _SLOWEST:
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
    """A defect must lie where wheels roll, and away from the train's start."""
    defect = study.irregularity
    if not isinstance(defect, IsolatedDefect):
        return
    reach = _DEFECT_REACH / defect.wave_number
    start, last = -study.extent.run_in, study.viaduct.length + train_length(study)
    if defect.position - reach < start:
        yield Finding(
            path=("irregularity", "position"),
            value=defect.position,
            reason=f"reaches the train's start at x = {start:.1f} m",
            remedy=(
                f"Place it at x = {start + reach:.1f} m or beyond, lengthen the run-in, or make "
                "the defect shorter (a larger wave number)."
            ),
        )
    if defect.position > last:
        yield Finding(
            path=("irregularity", "position"),
            value=defect.position,
            reason="lies beyond the end of the crossing",
            remedy=f"Place it before x = {last:.1f} m.",
        )
    if isinstance(study.viaduct, BeamBridge) and defect.rail == "right":
        yield Finding(
            path=("irregularity", "rail"),
            value=defect.rail,
            reason="no wheel rolls there: the one path of a plain beam counts as the left rail",
            remedy='Use "left" or "both".',
        )


_RULES: tuple[Rule, ...] = (_slow, _time_step, _cut_off, _approach, _defect, profile)
"""Of a crossing, once its parts go together."""


def _modal_viaduct(study: Study) -> Iterator[Finding]:
    yield from list(_deck(study)) or _deck_layout(study)


def _modal_track(study: Study) -> Iterator[Finding]:
    if not isinstance(study.track, TrackProperties):
        yield Finding(
            path=("track", "type"),
            value=study.track.type,
            reason="has no modes",
            remedy='Use "ballasted", or ask for the modes of the viaduct or the train.',
        )


_MODAL_RULES: dict[str, Rule] = {
    "viaduct": _modal_viaduct,
    "track": _modal_track,
    "train": _train_layout,
}
"""Of a modal analysis, by its part."""
