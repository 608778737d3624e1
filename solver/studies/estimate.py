"""What a study will cost, by closed formulas: nothing is allocated to find out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from solver.factorisation import back_end_name
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.mesh_level import MeshLevel
from solver.models.rails import ELEMENTS_PER_BAY
from solver.models.structure import estimate_unknowns
from solver.models.train import AxleTable, SprungMasses
from solver.models.viaduct import ViaductProperties
from solver.studies.crossing import (
    RAIL_BEYOND,
    TRACK_BAYS,
    crossing,
    rail_count,
    structure_ends,
    train_axles,
)
from solver.studies.study import JobKind, Study

__all__ = ["Estimate", "Unknowns", "estimate", "structure_unknowns", "unknowns"]


_MODEL_BYTES = 5_000
"""What runs share, for each unknown of the structure: measured 80 and 550 MB on the coarse and the
standard mesh. [B]"""


_STEP_OF_AXLES = 1e-7
"""Of a step, for each pair of axles: measured 0.3, 1.2, 4.8 ms for 50, 100, 200 on a beam,
and 2.7 ms for 200 on a viaduct. [s]"""

_FRAME_BYTES = 20
"""Of a vertex in a frame: three displacements, a velocity, an acceleration. [B]"""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """What all runs of a study cost together.

    Attributes:
        runs: Number of runs.
        steps: Time steps of all runs.
        unknowns: Unknowns of one run: structure, rails, train.
        seconds: Computing time of all runs on one core, a rough figure. [s]
        memory_bytes: Of one run. [B]
        disk_bytes: Results of all runs, and the model that several share. [B]
    """

    runs: int
    steps: int
    unknowns: int
    seconds: float
    memory_bytes: int
    disk_bytes: int


@dataclass(frozen=True, kw_only=True)
class Unknowns:
    """Unknowns of the parts of one run."""

    structure: int
    rails: int
    train: int

    @property
    def total(self) -> int:
        """All of them."""
        return self.structure + self.rails + self.train


def unknowns(study: Study, path_length: float) -> Unknowns:
    """Unknowns of one run whose path has this length. [m]"""
    n_train = _train_unknowns(study)
    if isinstance(study.viaduct, BeamBridge):
        # Two nodes of rigid ground on either side.
        return Unknowns(structure=0, rails=2 * (_beam_nodes(study.viaduct) + 4), train=n_train)
    assert isinstance(study.track, TrackProperties)
    bays = path_length / study.track.sleeper_spacing
    per_bay = 2 * (2 * ELEMENTS_PER_BAY[study.mesh_level] + 1)
    structure = structure_unknowns(study.viaduct, study.track, study.mesh_level)
    return Unknowns(structure=structure, rails=int(bays * per_bay), train=n_train)


def _train_unknowns(study: Study) -> int:
    """Cars with three freedoms, bogies with three and wheelsets with two, less the hinges."""
    train = study.train
    if isinstance(train, SprungMasses):
        return 2 * train.count
    if isinstance(train, AxleTable):
        return 2 * rail_count(study) * len(train.axles)
    cars, bogies = len(train.consist), train_axles(study) // 2
    hinges = 2 * cars - bogies
    return 3 * cars + 7 * bogies - hinges


def _beam_nodes(bridge: BeamBridge) -> int:
    return len(bridge.spans) * (bridge.elements_per_span + 1)


@lru_cache(maxsize=32)
def structure_unknowns(viaduct: ViaductProperties, track: TrackProperties, level: MeshLevel) -> int:
    """Unknowns of the three-dimensional structure; counted once a study, not once a run.

    Raises:
        InputError: Viaduct and track do not fit together.
    """
    return int(estimate_unknowns(viaduct, track, level))


def estimate(study: Study, kind: JobKind = "crossing") -> Estimate:
    """Cost of a study whose values are within their bounds.

    Args:
        study: The study.
        kind: What is computed.
    """
    return _crossings(study) if kind == "crossing" else _modes(study)


def _crossings(study: Study) -> Estimate:
    """Of all runs of the sweep."""
    steps, seconds, disk, memory, size, model = 0, 0.0, 0, 0, 0, 0
    for speed in study.sweep.speeds:
        extent = crossing(study, speed)
        count = unknowns(study, extent.path_end - extent.path_start)
        setup, step = _times(count)
        step += _STEP_OF_AXLES * train_axles(study) ** 2
        steps += extent.n_step
        seconds += setup + step * extent.n_step
        disk += _disk(study, count, extent.n_step)
        memory, size = max(memory, _memory(count)), max(size, count.total)
        model = _MODEL_BYTES * count.structure if len(study.sweep.speeds) > 1 else 0
    return Estimate(
        runs=len(study.sweep.speeds),
        steps=steps,
        unknowns=size,
        seconds=seconds,
        memory_bytes=memory,
        disk_bytes=disk + model,
    )


def _modes(study: Study) -> Estimate:
    """Of a modal analysis, as measured with 24 and 200 modes on the coarse and standard mesh."""
    n_dof, n_vertex = _modal_size(study)
    count = min(study.modes.count, n_dof)
    size = n_dof / 1e5
    slower = 4.0 if _is_superlu() else 1.0
    # The train's dense matrices, and the bed of the approach track, take their time at any count.
    fixed = {"viaduct": 0.3, "track": 1.5, "train": 0.3}[study.modes.part]
    return Estimate(
        runs=1,
        steps=1,
        unknowns=n_dof,
        seconds=fixed + slower * (2.1 * size + 0.19 * size**1.2 * count),
        memory_bytes=int(250e6 + 7.3e3 * n_dof + 30.0 * n_dof * count),
        disk_bytes=int(500e3 + 12.0 * n_vertex * count),
    )


def _modal_size(study: Study) -> tuple[int, int]:
    """Unknowns and drawn vertices of the part whose modes are asked for."""
    if study.modes.part == "train":
        return _train_unknowns(study), 0
    if study.modes.part == "track":
        per_bay = 2 * ELEMENTS_PER_BAY[study.mesh_level] + 1
        return TRACK_BAYS * per_bay, 4 * TRACK_BAYS * (ELEMENTS_PER_BAY[study.mesh_level] + 1)
    begin, end = structure_ends(study)
    count = unknowns(replace(study, train=SprungMasses()), end - begin + 2.0 * RAIL_BEYOND)
    return count.structure + count.rails, _vertices(study, count)


def _vertices(study: Study, count: Unknowns) -> int:
    """Vertices of the drawn structure."""
    if isinstance(study.viaduct, BeamBridge):
        return 2 * _beam_nodes(study.viaduct)
    return count.structure // 2 + 200


def _is_superlu() -> bool:
    return back_end_name() == "SuperLU"


def _times(count: Unknowns) -> tuple[float, float]:
    """Time before the first step and per step, from measurements on one core of 2026. [s]"""
    size = count.structure / 1e5
    if _is_superlu():
        return 1.0 + 60.0 * size**1.8, 0.4e-3 + 40e-9 * count.rails + 0.3 * size**1.25
    return 1.0 + 14.0 * size**1.3, 0.25e-3 + 40e-9 * count.rails + 0.045 * size**1.2


def _memory(count: Unknowns) -> int:
    """Peak memory of one run; measured 0.4, 1.4, 3.0 GB on coarse, standard, fine mesh. [B]"""
    factor = 2.9e9 * (count.structure / 1.1e5) ** 1.4 if _is_superlu() else 0.0
    return int(250e6 + factor + 11.3e3 * count.structure + 2.5e3 * count.rails)


def _disk(study: Study, count: Unknowns, n_step: int) -> int:
    """Results of one run: doubles for channels, singles for slab points and frames. [B]"""
    if isinstance(study.viaduct, BeamBridge):
        n_channel = 2 * len(study.viaduct.spans) + 4 * train_axles(study)
        n_point = _beam_nodes(study.viaduct)
    else:
        # Force and place of two wheels an axle; cars and bogies, or the masses of a table.
        n_body = train_axles(study) if isinstance(study.train, AxleTable) else 60
        n_channel = 4 * train_axles(study) + 2 * n_body
        n_point = count.structure // 30 + 60
    step = study.integration.time_step
    n_frame = n_step / max(1.0, study.outputs.frame_interval / step)
    frame = _FRAME_BYTES * _vertices(study, count)
    return int((8 * (n_channel + 1) + 4 * n_point) * n_step + frame * n_frame)
