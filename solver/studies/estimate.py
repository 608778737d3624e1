"""What a study will cost, by closed formulas: nothing is allocated to find out."""

from __future__ import annotations

from dataclasses import dataclass

from solver.factorisation import back_end_name
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.rails import ELEMENTS_PER_BAY
from solver.models.structure import estimate_unknowns
from solver.models.train import SprungMasses
from solver.studies.crossing import crossing, train_axles
from solver.studies.study import Study

__all__ = ["Estimate", "Unknowns", "estimate", "unknowns"]

_FILL_PARDISO, _FILL_SUPERLU = 4.0e-4, 1.4e-3
"""Entries of the factor over n^1.5, measured on the three mesh levels."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """What all runs of a study cost together.

    Attributes:
        runs: Number of runs.
        steps: Time steps of all runs.
        unknowns: Unknowns of one run: structure, rails, train.
        seconds: Computing time of all runs on one core, a rough figure. [s]
        memory_bytes: Of one run. [B]
        disk_bytes: Results of all runs. [B]
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
    train = study.train
    sprung = isinstance(train, SprungMasses)
    n_train = 2 * train.count if sprung else 11 * len(train.consist)
    if isinstance(study.viaduct, BeamBridge):
        spans = len(study.viaduct.spans) * (study.viaduct.elements_per_span + 1)
        return Unknowns(structure=0, rails=2 * (spans + 4), train=n_train)
    assert isinstance(study.track, TrackProperties)
    bays = path_length / study.track.sleeper_spacing
    per_bay = 2 * (2 * ELEMENTS_PER_BAY[study.mesh_level] + 1)
    structure = estimate_unknowns(study.viaduct, study.track, study.mesh_level)
    return Unknowns(structure=int(structure), rails=int(bays * per_bay), train=n_train)


def estimate(study: Study) -> Estimate:
    """Cost of a study whose values are within their bounds."""
    steps, seconds, disk, memory, size = 0, 0.0, 0, 0, 0
    for speed in study.sweep.speeds:
        extent = crossing(study, speed)
        count = unknowns(study, extent.path_end - extent.path_start)
        setup, step = _times(count)
        steps += extent.n_step
        seconds += setup + step * extent.n_step
        disk += _disk(study, count, extent.n_step)
        memory, size = max(memory, _memory(count)), max(size, count.total)
    return Estimate(
        runs=len(study.sweep.speeds),
        steps=steps,
        unknowns=size,
        seconds=seconds,
        memory_bytes=memory,
        disk_bytes=disk,
    )


def _is_superlu() -> bool:
    return back_end_name() == "SuperLU"


def _times(count: Unknowns) -> tuple[float, float]:
    """Time before the first step and per step, from measurements on one core of 2026. [s]"""
    size = count.structure / 1e5
    if _is_superlu():
        return 1.0 + 60.0 * size**1.8, 0.4e-3 + 40e-9 * count.rails + 0.3 * size**1.25
    return 1.0 + 14.0 * size**1.3, 0.25e-3 + 40e-9 * count.rails + 0.055 * size**1.2


def _memory(count: Unknowns) -> int:
    """Memory of one run. [B]"""
    fill = (_FILL_SUPERLU if _is_superlu() else _FILL_PARDISO) * count.structure**1.5 * 1e1
    base = 250e6
    return int(base + 8.0 * fill + 3500.0 * count.structure + 3000.0 * count.rails)


def _disk(study: Study, count: Unknowns, n_step: int) -> int:
    """Results of one run. [B]"""
    wheels = 2 * train_axles(study)
    channels = 8 * (2 * wheels + 120) * n_step
    slab = 4 * (count.structure // 30 + 60) * n_step
    frames = n_step * study.integration.time_step / study.outputs.frame_interval
    surface = 12 * (count.structure // 2 + 200) * frames
    return int(channels + slab + surface)
