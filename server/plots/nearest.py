"""The point of the deck, or of what is drawn, that lies nearest to where somebody pointed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from server.plots.request import Place
from server.plots.source import PlanSource
from server.plots.text import coordinate
from solver.arrays import Matrix

__all__ = ["Nearest", "nearest_slab_point", "nearest_vertex"]


@dataclass(frozen=True, kw_only=True)
class Nearest:
    """A point that a run knows.

    Attributes:
        index: Of the slab's point or of the vertex.
        place: Its x, y, z. [m]
        distance: From where somebody pointed. [m]
        part: What it belongs to, for example ``slab`` or ``rails``.
    """

    index: int
    place: Place
    distance: float
    part: str

    @property
    def words(self) -> str:
        """What and where it is."""
        x, y, z = (coordinate(value, 2) for value in self.place)
        return f"{self.part} at x = {x} m, y = {y} m, z = {z} m"

    @property
    def distance_words(self) -> str:
        """How far it is from where somebody pointed."""
        return f"{self.distance:.2f} m from the place asked for"


def nearest_slab_point(plan: PlanSource, place: Place) -> Nearest | None:
    """The slab's point below or above a place: heights count only between equals."""
    coordinates = plan.slab.coordinates
    if not len(coordinates):
        return None
    part = "slab" if plan.slab.judged_spans else "deck"
    return _nearest(coordinates, np.array([1.0, 1.0, 1e-3]), place, part)


def nearest_vertex(plan: PlanSource, place: Place) -> Nearest | None:
    """The vertex of the drawn surface that is nearest to a place in space."""
    geometry = plan.geometry
    if not len(geometry.vertices):
        return None
    found = _nearest(geometry.vertices, np.ones(3), place, "surface")
    for layer in geometry.layers:
        if (layer.faces == found.index).any():
            return Nearest(
                index=found.index, place=found.place, distance=found.distance, part=layer.name
            )
    return found


def _nearest(coordinates: Matrix, weights: Matrix, place: Place, part: str) -> Nearest:
    apart = coordinates - np.asarray(place)
    index = int(np.argmin(np.linalg.norm(apart * weights, axis=1)))
    x, y, z = coordinates[index].tolist()
    distance = float(np.linalg.norm(apart[index] * (weights >= 1.0)))
    return Nearest(index=index, place=(x, y, z), distance=distance, part=part)
