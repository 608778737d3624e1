"""Equilibrium of every step, computed anew from displacements, velocities and accelerations.

The engine finds its residuals by a recursion that never multiplies by K. Here nothing of that is
used: matrices, loads and contact directions come from the problem, and equation 4.3 is evaluated
as it stands over all freedoms at once, contact forces and reactions among the forces F,

    M a''(n+1) + (1 + alpha) q(n+1) - alpha q(n) = 0,      q = C a' + K a + R(a) - P - D X - S.

Its rows over F are the equation of motion (4.12, 5.16), those over P the reactions (4.13). A step
at whose end the rigid law started the motion anew satisfies M a'' + q = 0 instead: there the
accelerations and forces belong to that instant alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sparse

from solver.arrays import SparseMatrix, Vector
from solver.errors import InputError
from solver.integrators.hht import HHT
from solver.methods.problem import FreeDrive, Problem
from solver.methods.settings import StepState

__all__ = ["EquilibriumCheck", "Imbalance"]


@dataclass(frozen=True, kw_only=True)
class Imbalance:
    """Greatest residuals of a run, all relative to the load.

    Attributes:
        motion: Of the equation of motion over the free freedoms.
        reactions: Of the reactions over the prescribed freedoms.
        vertical: Of the global balance of weights, reactions and vertical inertia forces, in which
            no stiffness appears, and contact forces only where rigid ground carries them; not a
            number without a vertical direction.
        steps: Steps that were checked, the start included.
        skipped: Steps that the engine halved, whose middle is not known outside it.
    """

    motion: float
    reactions: float
    vertical: float
    steps: int
    skipped: int


@dataclass
class EquilibriumCheck:
    """Watches a run, step by step.

    Attributes:
        problem: What is integrated.
        method: How.
        vertical: Rigid-body translation upwards of all freedoms, structure then vehicle, shape
            (n_dof,), or None.
        load: What residuals are divided by: the greatest magnitude of the total load. [N]
    """

    problem: Problem
    method: HHT
    vertical: Vector | None
    load: float
    _previous: tuple[Vector, float] | None = None
    _counts: tuple[int, int] = (0, 0)
    _found: list[tuple[float, float, float]] = field(
        default_factory=list[tuple[float, float, float]]
    )
    _skipped: int = 0

    def __post_init__(self) -> None:
        structure, vehicle = self.problem.structure, self.problem.vehicle
        self._mass = _stack(structure.mass, vehicle.mass)
        self._stiffness = _stack(structure.stiffness, vehicle.stiffness)
        damping = _stack(structure.damping, vehicle.damping)
        self._damping = damping if damping.nnz else None
        n_structure = structure.n_dof
        self._prescribed = np.concatenate(
            [structure.prescribed, vehicle.prescribed + n_structure]
        ).astype(np.int64)
        self._is_free = np.ones(n_structure + vehicle.n_dof, dtype=bool)
        self._is_free[self._prescribed] = False
        if not self.load > 0.0:
            raise InputError("load", self.load, "is not positive", "Give what loads the system.")

    def observe(self, state: StepState) -> None:
        """Takes the state at the end of a step, or of the start."""
        inertia = self._mass @ state.acceleration
        forces, lifting = self._forces(state)
        # At the start and after a restart the accelerations belong to that instant's forces.
        counts = (state.halvings, state.restarts)
        started = self._previous is None or counts[1] > self._counts[1]
        halved = counts[0] > self._counts[0]
        alpha = 0.0 if started or self._previous is None else self.method.alpha
        # With alpha = 0 the equation at the end of a step does not know how long the step was.
        if halved and alpha != 0.0:
            self._skipped += 1
        else:
            before = (0.0 * forces, 0.0) if self._previous is None else self._previous
            residual = inertia + (1.0 + alpha) * forces - alpha * before[0]
            balance = float("nan")
            if self.vertical is not None:
                balance = float(self.vertical @ inertia)
                balance += (1.0 + alpha) * lifting - alpha * before[1]
            self._found.append(
                (
                    float(np.linalg.norm(residual[self._is_free])),
                    float(np.linalg.norm(residual[~self._is_free])),
                    abs(balance),
                )
            )
        self._previous = (forces, lifting)
        self._counts = counts

    def imbalance(self) -> Imbalance:
        """Greatest residuals so far."""
        found = np.array(self._found) / self.load
        return Imbalance(
            motion=float(found[:, 0].max()),
            reactions=float(found[:, 1].max()),
            vertical=float(found[:, 2].max()),
            steps=len(found),
            skipped=self._skipped,
        )

    def _forces(self, state: StepState) -> tuple[Vector, float]:
        """q over all freedoms, and its vertical sum without the stiffness."""
        problem = self.problem
        external = np.concatenate(
            [problem.structure.load_at(state.time), problem.vehicle.load_at(state.time)]
        )
        external[self._prescribed] += state.reactions
        internal = self._stiffness @ state.displacement
        for part, offset in ((problem.structure, 0), (problem.vehicle, problem.structure.n_dof)):
            if part.nonlinear is not None:
                freedoms = part.nonlinear.freedoms + offset
                internal[freedoms] += part.nonlinear.force(state.displacement[freedoms])
        viscous = 0.0 if self._damping is None else self._damping @ state.velocity
        external = external + contact_loads(problem, state)
        lifting = 0.0
        if self.vertical is not None:
            lifting = float(self.vertical @ (viscous - external))
        return internal + viscous - external, lifting


def contact_loads(problem: Problem, state: StepState) -> Vector:
    """D X over all freedoms: X along the normal on each wheel, and against it on the path. [N]"""
    if isinstance(problem.drive, FreeDrive) and problem.path.freedoms.size:
        raise InputError("drive", "free", "on a path that moves has no check of its own here",
                         "Use rigid ground.")  # fmt: skip
    point = problem.path.at(state.chainage)
    on_vehicle = np.zeros(problem.vehicle.n_dof)
    for axis, rows in enumerate(problem.wheels.rows):
        on_vehicle += rows.T @ (point.normal[:, axis] * state.contact_forces)
    on_structure = -problem.path.rows(point.element, point.local).transposed_dot(
        state.contact_forces
    )
    return np.concatenate([on_structure, on_vehicle])


def _stack(first: SparseMatrix, second: SparseMatrix) -> SparseMatrix:
    return sparse.csr_array(sparse.block_diag([first, second], format="csr"))
