"""What the coupled system is made of: train, rails, structure, irregularity, contact law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import IntVector, Matrix, Vector
from solver.contact.laws import NonlinearHertz
from solver.irregularities import RailIrregularity
from solver.models.beam_line import BeamLine
from solver.system.parts import StructureMatrices

__all__ = ["Irregularity", "RailProfiles", "System", "TrainMatrices"]

Irregularity = Callable[[IntVector, Vector], Vector]
"""Elevation r of the rail under wheels at x: (lines, x) to r. [m]"""

_DIFFERENCE = 1e-5
"""Step ahead of a wheel of the differences of an elevation that brings no derivatives: rounding
leaves 1e-9 of the slope and 1e-4 m/s2 of the vertical acceleration at 100 m/s. [m]"""


@dataclass(frozen=True, kw_only=True)
class RailProfiles:
    """The irregularity of every line, with its exact derivatives.

    Attributes:
        profiles: One a line.
    """

    profiles: tuple[RailIrregularity, ...]

    def __call__(self, lines: IntVector, x: Vector) -> Vector:
        """Elevation r. [m]"""
        return self._choose(lines, [profile.elevation(x) for profile in self.profiles])

    def derivative(self, lines: IntVector, x: Vector, order: int) -> Vector:
        """dr/dx (order 1) or d2r/dx2 (order 2)."""
        if order == 1:
            return self._choose(lines, [profile.slope(x) for profile in self.profiles])
        return self._choose(lines, [profile.curvature(x) for profile in self.profiles])

    @staticmethod
    def _choose(lines: IntVector, values: list[Vector]) -> Vector:
        chosen = values[-1]
        for line in range(len(values) - 2, -1, -1):
            chosen = np.where(lines == line, values[line], chosen)
        return chosen


@dataclass(frozen=True, kw_only=True)
class TrainMatrices:
    """The train as the system sees it.

    Attributes:
        mass: Shape (n_dof, n_dof).
        damping: Likewise.
        stiffness: Likewise.
        weight: Gravity load, shape (n_dof,). [N]
        wheel_rows: Upward displacement of each contact point, shape (n_wheel, n_dof).
        wheel_offsets: x of each wheel less x of the first axle. [m]
        wheel_lines: Line that each wheel rolls on.
        wheel_rest: Displacement of the contact points where the freedoms are zero, (n_wheel,). [m]
    """

    mass: Matrix
    damping: Matrix
    stiffness: Matrix
    weight: Vector
    wheel_rows: Matrix
    wheel_offsets: Vector
    wheel_lines: IntVector
    wheel_rest: Vector

    def from_rest(self, displacement: Vector) -> TrainMatrices:
        """The same train, its freedoms counted from another state.

        Suspensions deflect by decimetres at rest and move by millimetres in a run: counted from
        rest, accelerations keep two digits more of the displacements that they are made of.
        """
        return replace(
            self,
            weight=self.weight - self.stiffness @ displacement,
            wheel_rest=self.wheel_rest + self.wheel_rows @ displacement,
        )


@dataclass(frozen=True, kw_only=True)
class System:
    """Parts, and what joins them.

    Attributes:
        line: Rails with approach tracks, or a beam.
        seat_nodes: Node of the line above each seat of the structure, shape (n_seat,).
        structure: The three-dimensional structure, or None.
        train: The train.
        contact_compliance: 1 / k_h, 0 for rigid contact and the nonlinear law. [m/N]
        unilateral: Whether contact may open.
        irregularity: Elevation of the rails.
        start_position: x of the first axle at t = 0. [m]
        speed: [m/s]
        nonlinear_hertz: The nonlinear contact law, None for the rigid and the linear one.
    """

    line: BeamLine
    seat_nodes: IntVector
    structure: StructureMatrices | None
    train: TrainMatrices
    contact_compliance: float
    unilateral: bool
    irregularity: Irregularity
    start_position: float
    speed: float
    nonlinear_hertz: NonlinearHertz | None = None

    def wheel_positions(self, time: float) -> Vector:
        """x of every wheel, shape (n_wheel,). [m]"""
        return self.start_position + self.speed * time + self.train.wheel_offsets

    @property
    def is_rigid(self) -> bool:
        """Whether no spring lies between wheel and rail."""
        return self.nonlinear_hertz is None and self.contact_compliance == 0.0

    def irregularity_derivative(self, x: Vector, order: int) -> Vector:
        """dr/dx (order 1) or d2r/dx2 (order 2) just ahead of wheels at x, shape (n_wheel,).

        An elevation that is a mere function is differenced ahead of the wheel, where it is
        smooth when a kink has just been passed.
        """
        lines = self.train.wheel_lines
        if isinstance(self.irregularity, RailProfiles):
            return self.irregularity.derivative(lines, x, order)
        h = _DIFFERENCE
        values = [self.irregularity(lines, x + k * h) for k in range(6)]
        if order == 1:
            return (-3.0 * values[0] + 4.0 * values[1] - values[2]) / (2.0 * h)
        near = (values[0] - 2.0 * values[1] + values[2]) / h**2
        beyond = (values[3] - 2.0 * values[4] + values[5]) / h**2
        # A kink between the places counts in one difference only, and is no curvature.
        least = np.where(np.abs(near) < np.abs(beyond), near, beyond)
        return np.where(near * beyond > 0.0, least, 0.0)
