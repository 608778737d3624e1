"""Simply supported beams of eight-node solids in a row, rigid ground before and after.

Each span is a block of rectangular section, meshed regularly. Its supports are the two lines of
nodes across the section at mid-height, on the neutral axis: held vertically and laterally at both
ends, and longitudinally at the first (``pinned_roller``) or at both (``pinned_pinned``). Only so do
the counts of unknowns in Neves (2016) come out: 66 prescribed freedoms in 4.4.2 (two lines of 11
nodes, all three freedoms), 2 x 55 in 5.3.2 (33 + 22 a span). Held longitudinally at both ends
anywhere but on the neutral axis, the beam would act as an arch.

Wheels roll along the line of element edges on top, over the middle of the section.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy.sparse as sparse

from solver.arrays import FloatArray, IntArray, IntVector, SparseMatrix
from solver.assembly.scatter import ElementMatrices, scatter
from solver.contact.path import Path, edge_path, join
from solver.elements import solid
from solver.errors import InputError
from solver.models.plane_beam import BeamOnSupports, between_rigid_ground
from solver.models.subsystem import Subsystem

__all__ = ["SolidBeams", "solid_beams"]

_CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
"""Nodes of an element, in steps of the mesh: lower face counter-clockwise, then the upper."""


@dataclass(frozen=True, kw_only=True)
class SolidBeams:
    """Spans of one rectangular section.

    Attributes:
        spans: Lengths, the first from x = 0. [m]
        width: [m]
        height: [m]
        young_modulus: [Pa]
        poisson_ratio: [1]
        mass_per_length: [kg/m]
        elements: Elements of a span along x, y and z; even across, so that an edge line runs over
            the middle and nodes lie at mid-height and mid-span.
        supports: Whether the second end of each span may move longitudinally.

    Raises:
        InputError: Dimensions that are not positive, odd numbers of elements.
    """

    spans: tuple[float, ...]
    width: float
    height: float
    young_modulus: float
    poisson_ratio: float
    mass_per_length: float
    elements: tuple[int, int, int]
    supports: Literal["pinned_roller", "pinned_pinned"] = "pinned_roller"

    def __post_init__(self) -> None:
        for title in ("width", "height", "young_modulus", "mass_per_length"):
            value = getattr(self, title)
            if not 0.0 < value < np.inf:
                raise InputError(f"beam.{title}", value, "is not positive", "Use more than 0.")
        if not self.spans or not all(0.0 < length < np.inf for length in self.spans):
            raise InputError("beam.spans", self.spans, "are not positive lengths",
                             "Give one length or more.")  # fmt: skip
        if any(count < 2 or count % 2 for count in self.elements):
            raise InputError("beam.elements", self.elements, "are not even numbers of 2 or more",
                             "Use even numbers: nodes lie in the middle.")  # fmt: skip

    @property
    def density(self) -> float:
        """[kg/m3]"""
        return self.mass_per_length / (self.width * self.height)

    @property
    def nodes(self) -> tuple[int, int, int]:
        """Nodes of a span along x, y and z."""
        n_x, n_y, n_z = self.elements
        return n_x + 1, n_y + 1, n_z + 1

    @property
    def nodes_per_span(self) -> int:
        """Nodes of a span."""
        return int(np.prod(self.nodes))

    @property
    def n_dof(self) -> int:
        """Freedoms, prescribed ones included."""
        return 3 * len(self.spans) * self.nodes_per_span


def solid_beams(
    properties: SolidBeams,
    before: float = 0.0,
    after: float = 0.0,
    edge_rows: Literal["exact", "hermite"] = "exact",
) -> BeamOnSupports:
    """Assembles the spans.

    Args:
        properties: The spans and their mesh.
        before: Length of the rigid ground before the first span; 0 for none. [m]
        after: Length of the rigid ground after the last span; 0 for none. [m]
        edge_rows: Linear rows along the edges, with kinks at the nodes, or C1 cubics.

    Returns:
        Freedoms (u, v, w) of each node in turn, span by span, across each section in turn; the
        middles are those of the axis.
    """
    n_dof = properties.n_dof
    stiffness, mass = _matrices(properties)
    structure = Subsystem(
        name="the structure",
        mass=mass,
        damping=sparse.csr_array((n_dof, n_dof)),
        stiffness=stiffness,
        load=np.zeros(n_dof),
        prescribed=_supports(properties),
    )
    n_x, n_y, n_z = properties.elements
    top = _line(properties, n_y // 2, n_z)
    axis = _line(properties, n_y // 2, n_z // 2)
    positions = np.concatenate([[0.0], np.cumsum(np.repeat(np.array(properties.spans) / n_x, n_x))])
    paths: list[Path] = []
    for span, nodes in enumerate(top):
        points = np.zeros((n_x + 1, 3))
        points[:, 0] = positions[span * n_x : (span + 1) * n_x + 1]
        points[:, 2] = 0.5 * properties.height
        paths.append(edge_path(points, _deflections(nodes, n_dof), edge_rows))
    return BeamOnSupports(
        structure=structure,
        path=between_rigid_ground(join(paths), before, after),
        mid_spans=_deflections(axis[:, n_x // 2], n_dof),
        vertical=np.tile([0.0, 0.0, 1.0], n_dof // 3),
    )


def _node(properties: SolidBeams, span: int, x: IntArray, y: IntArray, z: IntArray) -> IntArray:
    """Number of the node at places of the regular mesh."""
    _, across, high = properties.nodes
    return span * properties.nodes_per_span + (x * across + y) * high + z


def _line(properties: SolidBeams, y: int, z: int) -> IntArray:
    """Nodes along each span at one place of the section, shape (n_span, n_x + 1)."""
    x = np.arange(properties.nodes[0])
    spans = range(len(properties.spans))
    return np.stack([_node(properties, s, x, np.array(y), np.array(z)) for s in spans])


def _deflections(nodes: IntVector, n_dof: int) -> SparseMatrix:
    """Rows of the vertical displacement of nodes, shape (n, n_dof)."""
    count = len(nodes)
    return sparse.csr_array((np.ones(count), (np.arange(count), 3 * nodes + 2)), (count, n_dof))


def _supports(properties: SolidBeams) -> IntVector:
    """Prescribed freedoms: lines of nodes across the ends at mid-height."""
    n_x, _, n_z = properties.elements
    across = np.arange(properties.nodes[1])
    found: list[IntVector] = []
    for span in range(len(properties.spans)):
        for x in (0, n_x):
            nodes = _node(properties, span, np.array(x), across, np.array(n_z // 2))
            free_to_slide = x > 0 and properties.supports == "pinned_roller"
            axes = (1, 2) if free_to_slide else (0, 1, 2)
            found.extend(3 * nodes + axis for axis in axes)
    return np.sort(np.concatenate(found)).astype(np.int64)


def _matrices(properties: SolidBeams) -> tuple[SparseMatrix, SparseMatrix]:
    """Stiffness and consistent mass; the elements of a span are all the same one."""
    count = np.array(properties.elements)
    grid = np.stack(np.meshgrid(*(np.arange(n) for n in count), indexing="ij"), axis=-1)
    corners = (grid.reshape(-1, 1, 3) + _CORNERS).transpose(2, 0, 1)
    stiffness: list[ElementMatrices] = []
    mass: list[ElementMatrices] = []
    for span, length in enumerate(properties.spans):
        nodes = _node(properties, span, *corners)
        freedoms = (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), 24)
        size = np.array([length, properties.width, properties.height]) / count
        one: FloatArray = (_CORNERS * size)[None].astype(float)
        shape = (len(nodes), 24, 24)
        k = solid.stiffness(one, properties.young_modulus, properties.poisson_ratio)
        m = solid.mass(one, properties.density)
        stiffness.append(ElementMatrices(freedoms=freedoms, matrices=np.broadcast_to(k, shape)))
        mass.append(ElementMatrices(freedoms=freedoms, matrices=np.broadcast_to(m, shape)))
    return scatter(stiffness, properties.n_dof), scatter(mass, properties.n_dof)
