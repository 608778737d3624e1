"""Structure and lines, with their effective matrices factorised; ``train_part`` has the train.

Each part answers the same three questions in a step: how would it move if no interface force
acted (``begin``), how compliant is it where the interface forces act, and how does it move once
they are known (``finish``).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sparse

from solver.arrays import BoolVector, FloatArray, IntVector, Matrix, SparseMatrix, Vector
from solver.factorisation import Condense, condense
from solver.factorisation.chain import Chain
from solver.factorisation.positive import positive_inverse
from solver.models.beam_line import BeamLine

__all__ = ["Coefficients", "LinePart", "StructureMatrices", "StructurePart"]


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """What multiplies M, C, K and the forces in the effective equation.

    Attributes:
        mass: A0, 0 in statics. [1/s2]
        damping: (1 + alpha) A1, 0 in statics. [1/s]
        stiffness: 1 + alpha, 1 in statics.
        force: 1 + alpha, 1 in statics.
        memory: alpha, 0 in statics.
    """

    mass: float
    damping: float
    stiffness: float
    force: float
    memory: float

    @classmethod
    def static(cls) -> Coefficients:
        """Coefficients of statics."""
        return cls(mass=0.0, damping=0.0, stiffness=1.0, force=1.0, memory=0.0)

    def effective(self, mass: SparseMatrix, damping: SparseMatrix, stiffness: SparseMatrix) -> Any:
        """Effective matrix of a part (equation 4.18)."""
        return self.mass * mass + self.damping * damping + self.stiffness * stiffness

    def imbalance(self, inertia_force: FloatArray, previous: FloatArray) -> FloatArray:
        """q(n) from M a''(n) and q(n-1); see ``solver.integrators.hht``."""
        return (self.memory * previous - inertia_force) / self.force


@dataclass(frozen=True, kw_only=True)
class StructureMatrices:
    """The three-dimensional structure, pads excluded.

    Attributes:
        mass: Shape (n_dof, n_dof).
        damping: Likewise.
        stiffness: Likewise.
        mass_proportional: Rayleigh coefficient of the dominating part. [1/s]
        stiffness_proportional: Likewise. [s]
        seats: Degree of freedom under each pad, line after line, shape (n_line * n_seat,).
        pad_stiffness: Shape (n_line * n_seat,). [N/m]
        pad_damping: Likewise. [N s/m]
        weight: Own weight, for the bearings' dead load; downward negative, (n_dof,). [N]
    """

    mass: SparseMatrix
    damping: SparseMatrix
    stiffness: SparseMatrix
    mass_proportional: float
    stiffness_proportional: float
    seats: IntVector
    pad_stiffness: Vector
    pad_damping: Vector
    weight: Vector


class StructurePart:
    """The large part: one forward and one backward pass over its factor a step.

    With Rayleigh damping C = a0 M + a1 K + R, the product C c needs no K: K is the effective
    matrix less its other terms, so that a(n+1) = kappa c + Kbar^-1 (...), kappa = a1 / (1 + A1 a1),
    and only M and the small remainder R are multiplied in a step.
    """

    def __init__(
        self,
        matrices: StructureMatrices,
        coefficients: Coefficients,
        condenser: Condense | None = None,
    ) -> None:
        self.matrices = matrices
        self._coefficients = coefficients
        self._mass = sparse.csr_array(matrices.mass)
        effective = coefficients.effective(matrices.mass, matrices.damping, matrices.stiffness)
        condensed = condense if condenser is None else condenser
        self._condensed = condensed(sparse.csr_array(effective), matrices.seats, "the structure")
        self.seat_compliance = positive_inverse(self._condensed.complement, "the structure")
        self.memory_bytes = self._condensed.memory_bytes
        self._remainder = _damping_remainder(matrices)
        self._shift_factor, self._mass_factor = self._rayleigh_factors()
        self._shift = np.zeros(matrices.mass.shape[0])
        self._reduced = np.zeros(matrices.seats.size)
        self.free_seats = np.zeros(matrices.seats.size)

    def _rayleigh_factors(self) -> tuple[float, float]:
        """kappa, and the factor of M c on the right-hand side."""
        c = self._coefficients
        a0, a1 = self.matrices.mass_proportional, self.matrices.stiffness_proportional
        newmark_a1 = c.damping / c.force
        kappa = a1 / (1.0 + newmark_a1 * a1)
        return kappa, c.force * a0 - kappa * (c.mass + c.damping * a0)

    def begin(
        self, inertia: FloatArray, viscous: FloatArray, acceleration: FloatArray, previous: Vector
    ) -> Vector:
        """Takes the histories; returns the imbalance of the last step."""
        c = self._coefficients
        products = self._mass @ np.stack(
            [inertia + self._mass_factor * viscous, acceleration], axis=1
        )
        imbalance = c.imbalance(products[:, 1], previous)
        newmark_a1 = c.damping / c.force
        load = products[:, 0] + c.memory * imbalance
        if self._remainder.nnz:
            factor = c.force * (1.0 - self._shift_factor * newmark_a1)
            load += factor * (self._remainder @ viscous)
        self._shift = self._shift_factor * viscous
        self.begin_load(load)
        return imbalance

    def begin_load(self, load: Vector) -> None:
        """Condenses a load on the seats."""
        self._reduced = self._condensed.forward(load)
        seats = self.matrices.seats
        self.free_seats = self._shift[seats] + self.seat_compliance @ self._reduced

    def finish(self, pad_forces: Vector) -> Vector:
        """Displacement, once the pad forces (up on the seats) are known."""
        loaded = self._reduced + self._coefficients.force * pad_forces
        return self._shift + self._condensed.backward(self.seat_compliance @ loaded)


def _damping_remainder(matrices: StructureMatrices) -> SparseMatrix:
    """R = C - a0 M - a1 K without its zeros."""
    remainder = sparse.csr_array(
        matrices.damping
        - matrices.mass_proportional * matrices.mass
        - matrices.stiffness_proportional * matrices.stiffness
    )
    scale = np.abs(matrices.damping.diagonal()).max(initial=0.0)
    remainder.data[np.abs(remainder.data) <= 1e-13 * scale] = 0.0
    remainder.eliminate_zeros()
    return remainder


class LinePart:
    """The beam lines: the rails with their approach tracks, or a plain beam.

    Sleepers are eliminated exactly, each from the node above it.
    """

    def __init__(self, line: BeamLine, coefficients: Coefficients, table: bool) -> None:
        self.line = line
        self._coefficients = coefficients
        self._mass = sparse.csr_array(line.mass)
        self._damping = sparse.csr_array(line.damping)
        self._free = line.free.ravel()
        effective = sparse.csr_array(
            coefficients.effective(line.mass, line.damping, line.stiffness)
        )
        diagonal, upper = self._condense_sleepers(effective)
        self._chain = Chain(diagonal, upper, "the rail or beam")
        lengths = np.diff(line.positions)
        typical = np.full(line.n_node, lengths[line.connected].mean())
        self.has_table = table and self._chain.prepare_table(typical)
        self.free = np.zeros((2 * line.n_node, line.n_line))
        self._load = np.zeros((line.n_dof, line.n_line))

    def _condense_sleepers(self, effective: SparseMatrix) -> tuple[FloatArray, FloatArray]:
        """Blocks of the chain, sleepers eliminated and fixed freedoms replaced by ones."""
        line, n = self.line, self.line.n_node
        diagonal, upper = _blocks(effective, n)
        if line.sleepers is not None:
            nodes = line.sleepers.nodes
            below = 2 * n + np.arange(nodes.size)
            own = effective.diagonal()[below]
            link = np.asarray(effective[2 * nodes, below]).ravel()
            self._sleeper_ratio = link / own
            self._sleeper_own = own
            np.subtract.at(diagonal[:, 0, 0], nodes, link**2 / own)
        _pin(diagonal, upper, ~line.free)
        return diagonal, upper

    def begin(
        self, inertia: FloatArray, viscous: FloatArray, acceleration: FloatArray, previous: Matrix
    ) -> Matrix:
        """Takes the histories; returns the imbalance of the last step."""
        c = self._coefficients
        imbalance = c.imbalance(self._mass @ acceleration, previous)
        self._load = (
            self._mass @ inertia + c.force * (self._damping @ viscous) + c.memory * imbalance
        )
        self.free = self._chain.solve(self._on_rail(self._load))
        return imbalance

    def _on_rail(self, load: Matrix) -> Matrix:
        """Load on the chain, the sleepers' share included, none on fixed freedoms."""
        n = 2 * self.line.n_node
        on_rail = load[:n].copy()
        if self.line.sleepers is not None:
            nodes = 2 * self.line.sleepers.nodes
            on_rail[nodes] -= self._sleeper_ratio[:, None] * load[n:]
        on_rail[~self._free] = 0.0
        return on_rail

    def finish(self, extra: Matrix) -> Matrix:
        """Displacement under the histories' load and ``extra`` on the chain (2 n_node, n_line)."""
        n = 2 * self.line.n_node
        load = self._load.copy()
        load[:n] += self._coefficients.force * extra
        displacement = np.empty_like(load)
        displacement[:n] = self._chain.solve(self._on_rail(load))
        if self.line.sleepers is not None:
            rail = displacement[2 * self.line.sleepers.nodes]
            displacement[n:] = (
                load[n:] / self._sleeper_own[:, None] - self._sleeper_ratio[:, None] * rail
            )
        return displacement

    def columns(self, nodes: IntVector, rows: FloatArray) -> Matrix:
        """Displacements for unit loads at places (nodes, rows): shape (2 n_node, n_place)."""
        return self._chain.solve(self._unit_loads(nodes, rows))

    def _unit_loads(self, nodes: IntVector, rows: FloatArray) -> Matrix:
        """Unit loads at places, shape (2 n_node, n_place)."""
        loads = np.zeros((2 * self.line.n_node, nodes.size))
        place = np.arange(nodes.size)
        for k in range(4):
            # A place at the last node has no weight beyond it.
            loads[np.minimum(2 * nodes + k, len(loads) - 1), place] += rows[:, k]
        loads[~self._free] = 0.0
        return loads

    def between(
        self, node_a: IntVector, rows_a: FloatArray, node_b: IntVector, rows_b: FloatArray
    ) -> Vector:
        """Compliance between pairs of places; see ``Chain.between``."""
        return self._chain.between(node_a, rows_a, node_b, rows_b)

    def masked(self, nodes: IntVector, rows: FloatArray) -> FloatArray:
        """Rows without the weights of fixed freedoms."""
        columns = 2 * nodes[:, None] + np.arange(4)
        return rows * self._free[columns]

    # -- at the level of the masses: what a restart needs ------------------------------------

    @cached_property
    def _mass_chain(self) -> Chain:
        """The rails' own mass, sleepers apart: they hang on springs, not on the mass."""
        diagonal, upper = _blocks(self._mass, self.line.n_node)
        _pin(diagonal, upper, ~self.line.free)
        return Chain(diagonal, upper, "the mass of the rail or beam")

    def accelerated(self, force: Matrix) -> Matrix:
        """M^-1 times a force on all freedoms (n_dof, n_line); zero where fixed."""
        n = 2 * self.line.n_node
        result = np.empty_like(force)
        on_rail = force[:n].copy()
        on_rail[~self._free] = 0.0
        result[:n] = self._mass_chain.solve(on_rail)
        result[n:] = force[n:] / self._mass.diagonal()[n:, None]
        return result

    def mass_columns(self, nodes: IntVector, rows: FloatArray) -> Matrix:
        """Velocities for unit impulses at places (nodes, rows): shape (2 n_node, n_place)."""
        return self._mass_chain.solve(self._unit_loads(nodes, rows))

    def inertia_force(self, acceleration: Matrix) -> Matrix:
        """M a''."""
        return self._mass @ acceleration

    def damping_force(self, velocity: Matrix) -> Matrix:
        """C a', the pads of the three-dimensional track apart."""
        return self._damping @ velocity

    @property
    def window_length(self) -> float:
        """Distance beyond which the table's compliance is zero. [m]"""
        steps = np.diff(self.line.positions)
        return float((self._chain.window + 1) * steps.max())


def _pin(diagonal: FloatArray, upper: FloatArray, fixed: BoolVector) -> None:
    """Replaces fixed freedoms of the chain by ones, in place."""
    n = diagonal.shape[0]
    for node, freedom in np.argwhere(fixed):
        diagonal[node, freedom, :] = 0.0
        diagonal[node, :, freedom] = 0.0
        diagonal[node, freedom, freedom] = 1.0
        if node < n - 1:
            upper[node, freedom, :] = 0.0
        if node > 0:
            upper[node - 1, :, freedom] = 0.0


def _blocks(matrix: SparseMatrix, n_node: int) -> tuple[FloatArray, FloatArray]:
    """Diagonal and upper 2 x 2 blocks of the chain's leading part."""
    rows = matrix[: 2 * n_node, : 2 * n_node].tocoo()
    first, second = rows.row // 2, rows.col // 2
    diagonal, upper = np.zeros((n_node, 2, 2)), np.zeros((n_node - 1, 2, 2))
    own = first == second
    diagonal[first[own], rows.row[own] % 2, rows.col[own] % 2] = rows.data[own]
    above = second == first + 1
    upper[first[above], rows.row[above] % 2, rows.col[above] % 2] = rows.data[above]
    return diagonal, upper
