"""Simple vehicles: sprung masses, and masses that move in a vertical plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from solver.arrays import SparseMatrix, Vector
from solver.methods.problem import Wheels
from solver.models.subsystem import Subsystem

__all__ = ["GRAVITY", "Vehicle", "ground_only", "plane_masses", "sprung_masses"]

GRAVITY = 9.81
"""[m/s2]"""


@dataclass(frozen=True, kw_only=True)
class Vehicle:
    """A vehicle with its wheels.

    Attributes:
        subsystem: Its freedoms.
        wheels: Its contact points.
        masses: Rows of the vertical displacements of its masses, shape (n_mass, n_dof).
        vertical: Rigid-body translation upwards, shape (n_dof,).
    """

    subsystem: Subsystem
    wheels: Wheels
    masses: SparseMatrix
    vertical: Vector


def sprung_masses(
    chainage: Vector, *, mass: float, stiffness: float, damping: float = 0.0
) -> Vehicle:
    """Masses, each on a spring and dashpot over a massless contact point.

    Args:
        chainage: Place of each contact point at t = 0, shape (n_wheel,). [m]
        mass: [kg]
        stiffness: [N/m]
        damping: [N s/m]

    Returns:
        Freedoms: contact point and mass of each in turn, upwards.
    """
    count = len(chainage)
    spring = sparse.kron(sparse.eye_array(count), np.array([[1.0, -1.0], [-1.0, 1.0]]), "csr")
    rows = sparse.eye_array(2 * count, format="csr")
    nothing = sparse.csr_array((count, 2 * count))
    subsystem = Subsystem(
        name="the vehicle",
        mass=sparse.diags_array(np.tile([0.0, mass], count), format="csr"),
        damping=damping * spring,
        stiffness=stiffness * spring,
        load=np.tile([0.0, -mass * GRAVITY], count),
    )
    wheels = Wheels(
        names=tuple(f"wheel {i + 1}" for i in range(count)),
        rows=(nothing, nothing, rows[0::2]),
        chainage=np.array(chainage, dtype=float),
    )
    return Vehicle(
        subsystem=subsystem, wheels=wheels, masses=rows[1::2], vertical=np.ones(2 * count)
    )


def plane_masses(chainage: Vector, *, mass: float, load: Vector) -> Vehicle:
    """Point masses that move in the vertical plane through the track, each its own contact point.

    Args:
        chainage: Place of each at t = 0, shape (n_wheel,). [m]
        mass: Of each. [kg]
        load: Force on each, along x and upwards, shape (2,). [N]

    Returns:
        Freedoms: displacement along x and upwards of each mass in turn.
    """
    count = len(chainage)
    rows = sparse.eye_array(2 * count, format="csr")
    empty = sparse.csr_array((2 * count, 2 * count))
    subsystem = Subsystem(
        name="the vehicle",
        mass=mass * rows,
        damping=empty,
        stiffness=empty,
        load=np.tile(load, count),
    )
    wheels = Wheels(
        names=tuple(f"mass {i + 1}" for i in range(count)),
        rows=(rows[0::2], sparse.csr_array((count, 2 * count)), rows[1::2]),
        chainage=np.array(chainage, dtype=float),
    )
    return Vehicle(
        subsystem=subsystem,
        wheels=wheels,
        masses=rows[1::2],
        vertical=np.tile([0.0, 1.0], count),
    )


def ground_only() -> Subsystem:
    """A structure of one freedom that nothing touches: rigid ground needs none."""
    one = sparse.csr_array(np.ones((1, 1)))
    return Subsystem(
        name="the structure",
        mass=one,
        damping=sparse.csr_array((1, 1)),
        stiffness=one,
        load=np.zeros(1),
    )
