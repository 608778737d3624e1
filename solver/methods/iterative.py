"""The iterative method: structure and vehicle in turn, block Gauss-Seidel (2.23 to 2.36).

Structure and vehicle keep their own factorised effective matrices. A sweep takes the deflection u
of the path under the wheels, and from it in turn

    (2.32) the wheels' displacements   a_X = r + u
    (2.33, 2.34) the contact forces    X = S (r + u - b)      (see ``CondensedVehicle``)
    (2.35) the structure               K a = F - (1 + alpha) H' X,   u~ = H a.

The error of u is multiplied by -(1 + alpha) H K^-1 H' S at each sweep: the structure's effective
compliance at the contact points times the vehicle's effective contact stiffness. Its spectral
radius, which is that of M^-1 N, decides beforehand whether the sweeps converge
(``predict_convergence``). Its eigenvalues are real and not positive, so that a relaxation
u + w (u~ - u) converges for every w below 2 / (1 + radius).

A sweep ends the iteration where u~ and u differ, at every wheel, by at most the tolerance times the
greatest displacement of the structure: (2.36), read at the wheels, where a small relaxation cannot
make an unfinished iteration look finished.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np
import scipy.linalg as dense

from solver.arrays import BoolVector, Matrix, Vector
from solver.assembly.rows import Rows
from solver.errors import ConvergenceError, InputError
from solver.factorisation.blocks import FirstBlock
from solver.integrators.hht import HHT
from solver.methods.border import Borders
from solver.methods.contact_step import ContactSolution
from solver.methods.partitioned import (
    CondensedVehicle,
    EffectiveParts,
    effective_factorisation,
    known_elevation,
    require_bilateral,
)
from solver.methods.problem import Problem
from solver.methods.settings import Settings, StepState
from solver.methods.stacked import Stacked
from solver.methods.step import StepEquations

__all__ = [
    "ConvergencePrediction",
    "DivergenceError",
    "IterativeContactSolver",
    "IterativeOptions",
    "predict_convergence",
]

_HOPELESS = 1e8
"""Growth of the residual within a step beyond which it has diverged."""
_LEAST_RELAXATION, _MOST_RELAXATION = 1e-6, 2.0
"""Bounds of Aitken's relaxation."""


class DivergenceError(ConvergenceError):
    """The sweeps of a step do not converge.

    Attributes:
        radius: Spectral radius of the sweep without relaxation, at this step. [1]
    """

    def __init__(self, time: float, wheel: str, residual: float, radius: float) -> None:
        super().__init__(time, wheel, residual)
        self.radius = radius
        advice = (
            "Allow more sweeps (most_iterations), a greater tolerance, or relax less (to 1)."
            if radius < 1.0
            else f"Use acceleration: aitken, a relaxation below {2.0 / (1.0 + radius):.3g}, or the "
            "direct method."
        )
        self.args = (
            f"the iterative method did not converge at t = {time:.6g} s ({wheel}, residual "
            f"{residual:.3g} N, spectral radius {radius:.4g}). {advice}",
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.time, self.wheel, self.residual, self.radius)


@dataclass(frozen=True, kw_only=True)
class IterativeOptions:
    """Options of the iterative method.

    Attributes:
        tolerance: Of (2.36); Yang and Fonder (1996) advise 1e-8 to 1e-5. It is blind to the forces:
            under a wheel of mass m an error e of u is a force m e / (beta dt^2). [1]
        most_iterations: Sweeps of a step before it is given up.
        relaxation: w in u + w (u~ - u); 1 is Gauss-Seidel, less is under-relaxation. [1]
        acceleration: ``aitken`` adapts the relaxation at every sweep, from ``relaxation`` at the
            first of the run.
        start: First u of a step: the one that the last contact ``forces`` give, for one more
            solution of the structure, or the last ``displacements``, as in the thesis.
        solution: ``full`` solves the whole structure at every sweep, as published; ``interface``
            sweeps on the path's freedoms, on which the structure is condensed once, and solves the
            whole structure once a step.

    Raises:
        InputError: A value outside its range.
    """

    tolerance: float = 1e-8
    most_iterations: int = 200
    relaxation: float = 1.0
    acceleration: Literal["none", "aitken"] = "none"
    start: Literal["forces", "displacements"] = "forces"
    solution: Literal["full", "interface"] = "full"

    def __post_init__(self) -> None:
        ranges = {"tolerance": (1e-13, 1e-2), "most_iterations": (1, 100_000),
                  "relaxation": (1e-6, 2.0)}  # fmt: skip
        for name, (least, most) in ranges.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise InputError(f"iterative.{name}", value, f"is not between {least} and {most}",
                                 "Leave it out for a good default.")  # fmt: skip
        choices = {"acceleration": ("none", "aitken"), "start": ("forces", "displacements"),
                   "solution": ("full", "interface")}  # fmt: skip
        for name, allowed in choices.items():
            if getattr(self, name) not in allowed:
                raise InputError(f"iterative.{name}", getattr(self, name), "is unknown",
                                 f"Use {' or '.join(allowed)}.")  # fmt: skip


