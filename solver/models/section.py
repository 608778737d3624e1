"""Cross-section of the deck: plates on their mid-lines, cut into elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import IntArray, IntVector, Matrix, Vector
from solver.models.ballasted_track import TrackProperties
from solver.models.mesh_level import MeshDensity
from solver.models.mesh_lines import merged, mirrored, subdivided
from solver.models.viaduct import ViaductProperties

__all__ = ["PARTS", "DeckSection", "deck_section", "section_node_count"]

PARTS = ("slab", "beam", "walls")
"""Names of the deck's parts, in the order of ``DeckSection.part``."""

_CLEAR = 0.05
"""No line at the rail if it is nearer than this to a web, a wall or the edge. [m]"""


@dataclass(frozen=True, kw_only=True)
class DeckSection:
    """Mid-lines of the cross-section.

    Attributes:
        nodes: Coordinates (y, z), shape (n_node, 2). [m]
        segments: Nodes of each element's side, shape (n_segment, 2).
        part: Part of each segment, a place in ``PARTS``, shape (n_segment,).
        thickness: Shape (n_segment,). [m]
        young_modulus: Shape (n_segment,). [Pa]
        slab: Nodes of the slab from right to left (y ascending).
        bottom: Nodes of the bottom plate, y ascending.
    """

    nodes: Matrix
    segments: IntArray
    part: IntVector
    thickness: Vector
    young_modulus: Vector
    slab: IntVector
    bottom: IntVector


def _slab_half(viaduct: ViaductProperties, track: TrackProperties, density: MeshDensity) -> Vector:
    """Lines of the slab at y >= 0: even between axis, web, wall and edge, one at the rail."""
    breaks = np.array([0.0, viaduct.web_position, viaduct.wall_position, 0.5 * viaduct.slab_width])
    counts = np.array([density.slab_centre, density.slab_gap, density.cantilever])
    plate = int(np.clip(np.searchsorted(breaks, track.rail_position), 1, len(breaks) - 1))
    share = (track.rail_position - breaks[plate - 1]) / (breaks[plate] - breaks[plate - 1])
    before = int(np.clip(round(share * counts[plate - 1]), 1, max(1, counts[plate - 1] - 1)))
    if min(share, 1.0 - share) * (breaks[plate] - breaks[plate - 1]) < _CLEAR:
        return subdivided(breaks, counts.tolist())
    after = max(1, int(counts[plate - 1]) - before)
    breaks = np.insert(breaks, plate, track.rail_position)
    counts = np.concatenate([counts[: plate - 1], [before, after], counts[plate:]])
    return subdivided(breaks, counts.tolist())


def _bottom_half(viaduct: ViaductProperties, density: MeshDensity) -> Vector:
    """Lines of the bottom plate at y >= 0, one of them at the bearings."""
    even = np.linspace(0.0, viaduct.web_position, max(1, density.bottom // 2) + 1)
    fixed = np.unique([0.0, viaduct.bearing_position, viaduct.web_position])
    return merged(fixed, even, keep_regular=False)


def section_node_count(
    viaduct: ViaductProperties, track: TrackProperties, density: MeshDensity
) -> int:
    """Nodes of the cross-section, without making it."""
    slab = 2 * len(_slab_half(viaduct, track, density)) - 1
    bottom = 2 * len(_bottom_half(viaduct, density)) - 1
    return slab + bottom + 2 * (density.web - 1) + 2 * density.wall


def deck_section(
    viaduct: ViaductProperties, track: TrackProperties, density: MeshDensity
) -> DeckSection:
    """Cuts the cross-section into elements.

    Args:
        viaduct: Its dimensions and materials.
        track: Where the rails are.
        density: Numbers of elements.

    Returns:
        The section.
    """
    slab_y = mirrored(_slab_half(viaduct, track, density))
    bottom_y = mirrored(_bottom_half(viaduct, density))
    bottom_z = 0.5 * viaduct.bottom_thickness
    nodes = [
        np.column_stack([slab_y, np.full(len(slab_y), viaduct.slab_level)]),
        np.column_stack([bottom_y, np.full(len(bottom_y), bottom_z)]),
    ]
    slab = np.arange(len(slab_y))
    bottom = len(slab_y) + np.arange(len(bottom_y))
    chains: list[tuple[IntVector, int]] = [(slab, 0), (bottom, 1)]
    next_node = len(slab_y) + len(bottom_y)
    for side, foot in ((-1, bottom[0]), (1, bottom[-1])):
        z = np.linspace(bottom_z, viaduct.slab_level, density.web + 1)[1:-1]
        head = slab[np.argmin(np.abs(slab_y - side * viaduct.web_position))]
        inner = next_node + np.arange(len(z))
        nodes.append(np.column_stack([np.full(len(z), side * viaduct.web_position), z]))
        chains.append((np.concatenate([[foot], inner, [head]]), 2))
        next_node += len(z)
    for side in (-1, 1):
        z = viaduct.slab_level + np.linspace(0.0, viaduct.wall_height, density.wall + 1)[1:]
        foot = slab[np.argmin(np.abs(slab_y - side * viaduct.wall_position))]
        nodes.append(np.column_stack([np.full(len(z), side * viaduct.wall_position), z]))
        chains.append((np.concatenate([[foot], next_node + np.arange(len(z))]), 3))
        next_node += len(z)
    return _assembled(viaduct, np.vstack(nodes), chains, slab, bottom)


def _assembled(
    viaduct: ViaductProperties,
    nodes: Matrix,
    chains: list[tuple[IntVector, int]],
    slab: IntVector,
    bottom: IntVector,
) -> DeckSection:
    """Joins the plates' chains of nodes; plates are slab, bottom, webs, walls."""
    segments = np.vstack([np.column_stack([chain[:-1], chain[1:]]) for chain, _ in chains])
    plate = np.concatenate([np.full(len(chain) - 1, kind) for chain, kind in chains])
    thickness = np.array(
        [
            viaduct.slab_thickness,
            viaduct.bottom_thickness,
            viaduct.web_thickness,
            viaduct.wall_thickness,
        ]
    )
    modulus = np.array(
        [
            viaduct.slab_modulus,
            viaduct.beam_modulus,
            viaduct.beam_modulus,
            viaduct.slab_modulus,
        ]
    )
    return DeckSection(
        nodes=nodes,
        segments=segments,
        part=np.array([0, 1, 1, 2])[plate],
        thickness=thickness[plate],
        young_modulus=modulus[plate],
        slab=slab,
        bottom=bottom,
    )
