"""Simply supported plane beams in a row, rigid ground before and after: a general subsystem.

Two-node elements in a vertical plane, straight, at any inclination. Each node has the deflection w
along the normal xi_2 of the path and the rotation, which is the slope dw/ds where there is no shear
deformation. Every span stands on its own two supports, whose deflections are prescribed freedoms,
so that their reactions are results.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse

from solver.arrays import FloatArray, IntVector, SparseMatrix, Vector
from solver.assembly.scatter import ElementMatrices, scatter
from solver.contact.path import Path, join, rigid_path
from solver.elements.beam import bending_mass, bending_stiffness
from solver.errors import InputError
from solver.models.subsystem import Subsystem

__all__ = ["BeamOnSupports", "PlaneBeams", "between_rigid_ground", "plane_beams"]


@dataclass(frozen=True, kw_only=True)
class PlaneBeams:
    """Equal or unequal spans of one section.

    Attributes:
        spans: Lengths, the first span from chainage 0. [m]
        rigidity: Flexural rigidity EI. [N m2]
        mass_per_length: [kg/m]
        elements_per_span: An even number puts a node at mid-span.
        shear_rigidity: Shear stiffness k G A; None leaves out shear deformation (Euler-Bernoulli).
            [N]
        rotary_inertia: Of the section in bending, density times second moment of area. [kg m]
        mass_damping: Rayleigh coefficient. [1/s]
        stiffness_damping: Rayleigh coefficient. [s]
        inclination: Angle of the axis, positive uphill. [rad]

    Raises:
        InputError: A value that cannot be used.
    """

    spans: tuple[float, ...]
    rigidity: float
    mass_per_length: float
    elements_per_span: int = 50
    shear_rigidity: float | None = None
    rotary_inertia: float = 0.0
    mass_damping: float = 0.0
    stiffness_damping: float = 0.0
    inclination: float = 0.0

    def __post_init__(self) -> None:
        positive = {
            "rigidity": self.rigidity,
            "mass_per_length": self.mass_per_length,
            "elements_per_span": self.elements_per_span,
            **{f"spans[{i}]": length for i, length in enumerate(self.spans)},
        }
        if self.shear_rigidity is not None:
            positive["shear_rigidity"] = self.shear_rigidity
        for title, value in positive.items():
            if not 0.0 < value < np.inf:
                raise InputError(f"beam.{title}", value, "is not positive", "Use more than 0.")
        for title in ("rotary_inertia", "mass_damping", "stiffness_damping"):
            value = getattr(self, title)
            if not 0.0 <= value < np.inf:
                raise InputError(f"beam.{title}", value, "is negative", "Use 0 or more.")
        if not self.spans:
            raise InputError("beam.spans", self.spans, "has no span", "Give one length or more.")
        if not abs(self.inclination) < 0.5 * np.pi:
            raise InputError("beam.inclination", self.inclination, "is vertical or beyond",
                             "Give an angle between -pi/2 and pi/2.")  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class BeamOnSupports:
    """A structure with its path.

    Attributes:
        structure: Supports are prescribed freedoms.
        path: Rigid ground, the spans from chainage 0 on, rigid ground.
        mid_spans: Row of the deflection of each span's axis at its middle, shape (n_span, n_dof).
        vertical: Rigid-body translation upwards of all freedoms, shape (n_dof,); None for an
            inclined beam, whose freedoms have no such motion.
    """

    structure: Subsystem
    path: Path
    mid_spans: SparseMatrix
    vertical: Vector | None


def plane_beams(properties: PlaneBeams, before: float = 0.0, after: float = 0.0) -> BeamOnSupports:
    """Assembles the spans.

    Args:
        properties: The spans and their section.
        before: Length of the rigid ground before the first span; 0 for none. [m]
        after: Length of the rigid ground after the last span; 0 for none. [m]

    Returns:
        Freedoms (w, rotation) of each node in turn, span by span.
    """
    per_span, n_span = properties.elements_per_span, len(properties.spans)
    n_node = n_span * (per_span + 1)
    lengths = np.repeat(np.array(properties.spans) / per_span, per_span)
    first = np.arange(n_span * per_span) + np.repeat(np.arange(n_span), per_span)
    freedoms = 2 * first[:, None] + np.arange(4)
    stiffness, mass = _matrices(properties, lengths, freedoms, 2 * n_node)
    span_start = (per_span + 1) * np.arange(n_span)
    ends = np.stack([span_start, span_start + per_span], axis=1).ravel()
    structure = Subsystem(
        name="the structure",
        mass=mass,
        damping=properties.mass_damping * mass + properties.stiffness_damping * stiffness,
        stiffness=stiffness,
        load=np.zeros(2 * n_node),
        prescribed=2 * ends,
    )
    spans = _span_path(properties, lengths, freedoms, 2 * n_node)
    joints = np.concatenate([[0.0], np.cumsum(properties.spans)])
    middles = spans.rows(*spans.locate(0.5 * (joints[:-1] + joints[1:]))).sparse()
    level = properties.inclination == 0.0
    return BeamOnSupports(
        structure=structure,
        path=between_rigid_ground(spans, before, after),
        mid_spans=middles,
        vertical=np.tile([1.0, 0.0], n_node) if level else None,
    )


def between_rigid_ground(spans: Path, before: float, after: float) -> Path:
    """Straight rigid ground before and after a path, in its directions at the ends.

    Args:
        spans: The path of the spans.
        before: Length of the ground before; 0 for none. [m]
        after: Length of the ground after; 0 for none. [m]

    Returns:
        The whole path, with the chainage of the spans unchanged.
    """
    n_dof = spans.generalised.shape[1]
    parts = [spans]
    if before > 0.0:
        start = spans.ends[0, 0]
        ground = np.stack([start - before * spans.tangents[0, 0], start])
        parts.insert(0, rigid_path(ground, n_dof))
    if after > 0.0:
        end = spans.ends[-1, 1]
        ground = np.stack([end, end + after * spans.tangents[-1, 1]])
        parts.append(rigid_path(ground, n_dof))
    whole = join(parts)
    begin = spans.chainage[0] - (before if before > 0.0 else 0.0)
    return replace(whole, chainage=begin + whole.chainage - whole.chainage[0])


def _matrices(
    properties: PlaneBeams, lengths: Vector, freedoms: IntVector, n_dof: int
) -> tuple[SparseMatrix, SparseMatrix]:
    """Stiffness and consistent mass."""
    phi = _shear_parameter(properties, lengths)
    stiffness = bending_stiffness(lengths, properties.rigidity, phi)
    mass = bending_mass(lengths, properties.mass_per_length, properties.rotary_inertia, phi)
    return (
        scatter([ElementMatrices(freedoms=freedoms, matrices=stiffness)], n_dof),
        scatter([ElementMatrices(freedoms=freedoms, matrices=mass)], n_dof),
    )


def _shear_parameter(properties: PlaneBeams, lengths: Vector) -> Vector:
    """phi = 12 EI / (k G A l^2)."""
    if properties.shear_rigidity is None:
        return np.zeros_like(lengths)
    return 12.0 * properties.rigidity / (properties.shear_rigidity * lengths**2)


def _span_path(properties: PlaneBeams, lengths: Vector, freedoms: IntVector, n_dof: int) -> Path:
    """The path over the spans: each element's own deflection, a cubic.

    With shear deformation the slope is the rotation plus the shear strain, which is constant
    along an element and linear in its freedoms; so the cubic of the element is kept exactly.
    """
    direction = np.array([np.cos(properties.inclination), 0.0, np.sin(properties.inclination)])
    nodes = np.concatenate([[0.0], np.cumsum(lengths)])[:, None] * direction
    phi = _shear_parameter(properties, lengths)
    strain = (
        np.stack(
            [
                -1.0 / lengths,
                -0.5 * np.ones_like(lengths),
                1.0 / lengths,
                -0.5 * np.ones_like(lengths),
            ],
            axis=1,
        )
        * (phi / (1.0 + phi))[:, None]
    )
    rows: FloatArray = np.tile(np.eye(4), (lengths.size, 1, 1))
    rows[:, 1] += strain
    rows[:, 3] += strain
    n_row = 4 * lengths.size
    places = (np.repeat(np.arange(n_row), 4), np.repeat(freedoms, 4, axis=0).ravel())
    generalised = sparse.csr_array((rows.ravel(), places), shape=(n_row, n_dof))
    return replace(rigid_path(nodes, n_dof), generalised=generalised)
