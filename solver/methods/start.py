"""The state at t = 0: at rest in equilibrium, or consistent with given displacements."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from solver.arrays import Matrix, SparseMatrix, Vector
from solver.contact.laws import LinearHertz, NonlinearHertz
from solver.contact.nonlinear import contact_force
from solver.contact.standing import StandingVehicle
from solver.errors import ConvergenceError, InputError
from solver.factorisation import factorise
from solver.methods.border import Border, Borders
from solver.methods.restart import Restart, consistent_forces
from solver.methods.settings import StepState
from solver.methods.stacked import Stacked
from solver.methods.step import reactions_after

__all__ = ["start_state"]

_MOST_ITERATIONS = 50
_TOUCHING = 1e-9
"""Gap below which a wheel touches. [m]"""


def start_state(stacked: Stacked, borders: Borders, restart: Restart) -> StepState:
    """State at t = 0.

    Raises:
        SingularSystemError: A static start of a part that can move without resistance.
        ConvergenceError: The nonlinear static start did not settle.
        InputError: A wheel would have to be pulled onto its path at the static start.
    """
    problem = stacked.problem
    displacement, velocity = problem.initial()
    supports = stacked.support_motion(0.0)
    displacement[stacked.prescribed] = supports[0]
    velocity[stacked.prescribed] = supports[1]
    acceleration = np.zeros(stacked.n_dof)
    acceleration[stacked.prescribed] = supports[2]
    border = borders.at(0.0, displacement, problem.wheels.chainage)
    state = StepState(
        step=0, time=0.0, displacement=displacement, velocity=velocity,
        acceleration=acceleration, contact_forces=np.zeros(problem.wheels.count),
        closed=np.ones(problem.wheels.count, dtype=bool), chainage=border.chainage,
        reactions=np.zeros(0), imbalance=np.zeros(stacked.free.size),
        imbalance_prescribed=np.zeros(stacked.prescribed.size),
        gap_acceleration=np.zeros(problem.wheels.count),
    )  # fmt: skip
    if problem.start == "static":
        border = _rest(stacked, borders, state)
    else:
        _fit(stacked, border, restart, state)
    restart.reference_load = _wheel_load(stacked, state)
    inertia = stacked.mass @ state.acceleration
    state.imbalance = -inertia[stacked.free]
    state.imbalance_prescribed = -inertia[stacked.prescribed]
    motion = (state.displacement, state.velocity, state.acceleration)
    contact = border.h.transposed_dot(state.contact_forces)
    state.reactions = reactions_after(stacked, 0.0, motion, contact, state.imbalance_prescribed)
    return state


def _wheel_load(stacked: Stacked, state: StepState) -> float:
    """Load of a wheel: of the start, or the share of the external forces where it has none."""
    if state.contact_forces.size == 0:
        return 0.0
    at_start = float(np.abs(state.contact_forces).mean())
    external, _ = stacked.load(0.0)
    return at_start or float(np.abs(external).sum()) / state.contact_forces.size


def _fit(stacked: Stacked, border: Border, restart: Restart, state: StepState) -> None:
    """Contact forces and accelerations that belong to the given displacements."""
    problem = stacked.problem
    law = problem.law
    state.closed = (border.gap <= _TOUCHING) | (not problem.unilateral)
    compression = np.maximum(-border.gap, 0.0) if problem.unilateral else -border.gap
    if isinstance(law, NonlinearHertz):
        state.contact_forces = contact_force(law, compression, problem.unilateral)
    elif isinstance(law, LinearHertz):
        state.contact_forces = law.stiffness * compression
    else:
        _require_outside(stacked, border)
        state.contact_forces = np.where(
            state.closed, consistent_forces(stacked, border, state), 0.0
        )
    restart.apply(border, state)


def _require_outside(stacked: Stacked, border: Border) -> None:
    """A rigid wheel cannot start inside its path, nor away from one that holds it."""
    problem = stacked.problem
    wrong = border.gap < -_TOUCHING
    if not problem.unilateral:
        wrong |= border.gap > _TOUCHING
    if wrong.any():
        wheel = int(np.argmax(np.abs(np.where(wrong, border.gap, 0.0))))
        raise InputError(
            "displacement", float(border.gap[wheel]),
            f"is the gap [m] of {problem.wheels.names[wheel]} at the start, with the rigid law",
            "Let the wheel start on its path, or give the contact a spring.",
        )  # fmt: skip


def _rest(stacked: Stacked, borders: Borders, state: StepState) -> Border:
    """Static equilibrium, all wheels closed.

    Repeated until it stands still where nonlinear elements or the places of free wheels depend
    on it; returns the contact rows there.
    """
    state.velocity[:] = 0.0
    state.acceleration[:] = 0.0
    external, _ = stacked.load(0.0)
    load = external - stacked.stiffness_fp @ state.displacement[stacked.prescribed]
    free, change = state.displacement[stacked.free], 0.0
    once = not stacked.nonlinear and not borders.moves_freely
    for _ in range(_MOST_ITERATIONS):
        border = borders.at(0.0, state.displacement, state.chainage)
        stiffness, offset = stacked.linearised(free)
        new, forces = _equilibrium(stacked, border, state, stiffness, load - offset)
        change = float(np.abs(new - free).max(initial=0.0))
        free = new
        state.displacement[stacked.free] = free
        state.chainage = border.chainage
        if once or change <= 1e-12 * float(np.abs(free).max(initial=1e-300)):
            state.contact_forces = forces
            _refuse_tension(stacked, forces)
            return border
    raise ConvergenceError(0.0, "all wheels", change)


def _equilibrium(
    stacked: Stacked, border: Border, state: StepState, stiffness: SparseMatrix, load: Vector
) -> tuple[Vector, Vector]:
    """Displacements of F and contact forces under a load on F, for one stiffness."""
    of_structure = np.flatnonzero(stacked.free < stacked.n_structure)
    of_vehicle = np.flatnonzero(stacked.free >= stacked.n_structure)
    rows = border.rows[:, stacked.free]
    supports = border.rows[:, stacked.prescribed] @ state.displacement[stacked.prescribed]
    path_rows = sparse.csr_array(rows[:, of_structure])
    own_stiffness = sparse.csr_array(stiffness[of_structure][:, of_structure])
    columns, own = _flexibility(own_stiffness, path_rows, load[of_structure])
    standing = StandingVehicle(
        name="the vehicle",
        stiffness=stiffness[of_vehicle][:, of_vehicle].toarray(),
        weight=load[of_vehicle],
        rows=rows[:, of_vehicle].toarray(),
    )
    compliance, law = path_rows @ columns, stacked.problem.law
    elevation = border.elevation - supports - path_rows @ own
    if isinstance(law, NonlinearHertz):
        on_vehicle, forces, _ = standing.on_hertz(compliance, elevation, law)
    else:
        spring = 1.0 / law.stiffness if isinstance(law, LinearHertz) else 0.0
        on_vehicle, forces = standing.on_linear(
            compliance + spring * np.eye(elevation.size), elevation
        )
    displacement = np.empty(stacked.free.size)
    displacement[of_structure] = own + columns @ forces
    displacement[of_vehicle] = on_vehicle
    return displacement, forces


def _refuse_tension(stacked: Stacked, forces: Vector) -> None:
    """The static start is found with every wheel on its path: none may need pulling down."""
    problem = stacked.problem
    least = int(np.argmin(forces)) if forces.size else 0
    if problem.unilateral and forces.size and forces[least] < -1e-9 * np.abs(forces).max():
        raise InputError(
            "unilateral", True,
            f"{problem.wheels.names[least]} would have to be pulled onto its path with "
            f"{-forces[least]:.4g} N at the static start",
            "Check masses and lengths, or let the contact pull (unilateral: false).",
        )  # fmt: skip


def _flexibility(
    stiffness: SparseMatrix, path_rows: SparseMatrix, load: Vector
) -> tuple[Matrix, Vector]:
    """The structure's displacements for unit contact forces and for its own load."""
    if load.size == 0 or (path_rows.nnz == 0 and not load.any()):
        return np.zeros((load.size, path_rows.shape[0])), np.zeros(load.size)
    loads = np.column_stack([path_rows.T.toarray(), load])
    found = factorise(stiffness, "the structure").solve(loads)
    return found[:, :-1], found[:, -1]
