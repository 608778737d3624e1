"""The static start: the train stands on the rails, everything in balance.

The compliance under the wheels is the static one of the rails, the structure and the contact
springs. A run with the nonlinear law that started from the state of the linear one would dip to
49 kN (modelling decision).

What the train's way adds to the rails beyond the place where it stands depends on the speed and on
nothing else, and the rails do not bend there: it is left out, so that all runs of a sweep have one
static start, to the last bit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Matrix, Vector
from solver.contact.standing import StandingVehicle
from solver.system.coupled import EffectiveSystem, System
from solver.system.parts import Coefficients

__all__ = ["StaticState", "at_rest_beyond", "standing", "static_start", "static_state"]

_BEYOND = 60.0
"""Rails kept beyond the foremost wheel and the structure. A rail's deflection falls by e in less
than 2 m even on a bed of a hundredth of ballast's stiffness: 1e-13 of it is cut off. [m]"""


@dataclass(frozen=True, kw_only=True)
class StaticState:
    """State of rest under the train's weight.

    Attributes:
        lines: Displacements of the lines, shape (n_dof, n_line).
        train: Of the train, shape (n_dof,).
        structure: Of the structure, shape (n_dof,), or None where there is none.
        contact_forces: Shape (n_wheel,). [N]
        compression: Of the nonlinear Hertz springs, 0 without them, shape (n_wheel,). [m]
        pad_forces: Tension in the pads, line after line, shape (n_pad,). [N]
        dead_load: Displacement of the structure under its own weight, rails and train absent.
    """

    lines: Matrix
    train: Vector
    structure: Vector | None
    contact_forces: Vector
    compression: Vector
    pad_forces: Vector
    dead_load: Vector | None


def static_state(system: System) -> StaticState:
    """State of rest under the train's weight, the first axle at its start position.

    Raises:
        SingularSystemError: Train or structure can move without resistance.
    """
    return at_rest_beyond(static_start(standing(system)), system)


def standing(system: System) -> System:
    """The system without the rails far beyond train and structure; plain beams are kept whole."""
    last = _last_node(system)
    if last == system.line.n_node - 1:
        return system
    return replace(system, line=system.line.held_beyond(last))


def at_rest_beyond(static: StaticState, system: System) -> StaticState:
    """The static start of a system from that of ``standing(system)``."""
    line = system.line
    lines = np.zeros((line.n_dof, line.n_line))
    lines[line.dofs_up_to(_last_node(system))] = static.lines
    return replace(static, lines=lines)


def _last_node(system: System) -> int:
    """The last node of the lines that the static start may move."""
    line, seats = system.line, system.seat_nodes
    if seats.size == 0:
        return line.n_node - 1
    front = float(system.wheel_positions(0.0).max())
    end = max(front, float(line.positions[seats[-1]])) + _BEYOND
    return min(int(np.searchsorted(line.positions, end)), line.n_node - 1)


def static_start(system: System) -> StaticState:
    """The state of rest of all that a system has.

    Raises:
        SingularSystemError: Train or structure can move without resistance.
    """
    effective = EffectiveSystem(system, Coefficients.static(), table=False)
    effective.locate_wheels(0.0)
    n_wheel = system.train.wheel_offsets.size
    compliance, _ = effective.contact_problem(np.zeros((n_wheel, n_wheel)))
    elevation = system.irregularity(system.train.wheel_lines, system.wheel_positions(0.0))
    train, forces, compression = _stand(system, compliance, elevation)
    pads = effective.pad_forces_for(forces)
    lines = effective.lines.finish(effective.line_load(forces, pads))
    structure = dead_load = None
    if effective.structure is not None:
        structure = np.array(effective.structure.finish(pads))
        effective.structure.begin_load(effective.structure.matrices.weight)
        dead_load = np.array(effective.structure.finish(np.zeros_like(pads)))
    return StaticState(
        lines=lines,
        train=train,
        structure=structure,
        contact_forces=forces,
        compression=compression,
        pad_forces=pads,
        dead_load=dead_load,
    )


def _stand(system: System, compliance: Matrix, elevation: Vector) -> tuple[Vector, Vector, Vector]:
    """Train displacements, contact forces and compressions by the system's contact law.

    Statics find every wheel on its rail: one that would have to be pulled shows tension, by the
    odd continuation of the nonlinear law.

    Raises:
        ConvergenceError: Newton's method did not settle.
    """
    train, law = system.train, system.nonlinear_hertz
    standing = StandingVehicle(
        name="the train", stiffness=train.stiffness, weight=train.weight, rows=train.wheel_rows
    )
    if law is None:
        found, forces = standing.on_linear(compliance, elevation - train.wheel_rest)
        return found, forces, np.zeros_like(forces)
    return standing.on_hertz(compliance, elevation - train.wheel_rest, law)
