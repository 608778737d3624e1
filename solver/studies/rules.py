"""Rules between the fields of a study: what forbids it, and what its user should know."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from solver.errors import InputError
from solver.factorisation import back_end_name
from solver.irregularities import IsolatedDefect
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.train import ArticulatedTrain
from solver.models.viaduct import ViaductProperties
from solver.standards.low_pass import DESIGN_FACTOR
from solver.studies.bounds import Finding
from solver.studies.crossing import crossing, element_length, train_length
from solver.studies.estimate import estimate, structure_unknowns
from solver.studies.study import Study

__all__ = ["relations", "warnings"]

_SLOWEST = 1e-3
"""Slower trains need no dynamics, and their steps cannot be counted. [m/s]"""
_HIGHEST_CUT_OFF = 100.0
"""Room for a cut-off that is only known from the modes of the deciding span. [Hz]"""
_DECAY = 40.0
"""Way in which the transient of the static start dies out. [m]"""
_DEFECT_REACH = 4.0
"""Beyond four of its widths 1/k a defect is 3e-4 of its height."""
_STEPS_PER_WIDTH = 4.0
"""Steps that a wheel takes over the width 1/k of a defect that it feels as it is."""

Rule = Callable[[Study], Iterator[Finding]]


def relations(study: Study) -> list[Finding]:
    """Everything that forbids a study whose values are each within their bounds."""
    # Parts that do not go together would only set off the rules that follow.
    return list(_parts(study)) or [found for rule in _RULES for found in rule(study)]


def _parts(study: Study) -> Iterator[Finding]:
    """Train, viaduct and track that go together and can be built."""
    if isinstance(study.viaduct, ViaductProperties) != isinstance(study.track, TrackProperties):
        yield Finding(
            path=("track", "type"),
            value=study.track.type,
            reason=f'does not go with a viaduct of type "{study.viaduct.type}"',
            remedy='Use "ballasted" with "u_girder", "none" with "beam".',
        )
    elif isinstance(study.viaduct, BeamBridge) and isinstance(study.train, ArticulatedTrain):
        yield Finding(
            path=("train", "type"),
            value=study.train.type,
            reason="has two rails; a plain beam has one path",
            remedy='Use a train of type "sprung_masses", or a viaduct of type "u_girder".',
        )
    elif not isinstance(study.viaduct, BeamBridge) and not isinstance(
        study.train, ArticulatedTrain
    ):
        yield Finding(
            path=("train", "type"),
            value=study.train.type,
            reason="rolls on one path; a ballasted track has two rails",
            remedy='Use a train of type "articulated", or a viaduct of type "beam".',
        )
    else:
        yield from _layout(study)


def _layout(study: Study) -> Iterator[Finding]:
    """What the models themselves refuse: an unknown car, a ballast wider than its trough."""
    builders: list[Callable[[], object]] = [lambda: train_length(study)]
    if isinstance(study.viaduct, ViaductProperties) and isinstance(study.track, TrackProperties):
        viaduct, track = study.viaduct, study.track
        builders.append(lambda: structure_unknowns(viaduct, track, study.mesh_level))
    for build in builders:
        try:
            build()
        except InputError as error:
            path = tuple(int(part) if part.isdigit() else part for part in error.field.split("."))
            yield Finding(path=path, value=error.value, reason=error.reason, remedy=error.remedy)


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


def _rounded_down(value: float, digits: int = 3) -> float:
    """A limit as people read it, never beyond the limit itself."""
    unit = 10.0 ** (math.floor(math.log10(value)) - digits + 1)
    return math.floor(value / unit * (1.0 + 1e-12)) * unit


def _time_step(study: Study) -> Iterator[Finding]:
    """A wheel must meet every rail element at least twice."""
    step, length = study.integration.time_step, element_length(study)
    fastest = max(study.sweep.speeds)
    if fastest * step > 0.5 * length * (1.0 + 1e-9):
        allowed = _rounded_down(0.5 * length / fastest)
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
        remedy=f"Use at most {_rounded_down(longest, 2):.2g} s"
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


_RULES: tuple[Rule, ...] = (_slow, _time_step, _cut_off, _approach, _defect)


def warnings(study: Study) -> list[Finding]:
    """What a user should know before running a study without errors."""
    return [
        found
        for rule in (_screening_mesh, _slow_back_end, _short_run_in, _short_defect)
        for found in rule(study)
    ]


def _screening_mesh(study: Study) -> Iterator[Finding]:
    if study.mesh_level == "coarse" and isinstance(study.viaduct, ViaductProperties):
        yield Finding(
            path=("mesh_level",),
            value="coarse",
            reason="is a screening mesh",
            remedy="Confirm the verdict on the standard mesh.",
        )


def _slow_back_end(study: Study) -> Iterator[Finding]:
    three_dimensional = isinstance(study.viaduct, ViaductProperties)
    if three_dimensional and study.mesh_level != "coarse" and back_end_name() == "SuperLU":
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


def _short_run_in(study: Study) -> Iterator[Finding]:
    """Peaks count from the first axle's arrival on the three-dimensional track."""
    if not isinstance(study.track, TrackProperties):
        return
    needed = study.track.embankment_length + _DECAY
    if study.extent.run_in < needed:
        yield Finding(
            path=("extent", "run_in"),
            value=study.extent.run_in,
            reason=(
                f"leaves less than {_DECAY:.0f} m for the start's transient to die out before "
                f"x = {-study.track.embankment_length:g} m"
            ),
            remedy=f"Use {math.ceil(needed)} m or more.",
        )


def _short_defect(study: Study) -> Iterator[Finding]:
    defect = study.irregularity
    if not isinstance(defect, IsolatedDefect):
        return
    allowed = 1.0 / (_STEPS_PER_WIDTH * defect.wave_number * max(study.sweep.speeds))
    if study.integration.time_step > allowed:
        yield Finding(
            path=("irregularity", "wave_number"),
            value=defect.wave_number,
            reason="makes a defect so short that a wheel takes few steps over it",
            remedy=(
                f"Use time steps of at most {_rounded_down(allowed, 2):.2g} s to resolve its "
                "contact forces."
            ),
        )
