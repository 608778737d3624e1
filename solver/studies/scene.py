"""From a study to a system: the models of one run, coupled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solver.arrays import IntVector
from solver.contact.laws import NonlinearHertz
from solver.errors import InputError
from solver.irregularities import rail_irregularities
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge, beam_bridge_line
from solver.models.beam_line import BeamLine
from solver.models.rails import ELEMENTS_PER_BAY, rail_line
from solver.models.structure_model import StructureModel
from solver.models.train import GRAVITY, TrainModel, build_train
from solver.models.viaduct import ViaductProperties
from solver.studies.crossing import Crossing, rail_count
from solver.studies.shared import Shared
from solver.studies.study import Study
from solver.system import System
from solver.system.system import RailProfiles, TrainMatrices
from solver.system.track_compliance import structure_matrices

__all__ = ["Scene", "build_scene"]

StageListener = Callable[[str], None]
"""Told the name of each stage as it begins."""


@dataclass(frozen=True, kw_only=True)
class Scene:
    """The models of one run.

    Attributes:
        system: The coupled system.
        train: The train.
        structure: The three-dimensional structure, or None for beams.
        bed_stiffness: Of the approach tracks, 0 for beams. [N/m]
    """

    system: System
    train: TrainModel
    structure: StructureModel | None
    bed_stiffness: float


def build_scene(
    study: Study,
    extent: Crossing,
    speed: float,
    report: StageListener,
    shared: Shared | None = None,
) -> Scene:
    """Builds the models of one run.

    Args:
        study: The study.
        extent: Where the run begins and ends.
        speed: Speed of the run. [m/s]
        report: Told each stage.
        shared: Where what runs share is had from; None makes all anew.

    Returns:
        The scene.

    Raises:
        InputError: The parts do not fit together.
    """
    report("building the train")
    train = build_train(study.train, rail_count(study))
    structure, bed_stiffness = None, 0.0
    if isinstance(study.viaduct, BeamBridge):
        line = beam_bridge_line(study.viaduct, extent.path_start, extent.path_end)
        seat_nodes: IntVector = np.zeros(0, dtype=np.int64)
    else:
        structure, line, seat_nodes, bed_stiffness = _ballasted(
            study, extent, report, shared or Shared()
        )
    return Scene(
        system=System(
            line=line,
            seat_nodes=seat_nodes,
            structure=None if structure is None else structure_matrices(structure),
            train=_train_matrices(train),
            contact_compliance=(
                1.0 / study.contact.stiffness if study.contact.law == "linear_hertz" else 0.0
            ),
            unilateral=study.contact.unilateral,
            irregularity=RailProfiles(profiles=rail_irregularities(study.irregularity)),
            start_position=extent.start,
            speed=speed,
            nonlinear_hertz=_nonlinear_hertz(study, train),
        ),
        train=train,
        structure=structure,
        bed_stiffness=bed_stiffness,
    )


def _ballasted(
    study: Study, extent: Crossing, report: StageListener, shared: Shared
) -> tuple[StructureModel, BeamLine, IntVector, float]:
    """Viaduct, ballasted track and rails."""
    viaduct, track = study.viaduct, study.track
    if not isinstance(viaduct, ViaductProperties) or not isinstance(track, TrackProperties):
        raise InputError(
            "track", study.track.type, "a U-girder viaduct carries a ballasted track",
            'Choose track type "ballasted", or viaduct type "beam".',
        )  # fmt: skip
    report("building the viaduct")
    structure = shared.structure(viaduct, track, study.mesh_level)
    report("matching the approach track")
    approach = shared.approach(track, study.approach, study.mesh_level)
    line, seat_nodes = rail_line(
        track,
        approach,
        ELEMENTS_PER_BAY[study.mesh_level],
        structure.seat_positions,
        viaduct.length,
        extent.path_start,
        extent.path_end,
    )
    return structure, line, seat_nodes, approach.bed_stiffness


def _train_matrices(train: TrainModel) -> TrainMatrices:
    return TrainMatrices(
        mass=train.mass,
        damping=train.damping,
        stiffness=train.stiffness,
        weight=train.weight,
        wheel_rows=train.wheel_rows,
        wheel_offsets=train.wheel_offsets,
        wheel_lines=train.wheel_rail,
        wheel_rest=np.zeros(train.n_wheel),
    )


def _nonlinear_hertz(study: Study, train: TrainModel) -> NonlinearHertz | None:
    """The nonlinear contact law, about the mean static load of a wheel."""
    if study.contact.law != "nonlinear_hertz":
        return None
    return NonlinearHertz(
        coefficient=study.contact.hertz_constant,
        reference_force=float(train.total_mass * GRAVITY / train.n_wheel),
    )
