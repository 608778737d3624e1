"""What forbids a measured profile: samples out of order, a start on its slope, a place too far."""

from __future__ import annotations

import math
from collections.abc import Iterator

from solver.irregularities import MeasuredProfile, disorder
from solver.studies.bounds import Finding
from solver.studies.crossing import train_length
from solver.studies.study import Study

__all__ = ["profile", "sample_order", "sample_order_of"]

_LONGEST_RUN_IN = 2000.0
"""As ``Extent.run_in`` is bounded. [m]"""


def sample_order(measured: MeasuredProfile) -> Iterator[Finding]:
    """Samples must follow each other: so much holds without a study around the profile.

    Args:
        measured: The profile, its values within their bounds.
    """
    yield from map(Finding.of, disorder([sample.position for sample in measured.samples]))


def sample_order_of(study: Study) -> Iterator[Finding]:
    """Samples must follow each other, whatever else is the matter with the study."""
    if isinstance(study.irregularity, MeasuredProfile):
        yield from sample_order(study.irregularity)


def profile(study: Study) -> Iterator[Finding]:
    """A measured profile must be in order, lie where wheels roll, and away from the train's start.

    The train stands still at t = 0 and rolls from then on: on a slope the rails would strike it.
    """
    measured = study.irregularity
    if not isinstance(measured, MeasuredProfile):
        return
    disordered = list(sample_order(measured))
    yield from disordered or _place(study, measured)


def _place(study: Study, measured: MeasuredProfile) -> Iterator[Finding]:
    first = measured.samples[0].position
    begin, start = first - measured.fade, 0.0 - study.extent.run_in
    last = study.viaduct.length + train_length(study)
    path = ("irregularity", "samples", 0, "position")
    if begin < start and not measured.is_level:
        needed = math.ceil(-10.0 * begin - 1e-6) / 10.0
        yield Finding(
            path=path,
            value=first,
            reason=(
                f"lets the rails leave zero at x = {begin:.1f} m, before the train's start at "
                f"x = {start:.1f} m: wheels that start on a slope are struck by it"
            ),
            remedy=(
                f"Begin the samples at x = {start + measured.fade:.1f} m or beyond"
                + (
                    f", make the fade shorter, or lengthen the run-in to {needed:g} m."
                    if needed <= _LONGEST_RUN_IN
                    else ": the first span starts at x = 0."
                )
            ),
        )
    if first > last:
        yield Finding(
            path=path,
            value=first,
            reason="lies beyond the end of the crossing",
            remedy=f"Begin the samples before x = {last:.1f} m; the first span starts at x = 0.",
        )
