"""The penalty method (section 2.3.3): a stiff spring in place of the constraint (2.61),

    [K + (1 + alpha) p H'H] a = F + (1 + alpha) p H' r,   X = p (r - H a),

K and F the effective matrix and load of structure and vehicle, p the penalty factor. No unknown is
added, but wheels enter the path's surface by X / p: the contact forces are wrong by about
1 / (p C) of their value, C = (1 + alpha) H K^-1 H' the effective compliance of the contact, until
rounding, which grows with p, takes over.

Two ways to solve it. ``refactorise`` is the classical one: the matrix changes as the wheels move,
and is factorised anew at every step. ``update`` keeps one factor of K and adds the springs by the
formula of Woodbury; it then *is* the direct method with 1 / p on the diagonal of the contact block,
that is, with a linear Hertz spring of stiffness p.

A linear Hertz law is a spring already: its stiffness is taken for p, and nothing is left to err.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from solver.arrays import BoolVector, Vector
from solver.contact.laws import LinearHertz
from solver.errors import InputError
from solver.factorisation.blocks import TwoBlockFactorisation
from solver.integrators.hht import HHT
from solver.methods.border import Border, Borders
from solver.methods.contact_step import ContactSolution
from solver.methods.partitioned import (
    effective_factorisation,
    known_elevation,
    require_bilateral,
)
from solver.methods.settings import StepState
from solver.methods.stacked import Stacked
from solver.methods.step import StepEquations

__all__ = ["PenaltyContactSolver", "PenaltyOptions", "default_penalty"]


@dataclass(frozen=True, kw_only=True)
class PenaltyOptions:
    """Options of the penalty method.

    Attributes:
        factor: Penalty over the greatest effective stiffness at the contact; see
            ``default_penalty``. [1]
        penalty: p itself; None takes ``factor``. [N/m]
        solution: ``refactorise`` at every step, or ``update`` one factor.

    Raises:
        InputError: A value outside its range.
    """

    factor: float = 1e4
    penalty: float | None = None
    solution: Literal["refactorise", "update"] = "refactorise"

    def __post_init__(self) -> None:
        given = {"factor": self.factor, "penalty": self.penalty}
        for name, value in given.items():
            if value is not None and not 0.0 < value < np.inf:
                raise InputError(f"penalty.{name}", value, "is not a positive number",
                                 "Leave it out for a good default.")  # fmt: skip
        if self.solution not in ("refactorise", "update"):
            raise InputError("penalty.solution", self.solution, "is unknown",
                             "Use refactorise or update.")  # fmt: skip


def default_penalty(stacked: Stacked, borders: Borders, method: HHT, factor: float) -> float:
    """Penalty "significantly larger than the diagonal terms" (2.59).

    Returns:
        ``factor`` times the greatest diagonal stiffness that a wheel, or a node of the path, has
        in the effective matrix along the contact. [N/m]
    """
    diagonal = stacked.whole(
        stacked.effective(method).diagonal(), np.zeros(stacked.prescribed.size)
    )
    wheels = stacked.problem.wheels
    border = borders.at(0.0, np.zeros(stacked.n_dof), wheels.chainage)
    on_wheels = border.wheel.sparse().power(2) @ diagonal
    nodes = stacked.problem.path.generalised[0::2].power(2) @ diagonal[: stacked.n_structure]
    return factor * float(max(on_wheels.max(initial=0.0), nodes.max(initial=0.0)))


class PenaltyContactSolver:
    """Solves a step by penalties; a ``ContactSolver``.

    Args:
        stacked: Matrices.
        borders: Contact rows.
        method: The time integration with its step length.
        options: Penalty and way of solution.

    Attributes:
        penalty: p. [N/m]

    Raises:
        InputError: Contact that may open, a nonlinear law or free drive.
        SingularSystemError: The effective matrix is not positive definite.
    """

    def __init__(
        self, stacked: Stacked, borders: Borders, method: HHT, options: PenaltyOptions
    ) -> None:
        problem = stacked.problem
        require_bilateral(problem, "penalty")
        self._stacked, self._borders = stacked, borders
        self._on_free = stacked.free_position(np.arange(stacked.n_dof))
        self._factor = method.force_factor
        if isinstance(problem.law, LinearHertz):
            if options.penalty is not None:
                raise InputError(
                    "penalty.penalty", options.penalty,
                    "the linear Hertz law brings its own stiffness",
                    "Leave the penalty out, or use the rigid law.",
                )  # fmt: skip
            self.penalty = problem.law.stiffness
        elif options.penalty is not None:
            self.penalty = options.penalty
        else:
            self.penalty = default_penalty(stacked, borders, method, options.factor)
        self._effective = stacked.effective(method)
        self._updated = self._one_factor() if options.solution == "update" else None

    def _one_factor(self) -> TwoBlockFactorisation:
        """The constant factor that the springs are added to."""
        positions = self._stacked.free_position(self._borders.freedoms)
        free = positions >= 0
        self._interface = self._borders.freedoms[free]
        self._place = np.full(self._stacked.n_dof, -1)
        self._place[self._interface] = np.arange(self._interface.size)
        return TwoBlockFactorisation(self._effective, positions[free], "structure and vehicle")

    def solve(
        self, step: StepEquations, state: StepState, keep_closed: BoolVector | None = None
    ) -> ContactSolution:
        """See ``ContactSolver``; no iterations."""
        border = self._borders.at(step.time, np.zeros(self._stacked.n_dof), state.chainage)
        elevation = known_elevation(self._stacked, border, step)
        if self._updated is not None:
            displacement, forces = self._update(self._updated, border, elevation, step.load)
        else:
            displacement, forces = self._refactorise(border, elevation, step.load)
        return ContactSolution(
            displacement=displacement, forces=forces, closed=np.ones(forces.size, dtype=bool),
            border=border, iterations=1,
        )  # fmt: skip

    def _refactorise(
        self, border: Border, elevation: Vector, load: Vector
    ) -> tuple[Vector, Vector]:
        """Displacements and contact forces of (2.61) as it stands."""
        rows = border.h.renumbered(self._on_free, self._stacked.free.size)
        weight, added = self._factor * self.penalty, rows.sparse()
        solver = effective_factorisation(
            self._effective + weight * (added.T @ added), "structure and vehicle with penalties"
        )
        displacement = solver.solve(load + weight * rows.transposed_dot(elevation))
        return displacement, self.penalty * (elevation - rows.dot(displacement))

    def _update(
        self, blocks: TwoBlockFactorisation, border: Border, elevation: Vector, load: Vector
    ) -> tuple[Vector, Vector]:
        """The same from the constant factor."""
        rows = border.h.renumbered(self._place, self._interface.size)
        corner = -self._factor / self.penalty * np.eye(elevation.size)
        blocks.border(rows.scaled(-self._factor), corner)
        return blocks.solve(load, -self._factor * elevation)
