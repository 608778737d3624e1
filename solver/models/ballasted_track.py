"""Ballasted track: rails, pads, sleepers, ballast; the defaults are those of the Alverca viaduct.

Sources: Neves (2016), tables 6.5 to 6.7, figures 6.13 and 6.14, sections 6.3.2, 6.3.5 and 7.3.1.
The ballast is one block of full width, the sleepers stand on it, and nothing fills the cribs: the
only reading that reproduces all counts of table 6.9.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Ge, Gt, Le

from solver.arrays import Vector
from solver.errors import InputError
from solver.units import Units

__all__ = ["TrackProperties", "pad_stiffness", "seat_positions", "track_ends"]


@dataclass(frozen=True, kw_only=True)
class TrackProperties:
    """Geometry, materials and damping of the track."""

    __pydantic_config__: ClassVar[dict[str, Any]] = {
        "extra": "forbid",
        "use_attribute_docstrings": True,
    }

    type: Literal["ballasted"] = "ballasted"
    """Kind of track."""

    rail_position: Annotated[float, Units.length, Ge(0.3), Le(1.2)] = 0.7175
    """Distance of a rail's axis from the track's axis."""
    rail_young_modulus: Annotated[float, Units.young_modulus, Ge(1e10), Le(1e12)] = 210e9
    """Modulus of elasticity of the rail."""
    rail_second_moment: Annotated[float, Units.second_moment, Ge(1e-7), Le(1e-3)] = 3038.3e-8
    """Second moment of area of the rail about its horizontal axis."""
    rail_area: Annotated[float, Units.area, Ge(1e-4), Le(1e-1)] = 76.70e-4
    """Cross-sectional area of the rail."""
    rail_density: Annotated[float, Units.density, Ge(500.0), Le(20000.0)] = 7850.0
    """Density of the rail."""
    pad_stiffness: Annotated[float, Units.stiffness, Ge(1e6), Le(1e11)] = 500e6
    """Vertical stiffness of one rail pad."""
    pad_damping: Annotated[float, Units.damping, Ge(0.0), Le(1e8)] = 200e3
    """Vertical damping of one rail pad."""
    transition: bool = True
    """Whether the pads soften towards the viaduct, before and after it."""
    transition_length: Annotated[float, Units.length, Ge(0.5), Le(100.0)] = 6.0
    """Length of each transition zone."""
    transition_stiffness: Annotated[float, Units.stiffness, Ge(1e6), Le(1e11)] = 125e6
    """Vertical stiffness of a pad at the viaduct's end of a transition zone."""
    sleeper_spacing: Annotated[float, Units.length, Ge(0.4), Le(1.2)] = 0.6
    """Distance between the axes of sleepers."""
    sleeper_phase: Annotated[float, Units.length, Ge(0.0), Le(1.2)] = 0.0
    """Position of one sleeper, from the start of the first span."""
    sleeper_length: Annotated[float, Units.length, Ge(1.5), Le(4.0)] = 2.60
    """Length of a sleeper's base."""
    sleeper_top_length: Annotated[float, Units.length, Ge(1.5), Le(4.0)] = 2.55
    """Length of a sleeper's top."""
    sleeper_width: Annotated[float, Units.length, Ge(0.05), Le(0.35)] = 0.20
    """Width of a sleeper's base, along the track."""
    sleeper_top_width: Annotated[float, Units.length, Ge(0.05), Le(0.35)] = 0.15
    """Width of a sleeper's top, along the track."""
    sleeper_height: Annotated[float, Units.length, Ge(0.05), Le(0.5)] = 0.23
    """Height of a sleeper."""
    sleeper_young_modulus: Annotated[float, Units.young_modulus, Ge(1e9), Le(1e12)] = 36e9
    """Modulus of elasticity of a sleeper."""
    sleeper_poisson_ratio: Annotated[float, Units.none, Ge(0.0), Le(0.45)] = 0.2
    """Poisson's ratio of a sleeper."""
    sleeper_density: Annotated[float, Units.density, Ge(100.0), Le(10000.0)] = 2890.0
    """Density of a sleeper."""
    ballast_width: Annotated[float, Units.length, Ge(2.0), Le(10.0)] = 4.30
    """Width of the ballast."""
    ballast_depth: Annotated[float, Units.length, Ge(0.05), Le(2.0)] = 0.313
    """Depth of the ballast under the sleepers."""
    ballast_young_modulus: Annotated[float, Units.young_modulus, Ge(1e6), Le(1e10)] = 145e6
    """Modulus of elasticity of the ballast."""
    ballast_poisson_ratio: Annotated[float, Units.none, Ge(0.0), Le(0.45)] = 0.15
    """Poisson's ratio of the ballast."""
    ballast_density: Annotated[float, Units.density, Ge(100.0), Le(5000.0)] = 2039.0
    """Density of the ballast."""
    mass_damping: Annotated[float, Units.mass_damping, Ge(0.0), Le(1000.0)] = 21.7
    """Rayleigh damping proportional to mass."""
    stiffness_damping: Annotated[float, Units.stiffness_damping, Ge(0.0), Le(0.1)] = 3.82e-5
    """Rayleigh damping proportional to stiffness."""
    embankment_length: Annotated[float, Units.length, Gt(0.0), Le(200.0)] = 18.0
    """Length of three-dimensional track before the first span, to its first sleeper."""

    def __post_init__(self) -> None:
        _check(self)


