"""The train as a part of the coupled system, with its effective matrix factorised."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.linalg as dense

from solver.arrays import BoolVector, FloatArray, Matrix, Vector
from solver.factorisation.positive import positive_inverse
from solver.system.parts import Coefficients

__all__ = ["TrainPart"]

_MASSLESS = 1e-12
"""Share of the greatest mass, or of a mass scaled to one, below which a freedom has none."""


class TrainPart:
    """The train: a few hundred unknowns, dense."""

    def __init__(
        self,
        mass: Matrix,
        damping: Matrix,
        stiffness: Matrix,
        weight: Vector,
        wheel_rows: Matrix,
        coefficients: Coefficients,
    ) -> None:
        self._mass, self._damping = mass, damping
        self._weight, self._rows = weight, wheel_rows
        self._coefficients = coefficients
        effective = coefficients.effective(mass, damping, stiffness)
        self._inverse = positive_inverse(effective, "the train")
        self._wheel_columns = self._inverse @ wheel_rows.T
        self.wheel_compliance = wheel_rows @ self._wheel_columns
        self._free = np.zeros(weight.size)
        self.free_wheels = np.zeros(wheel_rows.shape[0])

    def begin(
        self, inertia: FloatArray, viscous: FloatArray, acceleration: FloatArray, previous: Vector
    ) -> Vector:
        """Takes the histories; returns the imbalance of the last step."""
        c = self._coefficients
        imbalance = c.imbalance(self._mass @ acceleration, previous)
        load = self._mass @ inertia + c.force * (self._damping @ viscous + self._weight)
        self._free = self._inverse @ (load + c.memory * imbalance)
        self.free_wheels = self._rows @ self._free
        return imbalance

    def finish(self, contact_forces: Vector) -> Vector:
        """Displacement, once the contact forces (up on the wheels) are known."""
        return self._free + self._coefficients.force * (self._wheel_columns @ contact_forces)

    # -- at the level of the masses: what a restart needs ------------------------------------

    @cached_property
    def mobility(self) -> Matrix:
        """A symmetric inverse of the mass on the freedoms that have mass, zero elsewhere."""
        vectors, values, scale = self._mass_modes
        moving = values > _MASSLESS
        scaled = vectors[:, moving] * scale[:, None]
        return (scaled / values[moving]) @ scaled.T

    @cached_property
    def wheels_with_mass(self) -> BoolVector:
        """Wheels that no massless freedom moves, shape (n_wheel,)."""
        vectors, values, scale = self._mass_modes
        massless = vectors[:, values <= _MASSLESS] * scale[:, None]
        moved = np.abs(self._rows @ massless).max(axis=1, initial=0.0)
        reach = np.abs(self._rows * scale).max(axis=1, initial=0.0)
        return moved <= 1e-9 * reach

    @cached_property
    def _mass_modes(self) -> tuple[Matrix, Vector, Vector]:
        """Eigenvectors and eigenvalues of the mass scaled to a unit diagonal, and the scale."""
        diagonal = self._mass.diagonal()
        least = _MASSLESS * diagonal.max(initial=0.0)
        scale = np.where(diagonal > least, 1.0 / np.sqrt(np.maximum(diagonal, least)), 1.0)
        scaled = self._mass * np.outer(scale, scale)
        scaled[diagonal <= least] = 0.0
        scaled[:, diagonal <= least] = 0.0
        values, vectors = dense.eigh(scaled)
        return vectors, values, scale

    def inertia_force(self, acceleration: Vector) -> Vector:
        """M a''."""
        return self._mass @ acceleration

    def damping_force(self, velocity: Vector) -> Vector:
        """C a'."""
        return self._damping @ velocity
