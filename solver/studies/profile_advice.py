"""What to know of a measured profile before a run, and what its samples can hold."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from solver.arrays import Vector
from solver.irregularities import MeasuredProfile, SampledProfile
from solver.models.beam_bridge import BeamBridge
from solver.models.train_model import WHEEL_RADIUS
from solver.studies.bounds import Finding
from solver.studies.rules import rounded_down
from solver.studies.study import Study

__all__ = ["profile_advice", "shortest_wave"]

_STEPS_PER_SPACING = 2.0
"""Steps that a wheel takes from sample to sample: four over the shortest wave that is held."""
_LOOKED_AT = 30.0
"""The least cut-off of a deck's acceleration (EN 1990:2002/A1 A2.4.4.2.1(4)). [Hz]"""
_EVENEST = 0.05e-3
"""Lower profiles are under what track recording cars resolve. [m]"""
_FADE_BEND = 10.0 / 3.0**0.5
"""Greatest curvature of the fall S(t) = 1 - 10 t^3 + 15 t^4 - 6 t^5, at t = (3 - sqrt 3) / 6."""


def profile_advice(study: Study) -> Iterator[Finding]:
    """What a user should know of a measured profile that nothing forbids.

    Args:
        study: The study; nothing is said of other irregularities.
    """
    measured = study.irregularity
    if not isinstance(measured, MeasuredProfile):
        return
    if measured.is_level:
        yield _of_samples(
            measured, "are all zero: the rails are perfect", "Paste the measured elevations."
        )
        return
    yield from _flat(measured)
    yield from _one_path(study, measured)
    yield from _time_step(study, measured)
    yield from _wide_spacing(study, measured)
    yield from _dips(measured)
    yield from _fade(measured)


def shortest_wave(measured: MeasuredProfile) -> float:
    """The shortest wave that a profile holds: two of its median spacings. [m]"""
    return 2.0 * float(np.median(np.diff(measured.positions)))


def _of_samples(measured: MeasuredProfile, reason: str, remedy: str) -> Finding:
    path = ("irregularity", "samples")
    return Finding(path=path, value=len(measured.samples), reason=reason, remedy=remedy)


def _flat(measured: MeasuredProfile) -> Iterator[Finding]:
    """No rail is so even: metres pasted for millimetres are a thousand times too small."""
    highest = float(abs(measured.elevations).max())
    if highest < _EVENEST:
        yield _of_samples(
            measured,
            f"are at most {1e3 * highest:.2g} mm high: were metres given for millimetres?",
            "Give elevations in millimetres.",
        )


def _one_path(study: Study, measured: MeasuredProfile) -> Iterator[Finding]:
    """The one path of a plain beam counts as the left rail."""
    left, right = measured.elevations
    if isinstance(study.viaduct, BeamBridge) and not np.array_equal(left, right):
        yield _of_samples(
            measured,
            "differ between the rails: wheels on a plain beam read the left rail only",
            "Give what they shall roll on as the left rail's.",
        )


def _time_step(study: Study, measured: MeasuredProfile) -> Iterator[Finding]:
    """A wheel must feel each sample."""
    spacing, fastest = 0.5 * shortest_wave(measured), max(study.sweep.speeds)
    step, allowed = study.integration.time_step, spacing / (_STEPS_PER_SPACING * fastest)
    if step > allowed * (1.0 + 1e-9):
        yield Finding(
            path=("integration", "time_step"),
            value=step,
            reason=(
                f"is coarse for the profile: a wheel at {3.6 * fastest:.0f} km/h moves "
                f"{1e3 * fastest * step:.3g} mm a step, over samples {1e3 * spacing:.3g} mm apart"
            ),
            remedy=f"Use {rounded_down(allowed):.3g} s or less to feel every sample.",
        )


def _wide_spacing(study: Study, measured: MeasuredProfile) -> Iterator[Finding]:
    """Waves shorter than two spacings are not in the samples."""
    asked = study.outputs.cut_off_frequency or _LOOKED_AT
    slowest, wave = min(study.sweep.speeds), shortest_wave(measured)
    if slowest / wave < asked:
        yield _of_samples(
            measured,
            f"lie {0.5 * wave:.3g} m apart: waves under {wave:.3g} m are not in them, at "
            f"{3.6 * slowest:.0f} km/h all that a wheel would feel above {slowest / wave:.3g} Hz; "
            f"accelerations are looked at up to {asked:g} Hz",
            f"Measure every {rounded_down(0.5 * slowest / asked, 2):.2g} m or closer.",
        )


def _dips(measured: MeasuredProfile) -> Iterator[Finding]:
    """Where a rail is hollower than a wheel is round, the wheel bridges it."""
    for name, bends in zip(("left", "right"), _curvatures(measured), strict=True):
        worst = int(np.argmax(bends))
        if bends[worst] > 1.0 / WHEEL_RADIUS:
            sample = measured.samples[worst]
            yield Finding(
                path=("irregularity", "samples", worst, name),
                value=getattr(sample, name),
                reason=(
                    f"lies in a dip of radius {1e3 / bends[worst]:.3g} mm at "
                    f"x = {sample.position:.2f} m: a wheel of {1e3 * WHEEL_RADIUS:g} mm bridges it"
                ),
                remedy="Correct the sample, or filter the profile to longer waves.",
            )


def _fade(measured: MeasuredProfile) -> Iterator[Finding]:
    """The way back to zero is no measurement: it should be gentler than what was measured."""
    ends = measured.elevations[:, [0, -1]]
    height = float(abs(ends).max())
    bend = _FADE_BEND * height / measured.fade**2
    if bend > max(float(abs(bends).max()) for bends in _curvatures(measured)):
        yield Finding(
            path=("irregularity", "fade"),
            value=measured.fade,
            reason=(
                f"bends the rails more than the samples do: it comes back from "
                f"{1e3 * height:.3g} mm"
            ),
            remedy="Use a longer fade, or samples that begin and end near zero.",
        )


def _curvatures(measured: MeasuredProfile) -> tuple[Vector, Vector]:
    """r'' of both rails at the samples, between which that of a cubic spline is linear. [1/m]"""
    x, fade = measured.positions, measured.fade
    left, right = (
        SampledProfile(positions=x, elevations=rail, fade=fade).curvature(x)
        for rail in measured.elevations
    )
    return left, right
