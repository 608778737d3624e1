"""Irregularities of the rails: their properties, and one function object a rail."""

from __future__ import annotations

from typing import TypeAlias

from solver.irregularities.isolated import BellShapedDefect, IsolatedDefect
from solver.irregularities.measured import (
    MeasuredProfile,
    ProfileSample,
    SampledProfile,
    disorder,
)
from solver.irregularities.none import NoIrregularity, PerfectRail
from solver.irregularities.profile import RailIrregularity

__all__ = [
    "BellShapedDefect",
    "Irregularity",
    "IsolatedDefect",
    "MeasuredProfile",
    "NoIrregularity",
    "PerfectRail",
    "ProfileSample",
    "RailIrregularity",
    "SampledProfile",
    "describe",
    "disorder",
    "rail_irregularities",
]

Irregularity: TypeAlias = NoIrregularity | IsolatedDefect | MeasuredProfile
"""Every kind of irregularity, told apart by its ``type``."""


def rail_irregularities(properties: Irregularity) -> tuple[RailIrregularity, RailIrregularity]:
    """The function object of each rail.

    Args:
        properties: What kind of irregularity, where and how large.

    Returns:
        Left rail and right rail, in the order of the rail index.

    Raises:
        InputError: Samples of a measured profile are out of order.
    """
    if isinstance(properties, NoIrregularity):
        return PerfectRail(), PerfectRail()
    if isinstance(properties, MeasuredProfile):
        left, right = (_sampled(properties, rail) for rail in range(2))
        return left, right
    defect = BellShapedDefect(
        amplitude=properties.amplitude,
        wave_number=properties.wave_number,
        centre=properties.position,
    )
    return (
        PerfectRail() if properties.rail == "right" else defect,
        PerfectRail() if properties.rail == "left" else defect,
    )


def _sampled(profile: MeasuredProfile, rail: int) -> RailIrregularity:
    elevations = profile.elevations[rail]
    if not elevations.any():
        return PerfectRail()
    return SampledProfile(positions=profile.positions, elevations=elevations, fade=profile.fade)


def describe(properties: Irregularity) -> str:
    """A phrase for verdicts and titles.

    Args:
        properties: The irregularity.

    Returns:
        For example ``isolated defect of 10 mm at x = 27.0 m on the right rail``.
    """
    if isinstance(properties, NoIrregularity):
        return "no irregularities"
    if isinstance(properties, MeasuredProfile):
        return _measured(properties)
    rail = "both rails" if properties.rail == "both" else f"the {properties.rail} rail"
    return (
        f"isolated defect of {1e3 * properties.amplitude:.3g} mm "
        f"at x = {properties.position:.1f} m on {rail}"
    )


def _measured(profile: MeasuredProfile) -> str:
    x, heights = profile.positions, abs(profile.elevations).max(axis=1)
    left, right = (f"{1e3 * height:.3g}" for height in heights)
    rail = "the left rail" if heights[0] > heights[1] else "the right rail"
    if left == right:
        rail = "either rail"
    most = f"at most {1e3 * heights.max():.3g} mm on {rail}" if heights.any() else "all zero"
    return f"measured profile of {x.size} samples, x = {x[0]:.1f} to {x[-1]:.1f} m, {most}"
