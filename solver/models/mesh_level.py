"""Mesh levels: how many elements each part of the structure gets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from solver.errors import InputError

__all__ = ["MESH_LEVELS", "MeshDensity", "MeshLevel", "mesh_density"]

MeshLevel = Literal["coarse", "standard", "fine"]


@dataclass(frozen=True, kw_only=True)
class MeshDensity:
    """Numbers of elements.

    Attributes:
        sleeper: Along the track, in the width of a sleeper.
        crib: Along the track, between two sleepers.
        edge_ratio: Length of the ballast's element beside a sleeper over its neighbour's: the
            sleeper's edge concentrates the pressure.
        between_rails: Across, from rail to rail.
        outside_rails: Across, from a rail to the sleeper's end.
        shoulder: Across, from the sleeper's end to the ballast's side.
        ballast_layers: In the ballast's depth.
        joint_layers: In the ballast's depth beside a joint, a multiple of ``ballast_layers``. The
            strip of ballast that bridges a joint couples the spans: one layer there would raise
            the first frequencies by half a percent, and the resonant response by several.
        sleeper_layers: In a sleeper's height.
        deck_length: Greatest length of a shell along the track. [m]
        slab_centre: Across, from the axis to a web.
        slab_gap: Across, from a web to a wall.
        cantilever: Across, from a wall to the slab's edge.
        web: In a web's height.
        bottom: Across the bottom plate.
        wall: In a wall's height.
    """

    sleeper: int
    crib: int
    edge_ratio: float
    between_rails: int
    outside_rails: int
    shoulder: int
    ballast_layers: int
    joint_layers: int
    sleeper_layers: int
    deck_length: float
    slab_centre: int
    slab_gap: int
    cantilever: int
    web: int
    bottom: int
    wall: int


MESH_LEVELS: dict[MeshLevel, MeshDensity] = {
    "coarse": MeshDensity(
        sleeper=1,
        crib=2,
        edge_ratio=1.0,
        between_rails=1,
        outside_rails=1,
        shoulder=1,
        ballast_layers=1,
        joint_layers=3,
        sleeper_layers=1,
        deck_length=0.74,
        slab_centre=2,
        slab_gap=1,
        cantilever=1,
        web=2,
        bottom=4,
        wall=1,
    ),
    "standard": MeshDensity(
        sleeper=2,
        crib=4,
        edge_ratio=0.33,
        between_rails=4,
        outside_rails=2,
        shoulder=2,
        ballast_layers=2,
        joint_layers=2,
        sleeper_layers=1,
        deck_length=0.3,
        slab_centre=4,
        slab_gap=2,
        cantilever=2,
        web=4,
        bottom=6,
        wall=2,
    ),
    "fine": MeshDensity(
        sleeper=2,
        crib=5,
        edge_ratio=0.33,
        between_rails=6,
        outside_rails=2,
        shoulder=3,
        ballast_layers=3,
        joint_layers=3,
        sleeper_layers=1,
        deck_length=0.2,
        slab_centre=6,
        slab_gap=2,
        cantilever=3,
        web=5,
        bottom=8,
        wall=3,
    ),
}
"""The levels by name."""


def mesh_density(level: MeshLevel) -> MeshDensity:
    """The numbers of elements of a level.

    Raises:
        InputError: There is no such level.
    """
    if level not in MESH_LEVELS:
        raise InputError(
            "mesh_level", level, "is not a mesh level", f"Choose one of {', '.join(MESH_LEVELS)}."
        )
    return MESH_LEVELS[level]
