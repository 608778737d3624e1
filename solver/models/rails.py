"""The two rails over the whole path: three-dimensional track and two-dimensional approaches.

On the structure the rails rest on its seats (the coupling adds those pads); before and after it
each rail has its own two-dimensional track: pad, sleeper mass, bed spring and dashpot to ground.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from annotated_types import Ge, Le

from solver.arrays import IntVector, Vector
from solver.models.ballasted_track import TrackProperties, pad_stiffness
from solver.models.beam_line import BeamLine, Sleepers
from solver.models.mesh_level import MeshLevel
from solver.units import Units

__all__ = ["ELEMENTS_PER_BAY", "ApproachTrack", "rail_line", "sleeper_line"]

ELEMENTS_PER_BAY: dict[MeshLevel, int] = {"coarse": 2, "standard": 4, "fine": 8}
"""Beam elements of a rail between two sleepers. One would reverse the stiffness variation along
the bay (modelling decision "Track")."""


@dataclass(frozen=True, kw_only=True)
class ApproachTrack:
    """The two-dimensional track before and after the structure, for one rail.

    The mass and damping are those of Neves (2016), section 6.4.1 (103.8 kg and 11930 N s/m, in the
    text above table 6.10), doubled: as printed they contradict the thesis's own figures 6.24, 6.30
    and 6.41, doubled they agree. The stiffness (printed: 0.935e8 N/m) is matched to the
    three-dimensional track unless it is given.
    """

    __pydantic_config__: ClassVar[dict[str, Any]] = {
        "extra": "forbid",
        "use_attribute_docstrings": True,
    }

    bed_stiffness: Annotated[float, Units.stiffness, Ge(0.0), Le(1e11)] = 0.0
    """Stiffness under a sleeper, one rail's share; 0 matches it to the three-dimensional track."""
    sleeper_mass: Annotated[float, Units.small_mass, Ge(1.0), Le(1e4)] = 207.6
    """Mass of sleeper and ballast that move together, one rail's share."""
    bed_damping: Annotated[float, Units.damping, Ge(0.0), Le(1e8)] = 23860.0
    """Damping under a sleeper, one rail's share."""
    length: Annotated[float, Units.length, Ge(0.0), Le(5000.0)] = 0.0
    """Length of track before and after the structure; 0 takes what train and speed need."""


def sleeper_line(track: TrackProperties, start: float, end: float) -> Vector:
    """Sleepers of the whole path, shape (n_sleeper,), covering start to end. [m]"""
    spacing, phase = track.sleeper_spacing, track.sleeper_phase
    first = int(np.floor((start - phase) / spacing))
    last = int(np.ceil((end - phase) / spacing))
    return phase + spacing * np.arange(first, last + 1)


def rail_line(
    track: TrackProperties,
    approach: ApproachTrack,
    elements_per_bay: int,
    seats: Vector,
    viaduct_length: float,
    start: float,
    end: float,
) -> tuple[BeamLine, IntVector]:
    """Both rails from ``start`` to ``end``.

    Args:
        track: Rail section, pads, sleeper spacing.
        approach: The two-dimensional track; its bed stiffness must be set.
        elements_per_bay: Beam elements of a rail between two sleepers.
        seats: x of the structure's seats, consecutive sleepers, shape (n_seat,). [m]
        viaduct_length: Where the pads' transition after the viaduct begins. [m]
        start: Beginning of the path. [m]
        end: End of the path. [m]

    Returns:
        The line (two of them, side by side), and the nodes above the structure's seats.
    """
    sleepers = sleeper_line(track, start, end)
    per_bay = elements_per_bay
    n_node = (sleepers.size - 1) * per_bay + 1
    positions = sleepers[0] + track.sleeper_spacing / per_bay * np.arange(n_node)
    # Seats must coincide with nodes to the last bit: they are found by number, not by position.
    first_seat = round((seats[0] - sleepers[0]) / track.sleeper_spacing) if seats.size else 0
    seat_nodes = per_bay * (first_seat + np.arange(seats.size))
    outside = np.ones(sleepers.size, dtype=bool)
    outside[first_seat : first_seat + seats.size] = False
    n_outside = int(outside.sum())
    below = Sleepers(
        nodes=per_bay * np.flatnonzero(outside),
        pad_stiffness=pad_stiffness(track, viaduct_length, sleepers[outside]),
        pad_damping=np.full(n_outside, track.pad_damping),
        mass=approach.sleeper_mass,
        bed_stiffness=approach.bed_stiffness,
        bed_damping=approach.bed_damping,
    )
    line = BeamLine.build(
        positions=positions,
        rigidity=np.full(n_node - 1, track.rail_young_modulus * track.rail_second_moment),
        mass_per_length=np.full(n_node - 1, track.rail_area * track.rail_density),
        free=np.ones((n_node, 2), dtype=bool),
        n_line=2,
        sleepers=below if n_outside else None,
    )
    return line, seat_nodes.astype(np.int64)
