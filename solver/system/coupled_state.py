"""What the interface of a coupled system keeps from one step to the next."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from solver.arrays import Arrays, BoolVector, Vector, attributes_of, put_back

__all__ = ["CoupledState"]


@dataclass
class CoupledState:
    """Interface forces and statuses at the last step.

    Attributes:
        contact_forces: Shape (n_wheel,). [N]
        closed: Which wheels touch.
        pad_forces: Tension in the pads, line after line. [N]
        compression: Of the nonlinear Hertz springs, negative where open, shape (n_wheel,). [m]
        status_changes: Contacts lost or found since the start.
        small_solves: Solves of the contact problem, Newton iterations included, since the start.
        restarts: Restarts of rigid contact after an event.
        impact_loss: Energy lost in them. [J]
        impact_drive: Work of the drive in them. [J]
    """

    contact_forces: Vector
    closed: BoolVector
    pad_forces: Vector
    compression: Vector
    status_changes: int = 0
    small_solves: int = 0
    restarts: int = 0
    impact_loss: float = 0.0
    impact_drive: float = 0.0

    def arrays(self) -> Arrays:
        """Copies of all attributes."""
        return attributes_of(self)

    def restore(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Takes what ``arrays`` gave."""
        put_back(self, arrays)
