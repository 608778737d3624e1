"""A vehicle at rest on its wheels: displacements and contact forces together.

A free vehicle is singular without contact, hence the bordered system (modelling decision)

    [K   -W'] [z]   [weight]
    [W    S ] [X] = [  r   ]

with S the static compliance under the wheels, the springs of a linear law included. For the
nonlinear Hertz law Newton's method repeats it with the tangent of each contact,

    X = F(d) + F'(d) (d_new - d),

from the compressions of the reference load on; by the odd continuation of the law, so that a
wheel that would have to be pulled shows its tension.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
import scipy.linalg as dense

from solver.arrays import Matrix, Vector
from solver.contact.laws import NonlinearHertz
from solver.contact.nonlinear import contact_force, contact_stiffness
from solver.errors import ConvergenceError, SingularSystemError

__all__ = ["StandingVehicle"]

_TOLERANCE = 1e-11
"""Residual of a contact force over the greatest one."""
_MOST_ITERATIONS = 50


@dataclass(frozen=True, kw_only=True)
class StandingVehicle:
    """What stands on the wheels.

    Attributes:
        name: For messages.
        stiffness: K, shape (n_dof, n_dof).
        weight: Shape (n_dof,). [N]
        rows: W, upward displacement of the contact points, shape (n_wheel, n_dof).
    """

    name: str
    stiffness: Matrix
    weight: Vector
    rows: Matrix

    def on_linear(self, compliance: Matrix, elevation: Vector) -> tuple[Vector, Vector]:
        """Displacements and contact forces for rigid or linear contact.

        Args:
            compliance: S, shape (n_wheel, n_wheel). [m/N]
            elevation: r, shape (n_wheel,). [m]

        Raises:
            SingularSystemError: The vehicle can move without resistance.
        """
        n_dof, n_wheel = self.weight.size, elevation.size
        if n_dof + n_wheel == 0:
            return np.zeros(0), np.zeros(0)
        scale = float(np.abs(self.stiffness).max(initial=0.0)) or 1.0
        matrix = np.zeros((n_dof + n_wheel, n_dof + n_wheel))
        matrix[:n_dof, :n_dof] = self.stiffness / scale
        matrix[:n_dof, n_dof:] = -self.rows.T
        matrix[n_dof:, :n_dof] = self.rows
        matrix[n_dof:, n_dof:] = compliance * scale
        load = np.concatenate([self.weight / scale, elevation])
        try:
            with warnings.catch_warnings():
                # Singular but for rounding: the forces would be noise that still adds up.
                warnings.simplefilter("error", dense.LinAlgWarning)
                solution = dense.solve(matrix, load)
        except (dense.LinAlgError, dense.LinAlgWarning) as error:
            raise SingularSystemError(self.name, "a body moves without any spring") from error
        return solution[:n_dof], solution[n_dof:] * scale

    def on_hertz(
        self, compliance: Matrix, elevation: Vector, law: NonlinearHertz
    ) -> tuple[Vector, Vector, Vector]:
        """Displacements, contact forces and compressions for the nonlinear law.

        Raises:
            SingularSystemError: The vehicle can move without resistance.
            ConvergenceError: Newton's method did not settle.
        """
        d = np.full(elevation.size, law.reference_compression)
        least = 1e-6 * contact_stiffness(law, d, False)
        residual = np.zeros_like(d)
        for _ in range(_MOST_ITERATIONS):
            # A contact without any force has no tangent; a small one moves it on.
            tangent = np.maximum(contact_stiffness(law, d, False), least)
            force = contact_force(law, d, False)
            softer = compliance + np.diag(1.0 / tangent)
            vehicle, forces = self.on_linear(softer, elevation - d + force / tangent)
            d = d + (forces - force) / tangent
            residual = forces - contact_force(law, d, False)
            largest = np.abs(forces).max(initial=law.reference_force)
            if np.abs(residual).max(initial=0.0) <= _TOLERANCE * largest:
                return vehicle, contact_force(law, d, False), d
        wheel = int(np.argmax(np.abs(residual)))
        raise ConvergenceError(0.0, f"wheel {wheel + 1}", float(residual[wheel]))
