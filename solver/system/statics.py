"""The static start: the train stands on the rails, everything in balance.

A free train is singular without contact, hence the bordered system (modelling decision):

    [K   -W'] [z]   [weight]
    [W  S_xx] [X] = [  r   ]

with S_xx the static compliance of the rails, the structure and the contact springs.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
import scipy.linalg as dense

from solver.arrays import Matrix, Vector
from solver.errors import SingularSystemError
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
        pad_forces: Tension in the pads, line after line, shape (n_pad,). [N]
        dead_load: Displacement of the structure under its own weight, rails and train absent.
    """

    lines: Matrix
    train: Vector
    structure: Vector | None
    contact_forces: Vector
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
    train, forces = _bordered(system, compliance, elevation)
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
        pad_forces=pads,
        dead_load=dead_load,
    )


def _bordered(system: System, compliance: Matrix, elevation: Vector) -> tuple[Vector, Vector]:
    """Train displacements and contact forces of the bordered system, scaled to one magnitude."""
    train = system.train
    n_dof, n_wheel = train.weight.size, elevation.size
    scale = np.abs(train.stiffness).max() or 1.0
    matrix = np.zeros((n_dof + n_wheel, n_dof + n_wheel))
    matrix[:n_dof, :n_dof] = train.stiffness / scale
    matrix[:n_dof, n_dof:] = -train.wheel_rows.T
    matrix[n_dof:, :n_dof] = train.wheel_rows
    matrix[n_dof:, n_dof:] = compliance * scale
    load = np.concatenate([train.weight / scale, elevation - train.wheel_rest])
    try:
        with warnings.catch_warnings():
            # Singular but for rounding: the forces would be noise that still adds up.
            warnings.simplefilter("error", dense.LinAlgWarning)
            solution = dense.solve(matrix, load)
    except (dense.LinAlgError, dense.LinAlgWarning) as error:
        raise SingularSystemError("the train", "a body moves without any spring") from error
    return solution[:n_dof], solution[n_dof:] * scale
