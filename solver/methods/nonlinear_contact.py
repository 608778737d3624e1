"""Contact of a step by table 5.1: Newton's method on (R, Y, X), block 1 eliminated exactly.

R are the wheels' freedoms and those of other nonlinear elements, Y the internal node of each
Hertz spring (N4: it lies on the rail), X the contact forces. Block 1 is linear: its large factor
serves the whole run, its residual follows from the interface, and no iteration touches the factor.
Without a Hertz spring (rigid law, or linear, as 1 / k_h on the diagonal) there is no Y.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from solver.arrays import BoolVector, FloatArray, IntVector, Matrix, Vector
from solver.assembly.rows import Rows
from solver.contact.laws import LinearHertz, NonlinearHertz
from solver.contact.nonlinear import contact_force, contact_stiffness
from solver.factorisation.blocks import ThreeBlockFactorisation
from solver.integrators.hht import HHT
from solver.methods.border import Border, Borders
from solver.methods.contact_step import ContactSolution, UnsettledError
from solver.methods.settings import Settings, StepState
from solver.methods.stacked import NonlinearPart, Stacked
from solver.methods.step import StepEquations

__all__ = ["NonlinearContactSolver"]

_SOFTEST = 1e-3
"""Share of d_Q below which the tangent of Hertz's spring is that of the share: never zero."""


@dataclass
class _Iterate:
    """Unknowns of Newton's method.

    Attributes:
        whole: All freedoms; only the interface, R and P are kept up to date.
        internal: Y of each wheel, meaningful for closed contacts. [m]
        forces: X, shape (n_wheel,). [N]
        closed: Shape (n_wheel,).
    """

    whole: Vector
    internal: Vector
    forces: Vector
    closed: BoolVector


@dataclass(frozen=True, kw_only=True)
class _Residual:
    """Residuals psi of (5.16) and r-bar of (5.37), and what the tangent needs."""

    first: Vector
    second: Vector
    third: Vector
    compression: Vector
    spring: Vector
    border: Border


