"""Modal analysis of a viaduct with its track and rails (or of plain beams)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.arrays import Matrix, Vector
from solver.errors import InputError
from solver.modal import deck_points, global_shapes, identify, modes, rayleigh_damping_ratios
from solver.models.beam_bridge import BeamBridge, beam_bridge_line
from solver.models.viaduct import ViaductProperties
from solver.studies.crossing import Crossing, structure_ends
from solver.studies.scene import Scene, StageListener, build_scene
from solver.studies.study import Study
from solver.system.assembled import AssembledTrack, assemble_track

__all__ = ["ViaductModes", "modal_analysis", "viaduct_modes"]

_COUNT = 24
_RAIL_BEYOND = 12.0
"""Approach track kept on either side of the structure. [m]"""


@dataclass(frozen=True, kw_only=True)
class ViaductModes:
    """Modes of a viaduct with track and rails.

    Attributes:
        frequencies: Shape (n_mode,). [Hz]
        damping: Damping ratios, shape (n_mode,). [1]
        shapes: Shape (n_dof, n_mode), structure first, then rails.
        scene: The models.
        track: The assembled matrices.
    """

    frequencies: Vector
    damping: Vector
    shapes: Matrix
    scene: Scene
    track: AssembledTrack


def viaduct_modes(study: Study, report: StageListener, count: int = _COUNT) -> ViaductModes:
    """Modes of the study's viaduct, rails and pads included.

    Args:
        study: The study; train and speeds do not matter.
        report: Told each stage.
        count: Number of modes.

    Returns:
        The modes.
    """
    begin, end = structure_ends(study)
    extent = Crossing(
        start=0.0,
        path_start=begin - _RAIL_BEYOND,
        path_end=end + _RAIL_BEYOND,
        n_step=0,
        window_start=0.0,
        approach_needed=0.0,
    )
    scene = build_scene(study, extent, 1.0, report)
    report("finding the modes")
    track = assemble_track(scene.system)
    frequencies, shapes = modes(track.stiffness, track.mass, count)
    damping = rayleigh_damping_ratios(shapes, track.mass, track.damping, track.stiffness)
    return ViaductModes(
        frequencies=frequencies, damping=damping, shapes=shapes, scene=scene, track=track
    )


def modal_analysis(study: Study, report: StageListener = lambda stage: None) -> dict[str, Any]:
    """Modal analysis as plain JSON: frequencies, damping, what each mode looks like.

    Args:
        study: The study; train and speeds do not matter.
        report: Told each stage.

    Returns:
        ``{"modes": [{"number", "frequency", "damping", "name", "assurance"}], "facts": {...}}``.
    """
    if isinstance(study.viaduct, BeamBridge):
        return _beam_modes(study.viaduct)
    found = viaduct_modes(study, report)
    report("identifying the modes")
    names, likeness = identified(found, study)
    facts = {
        "mesh_level": study.mesh_level,
        "unknowns": int(found.track.mass.shape[0]),
        "assumption": "damping ratios are the diagonal of the modal damping matrix",
    }
    entries = _entries(found.frequencies, found.damping, names, likeness)
    return {"modes": entries, "facts": facts}


def _entries(
    frequencies: Vector, damping: Vector, names: dict[int, str], likeness: dict[int, float]
) -> list[dict[str, Any]]:
    """The table of modes as plain JSON; modes that look like nothing known have no name."""
    return [
        {
            "number": index + 1,
            "frequency": float(frequencies[index]),
            "damping": float(damping[index]),
            "name": names.get(index, ""),
            "assurance": likeness.get(index, 0.0),
        }
        for index in range(frequencies.size)
    ]


def identified(found: ViaductModes, study: Study) -> tuple[dict[int, str], dict[int, float]]:
    """Names of the modes that look like a global shape, and their MAC with it."""
    structure, viaduct = found.scene.structure, study.viaduct
    assert structure is not None
    assert isinstance(viaduct, ViaductProperties)
    points = deck_points(
        structure.node_coordinates,
        structure.slab_nodes,
        structure.span_of_slab_node,
        structure.bearing_positions,
        structure.bearing_span,
        viaduct.wall_position,
    )
    targets = global_shapes(len(viaduct.spans))
    own = found.shapes[: found.track.n_structure]
    chosen, likeness = identify(own, structure.displacement_operator, points, targets)
    names: dict[int, str] = {}
    best: dict[int, float] = {}
    for target, mode, criterion in zip(targets, chosen.tolist(), likeness.tolist(), strict=True):
        if criterion >= best.get(mode, 0.8):
            names[mode], best[mode] = target.name, criterion
    return names, best


def _beam_modes(bridge: BeamBridge) -> dict[str, Any]:
    """Modes of plain beams."""
    line = beam_bridge_line(bridge, -1.0, bridge.length + 1.0)
    free = np.flatnonzero(line.free.ravel())
    stiffness = line.stiffness[free][:, free]
    count = min(12, free.size - 2)
    if count < 1:
        raise InputError(
            "viaduct.elements_per_span", bridge.elements_per_span, "leaves no modes", "Use more."
        )
    mass = line.mass[free][:, free]
    frequencies, shapes = modes(stiffness, mass, count)
    damping = rayleigh_damping_ratios(shapes, mass, line.damping[free][:, free], stiffness)
    entries = _entries(frequencies, damping, {}, {})
    return {"modes": entries, "facts": {"unknowns": int(free.size)}}
