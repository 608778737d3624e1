"""Element matrices of deck and track, each with the Rayleigh damping of its part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.arrays import FloatArray, SparseMatrix, Vector
from solver.assembly.freedoms import Freedoms
from solver.assembly.scatter import ElementMatrices, scatter
from solver.elements import line_mass, shell, solid
from solver.models.ballasted_track import TrackProperties
from solver.models.structure_deck import DeckMesh
from solver.models.structure_track import TrackMesh
from solver.models.viaduct import ViaductProperties

__all__ = ["Matrices", "Part", "deck_parts", "summed", "track_parts"]


@dataclass(frozen=True, kw_only=True)
class Part:
    """Elements that share a kind.

    Attributes:
        mass: Their mass, if any.
        stiffness: Their stiffness, if any.
        mass_damping: Rayleigh factor on the mass, a number or one for each element. [1/s]
        stiffness_damping: Rayleigh factor on the stiffness, likewise. [s]
    """

    mass: ElementMatrices | None = None
    stiffness: ElementMatrices | None = None
    mass_damping: Vector | float = 0.0
    stiffness_damping: Vector | float = 0.0


@dataclass(frozen=True, kw_only=True)
class Matrices:
    """Sparse matrices before constraints: mass, stiffness, damping."""

    mass: SparseMatrix
    stiffness: SparseMatrix
    damping: SparseMatrix


def deck_parts(viaduct: ViaductProperties, deck: DeckMesh, freedoms: Freedoms) -> list[Part]:
    """Shells with damping, their drilling penalty without, and the mass along the edges."""
    section = deck.section
    corners = deck.coordinates[deck.shells]
    thickness = section.thickness[deck.segment]
    modulus = section.young_modulus[deck.segment]
    index = freedoms.of_elements(deck.shells, 6)
    nu = viaduct.poisson_ratio
    stiffness = shell.stiffness(corners, thickness, modulus, nu)
    drilling = shell.drilling_stiffness(corners, thickness, modulus, nu)
    mass = shell.mass(corners, thickness, viaduct.density)
    edges = line_mass.mass(deck.coordinates[deck.edges], viaduct.edge_mass)
    return [
        Part(
            mass=ElementMatrices(freedoms=index, matrices=mass),
            stiffness=ElementMatrices(freedoms=index, matrices=stiffness),
            mass_damping=viaduct.mass_damping,
            stiffness_damping=viaduct.stiffness_damping,
        ),
        Part(stiffness=ElementMatrices(freedoms=index, matrices=drilling)),
        Part(
            mass=ElementMatrices(freedoms=freedoms.of_elements(deck.edges, 3), matrices=edges),
            mass_damping=viaduct.mass_damping,
        ),
    ]


def track_parts(
    track: TrackProperties,
    coordinates: FloatArray,
    solids: TrackMesh,
    freedoms: Freedoms,
    viaduct: ViaductProperties | None,
) -> list[Part]:
    """Ballast and sleepers.

    Args:
        track: The track.
        coordinates: Nodes of the whole structure, shape (n_node, 3). [m]
        solids: The track's mesh.
        freedoms: Numbering of the whole structure.
        viaduct: Whose damping elements on a span take with ``damping = "deck"``.

    Returns:
        The two parts.
    """
    materials = (
        (
            solids.ballast,
            track.ballast_young_modulus,
            track.ballast_poisson_ratio,
            track.ballast_density,
        ),
        (
            solids.sleepers,
            track.sleeper_young_modulus,
            track.sleeper_poisson_ratio,
            track.sleeper_density,
        ),
    )
    parts: list[Part] = []
    for elements, modulus, poisson_ratio, density in materials:
        corners = coordinates[elements]
        index = freedoms.of_elements(elements, 3)
        on_deck = np.zeros(len(elements), dtype=np.bool_)
        mass_pair, stiffness_pair = (0.0, track.mass_damping), (0.0, track.stiffness_damping)
        if viaduct is not None and viaduct.damping == "deck":
            on_deck = corners[:, :, 0].mean(axis=1) > 0.0
            mass_pair = (viaduct.mass_damping, track.mass_damping)
            stiffness_pair = (viaduct.stiffness_damping, track.stiffness_damping)
        parts.append(
            Part(
                mass=ElementMatrices(freedoms=index, matrices=solid.mass(corners, density)),
                stiffness=ElementMatrices(
                    freedoms=index, matrices=solid.stiffness(corners, modulus, poisson_ratio)
                ),
                mass_damping=np.where(on_deck, *mass_pair),
                stiffness_damping=np.where(on_deck, *stiffness_pair),
            )
        )
    return parts


def summed(parts: Sequence[Part], count: int) -> Matrices:
    """Sums the parts into mass, stiffness and damping, shape (count, count) each."""
    mass = [part.mass for part in parts if part.mass is not None]
    stiffness = [part.stiffness for part in parts if part.stiffness is not None]
    damping = [part.mass.scaled(part.mass_damping) for part in parts if part.mass is not None]
    damping += [
        part.stiffness.scaled(part.stiffness_damping)
        for part in parts
        if part.stiffness is not None and np.any(part.stiffness_damping)
    ]
    return Matrices(
        mass=scatter(mass, count),
        stiffness=scatter(stiffness, count),
        damping=scatter(damping, count),
    )
