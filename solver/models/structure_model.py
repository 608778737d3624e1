"""The structure as the solver sees it: matrices of its unknowns, rail seats, mesh for drawing."""

from __future__ import annotations

from dataclasses import dataclass

from solver.arrays import IntArray, IntVector, Matrix, SparseMatrix, Vector

__all__ = ["StructureModel"]


@dataclass(frozen=True, kw_only=True)
class StructureModel:
    """Viaduct and three-dimensional track, or track alone, without pads and rails.

    Supports and rigid connections are eliminated exactly. Rotations about a plate's normal have no
    mass: ``mass`` is singular, ``stiffness`` is positive definite.

    Attributes:
        mass: Shape (n_dof, n_dof). [kg]
        stiffness: Shape (n_dof, n_dof). [N/m]
        damping: Shape (n_dof, n_dof). [N s/m]
        mass_proportional: Rayleigh factor of the greater part: ``damping - mass_proportional mass
            - stiffness_proportional stiffness`` vanishes there. [1/s]
        stiffness_proportional: The other factor of that pair. [s]
        weight: Own weight under 9.81 m/s2, downward negative, shape (n_dof,). [N]
        seat_dofs: Unknown that is the upward displacement of a sleeper's top under a rail, shape
            (2, n_seat), left rail first.
        seat_positions: Shape (n_seat,). [m]
        pad_stiffness: Shape (n_seat,). [N/m]
        pad_damping: Shape (n_seat,). [N s/m]
        node_coordinates: Shape (n_node, 3). [m]
        displacement_operator: Translations of all nodes (row 3 node + axis) from the unknowns,
            shape (3 n_node, n_dof).
        surfaces: Outer quadrilaterals of each layer (slab, beam, walls, ballast, sleepers), shape
            (n_face, 4).
        slab_nodes: Nodes of the upper slab, shape (n_slab_node,).
        span_of_slab_node: Shape (n_slab_node,).
        bearing_positions: Shape (n_bearing, 3). [m]
        bearing_span: Shape (n_bearing,).
        bearing_stiffness: Vertical stiffness, shape (n_bearing,). [N/m]
        bearing_operator: Upward displacement of the deck at the bearings, shape (n_bearing, n_dof);
            times ``bearing_stiffness`` it is the tension in the bearing. [1]
        joints: Ends of the spans, shape (n_span + 1,); empty without a viaduct. [m]
        part_names: Names of the layers in ``surfaces``.
    """

    mass: SparseMatrix
    stiffness: SparseMatrix
    damping: SparseMatrix
    mass_proportional: float
    stiffness_proportional: float
    weight: Vector
    seat_dofs: IntArray
    seat_positions: Vector
    pad_stiffness: Vector
    pad_damping: Vector
    node_coordinates: Matrix
    displacement_operator: SparseMatrix
    surfaces: dict[str, IntArray]
    slab_nodes: IntVector
    span_of_slab_node: IntVector
    bearing_positions: Matrix
    bearing_span: IntVector
    bearing_stiffness: Vector
    bearing_operator: SparseMatrix
    joints: Vector
    part_names: tuple[str, ...]

    @property
    def n_dof(self) -> int:
        """Number of unknowns."""
        return int(self.mass.shape[0])