class _Structure(Protocol):
    """The structure's half of a sweep."""

    def begin(self, load: Vector, rows: Rows) -> None:
        """Takes a step's effective load and the path's rows under the wheels."""
        ...

    def deflection(self, forces: Vector) -> Vector:
        """Deflection of the path under the wheels for contact forces, shape (n_wheel,). [m]"""
        ...

    @property
    def scale(self) -> float:
        """Greatest displacement found by the last ``deflection``."""
        ...

    def finish(self) -> Vector:
        """All displacements, for the forces of the last ``deflection``."""
        ...


class _WholeStructure:
    """Solves the whole structure at every sweep."""

    def __init__(self, parts: EffectiveParts) -> None:
        self._factor = parts.factor
        self._solver = effective_factorisation(parts.structure_matrix, "the structure")

    def begin(self, load: Vector, rows: Rows) -> None:
        self._load, self._rows = load, rows

    def deflection(self, forces: Vector) -> Vector:
        pushed = self._rows.transposed_dot(forces)
        self._found = self._solver.solve(self._load - self._factor * pushed)
        return self._rows.dot(self._found)

    @property
    def scale(self) -> float:
        return float(np.abs(self._found).max(initial=0.0))

    def finish(self) -> Vector:
        return self._found


class _CondensedStructure:
    """Sweeps on the path's freedoms; one forward and one backward pass a step."""

    def __init__(self, stacked: Stacked, borders: Borders, parts: EffectiveParts) -> None:
        self._factor = parts.factor
        positions = stacked.free_position(borders.path_freedoms)
        interface = positions[positions >= 0]
        self._place = np.full(parts.structure.size, -1)
        self._place[interface] = np.arange(interface.size)
        self._n_interface = interface.size
        self._block = FirstBlock(parts.structure_matrix, interface, "the structure")

    def _on_interface(self, rows: Rows) -> Rows:
        return rows.renumbered(self._place, self._n_interface)

    def compliance(self, rows: Rows) -> Matrix:
        """(1 + alpha) H K^-1 H' between the contact points, shape (n_wheel, n_wheel). [m/N]"""
        own = self._on_interface(rows)
        found = self._factor * own.times_transposed(own.times(self._block.flexibility))
        return 0.5 * (found + found.T)

    def begin(self, load: Vector, rows: Rows) -> None:
        self._free = self._block.forward(load)
        self._rows = self._on_interface(rows)
        # The flexibility is symmetric: its rows serve as its columns.
        self._shares = self._factor * self._rows.times(self._block.flexibility)

    def deflection(self, forces: Vector) -> Vector:
        self._found = self._free - forces @ self._shares
        return self._rows.dot(self._found)

    @property
    def scale(self) -> float:
        return float(np.abs(self._found).max(initial=0.0))

    def finish(self) -> Vector:
        return np.array(self._block.backward(self._found))


