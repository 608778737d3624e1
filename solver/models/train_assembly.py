"""Rigid bodies joined by springs and dashpots, assembled from rows of kinematics.

Every motion is a row over the degrees of freedom, so a hinge is an exact elimination: two car ends
that are one hinge simply have the same row. Mass, damping and stiffness are sums of row^T c row and
therefore symmetric and positive semidefinite by construction.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Matrix, Vector
from solver.models.train_model import GRAVITY

__all__ = ["RigidBodyAssembly", "end_height_row", "side_height_row"]


def end_height_row(rows: Matrix, ahead: float) -> Vector:
    """Height of a body's point that lies ahead of its centre (behind it if negative).

    Args:
        rows: Shape (3, n_dof): bounce, roll, pitch of the centre.
        ahead: Distance of the point along the way. [m]

    Returns:
        Shape (n_dof,). Pitch is positive about +y, so a point ahead goes down with it.
    """
    return np.asarray(rows[0] - ahead * rows[2], dtype=np.float64)


def side_height_row(height: Vector, roll: Vector, lateral: float) -> Vector:
    """Height of a body's point at a lateral distance, positive to the left.

    Args:
        height: Shape (n_dof,): row of the height on the body's axis.
        roll: Shape (n_dof,): row of the body's roll.
        lateral: Distance of the point from the axis. [m]

    Returns:
        Shape (n_dof,). Roll is positive about +x, so the left side goes up with it.
    """
    return np.asarray(height + lateral * roll, dtype=np.float64)


class RigidBodyAssembly:
    """Accumulates bodies, springs and dashpots over a fixed set of degrees of freedom."""

    def __init__(self, n_dof: int) -> None:
        self.mass: Matrix = np.zeros((n_dof, n_dof))
        self.damping: Matrix = np.zeros((n_dof, n_dof))
        self.stiffness: Matrix = np.zeros((n_dof, n_dof))
        self.weight: Vector = np.zeros(n_dof)

    def add_body(
        self, rows: Matrix, mass: float, roll_inertia: float = 0.0, pitch_inertia: float = 0.0
    ) -> None:
        """Adds a body's inertia and weight.

        Args:
            rows: Shape (3, n_dof): bounce, roll, pitch of its centre of mass.
            mass: Its mass. [kg]
            roll_inertia: About the longitudinal axis. [kg m2]
            pitch_inertia: About the lateral axis. [kg m2]
        """
        inertia = np.array([mass, roll_inertia, pitch_inertia])
        self.mass += rows.T @ (inertia[:, None] * rows)
        self.weight -= GRAVITY * mass * rows[0]

    def add_spring(self, elongation: Vector, stiffness: float, damping: float) -> None:
        """Adds a spring and a dashpot in parallel.

        Args:
            elongation: Shape (n_dof,): row of the relative displacement of its ends.
            stiffness: Of the spring. [N/m]
            damping: Of the dashpot. [N s/m]
        """
        pair = np.outer(elongation, elongation)
        self.stiffness += stiffness * pair
        self.damping += damping * pair
