"""Solids that the viewer draws many times: wheel, axle, bogie, carbody, box."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import IntArray, Matrix

__all__ = ["Solid", "axle", "bogie_frame", "carbody", "crossed_bars", "unit_box", "wheel"]


@dataclass(frozen=True, kw_only=True)
class Solid:
    """A closed triangulated surface.

    Attributes:
        vertices: Shape (n_vertex, 3). [m]
        triangles: Outward oriented, shape (n_triangle, 3).
    """

    vertices: Matrix
    triangles: IntArray


def wheel(radius: float, *, segments: int = 28) -> Solid:
    """A wheel about the y axis with tread, hub and a flange towards y < 0.

    Args:
        radius: Rolling radius. [m]
        segments: Sides of the circle.
    """
    flange, hub = radius + 0.03, 0.22 * radius
    profile = np.array(
        [
            (-0.070, 0.02),
            (-0.095, hub),
            (-0.045, 1.2 * hub),
            (-0.045, 0.82 * radius),
            (-0.068, 0.86 * radius),
            (-0.068, flange),
            (-0.040, flange),
            (-0.034, radius),
            (0.067, 0.985 * radius),
            (0.067, 0.86 * radius),
            (0.030, 0.82 * radius),
            (0.030, 1.2 * hub),
            (0.080, hub),
            (0.060, 0.02),
        ]
    )
    return _revolved(profile, segments)


def axle(radius: float) -> Solid:
    """A round bar along y of unit length, to be scaled to the gauge."""
    profile = np.array([(-0.5, 0.0), (-0.5, radius), (0.5, radius), (0.5, 0.0)])
    return _revolved(profile, 10)


def unit_box() -> Solid:
    """A cube of unit edges about the origin."""
    return _extruded(np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]))


def crossed_bars(*, size: float = 0.6) -> Solid:
    """An upright cross of two bars at 45 degrees, seen from the side: no contact.

    Args:
        size: Length of a bar. [m]
    """
    box, turn = unit_box(), float(np.sqrt(0.5))
    bar = box.vertices * np.array([size, 0.06, 0.09])
    x, y, z = bar.T
    arms = [np.column_stack((turn * (x - s * z), y, turn * (s * x + z))) for s in (1.0, -1.0)]
    return Solid(
        vertices=np.concatenate(arms),
        triangles=np.concatenate([box.triangles, box.triangles + len(box.vertices)]),
    )


def bogie_frame() -> Solid:
    """An H of two side beams and a transom in a unit cube, open over the wheels."""
    box = unit_box()
    parts = [
        (np.array([1.0, 0.09, 1.0]), np.array([0.0, 0.455, 0.0])),
        (np.array([1.0, 0.09, 1.0]), np.array([0.0, -0.455, 0.0])),
        (np.array([0.16, 0.82, 0.9]), np.zeros(3)),
    ]
    n = len(box.vertices)
    return Solid(
        vertices=np.concatenate([box.vertices * size + middle for size, middle in parts]),
        triangles=np.concatenate([box.triangles + n * i for i in range(len(parts))]),
    )


def carbody() -> Solid:
    """The outline of a coach in a unit cube: tumblehome sides and a rounded roof."""
    half = np.array(
        [(0.40, -0.5), (0.47, -0.42), (0.5, -0.05), (0.47, 0.22), (0.38, 0.40), (0.20, 0.5)]
    )
    return _extruded(np.concatenate((half, half[::-1] * np.array([-1.0, 1.0]))))


def _revolved(profile: Matrix, segments: int) -> Solid:
    """Turns a profile of (y, radius) about the y axis."""
    angle = np.arange(segments) * 2.0 * np.pi / segments
    rings = [
        np.column_stack((r * np.sin(angle), np.full(segments, y), r * np.cos(angle)))
        for y, r in profile
    ]
    here = np.arange(segments)
    onward = (here + 1) % segments
    triangles: list[IntArray] = []
    for ring in range(len(profile) - 1):
        a, b = ring * segments + here, ring * segments + onward
        c, d = b + segments, a + segments
        triangles += [np.column_stack((a, b, c)), np.column_stack((a, c, d))]
    return Solid(vertices=np.concatenate(rings), triangles=np.concatenate(triangles))


def _extruded(section: Matrix) -> Solid:
    """Extends a convex section of (y, z), anticlockwise seen from +x, over -0.5 < x < 0.5."""
    n = len(section)
    ends = [np.column_stack((np.full(n, x), section)) for x in (-0.5, 0.5)]
    here = np.arange(n)
    onward = (here + 1) % n
    sides = [
        np.column_stack((here, onward, onward + n)),
        np.column_stack((here, onward + n, here + n)),
    ]
    fan = np.column_stack((np.zeros(n - 2, dtype=np.int64), here[1:-1], here[2:]))
    caps = [fan[:, ::-1], fan + n]
    return Solid(vertices=np.concatenate(ends), triangles=np.concatenate(sides + caps))
