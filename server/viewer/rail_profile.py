"""Rails with a section: a run stores only the top of the railhead, as a ribbon."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from server.viewer.surface import Surface
from solver.arrays import IntArray, Matrix, Vector

__all__ = ["SECTION_POINTS", "with_rail_section"]

_SECTION = ((0.0, 0.0), (0.0, 0.05), (-0.025, 0.065), (0.039, 0.172))
"""Spread beyond the head's edge and depth below its top of head, web and foot, after 60E1: head
72 mm, foot 150 mm, height 172 mm. [m]"""
SECTION_POINTS = len(_SECTION)
"""Vertices drawn for one of the ribbon."""


def with_rail_section(surface: Surface, vertices: Matrix) -> Surface:
    """Hangs a rail's section below a flat ribbon; it moves with the ribbon.

    Args:
        surface: Of the railheads; returned as it is unless all of it is level.
        vertices: Of the geometry at rest, shape (n_vertex, 3). [m]
    """
    corners = vertices[surface.vertices]
    levels = corners[surface.triangles][:, :, 2]
    if not len(levels) or float(np.ptp(levels, axis=1).max()) > 1e-6:
        return surface
    side, n = _sides(surface.triangles, corners), len(corners)
    edges = _edges_along(surface.triangles, side)
    triangles = [surface.triangles]
    for ring in range(len(_SECTION) - 1):
        upper, lower = edges + ring * n, edges + (ring + 1) * n
        triangles.append(np.column_stack((upper, lower[:, 1])))
        triangles.append(np.column_stack((upper[:, 0], lower[:, 1], lower[:, 0])))
    return replace(
        surface,
        vertices=np.tile(surface.vertices, len(_SECTION)),
        offsets=np.concatenate(
            [
                np.column_stack((np.zeros(n), side * spread, np.full(n, -depth)))
                for spread, depth in _SECTION
            ]
        ),
        triangles=np.concatenate(triangles),
    )


def _sides(triangles: IntArray, corners: Matrix) -> Vector:
    """On which edge of its ribbon each vertex lies: +1 for greater y, -1 for less."""
    lateral = corners[triangles][:, :, 1]
    middle = (lateral.min(axis=1) + lateral.max(axis=1)) / 2.0
    side = np.zeros(len(corners))
    side[triangles] = np.sign(lateral - middle[:, None])
    return side


def _edges_along(triangles: IntArray, side: Vector) -> IntArray:
    """Edges that follow the ribbon, each once, shape (n_edge, 2)."""
    edges = np.concatenate((triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]))
    along = edges[side[edges[:, 0]] == side[edges[:, 1]]]
    return np.unique(np.sort(along, axis=1), axis=0)
