"""The static start: the train stands on the rails, everything in balance.

The compliance under the wheels is the static one of the rails, the structure and the contact
springs. A run with the nonlinear law that started from the state of the linear one would dip to
49 kN (modelling decision).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Matrix, Vector
from solver.contact.standing import StandingVehicle
from solver.system.coupled import EffectiveSystem, System
from solver.system.parts import Coefficients

__all__ = ["StaticState", "static_state"]


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