class IterativeContactSolver:
    """Solves a step by sweeps; a ``ContactSolver``.

    Args:
        stacked: Matrices.
        borders: Contact rows.
        method: The time integration with its step length.
        options: Tolerance, relaxation, start.

    Raises:
        InputError: Contact that may open, a nonlinear law or free drive.
        SingularSystemError: An effective matrix is singular.
    """

    def __init__(
        self, stacked: Stacked, borders: Borders, method: HHT, options: IterativeOptions
    ) -> None:
        require_bilateral(stacked.problem, "iterative")
        self._stacked, self._borders, self._options = stacked, borders, options
        self._parts = EffectiveParts(stacked, method)
        self._vehicle = CondensedVehicle(stacked, borders, self._parts)
        self._structure: _Structure = (
            _WholeStructure(self._parts)
            if options.solution == "full"
            else _CondensedStructure(stacked, borders, self._parts)
        )
        self._relaxation = options.relaxation

    def solve(
        self, step: StepEquations, state: StepState, keep_closed: BoolVector | None = None
    ) -> ContactSolution:
        """See ``ContactSolver``.

        Raises:
            DivergenceError: The sweeps do not converge, or not within those allowed.
        """
        parts, stacked = self._parts, self._stacked
        border = self._borders.at(step.time, np.zeros(stacked.n_dof), state.chainage)
        rows = parts.path_rows(border)
        free = self._vehicle.begin(step.load[parts.vehicle])
        offset = known_elevation(stacked, border, step) - free
        self._structure.begin(step.load[parts.structure], rows)
        if self._options.start == "forces":
            first = self._structure.deflection(state.contact_forces)
        else:
            first = rows.dot(state.displacement[stacked.free[parts.structure]])
        forces, iterations = self._sweeps(first, offset, rows, step.time)
        displacement = np.concatenate([self._structure.finish(), self._vehicle.finish(forces)])
        return ContactSolution(
            displacement=displacement, forces=forces, closed=np.ones(forces.size, dtype=bool),
            border=border, iterations=iterations,
        )  # fmt: skip

    def _sweeps(
        self, deflection: Vector, offset: Vector, rows: Rows, time: float
    ) -> tuple[Vector, int]:
        """Contact forces and the number of sweeps."""
        options, spring = self._options, self._vehicle.stiffness
        largest = previous = np.zeros(0)
        limit = np.inf
        with np.errstate(over="ignore", invalid="ignore"):
            for sweep in range(1, options.most_iterations + 1):
                forces = spring @ (deflection + offset)
                residual = self._structure.deflection(forces) - deflection
                size = float(np.abs(residual).max(initial=0.0))
                if size <= options.tolerance * self._structure.scale:
                    return forces, sweep
                if not size <= limit:
                    break
                if sweep == 1:
                    limit = _HOPELESS * size
                elif options.acceleration == "aitken":
                    self._accelerate(residual, previous)
                largest = spring @ residual
                deflection = deflection + self._relaxation * residual
                previous = residual
        wheel = int(np.argmax(np.abs(largest)))
        self._relaxation = options.relaxation
        raise DivergenceError(
            time, self._stacked.problem.wheels.names[wheel], float(np.abs(largest[wheel])),
            self._radius(rows),
        )  # fmt: skip

    def _accelerate(self, residual: Vector, previous: Vector) -> None:
        """Aitken's delta-squared formula on the vector of deflections under the wheels."""
        change = residual - previous
        squared = float(change @ change)
        if squared > 0.0:
            factor = -self._relaxation * float(previous @ change) / squared
            self._relaxation = min(max(factor, _LEAST_RELAXATION), _MOST_RELAXATION)

    def _radius(self, rows: Rows) -> float:
        """Spectral radius of a sweep at this place of the wheels."""
        structure = _CondensedStructure(self._stacked, self._borders, self._parts)
        return float(_eigenvalues(structure, self._vehicle, rows).max(initial=0.0))


def _eigenvalues(structure: _CondensedStructure, vehicle: CondensedVehicle, rows: Rows) -> Vector:
    """Eigenvalues of (1 + alpha) H K^-1 H' S, none negative, shape (n_wheel,)."""
    found = dense.eigh(structure.compliance(rows), vehicle.flexibility, eigvals_only=True)
    return np.maximum(found, 0.0)


@dataclass(frozen=True, kw_only=True)
class ConvergencePrediction:
    """Convergence of the iterative method, known before it runs.

    Attributes:
        times: Instants looked at, shape (n_time,). [s]
        radii: Spectral radius of M^-1 N at each, shape (n_time,). [1]
    """

    times: Vector
    radii: Vector

    @property
    def radius(self) -> float:
        """The greatest of them."""
        return float(self.radii.max(initial=0.0))

    @property
    def converges(self) -> bool:
        """Whether the sweeps converge without relaxation (2.25)."""
        return self.radius < 1.0

    @property
    def greatest_relaxation(self) -> float:
        """Relaxation below which the sweeps converge at every instant."""
        return 2.0 / (1.0 + self.radius)

    def iterations(self, tolerance: float) -> float:
        """Sweeps for a reduction of the error by ``tolerance``, without relaxation."""
        if not self.converges:
            return np.inf
        return float(np.log(tolerance) / np.log(max(self.radius, 1e-300)))


def predict_convergence(
    problem: Problem, settings: Settings, times: Vector | None = None
) -> ConvergencePrediction:
    """Spectral radius of M^-1 N (2.23 to 2.30) along a run, without running it.

    Args:
        problem: What would be solved; bilateral, linear contact at a prescribed speed.
        settings: How; the time step counts.
        times: Instants; None takes 65, evenly over the run. [s]

    Returns:
        The radii, one for each place of the wheels.

    Raises:
        InputError: The iterative method cannot solve the problem.
        SingularSystemError: An effective matrix is singular.
    """
    require_bilateral(problem, "iterative")
    stacked = Stacked(problem)
    borders = Borders(problem, stacked)
    parts = EffectiveParts(stacked, settings.method)
    vehicle = CondensedVehicle(stacked, borders, parts)
    structure = _CondensedStructure(stacked, borders, parts)
    if times is None:
        times = np.linspace(0.0, settings.n_step * settings.time_step, 65)
    radii = np.zeros(times.size)
    nowhere = np.zeros(stacked.n_dof)
    for index, time in enumerate(times):
        border = borders.at(float(time), nowhere, problem.wheels.chainage)
        rows = parts.path_rows(border)
        radii[index] = _eigenvalues(structure, vehicle, rows).max(initial=0.0)
    return ConvergencePrediction(times=np.array(times), radii=radii)
