"""What a contact solver of one step takes and gives, whatever the law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from solver.arrays import BoolVector, Vector
from solver.methods.border import Border
from solver.methods.settings import StepState
from solver.methods.step import StepEquations

__all__ = ["ContactSolution", "ContactSolver", "UnsettledError"]


class UnsettledError(Exception):
    """The contact of a step did not settle: the step has to be shorter.

    Attributes:
        wheel: Name of the worst wheel.
        residual: Its residual. [N]
    """

    def __init__(self, wheel: str, residual: float) -> None:
        self.wheel, self.residual = wheel, residual
        super().__init__(f"{wheel}, residual {residual:.3g} N")


@dataclass(frozen=True, kw_only=True)
class ContactSolution:
    """Solution of one step.

    Attributes:
        displacement: Of the free freedoms, shape (n_F,).
        forces: Contact forces, shape (n_wheel,). [N]
        closed: Shape (n_wheel,).
        border: Contact rows at the solution.
        iterations: Newton iterations or contact searches.
    """

    displacement: Vector
    forces: Vector
    closed: BoolVector
    border: Border
    iterations: int


class ContactSolver(Protocol):
    """Solves the contact of a step; its large factor belongs to one step length."""

    def solve(
        self, step: StepEquations, state: StepState, keep_closed: BoolVector | None = None
    ) -> ContactSolution:
        """Displacements and contact forces at the end of the step.

        Args:
            step: The step's equations.
            state: State at its beginning.
            keep_closed: Wheels that must not open, shape (n_wheel,).

        Raises:
            UnsettledError: No admissible contact state within the allowed iterations.
            InputError: A wheel leaves its path.
        """
        ...
