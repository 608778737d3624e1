"""Modes of a viaduct with its track and rails, or of plain beams."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sparse

from solver.arrays import Matrix, SparseMatrix
from solver.errors import InputError
from solver.modal import deck_points, global_shapes, identify, modes, rayleigh_damping_ratios
from solver.models.beam_bridge import BeamBridge, beam_bridge_line
from solver.models.structure_model import StructureModel
from solver.models.train import SprungMasses
from solver.models.viaduct import ViaductProperties
from solver.results import Geometry
from solver.simulation import LINES
from solver.studies.crossing import RAIL_BEYOND, Crossing, structure_ends
from solver.studies.deck import Deck, beam_deck, deck_of
from solver.studies.modal_shapes import PartModes, no_wheels, none_of, spread
from solver.studies.scene import StageListener, build_scene
from solver.studies.study import Study
from solver.system.assembled import AssembledTrack, assemble_track

__all__ = ["viaduct_modes"]

_RECOGNISED = 0.8
"""Assurance criterion from which a mode bears a global shape's name."""


def viaduct_modes(study: Study, report: StageListener) -> PartModes:
    """Modes of the study's viaduct, rails and pads included; of plain beams without anything.

    Args:
        study: The study; train and speeds do not matter.
        report: Told each stage.

    Returns:
        The modes.

    Raises:
        InputError: Viaduct and track do not go together.
    """
    if isinstance(study.viaduct, BeamBridge):
        report("finding the modes")
        return _beam_modes(study.viaduct, study.modes.count)
    begin, end = structure_ends(study)
    extent = Crossing(
        start=0.0, path_start=begin - RAIL_BEYOND, path_end=end + RAIL_BEYOND,
        n_step=0, window_start=0.0, approach_needed=0.0,
    )  # fmt: skip
    # Whatever train the study has: it is not there.
    scene = build_scene(replace(study, train=SprungMasses()), extent, 1.0, report)
    assert scene.structure is not None
    report("finding the modes")
    track = assemble_track(scene.system)
    n_dof = track.mass.shape[0]
    frequencies, shapes = modes(track.stiffness, track.mass, min(study.modes.count, n_dof - 2))
    report("identifying the modes")
    names, likeness = _identified(shapes[: track.n_structure], scene.structure, study.viaduct)
    deck = deck_of(study, scene)
    return PartModes(
        frequencies=frequencies,
        damping=rayleigh_damping_ratios(shapes, track.mass, track.damping, track.stiffness),
        shapes=shapes,
        geometry=_geometry(deck),
        surface=_surface(deck, track),
        wheels=none_of(n_dof),
        bodies=none_of(n_dof),
        names=names,
        likeness=likeness,
        facts={"mesh_level": study.mesh_level},
    )


def _geometry(deck: Deck) -> Geometry:
    return Geometry(
        vertices=deck.vertices, layers=deck.layers, wheels=no_wheels(), bodies=(), spans=deck.spans
    )


def _surface(deck: Deck, track: AssembledTrack) -> SparseMatrix:
    """Displacement of all vertices, the rails' last, from the assembled unknowns."""
    n_dof = track.mass.shape[0]
    structure = spread(np.arange(track.n_structure), n_dof)
    # Flattened, the lines' freedoms lie side by side: line after line within each freedom.
    lines = spread(track.line_dofs.T.ravel(), n_dof)
    return sparse.vstack([deck.surface @ structure, _upwards(deck.rail_rows @ lines)], format="csr")


def _upwards(heights: SparseMatrix) -> SparseMatrix:
    """Displacements along x, y, z of points that only move up and down."""
    return sparse.csr_array(sparse.kron(heights, np.array([[0.0], [0.0], [1.0]])))


def _identified(
    shapes: Matrix, structure: StructureModel, viaduct: ViaductProperties
) -> tuple[dict[int, str], dict[int, float]]:
    """Names of the modes that look like a global shape, and their likeness to it."""
    points = deck_points(
        structure.node_coordinates,
        structure.slab_nodes,
        structure.span_of_slab_node,
        structure.bearing_positions,
        structure.bearing_span,
        viaduct.wall_position,
    )
    targets = global_shapes(len(viaduct.spans))
    chosen, likeness = identify(shapes, structure.displacement_operator, points, targets)
    names: dict[int, str] = {}
    best: dict[int, float] = {}
    for target, mode, criterion in zip(targets, chosen.tolist(), likeness.tolist(), strict=True):
        if criterion >= best.get(mode, _RECOGNISED):
            names[mode], best[mode] = target.name, criterion
    return names, best


def _beam_modes(bridge: BeamBridge, count: int) -> PartModes:
    """Modes of plain beams; those of a single one have the name of their half waves."""
    line = beam_bridge_line(bridge, -1.0, bridge.length + 1.0)
    free = np.flatnonzero(line.free.ravel())
    available = free.size - 2
    if available < 1:
        raise InputError(
            "viaduct.elements_per_span", bridge.elements_per_span, "leaves no modes", "Use more."
        )
    stiffness, mass = line.stiffness[free][:, free], line.mass[free][:, free]
    frequencies, shapes = modes(stiffness, mass, min(count, available))
    unknowns = np.full(line.n_dof, -1)
    unknowns[free] = np.arange(free.size)
    deck = beam_deck(bridge, line)
    assert deck.part == LINES
    names = {}
    if len(bridge.spans) == 1:
        names = {k: f"bending, {_half_waves(k + 1)}" for k in range(frequencies.size)}
    return PartModes(
        frequencies=frequencies,
        damping=rayleigh_damping_ratios(shapes, mass, line.damping[free][:, free], stiffness),
        shapes=shapes,
        geometry=_geometry(deck),
        surface=sparse.csr_array(deck.surface @ spread(unknowns, free.size)),
        wheels=none_of(free.size),
        bodies=none_of(free.size),
        names=names,
    )


def _half_waves(count: int) -> str:
    return "1 half wave" if count == 1 else f"{count} half waves"
