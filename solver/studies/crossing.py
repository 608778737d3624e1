"""The extent of a crossing, or of what a modal analysis looks at, and how many steps it takes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from solver.models.ballasted_track import TrackProperties, track_ends
from solver.models.beam_bridge import BeamBridge
from solver.models.rails import ELEMENTS_PER_BAY
from solver.models.train import ArticulatedTrain, AxleTable
from solver.models.train_layout import lay_out
from solver.models.viaduct import ViaductProperties
from solver.studies.study import Study

__all__ = [
    "PATH_MARGIN",
    "RAIL_BEYOND",
    "TRACK_BAYS",
    "Crossing",
    "crossing",
    "element_length",
    "rail_count",
    "structure_ends",
    "train_axles",
    "train_length",
]

PATH_MARGIN = 20.0
"""No path end is nearer to a wheel than this. [m]"""
RAIL_BEYOND = 12.0
"""Approach track that a modal analysis keeps on either side of the structure. [m]"""
TRACK_BAYS = 30
"""Sleeper bays of a track whose modes are found."""


@dataclass(frozen=True, kw_only=True)
class Crossing:
    """One run's extent.

    Attributes:
        start: x of the first axle at t = 0. [m]
        path_start: Where the path begins. [m]
        path_end: Where it ends. [m]
        n_step: Number of time steps.
        window_start: Time from which peaks and verdicts count. [s]
        approach_needed: Length of approach track needed before or after the structure. [m]
    """

    start: float
    path_start: float
    path_end: float
    n_step: int
    window_start: float
    approach_needed: float


def train_length(study: Study) -> float:
    """Distance from the first to the last axle. [m]"""
    train = study.train
    if isinstance(train, ArticulatedTrain):
        return -_axles(train)[-1]
    if isinstance(train, AxleTable):
        return train.axles[-1].position - train.axles[0].position
    return (train.count - 1) * train.spacing


@lru_cache(maxsize=32)
def _axles(train: ArticulatedTrain) -> tuple[float, ...]:
    """Offsets of the axles from the first one; a sweep of 500 runs asks 500 times. [m]"""
    return tuple(sorted((float(x) for x in lay_out(train).axle_offsets), reverse=True))


def element_length(study: Study) -> float:
    """Length of the beam elements that the wheels roll on. [m]"""
    if isinstance(study.track, TrackProperties):
        return study.track.sleeper_spacing / ELEMENTS_PER_BAY[study.mesh_level]
    if isinstance(study.viaduct, ViaductProperties):
        return math.inf
    return study.viaduct.element_length


def crossing(study: Study, speed: float) -> Crossing:
    """The extent of the run at one speed (modelling decision "Statics and run-in").

    The run ends ``run_out`` after the last axle has left the last span; peaks count from the first
    axle's arrival on the three-dimensional track.
    """
    length, bridge = train_length(study), study.viaduct.length
    start = -study.extent.run_in
    distance = study.extent.run_in + bridge + length + speed * study.extent.run_out
    n_step = math.ceil(distance / (speed * study.integration.time_step) - 1e-9)
    travelled = n_step * speed * study.integration.time_step
    structure_start, structure_end = structure_ends(study)
    path_start = min(start - length - PATH_MARGIN, structure_start)
    path_end = max(start + travelled + PATH_MARGIN, structure_end)
    needed = max(structure_start - path_start, path_end - structure_end)
    given = study.approach.length
    if given > 0.0:
        path_start = min(path_start, structure_start - given)
        path_end = max(path_end, structure_end + given)
    first = 0.0
    if isinstance(study.track, TrackProperties):
        first = -study.track.embankment_length
    window = max(0.0, (first - start) / speed)
    return Crossing(
        start=start,
        path_start=path_start,
        path_end=path_end,
        n_step=n_step,
        window_start=window,
        approach_needed=needed,
    )


def structure_ends(study: Study) -> tuple[float, float]:
    """Beginning and end of what is modelled in three dimensions (or of the beams). [m]"""
    if isinstance(study.track, TrackProperties) and isinstance(study.viaduct, ViaductProperties):
        return track_ends(study.track, study.viaduct.length)
    return 0.0, study.viaduct.length


def train_axles(study: Study) -> int:
    """Number of axles."""
    train = study.train
    if isinstance(train, ArticulatedTrain):
        return len(_axles(train))
    return len(train.axles) if isinstance(train, AxleTable) else train.count


def rail_count(study: Study) -> Literal[1, 2]:
    """Rails on which the wheels roll: a plain beam is one path."""
    return 1 if isinstance(study.viaduct, BeamBridge) else 2
