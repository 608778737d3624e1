"""What stands around the model, for the eye only: piers and rails that nobody computes."""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray, Matrix
from solver.results import Geometry

__all__ = ["RAILS_BEYOND", "piers", "rigid_rails"]

RAILS_BEYOND = 10.0
"""Rigid rails end this far beyond the train and the model. [m]"""

_PIER_DEPTH = 3.0
_PIER_LENGTH = 1.0
_NARROWEST_PIER = 1.0
_GAP = 0.25
"""Between the deck's lowest point and the top of a pier, so that they do not flicker. [m]"""


def piers(geometry: Geometry) -> tuple[Matrix, Matrix]:
    """Boxes under the ends of the spans.

    Args:
        geometry: Of the run.

    Returns:
        Centres and sizes, shapes (n, 3); none without spans and a surface. [m]
    """
    if not len(geometry.spans) or not len(geometry.vertices):
        return np.empty((0, 3)), np.empty((0, 3))
    ends = np.unique(np.round(geometry.spans, 3))
    within = _on_the_spans(geometry.vertices, geometry.spans)
    width = max(0.6 * float(np.ptp(within[:, 1])), _NARROWEST_PIER)
    middle = float(within[:, 2].min()) - _GAP - _PIER_DEPTH / 2.0
    centres = np.column_stack((ends, np.zeros(len(ends)), np.full(len(ends), middle)))
    return centres, np.tile([_PIER_LENGTH, width, _PIER_DEPTH], (len(ends), 1))


def rigid_rails(geometry: Geometry, first_axle: float) -> FloatArray:
    """Rails before and behind what is modelled, or below a train that stands alone.

    Args:
        geometry: Of the run.
        first_axle: x of the first axle. [m]

    Returns:
        Ends on top of the rails, shape (n, 2, 3); none without wheels. [m]
    """
    wheels = geometry.wheels
    if not wheels.names:
        return np.empty((0, 2, 3))
    reach = RAILS_BEYOND - float(wheels.offsets.min())
    pieces = [(first_axle - reach, first_axle + RAILS_BEYOND)]
    if len(geometry.vertices):
        along = geometry.vertices[:, 0]
        low, high = float(along.min()), float(along.max())
        pieces = [(low - reach, low), (high, high + reach)]
    z = wheels.contact_height
    sides = np.unique(wheels.lateral).tolist()
    return np.array([[(a, y, z), (b, y, z)] for a, b in pieces for y in sides])


def _on_the_spans(vertices: Matrix, spans: Matrix) -> Matrix:
    """Vertices on the spans, without embankments."""
    inside = (vertices[:, 0] >= spans.min() - 1e-6) & (vertices[:, 0] <= spans.max() + 1e-6)
    return vertices[inside] if inside.any() else vertices
