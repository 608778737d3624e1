"""A line of beam elements on which wheels roll: a rail with its approach track, or a plain beam.

Each node has a deflection w (upward) and a slope dw/dx; elements are Euler-Bernoulli with cubic
Hermite shape functions and consistent mass. Nodes may be fixed, neighbouring nodes may be
unconnected (a joint between two spans), and sleepers on springs may hang below nodes (the
two-dimensional approach track: rail - pad - sleeper mass - bed).

Several identical lines side by side (the two rails) share one set of matrices: their states are
the columns of one array.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse

from solver.arrays import BoolVector, FloatArray, IntVector, SparseMatrix, Vector
from solver.contact.path import hermite
from solver.elements.beam import bending_mass, bending_stiffness
from solver.errors import InputError

__all__ = ["BeamLine", "Sleepers"]


@dataclass(frozen=True, kw_only=True)
class Sleepers:
    """Sleepers of a two-dimensional track, each under one node.

    Attributes:
        nodes: Node above each sleeper, shape (n_sleeper,).
        pad_stiffness: Between rail and sleeper, shape (n_sleeper,). [N/m]
        pad_damping: Shape (n_sleeper,). [N s/m]
        mass: Sleeper and the ballast that moves with it, one rail's share. [kg]
        bed_stiffness: Between sleeper and ground, one rail's share. [N/m]
        bed_damping: [N s/m]
    """

    nodes: IntVector
    pad_stiffness: Vector
    pad_damping: Vector
    mass: float
    bed_stiffness: float
    bed_damping: float


@dataclass(frozen=True, kw_only=True)
class BeamLine:
    """Matrices and geometry of ``n_line`` identical lines.

    Degrees of freedom: (w, dw/dx) of each node in turn, then the deflection of each sleeper.

    Attributes:
        positions: x of the nodes, not decreasing, shape (n_node,). [m]
        connected: Whether an element joins node i to node i + 1, shape (n_node - 1,).
        free: Which of (w, dw/dx) may move, shape (n_node, 2).
        mass: Shape (n_dof, n_dof). [kg, kg m, kg m2]
        damping: Likewise.
        stiffness: Likewise.
        sleepers: The sleepers, or None.
        n_line: Number of lines, 1 or 2.
    """

    positions: Vector
    connected: BoolVector
    free: BoolVector
    mass: SparseMatrix
    damping: SparseMatrix
    stiffness: SparseMatrix
    sleepers: Sleepers | None
    n_line: int

    @classmethod
    def build(
        cls,
        *,
        positions: Vector,
        rigidity: Vector,
        mass_per_length: Vector,
        free: BoolVector,
        n_line: int,
        sleepers: Sleepers | None = None,
        mass_proportional: float = 0.0,
        stiffness_proportional: float = 0.0,
    ) -> BeamLine:
        """Assembles the line.

        Args:
            positions: x of the nodes, shape (n_node,); equal neighbours are a joint. [m]
            rigidity: EI of the element after each node, shape (n_node - 1,). [N m2]
            mass_per_length: Shape (n_node - 1,). [kg/m]
            free: Which of (w, dw/dx) may move, shape (n_node, 2).
            n_line: Number of identical lines.
            sleepers: Sleepers below nodes.
            mass_proportional: Rayleigh coefficient of the beams. [1/s]
            stiffness_proportional: Rayleigh coefficient of the beams. [s]

        Raises:
            InputError: Positions decrease.
        """
        lengths = np.diff(positions)
        if np.any(lengths < 0.0):
            index = int(np.argmax(lengths < 0.0))
            raise InputError(
                "positions", float(positions[index + 1]), "is left of the node before it",
                "List the nodes from left to right.",
            )  # fmt: skip
        connected = lengths > 0.0
        n_dof = 2 * positions.size + (0 if sleepers is None else sleepers.nodes.size)
        elements = np.flatnonzero(connected)
        real = lengths[elements]
        stiffness = _scatter(bending_stiffness(real, rigidity[elements]), elements, n_dof)
        mass = _scatter(bending_mass(real, mass_per_length[elements]), elements, n_dof)
        damping = mass_proportional * mass + stiffness_proportional * stiffness
        if sleepers is not None:
            mass = mass + _sleeper_mass(sleepers, positions.size, n_dof)
            pads, beds = sleepers.pad_stiffness, sleepers.bed_stiffness
            stiffness = stiffness + _sleeper_springs(sleepers, pads, beds, positions.size, n_dof)
            pads, beds = sleepers.pad_damping, sleepers.bed_damping
            damping = damping + _sleeper_springs(sleepers, pads, beds, positions.size, n_dof)
        return cls(
            positions=positions,
            connected=connected,
            free=free,
            mass=mass.tocsr(),
            damping=damping.tocsr(),
            stiffness=stiffness.tocsr(),
            sleepers=sleepers,
            n_line=n_line,
        )

    @property
    def n_dof(self) -> int:
        """Degrees of freedom of one line, the fixed ones included."""
        return int(self.mass.shape[0])

    @property
    def n_node(self) -> int:
        """Nodes of one line."""
        return self.positions.size

    def dofs_up_to(self, last: int) -> IntVector:
        """Freedoms of the nodes up to one, and of the sleepers below them."""
        nodes = np.arange(2 * (last + 1))
        if self.sleepers is None:
            return nodes
        own = np.flatnonzero(self.sleepers.nodes <= last)
        return np.concatenate([nodes, 2 * self.n_node + own])

    def held_beyond(self, last: int) -> BeamLine:
        """The line up to a node, the next one held: the same matrices without what follows."""
        kept, sleepers = self.dofs_up_to(last), self.sleepers
        if sleepers is not None:
            own = sleepers.nodes <= last
            sleepers = replace(
                sleepers,
                nodes=sleepers.nodes[own],
                pad_stiffness=sleepers.pad_stiffness[own],
                pad_damping=sleepers.pad_damping[own],
            )
        return replace(
            self,
            positions=self.positions[: last + 1],
            connected=self.connected[:last],
            free=self.free[: last + 1],
            mass=self.mass[kept][:, kept],
            damping=self.damping[kept][:, kept],
            stiffness=self.stiffness[kept][:, kept],
            sleepers=sleepers,
        )

    def locate(self, x: Vector) -> tuple[IntVector, FloatArray]:
        """Element under each position and its Hermite rows.

        Args:
            x: Positions, shape (n,). [m]

        Returns:
            Left node of each element, shape (n,), and the rows on (w1, w1', w2, w2'), shape (n, 4).

        Raises:
            InputError: A position is off the line.
        """
        if x.size and (x.min() < self.positions[0] or x.max() > self.positions[-1]):
            worst = x.min() if x.min() < self.positions[0] else x.max()
            raise InputError(
                "path", float(worst), "a wheel is beyond the end of its path",
                "Lengthen the approach track.",
            )  # fmt: skip
        left = np.searchsorted(self.positions, x, side="right") - 1
        left = np.clip(left, 0, self.n_node - 2)
        # At the very end of the line, and at a joint's first node, step back to a real element.
        left = np.where(self.connected[left], left, left - 1)
        length = self.positions[left + 1] - self.positions[left]
        return left, hermite((x - self.positions[left]) / length, length)


def _scatter(blocks: FloatArray, elements: IntVector, n_dof: int) -> SparseMatrix:
    """Element matrices (n, 4, 4) to a sparse matrix; element i joins nodes i and i + 1."""
    dofs = 2 * elements[:, None] + np.arange(4)
    rows = np.repeat(dofs, 4, axis=1).ravel()
    columns = np.tile(dofs, (1, 4)).ravel()
    return sparse.coo_array((blocks.ravel(), (rows, columns)), shape=(n_dof, n_dof)).tocsr()


def _sleeper_mass(sleepers: Sleepers, n_node: int, n_dof: int) -> SparseMatrix:
    dofs = 2 * n_node + np.arange(sleepers.nodes.size)
    values = np.full(dofs.size, sleepers.mass)
    return sparse.coo_array((values, (dofs, dofs)), shape=(n_dof, n_dof)).tocsr()


def _sleeper_springs(
    sleepers: Sleepers, pad: Vector, bed: float, n_node: int, n_dof: int
) -> SparseMatrix:
    """Pads between rail and sleepers, beds between sleepers and ground."""
    rail = 2 * sleepers.nodes
    below = 2 * n_node + np.arange(rail.size)
    rows = np.concatenate([rail, below, rail, below])
    columns = np.concatenate([rail, below, below, rail])
    values = np.concatenate([pad, pad + bed, -pad, -pad])
    return sparse.coo_array((values, (rows, columns)), shape=(n_dof, n_dof)).tocsr()
