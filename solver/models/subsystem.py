"""A subsystem in general form: matrices, supports that may move, loads, nonlinear springs.

The structure and the vehicle of the general engine (``solver.methods``) are each one subsystem.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import scipy.sparse as sparse

from solver.arrays import IntVector, Matrix, SparseMatrix, Vector
from solver.errors import InputError

__all__ = ["NonlinearElements", "Subsystem", "SupportMotion"]

SupportMotion = Callable[[float], tuple[Vector, Vector, Vector]]
"""Displacement, velocity, acceleration of the prescribed freedoms at a time. [s]"""


class NonlinearElements(Protocol):
    """Elements whose force is no linear function of the displacement."""

    freedoms: IntVector
    """Distinct freedoms of the subsystem that they join, shape (n,)."""

    def force(self, displacement: Vector) -> Vector:
        """Internal force on ``freedoms``, shape (n,). [N]"""
        ...

    def tangent(self, displacement: Vector) -> Matrix:
        """Its derivative, symmetric, shape (n, n). [N/m]"""
        ...


def _nothing() -> IntVector:
    return np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, kw_only=True)
class Subsystem:
    """M, C, K, supports and loads of one part.

    Attributes:
        name: For messages: ``the structure``, ``the vehicle``.
        mass: Shape (n_dof, n_dof). [kg]
        damping: Likewise. [N s/m]
        stiffness: Likewise; of the linear elements only. [N/m]
        load: External force, constant or a function of time, shape (n_dof,). [N]
        prescribed: Freedoms of P type (equation 4.5), supports and driven ones.
        support_motion: Motion of the prescribed freedoms; None holds them at zero.
        nonlinear: Elements beyond the stiffness matrix, or None.

    Raises:
        InputError: Shapes that do not fit, a matrix that is not symmetric, negative masses,
            values that are not numbers.
    """

    name: str
    mass: SparseMatrix
    damping: SparseMatrix
    stiffness: SparseMatrix
    load: Vector | Callable[[float], Vector]
    prescribed: IntVector = field(default_factory=_nothing)
    support_motion: SupportMotion | None = None
    nonlinear: NonlinearElements | None = None

    def __post_init__(self) -> None:
        for title in ("mass", "damping", "stiffness"):
            matrix = sparse.csr_array(getattr(self, title))
            _require_sound(self.name, title, matrix, self.n_dof)
            object.__setattr__(self, title, matrix)
        if self.mass.diagonal().min(initial=0.0) < 0.0:
            _refuse(self.name, "mass", float(self.mass.diagonal().min()), "is a negative mass",
                    "Give masses and densities as positive numbers.")  # fmt: skip
        prescribed = np.asarray(self.prescribed, dtype=np.int64)
        if prescribed.size and (
            prescribed.min() < 0
            or prescribed.max() >= self.n_dof
            or np.unique(prescribed).size < prescribed.size
        ):
            _refuse(self.name, "prescribed", prescribed.tolist()[:8],
                    f"is not a list of distinct freedoms between 0 and {self.n_dof - 1}",
                    "List each supported freedom once.")  # fmt: skip
        object.__setattr__(self, "prescribed", prescribed)
        self.load_at(0.0)

        self._require_free_elements()

    def _require_free_elements(self) -> None:
        """Nonlinear elements join free freedoms, each once."""
        if self.nonlinear is None:
            return
        freedoms = np.asarray(self.nonlinear.freedoms)
        sound = freedoms.size == 0 or (freedoms.min() >= 0 and freedoms.max() < self.n_dof)
        if not sound or np.unique(freedoms).size < freedoms.size:
            _refuse(self.name, "nonlinear", freedoms.tolist()[:8],
                    f"is not a list of distinct freedoms between 0 and {self.n_dof - 1}",
                    "List each freedom of the elements once.")  # fmt: skip
        if np.isin(freedoms, self.prescribed).any():
            _refuse(self.name, "nonlinear", freedoms.tolist()[:8], "joins a prescribed freedom",
                    "Put a stiff spring between the element and the support.")  # fmt: skip

    @property
    def n_dof(self) -> int:
        """Freedoms, prescribed ones included."""
        return int(self.mass.shape[0])

    def load_at(self, time: float) -> Vector:
        """External force at a time, shape (n_dof,). [N]

        Raises:
            InputError: It is not one finite force for every freedom.
        """
        load = self.load(time) if callable(self.load) else self.load
        if np.shape(load) != (self.n_dof,) or not np.isfinite(load).all():
            _refuse(self.name, "load", np.shape(load),
                    f"is not {self.n_dof} finite forces at t = {time:g} s",
                    "Give one force for every freedom.")  # fmt: skip
        return load

    def support_motion_at(self, time: float) -> tuple[Vector, Vector, Vector]:
        """Displacement, velocity and acceleration of the prescribed freedoms at a time.

        Raises:
            InputError: They are not one finite number for every prescribed freedom.
        """
        if self.support_motion is None:
            zero = np.zeros(self.prescribed.size)
            return zero, zero, zero
        motion = self.support_motion(time)
        for title, values in zip(("displacement", "velocity", "acceleration"), motion, strict=True):
            if np.shape(values) != self.prescribed.shape or not np.isfinite(values).all():
                _refuse(self.name, f"support_motion.{title}", np.shape(values),
                        f"is not {self.prescribed.size} finite numbers at t = {time:g} s",
                        "Give one number for every prescribed freedom.")  # fmt: skip
        return motion


def _require_sound(name: str, title: str, matrix: SparseMatrix, n_dof: int) -> None:
    """The matrix is square, finite and symmetric."""
    if matrix.shape != (n_dof, n_dof):
        _refuse(name, title, matrix.shape, f"is not of shape ({n_dof}, {n_dof})",
                "Assemble mass, damping and stiffness over the same freedoms.")  # fmt: skip
    if not np.isfinite(matrix.data).all():
        _refuse(name, title, "not a number", "contains values that are not finite",
                "Check the materials and the geometry of the elements.")  # fmt: skip
    asymmetry = np.abs((matrix - matrix.T).data).max(initial=0.0)
    if asymmetry > 1e-9 * np.abs(matrix.data).max(initial=0.0):
        _refuse(name, title, float(asymmetry), "is the greatest difference to the transpose",
                "Use elements with symmetric matrices.")  # fmt: skip


def _refuse(name: str, title: str, value: object, reason: str, remedy: str) -> None:
    raise InputError(f"{name}.{title}", value, reason, remedy)
