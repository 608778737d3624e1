"""The plane beam that beams of solids behave like, local effects of the mesh included.

A wheel on the edge of solids presses a dent into it that no beam theory knows: on the mesh of
section 5.3.2 it is 2.5e-10 m/N, softer than a wheel's Hertz spring, and 6e-10 m/N at the ends of a
span. And a line of supported nodes gives way. So the beam, with shear deformation and rotary
inertia, gets

- a surface: a massless node over each node of the beam, on a spring whose flexibility is that of
  the solids under a wheel there, less that of the beam, both from statics;
- supports with the one stiffness that makes the first natural frequency that of the solids.

Nothing is taken from any time history.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sparse
from scipy.optimize import brentq

from solver.arrays import IntVector, SparseMatrix, Vector
from solver.contact.path import Path, edge_path, join
from solver.factorisation import factorise
from solver.models.plane_beam import (
    BeamOnSupports,
    PlaneBeams,
    between_rigid_ground,
    plane_beams,
)
from solver.models.solid_beam import SolidBeams, solid_beams
from solver.models.subsystem import Subsystem
from solver.verification.spectrum import first_frequencies

__all__ = ["flexibility_under_wheels", "indented_beams"]

_SOFTEST_SUPPORT = 0.05
"""Flexibility of a support over that of the span: with more it would be a bad support."""


def indented_beams(
    beam: PlaneBeams, solids: SolidBeams, before: float, after: float
) -> tuple[BeamOnSupports, float]:
    """Beams with the solids' dents and supports.

    Args:
        beam: Section of the beams; their mesh becomes that of the solids' edges.
        solids: Equal spans.
        before: Length of the rigid ground before the first span. [m]
        after: Length of the rigid ground after the last span. [m]

    Returns:
        The beams and the stiffness of one support. [N/m]
    """
    fine = replace(beam, spans=solids.spans, elements_per_span=solids.elements[0])
    one_beam = replace(fine, spans=solids.spans[:1])
    one_solid = solid_beams(replace(solids, spans=solids.spans[:1]))
    wanted = float(first_frequencies(one_solid.structure, 1)[0])
    places = np.linspace(0.0, solids.spans[0], solids.elements[0] + 1)
    under_wheels = flexibility_under_wheels(one_solid, places)
    probe = np.full(places.size, 1e-10)

    def dents(support: float) -> Vector:
        bare = _beam_with_surface(one_beam, probe, support)
        return under_wheels - (flexibility_under_wheels(bare, places) - probe)

    def excess(support: float) -> float:
        model = _beam_with_surface(one_beam, dents(support), support)
        return float(first_frequencies(model.structure, 1)[0]) - wanted

    middle = solids.spans[0] ** 3 / (48.0 * beam.rigidity)
    support = float(brentq(excess, 1e-4 * middle, _SOFTEST_SUPPORT * middle, rtol=1e-6))
    return _beam_with_surface(fine, dents(support), support, before, after), 1.0 / support


def flexibility_under_wheels(bridge: BeamOnSupports, places: Vector) -> Vector:
    """Displacement of the path under a unit force at the same place, shape of places. [m/N]"""
    structure = bridge.structure
    free = np.setdiff1d(np.arange(structure.n_dof), structure.prescribed)
    rows = bridge.path.rows(*bridge.path.locate(places)).dense()[:, free]
    stiffness = sparse.csr_array(structure.stiffness[free][:, free])
    columns = factorise(stiffness, "the structure").solve(np.ascontiguousarray(rows.T))
    return np.einsum("ij,ji->i", rows, columns)


def _beam_with_surface(
    properties: PlaneBeams, dents: Vector, support: float, before: float = 0.0, after: float = 0.0
) -> BeamOnSupports:
    """Freedoms of the beams, then of their surface, then of the ground below the supports.

    Args:
        properties: The beams.
        dents: Flexibility of the surface at the nodes of each span. [m/N]
        support: Flexibility of a support. [m/N]
        before: Length of rigid ground. [m]
        after: Likewise. [m]
    """
    bare = plane_beams(properties)
    n_span, n_beam, n_line = len(properties.spans), bare.structure.n_dof, dents.size
    axis = np.arange(0, n_beam, 2)
    surface = n_beam + np.arange(axis.size)
    ground = n_beam + axis.size + np.arange(2 * n_span)
    n_dof = n_beam + axis.size + 2 * n_span
    stiffness = _widened(bare.structure.stiffness, n_dof)
    stiffness = stiffness + _springs(surface, axis, np.tile(1.0 / dents, n_span), n_dof)
    supports = np.full(2 * n_span, 1.0 / support)
    stiffness = stiffness + _springs(bare.structure.prescribed, ground, supports, n_dof)
    structure = Subsystem(
        name="the structure",
        mass=_widened(bare.structure.mass, n_dof),
        damping=sparse.csr_array((n_dof, n_dof)),
        stiffness=stiffness,
        load=np.zeros(n_dof),
        prescribed=ground,
    )
    starts = np.concatenate([[0.0], np.cumsum(properties.spans)])
    paths: list[Path] = []
    for span in range(n_span):
        points = np.zeros((n_line, 3))
        points[:, 0] = np.linspace(starts[span], starts[span + 1], n_line)
        nodes = surface[span * n_line : (span + 1) * n_line]
        ones = (np.ones(n_line), (np.arange(n_line), nodes))
        paths.append(edge_path(points, sparse.csr_array(ones, shape=(n_line, n_dof)), "exact"))
    vertical = np.ones(n_dof)
    vertical[1:n_beam:2] = 0.0
    none = sparse.csr_array((n_span, n_dof - n_beam))
    return BeamOnSupports(
        structure=structure,
        path=between_rigid_ground(join(paths), before, after),
        mid_spans=sparse.csr_array(sparse.hstack([bare.mid_spans, none])),
        vertical=vertical,
    )


def _widened(matrix: SparseMatrix, n_dof: int) -> SparseMatrix:
    more = n_dof - matrix.shape[0]
    return sparse.csr_array(sparse.block_diag([matrix, sparse.csr_array((more, more))]))


def _springs(first: IntVector, second: IntVector, stiffness: Vector, n_dof: int) -> SparseMatrix:
    """Springs between freedoms, one a pair."""
    rows = np.concatenate([first, second, first, second])
    columns = np.concatenate([first, second, second, first])
    values = np.concatenate([stiffness, stiffness, -stiffness, -stiffness])
    return sparse.coo_array((values, (rows, columns)), shape=(n_dof, n_dof)).tocsr()