def _check(track: TrackProperties) -> None:
    """Relations between fields that make a track possible."""
    order = (
        ("sleeper_phase", track.sleeper_phase, track.sleeper_spacing - 1e-6, "the spacing"),
        ("sleeper_length", track.sleeper_length, track.ballast_width - 0.1, "the ballast"),
        ("sleeper_top_length", track.sleeper_top_length, track.sleeper_length, "the base"),
        ("sleeper_top_width", track.sleeper_top_width, track.sleeper_width, "the base"),
        (
            "rail_position",
            track.rail_position,
            0.5 * track.sleeper_top_length - 0.05,
            "the sleeper's top",
        ),
    )
    for field, value, greatest, container in order:
        if value > greatest + 1e-9:
            raise InputError(
                f"track.{field}",
                value,
                f"must be at most {greatest:.4g} m to lie within {container}",
                "Change one of the two.",
            )


def seat_positions(track: TrackProperties, viaduct_length: float) -> Vector:
    """Positions of the sleepers of the three-dimensional track.

    From the embankment's first sleeper to the last one that stands wholly on the last span.

    Args:
        track: The track.
        viaduct_length: Length of all spans. [m]

    Returns:
        Shape (n_seat,). [m]
    """
    tolerance = 1e-6
    start = -track.embankment_length - track.sleeper_phase
    end = viaduct_length - 0.5 * track.sleeper_width - track.sleeper_phase
    first = int(np.ceil(start / track.sleeper_spacing - tolerance))
    last = int(np.floor(end / track.sleeper_spacing + tolerance))
    return track.sleeper_phase + track.sleeper_spacing * np.arange(first, last + 1)


def track_ends(track: TrackProperties, viaduct_length: float) -> tuple[float, float]:
    """Where the three-dimensional ballast starts and ends: half a bay beyond the last sleepers.

    Args:
        track: The track.
        viaduct_length: Length of all spans, where the ballast ends at the latest. [m]

    Returns:
        Start and end. [m]
    """
    seats = seat_positions(track, viaduct_length)
    half_bay = 0.5 * track.sleeper_spacing
    return float(seats[0]) - half_bay, min(float(seats[-1]) + half_bay, viaduct_length)


def pad_stiffness(track: TrackProperties, viaduct_length: float, positions: Vector) -> Vector:
    """Stiffness of the pads at these positions, softer towards the viaduct if so chosen.

    Args:
        track: The track.
        viaduct_length: Length of all spans. [m]
        positions: Along the track, on the viaduct and beyond it, shape (n,). [m]

    Returns:
        Shape (n,). [N/m]

    References:
        Neves (2016), section 7.3.1: linear from 500 to 125 MN/m over 6 m before and after.
    """
    stiffness = np.full(len(positions), track.pad_stiffness)
    if not track.transition:
        return stiffness
    outside = np.maximum(-positions, positions - viaduct_length)
    zone = (outside >= -1e-9) & (outside < track.transition_length)
    share = outside[zone] / track.transition_length
    change = track.pad_stiffness - track.transition_stiffness
    stiffness[zone] = track.transition_stiffness + change * share
    return stiffness
