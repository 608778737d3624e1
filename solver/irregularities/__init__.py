"""Irregularities of the rails: their properties, and one function object a rail."""

from __future__ import annotations

from typing import TypeAlias

from solver.irregularities.isolated import BellShapedDefect, IsolatedDefect
from solver.irregularities.none import NoIrregularity, PerfectRail
from solver.irregularities.profile import RailIrregularity

__all__ = [
    "BellShapedDefect",
    "Irregularity",
    "IsolatedDefect",
    "NoIrregularity",
    "PerfectRail",
    "RailIrregularity",
    "describe",
    "rail_irregularities",
]

Irregularity: TypeAlias = NoIrregularity | IsolatedDefect
"""Every kind of irregularity, told apart by its ``type``."""


def rail_irregularities(properties: Irregularity) -> tuple[RailIrregularity, RailIrregularity]:
    """The function object of each rail.

    Args:
        properties: What kind of irregularity, where and how large.

    Returns:
        Left rail and right rail, in the order of the rail index.
    """
    if isinstance(properties, NoIrregularity):
        return PerfectRail(), PerfectRail()
    defect = BellShapedDefect(
        amplitude=properties.amplitude,
        wave_number=properties.wave_number,
        centre=properties.position,
    )
    return (
        PerfectRail() if properties.rail == "right" else defect,
        PerfectRail() if properties.rail == "left" else defect,
    )


def describe(properties: Irregularity) -> str:
    """A phrase for verdicts and titles.

    Args:
        properties: The irregularity.

    Returns:
        For example ``isolated defect of 10 mm at x = 27.0 m on the right rail``.
    """
    if isinstance(properties, NoIrregularity):
        return "no irregularities"
    rail = "both rails" if properties.rail == "both" else f"the {properties.rail} rail"
    return (
        f"isolated defect of {1e3 * properties.amplitude:.3g} mm "
        f"at x = {properties.position:.1f} m on {rail}"
    )
