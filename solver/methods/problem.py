"""What the four methods of chapter 2 solve: a structure, a vehicle, and wheels on a path."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from solver.arrays import FloatArray, SparseMatrix, Vector
from solver.contact.laws import ContactLaw, RigidContact
from solver.contact.path import Path
from solver.errors import InputError
from solver.irregularities import PerfectRail, RailIrregularity
from solver.models.subsystem import Subsystem

__all__ = ["FreeDrive", "PrescribedSpeed", "Problem", "Wheels"]


@dataclass(frozen=True, kw_only=True)
class PrescribedSpeed:
    """The wheels' places are prescribed: x(t) = x(0) + v t along a straight path.

    Attributes:
        speed: v. [m/s]
    """

    speed: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.speed < 1000.0:
            raise InputError("drive.speed", self.speed, "is not between 0 and 1000 m/s",
                             "Give the speed in m/s.")  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class FreeDrive:
    """The wheels' places are unknowns: forces and inertia decide where they go."""


@dataclass(frozen=True, kw_only=True)
class Wheels:
    """Contact points of the vehicle.

    Attributes:
        names: For messages and channels, one a wheel.
        rows: Displacement (x, y, z) of each contact point from the vehicle's freedoms, each of
            shape (n_wheel, n_vehicle_dof).
        chainage: Place on the path at t = 0, shape (n_wheel,). [m]
    """

    names: tuple[str, ...]
    rows: tuple[SparseMatrix, SparseMatrix, SparseMatrix]
    chainage: Vector

    def __post_init__(self) -> None:
        chainage = np.asarray(self.chainage, dtype=float)
        if chainage.shape != (self.count,) or not np.isfinite(chainage).all():
            raise InputError(
                "wheels.chainage", chainage.tolist(),
                f"is not a finite place for each of {self.count} wheels",
                "Give one place on the path for every name.",
            )  # fmt: skip
        if len(set(self.names)) < self.count:
            raise InputError("wheels.names", self.names, "has a name twice",
                             "Give every wheel a name of its own.")  # fmt: skip

    @property
    def count(self) -> int:
        """Number of wheels."""
        return len(self.names)


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A vehicle on a structure.

    Attributes:
        structure: Its freedoms come first in stacked arrays.
        vehicle: Its freedoms follow.
        wheels: Contact points of the vehicle.
        path: What they roll on.
        law: Contact law.
        drive: Prescribed speed, or free.
        unilateral: Whether contact may open; if not, forces may be tension.
        irregularity: Elevation of the path's surface by chainage, inside the constraint.
        start: ``static`` starts from rest in equilibrium; ``consistent`` from ``displacement``
            and ``velocity`` with the accelerations and forces that belong to them.
        displacement: Start of all freedoms, structure then vehicle; None is zero.
        velocity: Likewise.

    Raises:
        InputError: Shapes that do not fit; a wheel that starts outside its path; a prescribed
            speed on a path that is not straight.
    """

    structure: Subsystem
    vehicle: Subsystem
    wheels: Wheels
    path: Path
    law: ContactLaw = field(default_factory=RigidContact)
    drive: PrescribedSpeed | FreeDrive
    unilateral: bool = True
    irregularity: RailIrregularity = field(default_factory=PerfectRail)
    start: Literal["static", "consistent"] = "static"
    displacement: Vector | None = None
    velocity: Vector | None = None

    def __post_init__(self) -> None:
        n_vehicle, n_wheel = self.vehicle.n_dof, self.wheels.count
        for axis, rows in zip("xyz", self.wheels.rows, strict=True):
            if rows.shape != (n_wheel, n_vehicle):
                raise InputError(
                    f"wheels.rows.{axis}", rows.shape, f"is not of shape ({n_wheel}, {n_vehicle})",
                    "Give one row for every wheel over the vehicle's freedoms.",
                )  # fmt: skip
        if self.path.generalised.shape[1] != self.structure.n_dof:
            raise InputError(
                "path", self.path.generalised.shape[1],
                f"freedoms, but the structure has {self.structure.n_dof}",
                "Build the path over the structure's freedoms.",
            )  # fmt: skip
        self.require_inside(self.wheels.chainage, "start outside")
        if isinstance(self.drive, PrescribedSpeed):
            self._require_straight()
        else:
            self._require_smooth()

    def require_inside(self, chainage: Vector, what: str) -> None:
        """Refuses wheels that are not on the path.

        Args:
            chainage: Of each wheel. [m]
            what: What the wheel would do, for the message.

        Raises:
            InputError: A wheel is not.
        """
        first, last = float(self.path.chainage[0]), float(self.path.chainage[-1])
        outside = ~((chainage >= first) & (chainage <= last))
        if outside.any():
            wheel = int(np.argmax(outside))
            raise InputError(
                f"wheels.chainage[{wheel}]", float(chainage[wheel]),
                f"{self.wheels.names[wheel]} would {what} its path ({first:g} to {last:g} m)",
                "Lengthen the path, or start the vehicle elsewhere.",
            )  # fmt: skip

    def _require_straight(self) -> None:
        tangents = self.path.tangents.reshape(-1, 3)
        if np.abs(tangents - tangents[0]).max() > 1e-9:
            raise InputError(
                "drive", "speed", "the path is not straight",
                "Describe its shape as an irregularity, or let the vehicle roll freely.",
            )  # fmt: skip

    def _require_smooth(self) -> None:
        """A wheel that rolls freely wants one tangent at every point of its path."""
        jumps = np.abs(self.path.tangents[1:, 0] - self.path.tangents[:-1, 1]).max(axis=1)
        if jumps.max(initial=0.0) > 1e-6:
            place = float(self.path.chainage[1 + int(np.argmax(jumps))])
            raise InputError(
                "path", place, "is a kink [m along the path], which free drive cannot roll over",
                "Lay a smooth curve through the points (smooth=True).",
            )  # fmt: skip

    def check_duration(self, duration: float, time_step: float) -> None:
        """Refuses runs that leave the path or step over its elements.

        Raises:
            InputError: The path ends before the vehicle does, or a wheel would step over a
                whole element.
        """
        if not isinstance(self.drive, PrescribedSpeed):
            return
        self.require_inside(self.wheels.chainage + self.drive.speed * duration, "end outside")
        self.require_short(self.drive.speed * time_step, time_step, 0)

    def require_short(self, advance: float, time_step: float, wheel: int) -> None:
        """Refuses a step in which a wheel passes over a whole element of a flexible path.

        Args:
            advance: Of the wheel in the step. [m]
            time_step: [s]
            wheel: Index of the wheel.

        Raises:
            InputError: It does.
        """
        shortest = self.path.shortest_flexible
        if advance > shortest:
            raise InputError(
                "integration.time_step", time_step,
                f"{self.wheels.names[wheel]} advances {advance:.3g} m a step, over elements of "
                f"{shortest:.3g} m",
                f"Use {0.5 * shortest / advance * time_step:.2g} s or less.",
            )  # fmt: skip

    def initial(self) -> tuple[Vector, Vector]:
        """Displacement and velocity of all freedoms at t = 0, structure then vehicle."""
        n_dof = self.structure.n_dof + self.vehicle.n_dof
        values: list[FloatArray] = []
        for title in ("displacement", "velocity"):
            given = getattr(self, title)
            value = np.zeros(n_dof) if given is None else np.array(given, dtype=float)
            if value.shape != (n_dof,) or not np.isfinite(value).all():
                raise InputError(title, value.shape, f"is not {n_dof} finite numbers",
                                 "Give the structure's freedoms, then the vehicle's.")  # fmt: skip
            values.append(value)
        return values[0], values[1]