class NonlinearContactSolver:
    """Factorises block 1 once, for one step length.

    Args:
        stacked: Matrices.
        borders: Contact rows.
        settings: Tolerances.
        method: The method with its step length.
    """

    def __init__(self, stacked: Stacked, borders: Borders, settings: Settings, method: HHT) -> None:
        self._stacked, self._borders, self._settings = stacked, borders, settings
        self._problem = stacked.problem
        self._factor = method.force_factor
        effective = stacked.effective(method)
        wheels = stacked.free_position(borders.wheel_freedoms)
        parts = [part.freedoms for part in stacked.nonlinear]
        self._second = np.unique(np.concatenate([wheels[wheels >= 0], *parts])).astype(np.int64)
        self._first = np.setdiff1d(np.arange(stacked.free.size), self._second)
        coupling = sparse.csr_array(effective[self._second][:, self._first])
        self._corner = effective[self._second][:, self._second].toarray()
        self._choose_interface(coupling)
        first = sparse.csr_array(effective[self._first][:, self._first])
        self._coupling = coupling[:, self._interface].toarray()
        self.blocks = ThreeBlockFactorisation(
            first, self._interface, self._coupling, "structure and vehicle"
        )
        # Columns of all freedoms that each block's unknowns are.
        self._first_columns = stacked.free[self._first[self._interface]]
        self._second_columns = stacked.free[self._second]
        self._first_place = _places(self._first_columns, stacked.n_dof)
        self._second_place = _places(self._second_columns, stacked.n_dof)
        law = self._problem.law
        self._hertz = law if isinstance(law, NonlinearHertz) else None
        self._spring = 1.0 / law.stiffness if isinstance(law, LinearHertz) else 0.0
        self._tangents: list[Matrix] | None = None

    def _choose_interface(self, coupling: sparse.csr_array) -> None:
        """Block 1's unknowns that the path, or block 2, touches."""
        path = self._stacked.free_position(self._borders.path_freedoms)
        place = np.full(self._stacked.free.size, -1)
        place[self._first] = np.arange(self._first.size)
        on_path = place[path[path >= 0]]
        self._interface: IntVector = np.unique(
            np.concatenate([on_path[on_path >= 0], coupling.indices])
        ).astype(np.int64)

    def solve(
        self, step: StepEquations, state: StepState, keep_closed: BoolVector | None = None
    ) -> ContactSolution:
        """See ``ContactSolver``."""
        settings = self._settings
        self.blocks.forward(step.load[self._first])
        iterate, border = self._predict(step, state)
        flips = np.zeros(iterate.closed.size, dtype=int)
        for iteration in range(1, settings.most_iterations + 1):
            changed = self._update_status(iterate, border, keep_closed)
            flips += changed
            if flips.max(initial=0) > settings.most_flips:
                raise UnsettledError(self._name(flips), float(np.abs(iterate.forces).max()))
            residual = self._residual(step, iterate, border)
            if not changed.any() and iteration > 1 and self._converged(step, iterate, residual):
                return self._finish(iterate, residual, iteration - 1)
            self._improve(iterate, residual, self._structure_tangents(iterate))
            border = self._borders.again(step.time, iterate.whole, border)
        residual = self._residual(step, iterate, border)
        raise UnsettledError(self._name(np.abs(iterate.forces)), _norm(residual))

    # -- the iterate ------------------------------------------------------------------------

    def _predict(self, step: StepEquations, state: StepState) -> tuple[_Iterate, Border]:
        """Predictors of table 5.1, step 4: no acceleration, the last contact forces."""
        dt, beta = step.method.time_step, step.method.beta
        whole = (
            state.displacement + dt * state.velocity
            + 0.5 * dt**2 * (1.0 - 2.0 * beta) * state.acceleration
        )  # fmt: skip
        whole[self._stacked.prescribed] = step.supports[0]
        closed = np.array(state.closed)
        forces = np.where(closed, state.contact_forces, 0.0)
        border = self._borders.at(step.time, whole, state.chainage)
        internal = border.height + self._compression(forces)
        return _Iterate(whole=whole, internal=internal, forces=forces, closed=closed), border

    def _compression(self, force: Vector) -> Vector:
        """Compression of the springs under forces."""
        if self._hertz is None:
            return np.zeros_like(force)
        return np.sign(force) * (np.abs(force) / self._hertz.coefficient) ** (2.0 / 3.0)

    def _update_status(
        self, iterate: _Iterate, border: Border, keep_closed: BoolVector | None
    ) -> BoolVector:
        """Opens closed pairs in tension and closes open pairs inside the rail."""
        if not self._problem.unilateral:
            changed = ~iterate.closed
        else:
            opens = iterate.closed & (iterate.forces < 0.0)
            if keep_closed is not None:
                opens &= ~keep_closed
            closes = ~iterate.closed & (border.gap < 0.0)
            changed = opens | closes
            iterate.forces[opens] = 0.0
        if changed.any():
            iterate.closed = iterate.closed ^ changed
            touched = changed & iterate.closed
            iterate.internal[touched] = (border.height - border.gap)[touched]
        return changed

    # -- Newton's method --------------------------------------------------------------------

    def _residual(self, step: StepEquations, iterate: _Iterate, border: Border) -> _Residual:
        """psi of block 1 on its interface, of R and of (Y, X)."""
        f, closed = self._factor, iterate.closed
        on_first = iterate.whole[self._first_columns]
        on_second = iterate.whole[self._second_columns]
        compression = iterate.internal - border.height
        spring = self._spring_force(compression)
        on_wheel = np.where(closed, iterate.forces if self._hertz is None else spring, 0.0)
        force = border.wheel.transposed_dot(on_wheel)
        border.rest.add(np.where(closed, iterate.forces, 0.0), force)
        first = (
            self.blocks.reduced - self._coupling.T @ on_second
            + f * force[self._first_columns] - self.blocks.complement @ on_first
        )  # fmt: skip
        second = (
            step.load[self._second] - self._coupling @ on_first - self._corner @ on_second
            + f * force[self._second_columns] - f * self._internal(iterate)[self._second]
        )  # fmt: skip
        surface = border.height - border.gap
        if self._hertz is None:
            gap = border.gap + self._spring * iterate.forces
            third = f * gap[closed]
        else:
            third = np.concatenate(
                [f * (iterate.forces - spring)[closed], f * (iterate.internal - surface)[closed]]
            )
        return _Residual(
            first=first, second=second, third=third, compression=compression, spring=spring,
            border=border,
        )  # fmt: skip

    def _spring_force(self, compression: Vector) -> Vector:
        """F_s, odd in the compression where contact may pull."""
        if self._hertz is None:
            return np.zeros_like(compression)
        return contact_force(self._hertz, compression, self._problem.unilateral)

    def _structure_tangents(self, iterate: _Iterate) -> list[Matrix]:
        """Tangents of the nonlinear elements other than contact; the first ones, if constant."""
        if self._tangents is not None:
            return self._tangents
        free = iterate.whole[self._stacked.free]
        tangents = [part.tangent(free) for part in self._stacked.nonlinear]
        if self._settings.tangent == "constant":
            self._tangents = tangents
        return tangents

    def _improve(self, iterate: _Iterate, residual: _Residual, tangents: list[Matrix]) -> None:
        """Solves (5.39) and updates the iterate (step 11)."""
        f, closed = self._factor, iterate.closed
        corner = self._corner
        if tangents:
            corner = corner + f * self._scatter(tangents)
        wheel, rest = residual.border.wheel.take(closed), residual.border.rest.take(closed)
        if self._hertz is None:
            both = residual.border.h.take(closed).scaled(-f)
            a31, a32 = self._on_first(both), self._on_second(both)
            a33 = -f * self._spring * np.eye(both.count)
        else:
            on_wheel = self._on_second(wheel)
            stiffness = self._spring_tangent(residual.compression[closed])
            corner = corner + f * (on_wheel.T * stiffness) @ on_wheel
            a31, a32, a33 = self._hertz_blocks(rest.scaled(-f), on_wheel, stiffness)
        self.blocks.update(corner, a31, a32, a33)
        x1, x2, x3 = self.blocks.solve_reduced(residual.first, residual.second, residual.third)
        iterate.whole[self._first_columns] += x1
        iterate.whole[self._second_columns] += x2
        n_closed = int(closed.sum())
        if self._hertz is not None:
            iterate.internal[closed] += x3[:n_closed]
        iterate.forces[closed] += x3[x3.size - n_closed :]
        if not np.isfinite(iterate.forces).all():
            raise UnsettledError(self._name(iterate.closed.astype(float)), float("inf"))

    def _hertz_blocks(
        self, rest: Rows, on_wheel: Matrix, stiffness: Vector
    ) -> tuple[Rows, Matrix, Matrix]:
        """Third rows of (5.40), Y first, then X; ``rest`` already times -(1 + alpha)."""
        f, count = self._factor, stiffness.size
        below = self._on_first(rest)
        a31 = Rows(
            np.concatenate([np.zeros_like(below.columns), below.columns]),
            np.concatenate([np.zeros_like(below.values), below.values]),
            below.n_column,
        )
        a32 = np.concatenate([-f * stiffness[:, None] * on_wheel, self._on_second(rest)])
        a33 = np.zeros((2 * count, 2 * count))
        index = np.arange(count)
        a33[index, index] = f * stiffness
        a33[index, count + index] = a33[count + index, index] = -f
        return a31, a32, a33

    def _on_first(self, rows: Rows) -> Rows:
        """Rows over block 1's interface."""
        return rows.renumbered(self._first_place, self._first_columns.size)

    def _on_second(self, rows: Rows) -> Matrix:
        """Rows over block 2."""
        return rows.renumbered(self._second_place, self._second_columns.size).dense()

    def _spring_tangent(self, compression: Vector) -> Vector:
        """k_t = 3/2 K_h d^(1/2), never zero."""
        assert self._hertz is not None
        least = _SOFTEST * self._hertz.reference_compression
        return contact_stiffness(self._hertz, np.maximum(np.abs(compression), least), False)

    def _scatter(self, tangents: list[Matrix]) -> Matrix:
        """Tangents of the nonlinear elements over block 2."""
        total: FloatArray = np.zeros_like(self._corner)
        parts: list[NonlinearPart] = self._stacked.nonlinear
        for part, tangent in zip(parts, tangents, strict=True):
            places = np.searchsorted(self._second, part.freedoms)
            total[np.ix_(places, places)] += tangent
        return total

    # -- the end ----------------------------------------------------------------------------

    def _converged(self, step: StepEquations, iterate: _Iterate, residual: _Residual) -> bool:
        """The rules of modelling.md: load, each wheel, each gap."""
        settings, closed = self._settings, iterate.closed
        largest = float(np.abs(iterate.forces).max(initial=0.0))
        load = max(float(np.linalg.norm(step.external)), largest)
        if self._hertz is None:
            gap = residual.border.gap + self._spring * iterate.forces
            wheel = np.zeros(1)
        else:
            gap = iterate.internal - (residual.border.height - residual.border.gap)
            wheel = np.abs(iterate.forces - residual.spring)[closed]
        share = load / max(1, closed.size)
        internal = np.linalg.norm(self._internal(iterate))
        # Without any load the residual ends in the rounding of the histories.
        rounding = 1e-12 * float(np.linalg.norm(step.load))
        return bool(
            _norm(residual) <= settings.tolerance * max(load, float(internal)) + rounding
            and wheel.max(initial=0.0) <= settings.wheel_tolerance * share
            and np.abs(gap[closed]).max(initial=0.0) <= settings.gap_tolerance
        )

    def _finish(self, iterate: _Iterate, residual: _Residual, iterations: int) -> ContactSolution:
        displacement = np.empty(self._stacked.free.size)
        displacement[self._second] = iterate.whole[self._second_columns]
        # The forward pass holds the load of block 1 alone; its interface is known now.
        displacement[self._first] = self.blocks.backward(iterate.whole[self._first_columns])
        return ContactSolution(
            displacement=displacement,
            forces=np.where(iterate.closed, iterate.forces, 0.0),
            closed=iterate.closed,
            border=residual.border,
            iterations=iterations,
        )

    def _internal(self, iterate: _Iterate) -> Vector:
        """Forces of the nonlinear elements over F."""
        if not self._stacked.nonlinear:
            return np.zeros(self._stacked.free.size)
        return self._stacked.nonlinear_force(iterate.whole[self._stacked.free])

    def _name(self, weights: Vector) -> str:
        names = self._problem.wheels.names
        return names[int(np.argmax(weights))] if names else "none"


def _places(columns: IntVector, n_dof: int) -> IntVector:
    """Place of each freedom among ``columns``, -1 elsewhere."""
    place = np.full(n_dof, -1)
    place[columns] = np.arange(columns.size)
    return place


def _norm(residual: _Residual) -> float:
    """Norm of the force residuals."""
    return float(np.sqrt(residual.first @ residual.first + residual.second @ residual.second))
