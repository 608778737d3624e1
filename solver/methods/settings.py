"""Settings of an integration, and the state that it yields at every step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from solver.arrays import BoolVector, Vector
from solver.errors import InputError
from solver.integrators.hht import HHT

__all__ = ["Settings", "StepState"]


@dataclass(frozen=True, kw_only=True)
class Settings:
    """How a problem is integrated.

    Attributes:
        method: Time integration.
        n_step: Steps to take.
        tolerance: Residual over load at which Newton's method ends (5.28).
        wheel_tolerance: Residual of a wheel over the load's share of a wheel.
        gap_tolerance: Greatest gap of a closed contact. [m]
        most_iterations: Newton iterations of a step before it is halved.
        most_flips: Status changes of one wheel in a step before it is halved.
        most_halvings: How often a step may be halved before the run stops.
        tangent: Of nonlinear elements other than contact: ``updated`` at every iteration, or
            ``constant``, that of the first step.

    Raises:
        InputError: A value outside its range.
    """

    method: HHT
    n_step: int
    tolerance: float = 1e-6
    wheel_tolerance: float = 1e-4
    gap_tolerance: float = 1e-9
    most_iterations: int = 20
    most_flips: int = 4
    most_halvings: int = 4
    tangent: Literal["updated", "constant"] = "updated"

    def __post_init__(self) -> None:
        ranges = {
            "n_step": (0, 10_000_000), "tolerance": (1e-14, 1e-2),
            "wheel_tolerance": (1e-14, 1e-1), "gap_tolerance": (1e-15, 1e-3),
            "most_iterations": (2, 1000), "most_flips": (1, 1000), "most_halvings": (0, 12),
        }  # fmt: skip
        for name, (least, most) in ranges.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise InputError(f"settings.{name}", value, f"is not between {least} and {most}",
                                 "Leave it out for a good default.")  # fmt: skip
        if self.tangent not in ("updated", "constant"):
            raise InputError("settings.tangent", self.tangent, "is neither updated nor constant",
                             "Leave it out for the updated tangent.")  # fmt: skip

    @property
    def time_step(self) -> float:
        """[s]"""
        return self.method.time_step


@dataclass(kw_only=True)
class StepState:
    """State at the end of a step.

    Attributes:
        step: 0 at the start.
        time: [s]
        displacement: Of all freedoms, structure then vehicle, shape (n_dof,). [m, rad]
        velocity: Likewise.
        acceleration: Likewise; of order 2 against the exact value at ``time + alpha dt``.
        contact_forces: Positive in compression, shape (n_wheel,). [N]
        closed: Which wheels touch, shape (n_wheel,).
        chainage: Place of each wheel on its path, shape (n_wheel,). [m]
        reactions: Of the prescribed freedoms (4.13), the structure's then the vehicle's. [N]
        imbalance: C a' + R(a) - F over the free freedoms, contact forces in F. [N]
        imbalance_prescribed: The same over the prescribed freedoms, reactions in F. [N]
        gap_acceleration: Second derivative of the gaps of rigid contacts of wheels with mass, as
            the accelerations have it, shape (n_wheel,). [m/s2]
        iterations: Newton iterations or contact searches of the step.
        status_changes: Contacts lost or found since the start.
        halvings: Steps halved since the start.
        restarts: Impulses since the start (rigid law).
    """

    step: int
    time: float
    displacement: Vector
    velocity: Vector
    acceleration: Vector
    contact_forces: Vector
    closed: BoolVector
    chainage: Vector
    reactions: Vector
    imbalance: Vector
    imbalance_prescribed: Vector
    gap_acceleration: Vector
    iterations: int = 0
    status_changes: int = 0
    halvings: int = 0
    restarts: int = 0
