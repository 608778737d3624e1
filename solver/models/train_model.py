"""The train as the solver sees it: matrices, weights and wheels of a system of rigid bodies.

Signs: z upwards; roll is positive about +x (left side up); pitch is positive about +y (nose down).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from solver.arrays import IntVector, Matrix, Vector

__all__ = ["GRAVITY", "LEFT", "RIGHT", "WHEEL_RADIUS", "Body", "BodyKind", "TrainModel"]

GRAVITY = 9.81
"""Acceleration of gravity. [m/s2]"""
WHEEL_RADIUS = 0.46
"""Nominal rolling radius of the KHST's wheels (Neves 2016, section 6.2.2); others are drawn with
it too. [m]"""
LEFT, RIGHT = 0, 1
"""Index of the left rail (y > 0) and of the right rail (y < 0)."""

BodyKind = Literal["carbody", "bogie", "wheelset"]


@dataclass(frozen=True, kw_only=True)
class Body:
    """One rigid body. Drawn offset, length, width, height and base height serve drawing only.

    Attributes:
        name: For example ``carbody 03``.
        kind: What it is.
        mass: Its mass. [kg]
        offset: x of its centre of mass minus the first axle's x. [m]
        drawn_offset: x of the drawn box's centre minus the first axle's x. [m]
        length: Drawn extent along x. [m]
        width: Drawn extent along y. [m]
        height: Drawn extent along z. [m]
        base_height: Drawn underside above the top of rail. [m]
        rows: Shape (3, n_dof): bounce, roll and pitch of its centre from the degrees of freedom.
    """

    name: str
    kind: BodyKind
    mass: float
    offset: float
    drawn_offset: float
    length: float
    width: float
    height: float
    base_height: float
    rows: Matrix


@dataclass(frozen=True, kw_only=True)
class TrainModel:
    """A train's matrices and the places of its wheels.

    Attributes:
        name: The train's name.
        mass: Shape (n_dof, n_dof). [kg, kg m2]
        damping: Shape (n_dof, n_dof). [N s/m, N m s]
        stiffness: Shape (n_dof, n_dof); singular, the train stands on nothing. [N/m, N m]
        weight: Shape (n_dof,): load of gravity, negative is downwards. [N, N m]
        wheel_rows: Shape (n_wheel, n_dof): upward displacement of each wheel's contact point.
        wheel_offsets: Shape (n_wheel,): x of the wheel minus x of the first axle, at most 0. [m]
        wheel_rail: Shape (n_wheel,): 0 on the left rail, 1 on the right.
        wheel_lateral: Shape (n_wheel,): y of the wheel's contact point. [m]
        wheel_names: Length n_wheel, for example ``wheel 01 left``.
        wheel_radius: Nominal rolling radius. [m]
        axle_offsets: Shape (n_axle,): x of the axle minus x of the first axle, at most 0. [m]
        bodies: Every rigid body, in the order of the train.
        dof_names: Length n_dof, for example ``bogie 01 pitch``.
    """

    name: str
    mass: Matrix
    damping: Matrix
    stiffness: Matrix
    weight: Vector
    wheel_rows: Matrix
    wheel_offsets: Vector
    wheel_rail: IntVector
    wheel_lateral: Vector
    wheel_names: tuple[str, ...]
    wheel_radius: float
    axle_offsets: Vector
    bodies: tuple[Body, ...]
    dof_names: tuple[str, ...]

    @property
    def n_dof(self) -> int:
        """Number of degrees of freedom."""
        return len(self.weight)

    @property
    def n_wheel(self) -> int:
        """Number of wheels."""
        return len(self.wheel_offsets)

    @property
    def length(self) -> float:
        """Distance from the first to the last axle. [m]"""
        return float(-np.min(self.axle_offsets))

    @property
    def total_mass(self) -> float:
        """Mass of all bodies together. [kg]"""
        return float(sum(body.mass for body in self.bodies))
