"""What every modal analysis finds, of whichever part: frequencies, shapes, and how to draw them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sparse

from solver.arrays import IntVector, Matrix, SparseMatrix, Vector
from solver.results import Geometry, WheelGeometry

__all__ = ["PartModes", "no_wheels", "none_of", "spread"]


@dataclass(frozen=True, kw_only=True)
class PartModes:
    """Modes of one part, in ascending order of frequency.

    Attributes:
        frequencies: Shape (n_mode,). [Hz]
        damping: Damping ratios, the diagonal of the modal damping matrix, shape (n_mode,). [1]
        shapes: Shape (n_dof, n_mode).
        geometry: What is drawn, at rest.
        surface: Displacement of the vertices from the freedoms, shape (3 n_vertex, n_dof).
        wheels: Vertical displacement of the wheels, shape (n_wheel, n_dof).
        bodies: Bounce, roll, pitch of the bodies, shape (3 n_body, n_dof).
        names: What a mode looks like, where that is known, by its index.
        likeness: Assurance criterion of a named mode with the shape that its name means.
        facts: What the summary says about the model.
    """

    frequencies: Vector
    damping: Vector
    shapes: Matrix
    geometry: Geometry
    surface: SparseMatrix
    wheels: SparseMatrix
    bodies: SparseMatrix
    names: dict[int, str] = field(default_factory=dict[int, str])
    likeness: dict[int, float] = field(default_factory=dict[int, float])
    facts: dict[str, object] = field(default_factory=dict[str, object])


def no_wheels() -> WheelGeometry:
    """Of a part that is drawn without a train."""
    return WheelGeometry(
        names=(), offsets=np.zeros(0), lateral=np.zeros(0), contact_height=0.0, radius=0.0
    )


def none_of(n_dof: int) -> SparseMatrix:
    """Rows that read nothing."""
    return sparse.csr_array((0, n_dof))


def spread(unknowns: IntVector, n_unknown: int) -> SparseMatrix:
    """Every freedom from the unknowns.

    Args:
        unknowns: Unknown of each freedom, -1 where it is fixed, shape (n_freedom,).
        n_unknown: How many there are.

    Returns:
        Shape (n_freedom, n_unknown).
    """
    free = np.flatnonzero(unknowns >= 0)
    return sparse.coo_array(
        (np.ones(free.size), (free, unknowns[free])), shape=(unknowns.size, n_unknown)
    ).tocsr()
