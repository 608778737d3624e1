"""Contact rows of all wheels at one instant: what the constraint H a = r says (4.24, 5.32).

One form serves both drives. With the gap of a wheel above the deformed, irregular surface,

    gap(a) = xi_2 . (p - x(s)) - w(s) - r(s),

``rows`` is its derivative by the displacements, and a closed rigid contact at the next iterate
reads rows a = elevation, elevation = rows a(i) - gap(a(i)). At a prescribed speed s is known and
the gap is linear in a. In free drive s is the nearest point of the path, an unknown of the wheel;
the force then stands at right angles to the deformed surface, slope included, and does no work
along it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sparse

from solver.arrays import FloatArray, IntVector, SparseMatrix, Vector
from solver.assembly.rows import Rows
from solver.contact.path import PathPoint
from solver.methods.problem import PrescribedSpeed, Problem
from solver.methods.stacked import Stacked

__all__ = ["Border", "Borders"]


@dataclass(frozen=True, kw_only=True)
class Border:
    """Contact rows at one instant and iterate, over all freedoms, structure then vehicle.

    Attributes:
        wheel: Rows of the wheels' displacement along xi_2.
        rest: What else the gap depends on: the path, and in free drive the slope.
        elevation: Right-hand side, shape (n_wheel,). [m]
        gap: Of the iterate, shape (n_wheel,). [m]
        height: Of the wheels above the undeformed, perfect path: gap + w + r, (n_wheel,). [m]
        chainage: Place of each wheel, shape (n_wheel,). [m]
        point: Geometry under each wheel.
    """

    wheel: Rows
    rest: Rows
    elevation: Vector
    gap: Vector
    height: Vector
    chainage: Vector
    point: PathPoint

    @cached_property
    def h(self) -> Rows:
        """H: derivative of the gap."""
        return self.wheel.joined(self.rest)

    @cached_property
    def rows(self) -> SparseMatrix:
        """H as a sparse matrix, shape (n_wheel, n_dof)."""
        return self.h.sparse()


class Borders:
    """Makes borders for the wheels of a problem.

    Attributes:
        freedoms: Freedoms that any border may touch, ascending.
        path_freedoms: Those of the structure.
        wheel_freedoms: Those of the vehicle.
        moves_freely: Whether the wheels' places are unknowns.
    """

    def __init__(self, problem: Problem, stacked: Stacked) -> None:
        self._problem, self._n_dof = problem, stacked.n_dof
        n_wheel = problem.wheels.count
        axes = sparse.csr_array(sparse.hstack(problem.wheels.rows, format="csr"))
        together = Rows.from_sparse(axes)
        n_vehicle = problem.vehicle.n_dof
        self._wheel_columns = stacked.n_structure + together.columns % max(n_vehicle, 1)
        axis = together.columns // max(n_vehicle, 1)
        self._axes = [np.where(axis == k, together.values, 0.0) for k in range(3)]
        touched = np.unique(self._wheel_columns[together.values != 0.0])
        self.wheel_freedoms: IntVector = touched.astype(np.int64)
        self.path_freedoms: IntVector = problem.path.freedoms
        self.freedoms: IntVector = np.concatenate([self.path_freedoms, self.wheel_freedoms])
        self._start = problem.path.at(problem.wheels.chainage).position
        self.moves_freely = not isinstance(problem.drive, PrescribedSpeed)
        self._count = n_wheel

    def speed(self, velocity: Vector, border: Border) -> Vector:
        """Speed of each wheel along the path, shape (n_wheel,). [m/s]"""
        drive = self._problem.drive
        if isinstance(drive, PrescribedSpeed):
            return np.full(self._count, drive.speed)
        return self._towards(border.point.tangent).dot(velocity)

    def at(self, time: float, displacement: Vector, guess: Vector) -> Border:
        """Border for the displacements of all freedoms.

        Args:
            time: [s]
            displacement: Of all freedoms, the present iterate, shape (n_dof,).
            guess: Chainage of the wheels to start the search from, shape (n_wheel,). [m]

        Raises:
            InputError: A wheel leaves its path.
        """
        drive = self._problem.drive
        if isinstance(drive, PrescribedSpeed):
            return self._prescribed(drive.speed * time, displacement)
        return self._free(time, displacement, guess)

    def _prescribed(self, advance: float, displacement: Vector) -> Border:
        chainage = self._problem.wheels.chainage + advance
        point = self._problem.path.at(chainage)
        wheel, path = self._towards(point.normal), self._path_rows(point)
        elevation = self._problem.irregularity.elevation(chainage)
        height = wheel.dot(displacement)
        return Border(
            wheel=wheel, rest=path.scaled(-1.0), elevation=elevation,
            gap=height - path.dot(displacement) - elevation, height=height, chainage=chainage,
            point=point,
        )  # fmt: skip

    def again(self, time: float, displacement: Vector, border: Border) -> Border:
        """The border of the same instant at another iterate.

        At a prescribed speed nothing but the gaps changes.
        """
        if self.moves_freely:
            return self._free(time, displacement, border.chainage)
        height = border.wheel.dot(displacement)
        gap = height + border.rest.dot(displacement) - border.elevation
        return replace(border, gap=gap, height=height)

    def _free(self, time: float, displacement: Vector, guess: Vector) -> Border:
        problem = self._problem
        moved = [
            np.einsum("nk,nk->n", axis, displacement[self._wheel_columns]) for axis in self._axes
        ]
        places = self._start + np.stack(moved, axis=1)
        chainage = problem.path.nearest(places, guess)
        problem.require_inside(chainage, f"be, at t = {time:.6g} s, outside")
        point = problem.path.at(chainage)
        height = np.einsum("nk,nk->n", places - point.position, point.normal)
        path, slope_rows = self._path_rows(point), self._path_rows(point, 1)
        surface = path.dot(displacement) + problem.irregularity.elevation(chainage)
        slope = slope_rows.dot(displacement) + problem.irregularity.slope(chainage)
        wheel = self._towards(point.normal)
        rest = path.joined(self._towards(point.tangent).scaled(slope)).scaled(-1.0)
        gap = height - surface
        linear = wheel.dot(displacement) + rest.dot(displacement)
        return Border(
            wheel=wheel, rest=rest, elevation=linear - gap, gap=gap, height=height,
            chainage=chainage,
            point=point,
        )  # fmt: skip

    def path_rate(self, border: Border, displacement: Vector, velocity: Vector) -> Vector:
        """What H a' must equal while a closed contact stays closed, shape (n_wheel,). [m/s]

        v (dw/ds + dr/ds) at a prescribed speed; nothing in free drive, where H holds the slope.
        """
        if self.moves_freely:
            return np.zeros(self._count)
        slope = self._path_rows(border.point, 1).dot(displacement)
        return self.speed(velocity, border) * (
            slope + self._problem.irregularity.slope(border.chainage)
        )

    def path_acceleration(self, border: Border, displacement: Vector, velocity: Vector) -> Vector:
        """What H a'' must equal while a closed contact stays closed, shape (n_wheel,). [m/s2]

        2 v dw'/ds + v^2 (d2w/ds2 + d2r/ds2 + curvature of the path).
        """
        speed = self.speed(velocity, border)
        bend = self._path_rows(border.point, 2).dot(displacement)
        bend = bend + self._problem.irregularity.curvature(border.chainage)
        turning = self._path_rows(border.point, 1).dot(velocity)
        return 2.0 * speed * turning + speed**2 * (bend + border.point.curvature)

    def _towards(self, direction: FloatArray) -> Rows:
        """Rows of the contact points' displacement in a direction each, shape (n_wheel, 3)."""
        values = sum(direction[:, k : k + 1] * axis for k, axis in enumerate(self._axes))
        return Rows(self._wheel_columns, np.asarray(values), self._n_dof)

    def _path_rows(self, point: PathPoint, derivative: int = 0) -> Rows:
        """Rows of the path's normal displacement; the structure's freedoms come first."""
        rows = self._problem.path.rows(point.element, point.local, derivative)
        return Rows(rows.columns, rows.values, self._n_dof)
