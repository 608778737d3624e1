"""Static deflection of a rail under a wheel set, on the three- and the two-dimensional track.

The approach tracks continue the three-dimensional track: their bed stiffness is chosen so that a
wheel set in the middle of a bay deflects both by the same amount.
"""

from __future__ import annotations

from dataclasses import replace
from typing import cast

import numpy as np

from solver.arrays import Vector
from solver.errors import InputError
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_line import BeamLine
from solver.models.mesh_level import MeshLevel
from solver.models.rails import ELEMENTS_PER_BAY, ApproachTrack, rail_line
from solver.models.structure import build_track
from solver.models.structure_model import StructureModel
from solver.system.coupled import EffectiveSystem, System, TrainMatrices
from solver.system.parts import Coefficients, StructureMatrices

__all__ = ["approach_deflections", "matched_approach", "structure_matrices", "track_deflections"]

_N_SLEEPER = 20
"""Sleepers of the track that is compared: the deflection dies out within five bays."""
_SOFTEST, _STIFFEST = 6.0, 10.5
"""Exponents of ten between which the bed's stiffness is sought. [N/m]"""


def structure_matrices(model: StructureModel) -> StructureMatrices:
    """A structure as the system sees it: its pads repeated for both rails."""
    n_line = model.seat_dofs.shape[0]
    return StructureMatrices(
        mass=model.mass,
        damping=model.damping,
        stiffness=model.stiffness,
        mass_proportional=model.mass_proportional,
        stiffness_proportional=model.stiffness_proportional,
        seats=model.seat_dofs.ravel(),
        pad_stiffness=np.tile(model.pad_stiffness, n_line),
        pad_damping=np.tile(model.pad_damping, n_line),
        weight=model.weight,
    )


def track_deflections(
    track: TrackProperties,
    level: MeshLevel,
    places: Vector,
    coefficients: Coefficients,
    elements_per_bay: int = 0,
) -> Vector:
    """Deflection of the rails per unit load on each, on the three-dimensional track.

    Args:
        track: The track.
        level: Mesh level.
        places: Positions within a bay, from one sleeper to the next, 0 to 1, shape (n,).
        coefficients: Statics, or those of a time step (compliance then is the effective one).
        elements_per_bay: Of the rails; 0 takes the mesh level's.

    Returns:
        Shape (n,), both rails loaded alike. [m/N]
    """
    model = build_track(track, _N_SLEEPER, level)
    seats = model.seat_positions
    line, nodes = _clamped_line(track, elements_per_bay or ELEMENTS_PER_BAY[level], seats)
    bay = 0.5 * (seats[0] + seats[-1]) - 0.5 * track.sleeper_spacing
    return _deflections(
        line, nodes, structure_matrices(model), bay + places * track.sleeper_spacing, coefficients
    )


def approach_deflections(
    track: TrackProperties,
    approach: ApproachTrack,
    level: MeshLevel,
    places: Vector,
    coefficients: Coefficients,
) -> Vector:
    """The same on the two-dimensional track."""
    extent = track.sleeper_spacing * (_N_SLEEPER - 1)
    plain = replace(track, sleeper_phase=0.0, transition=False)
    line, nodes = rail_line(plain, approach, ELEMENTS_PER_BAY[level], np.zeros(0), 0.0, 0.0, extent)
    bay = track.sleeper_spacing * (_N_SLEEPER // 2 - 1)
    return _deflections(line, nodes, None, bay + places * track.sleeper_spacing, coefficients)


def matched_approach(
    track: TrackProperties, approach: ApproachTrack, level: MeshLevel
) -> ApproachTrack:
    """The approach with its bed stiffness matched, or as given if it was given.

    Raises:
        InputError: No bed stiffness matches.
    """
    if approach.bed_stiffness > 0.0:
        return approach
    static, middle = Coefficients.static(), np.array([0.5])
    target = float(track_deflections(track, level, middle, static)[0])

    def excess(exponent: float) -> float:
        trial = replace(approach, bed_stiffness=float(10.0**exponent))
        return float(approach_deflections(track, trial, level, middle, static)[0]) - target

    if excess(_SOFTEST) < 0.0 or excess(_STIFFEST) > 0.0:
        raise InputError(
            "approach.bed_stiffness", approach.bed_stiffness,
            f"no bed between {10**_SOFTEST:.1g} and {10**_STIFFEST:.1g} N/m deflects like the "
            f"three-dimensional track ({1e9 * target:.3g} nm/N)",
            "Check the track's stiffnesses, or give the bed's stiffness by hand.",
        )  # fmt: skip
    # Imported here: a server that only checks studies does not need its memory.
    from scipy.optimize import brentq

    exponent: float = cast(float, brentq(excess, _SOFTEST, _STIFFEST, xtol=1e-6))
    return replace(approach, bed_stiffness=10.0**exponent)


def _clamped_line(
    track: TrackProperties, elements_per_bay: int, seats: Vector
) -> tuple[BeamLine, np.ndarray]:
    """Rails over the seats only, clamped at both ends, where nothing moves any more."""
    plain = replace(track, sleeper_phase=0.0, transition=False)
    shifted = seats - seats[0]
    unused = ApproachTrack(bed_stiffness=1.0)
    line, nodes = rail_line(plain, unused, elements_per_bay, shifted, 0.0, 0.0, float(shifted[-1]))
    free = line.free.copy()
    free[0] = free[-1] = False
    return replace(line, free=free, positions=line.positions + seats[0]), nodes


def _deflections(
    line: BeamLine,
    seat_nodes: np.ndarray,
    structure: StructureMatrices | None,
    places: Vector,
    coefficients: Coefficients,
) -> Vector:
    """Deflection per unit load under two wheels, one a rail, at each place."""
    found = np.zeros(places.size)
    system = System(
        line=line,
        seat_nodes=seat_nodes,
        structure=structure,
        train=_wheel_set(),
        contact_compliance=0.0,
        unilateral=False,
        irregularity=lambda lines, x: np.zeros_like(x),
        start_position=0.0,
        speed=1.0,
    )
    effective = EffectiveSystem(system, coefficients, table=False)
    for index, place in enumerate(places):
        effective.locate_wheels(float(place))
        compliance, _ = effective.contact_problem(np.zeros((2, 2)))
        found[index] = compliance[0].sum() / coefficients.force
    return found


def _wheel_set() -> TrainMatrices:
    """Two wheels of unit mass, one a rail; only their places matter."""
    return TrainMatrices(
        mass=np.eye(2),
        damping=np.zeros((2, 2)),
        stiffness=np.zeros((2, 2)),
        weight=np.zeros(2),
        wheel_rows=np.eye(2),
        wheel_offsets=np.zeros(2),
        wheel_lines=np.array([0, 1]),
        wheel_rest=np.zeros(2),
    )
