"""Modes of the approach track: a rail on pads, sleepers and their bed, without any viaduct."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from solver.arrays import IntArray, IntVector, Matrix, SparseMatrix, Vector
from solver.errors import InputError
from solver.modal import assurance, modes, rayleigh_damping_ratios
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_line import BeamLine, Sleepers
from solver.models.rails import ELEMENTS_PER_BAY, ApproachTrack
from solver.results import Geometry, Layer
from solver.studies.crossing import TRACK_BAYS
from solver.studies.deck import rail_strips, selection
from solver.studies.modal_shapes import PartModes, no_wheels, none_of, spread
from solver.studies.scene import StageListener
from solver.studies.shared import Shared
from solver.studies.study import Study

__all__ = ["track_line", "track_modes"]

_SLEEPER_HALF_LENGTH, _SLEEPER_HALF_WIDTH, _RAIL_HEIGHT = 1.3, 0.13, 0.172
"""Of the drawn sleepers and rails; no computation reads them. [m]"""


def track_modes(study: Study, report: StageListener) -> PartModes:
    """Modes of ``TRACK_BAYS`` bays of the study's approach track, symmetric about both ends.

    Planes of symmetry half a bay beyond the last sleepers make the shapes those of an endless
    track: cosines of n half waves, once with the sleepers moving with the rail and once against.

    Args:
        study: The study; only its track, approach and mesh level matter.
        report: Told each stage.

    Returns:
        The modes of one rail; both rails are drawn, moving together.

    Raises:
        InputError: The study has no track.
    """
    if not isinstance(study.track, TrackProperties):
        raise InputError(
            "track.type", study.track.type, "has no modes", 'Use a track of type "ballasted".'
        )
    report("matching the approach track")
    approach = Shared().approach(study.track, study.approach, study.mesh_level)
    line = track_line(study.track, approach, ELEMENTS_PER_BAY[study.mesh_level])
    report("finding the modes")
    free = np.flatnonzero(np.concatenate([line.free.ravel(), np.ones(TRACK_BAYS, dtype=bool)]))
    mass, damping, stiffness = (
        sparse.csr_array(part[free][:, free]) for part in (line.mass, line.damping, line.stiffness)
    )
    frequencies, shapes = modes(stiffness, mass, min(study.modes.count, free.size - 2))
    unknowns = np.full(line.n_dof, -1)
    unknowns[free] = np.arange(free.size)
    every = spread(unknowns, free.size)
    names, likeness = _identified(line, np.asarray(every @ shapes))
    geometry, heights = _drawn(line, study.track)
    return PartModes(
        frequencies=frequencies,
        damping=rayleigh_damping_ratios(shapes, mass, damping, stiffness),
        shapes=shapes,
        geometry=geometry,
        surface=sparse.csr_array(sparse.kron(heights @ every, np.array([[0.0], [0.0], [1.0]]))),
        wheels=none_of(free.size),
        bodies=none_of(free.size),
        names=names,
        likeness=likeness,
        facts={
            "length": TRACK_BAYS * study.track.sleeper_spacing,
            "approach_bed_stiffness": approach.bed_stiffness,
            "assumption": f"{TRACK_BAYS} sleeper bays with a plane of symmetry at either end",
        },
    )


def track_line(track: TrackProperties, approach: ApproachTrack, per_bay: int) -> BeamLine:
    """One rail over ``TRACK_BAYS`` sleepers, from half a bay before the first to half a bay beyond.

    Args:
        track: Rail section, regular pads, sleeper spacing.
        approach: Sleepers and bed; its bed stiffness must be set.
        per_bay: Beam elements of a bay, an even number.

    Returns:
        The line; its ends keep their direction.
    """
    n_node = TRACK_BAYS * per_bay + 1
    free = np.ones((n_node, 2), dtype=bool)
    free[[0, -1], 1] = False
    return BeamLine.build(
        positions=track.sleeper_spacing / per_bay * np.arange(n_node),
        rigidity=np.full(n_node - 1, track.rail_young_modulus * track.rail_second_moment),
        mass_per_length=np.full(n_node - 1, track.rail_area * track.rail_density),
        free=free,
        n_line=1,
        sleepers=Sleepers(
            nodes=per_bay // 2 + per_bay * np.arange(TRACK_BAYS),
            pad_stiffness=np.full(TRACK_BAYS, track.pad_stiffness),
            pad_damping=np.full(TRACK_BAYS, track.pad_damping),
            mass=approach.sleeper_mass,
            bed_stiffness=approach.bed_stiffness,
            bed_damping=approach.bed_damping,
        ),
    )


def _identified(line: BeamLine, shapes: Matrix) -> tuple[dict[int, str], dict[int, float]]:
    """Half waves of each shape along the rail, and how the sleepers move to it."""
    assert line.sleepers is not None
    rail = shapes[: 2 * line.n_node : 2]
    waves = np.arange(line.n_node // 2 + 1)
    cosines = np.cos(np.pi * np.outer(line.positions / line.positions[-1], waves))
    criterion = assurance(cosines, rail)
    together = np.sum(rail[line.sleepers.nodes] * shapes[2 * line.n_node :], axis=0) > 0.0
    best = np.argmax(criterion, axis=0)
    names = {
        mode: f"{_half_waves(int(wave))}, sleepers {'with' if together[mode] else 'against'} rail"
        for mode, wave in enumerate(best)
    }
    return names, {mode: float(criterion[wave, mode]) for mode, wave in enumerate(best)}


def _half_waves(count: int) -> str:
    return {0: "bounce", 1: "1 half wave"}.get(count, f"{count} half waves")


def _drawn(line: BeamLine, track: TrackProperties) -> tuple[Geometry, SparseMatrix]:
    """Rails and sleepers as strips, and the heights of their vertices from the line's freedoms."""
    assert line.sleepers is not None
    rails, rail_faces = rail_strips(line.positions, track.rail_position, _RAIL_HEIGHT)
    sleepers, sleeper_faces = _sleeper_strips(line.positions[line.sleepers.nodes])
    columns: IntVector = np.concatenate(
        [
            np.tile(2 * np.arange(line.n_node), 4),
            np.repeat(2 * line.n_node + np.arange(TRACK_BAYS), 4),
        ]
    )
    geometry = Geometry(
        vertices=np.concatenate([rails, sleepers]),
        layers=(
            Layer(name="rails", faces=rail_faces),
            Layer(name="sleepers", faces=sleeper_faces + len(rails)),
        ),
        wheels=no_wheels(),
        bodies=(),
        spans=np.zeros((0, 2)),
    )
    return geometry, selection(columns, line.n_dof)


def _sleeper_strips(x: Vector) -> tuple[Matrix, IntArray]:
    """Tops of the sleepers: vertices, four a sleeper, and faces."""
    corners = np.array([(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])
    vertices = np.zeros((x.size, 4, 3))
    vertices[:, :, 0] = x[:, None] + _SLEEPER_HALF_WIDTH * corners[:, 0]
    vertices[:, :, 1] = _SLEEPER_HALF_LENGTH * corners[:, 1]
    return vertices.reshape(-1, 3), np.arange(4 * x.size).reshape(-1, 4)
