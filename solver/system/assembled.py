"""Structure, pads and rails in one sparse matrix: for modes, and as a second formulation in tests.

A run never builds it: there the rails, the train and the structure stay apart. Unknowns: the
structure's, then the lines' (line after line).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from solver.arrays import IntVector, SparseMatrix, Vector
from solver.errors import InputError
from solver.system.coupled import System

__all__ = ["AssembledTrack", "assemble_track"]


@dataclass(frozen=True, kw_only=True)
class AssembledTrack:
    """Structure, pads and rails assembled.

    Attributes:
        mass: Shape (n_dof, n_dof).
        damping: Likewise, pad dashpots included.
        stiffness: Likewise, pads included.
        n_structure: Unknowns of the structure; they come first.
        line_dofs: Unknown of each freedom of each line, -1 where it is fixed, shape
            (n_line, n_line_dof).
    """

    mass: SparseMatrix
    damping: SparseMatrix
    stiffness: SparseMatrix
    n_structure: int
    line_dofs: IntVector


def assemble_track(system: System) -> AssembledTrack:
    """Assembles structure, pads and rails.

    Raises:
        InputError: The system has no structure.
    """
    structure, line = system.structure, system.line
    if structure is None:
        raise InputError(
            "viaduct", "beam", "has no three-dimensional structure", "Use a U-girder viaduct."
        )
    n_structure, n_seat = structure.mass.shape[0], system.seat_nodes.size
    free = np.ones(line.n_dof, dtype=bool)
    free[: line.free.size] = line.free.ravel()
    selection = sparse.csr_array(sparse.eye_array(line.n_dof))[np.flatnonzero(free)]
    n_free = int(free.sum())
    line_dofs = np.full((line.n_line, line.n_dof), -1)
    for number in range(line.n_line):
        line_dofs[number, free] = n_structure + number * n_free + np.arange(n_free)
    n_dof = n_structure + line.n_line * n_free
    rails = line_dofs[:, 2 * system.seat_nodes].ravel()
    jump = sparse.coo_array(
        (
            np.concatenate([np.ones(rails.size), -np.ones(rails.size)]),
            (
                np.tile(np.arange(line.n_line * n_seat), 2),
                np.concatenate([rails, structure.seats]),
            ),
        ),
        shape=(line.n_line * n_seat, n_dof),
    ).tocsr()

    def whole(own: SparseMatrix, rail: SparseMatrix, pads: Vector | None) -> SparseMatrix:
        on_rail = selection @ rail @ selection.T
        matrix = sparse.block_diag([own, *([on_rail] * line.n_line)], format="csr")
        return matrix if pads is None else matrix + jump.T @ sparse.diags_array(pads) @ jump

    return AssembledTrack(
        mass=whole(structure.mass, line.mass, None),
        damping=whole(structure.damping, line.damping, structure.pad_damping),
        stiffness=whole(structure.stiffness, line.stiffness, structure.pad_stiffness),
        n_structure=n_structure,
        line_dofs=line_dofs,
    )
