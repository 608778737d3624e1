"""A train given as a table of axles: where each stands, what it weighs, how it is sprung."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi, sqrt
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Ge, Gt, Le, Len

from solver.arrays import Matrix, Vector
from solver.errors import InputError
from solver.models.train_assembly import RigidBodyAssembly, side_height_row
from solver.models.train_model import GRAVITY, LEFT, RIGHT, WHEEL_RADIUS, Body, TrainModel
from solver.units import Units

__all__ = ["Axle", "AxleTable", "axle_table_errors", "axle_table_train"]

_STRICT: dict[str, Any] = {"extra": "forbid", "use_attribute_docstrings": True}


@dataclass(frozen=True, kw_only=True)
class Axle:
    """One row of the table: a mass on a spring and dashpot over an unsprung mass."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    position: Annotated[float, Units.length, Ge(0), Le(2000)]
    """Distance behind the head of the train; the train begins at the first axle, wherever the
    distances are counted from."""
    load: Annotated[float, Units.force, Gt(0), Le(1e6)]
    """Static load of the whole axle, all its masses times 9.81 m/s2."""
    unsprung_mass: Annotated[float, Units.mass, Ge(0), Le(2e4)] = 0.0
    """Mass of the load that follows the rail: the wheelset."""
    stiffness: Annotated[float, Units.stiffness, Ge(0), Le(1e12)] = 0.0
    """Stiffness of the axle's suspension; 0 lets it follow from the bounce frequency."""
    damping: Annotated[float, Units.damping, Ge(0), Le(1e9)] = 0.0
    """Damping of the axle's suspension; 0 lets it follow from the damping ratio."""

    @property
    def sprung_mass(self) -> float:
        """What is left of the load's mass above the suspension. [kg]"""
        return self.load / GRAVITY - self.unsprung_mass


@dataclass(frozen=True, kw_only=True)
class AxleTable:
    """Axles one behind the other, each a sprung mass of its own; nothing couples them.

    It stands for loads that move, with some of a vehicle's mass: contact forces and the bridge
    follow from it, passengers' comfort does not, for it has no carbodies. On a plain beam an axle
    has one wheel; on a track with two rails it has two, each with half of its masses and
    suspension.

    The suspension that is not given is an assumption: every sprung mass bounces at 1 Hz, about as
    carbodies do on their secondary springs, without damping unless the table says so. The softer
    it is, the more the axles are constant forces: a force varies by (2 pi f)^2 u / g of itself
    where the rail moves by u well above f.
    """

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    type: Literal["axle_table"] = "axle_table"
    """Kind of train."""
    name: Annotated[str, Len(1, 80)] = "axle table"
    """Name shown in results and verdicts."""
    axles: Annotated[tuple[Axle, ...], Len(1, 200)] = (Axle(position=0.0, load=170e3),)
    """The axles, from the first to the last, one a row: position and load are enough, the rest
    follows where it is 0."""
    bounce_frequency: Annotated[float, Units.frequency, Ge(0.05), Le(50)] = 1.0
    """Natural frequency of the sprung mass of axles whose stiffness is 0 (assumed)."""
    damping_ratio: Annotated[float, Units.none, Ge(0), Le(1)] = 0.0
    """Damping of the sprung mass of axles whose damping is 0, as a part of the critical one
    (assumed). With damping, axles without unsprung mass feel every kink of the rail."""
    wheel_lateral_distance: Annotated[float, Units.length, Gt(0), Le(3)] = 1.435
    """Lateral distance between the contact points of an axle on two rails."""

    @property
    def offsets(self) -> Vector:
        """Shape (n_axle,): x of each axle minus x of the first. [m]"""
        positions = np.array([axle.position for axle in self.axles])
        # Subtracted this way round, so that the first is 0 and not -0.
        return positions[0] - positions

    def suspension(self, axle: Axle) -> tuple[float, float]:
        """Stiffness and damping of an axle, its own or those that follow from the table.

        Args:
            axle: One of the axles.

        Returns:
            k [N/m] and c [N s/m]; c is a part of 2 sqrt(k m), whosever k is.
        """
        mass = axle.sprung_mass
        stiffness = axle.stiffness or mass * (2.0 * pi * self.bounce_frequency) ** 2
        return stiffness, axle.damping or 2.0 * self.damping_ratio * sqrt(stiffness * mass)


def axle_table_errors(properties: AxleTable) -> Iterator[InputError]:
    """Everything that rows forbid together, by row.

    Args:
        properties: A table whose values are each within their bounds.

    Yields:
        One error for each row that is not behind the one before, or that leaves no sprung mass.
    """
    before = -1.0
    for index, axle in enumerate(properties.axles):
        if axle.position <= before:
            yield InputError(
                f"train.axles.{index}.position",
                axle.position,
                f"is not behind the axle of row {index}, which stands at {before:g} m",
                "Give distances that grow from row to row.",
            )
        before = axle.position
        if axle.sprung_mass <= 0.0:
            mass = 1e-3 * axle.load / GRAVITY
            yield InputError(
                f"train.axles.{index}.unsprung_mass",
                axle.unsprung_mass,
                f"leaves no sprung mass: the load of {1e-3 * axle.load:g} kN is {mass:.4g} t",
                f"Use less than {mass:.4g} t, or a greater load.",
            )


# Boxes that stand for the masses in the viewer, short enough for the axles of a bogie; no
# computation reads them.
_BOX_LENGTH, _BOX_HEIGHT, _BOX_BASE = 1.2, 0.8, 1.2
_BOX_WIDTH = {1: 1.2, 2: 2.0}


@dataclass(frozen=True, kw_only=True)
class _Wheels:
    """The wheels of each axle, and how it moves.

    Attributes:
        rails: Index of each wheel's rail.
        lateral: y of each wheel. [m]
        sides: What is added to each wheel's name.
        motions: Degrees of freedom of a mass.
    """

    rails: tuple[int, ...]
    lateral: tuple[float, ...]
    sides: tuple[str, ...]
    motions: tuple[str, ...]


_ON_ONE_RAIL = _Wheels(rails=(LEFT,), lateral=(0.0,), sides=("",), motions=("bounce",))


def _on_two_rails(distance: float) -> _Wheels:
    return _Wheels(
        rails=(LEFT, RIGHT),
        lateral=(distance / 2, -distance / 2),
        sides=(" left", " right"),
        motions=("bounce", "roll"),
    )


def axle_table_train(properties: AxleTable, rail_count: Literal[1, 2] = 1) -> TrainModel:
    """Assembles the axles: bounce of the sprung and the unsprung mass, on two rails roll as well.

    Args:
        properties: The table.
        rail_count: Rails of the structure: on one, a wheel an axle at y = 0 on rail 0; on two, a
            wheel on each with half of the axle's masses, stiffness and damping above it.

    Returns:
        The train; wheels run from the first axle to the last, left before right.

    Raises:
        InputError: A row is not behind the one before, or leaves no sprung mass.
    """
    for error in axle_table_errors(properties):
        raise error
    own = _ON_ONE_RAIL if rail_count == 1 else _on_two_rails(properties.wheel_lateral_distance)
    count, numbers = len(properties.axles), range(1, len(properties.axles) + 1)
    assembly = RigidBodyAssembly(2 * len(own.motions) * count)
    bodies: list[Body] = []
    wheel_rows: list[Vector] = []
    for index, axle in enumerate(properties.axles):
        rows = tuple(_motion(index, part, len(own.motions), count) for part in (0, 1))
        wheel_rows += _assemble(assembly, axle, properties.suspension(axle), own, rows)
        bodies += _bodies(properties, index, rail_count, rows)
    return TrainModel(
        name=properties.name,
        mass=assembly.mass,
        damping=assembly.damping,
        stiffness=assembly.stiffness,
        weight=assembly.weight,
        wheel_rows=np.array(wheel_rows),
        wheel_offsets=np.repeat(properties.offsets, rail_count),
        wheel_rail=np.tile(np.array(own.rails, dtype=np.int64), count),
        wheel_lateral=np.tile(own.lateral, count),
        wheel_names=tuple(f"wheel {i:02d}{side}" for i in numbers for side in own.sides),
        wheel_radius=WHEEL_RADIUS,
        axle_offsets=properties.offsets,
        bodies=tuple(bodies),
        dof_names=tuple(
            f"{part} {i:02d} {motion}"
            for i in numbers
            for part in ("mass", "wheelset")
            for motion in own.motions
        ),
    )


def _assemble(
    assembly: RigidBodyAssembly,
    axle: Axle,
    suspension: tuple[float, float],
    wheels: _Wheels,
    rows: Sequence[Matrix],
) -> list[Vector]:
    """Adds an axle's masses and suspension, and gives the rows of its wheels' contact points."""
    sprung, unsprung = rows
    # A share above each wheel: m (b / 2)^2 about the longitudinal axis.
    radius = wheels.lateral[0]
    assembly.add_body(sprung, axle.sprung_mass, axle.sprung_mass * radius**2)
    assembly.add_body(unsprung, axle.unsprung_mass, axle.unsprung_mass * radius**2)
    stiffness, damping = (value / len(wheels.lateral) for value in suspension)
    found: list[Vector] = []
    for y in wheels.lateral:
        wheel = side_height_row(unsprung[0], unsprung[1], y)
        elongation = side_height_row(sprung[0], sprung[1], y) - wheel
        assembly.add_spring(elongation, stiffness, damping)
        found.append(wheel)
    return found


def _motion(index: int, part: int, n_motion: int, count: int) -> Matrix:
    """Bounce, roll and pitch of an axle's sprung (0) or unsprung (1) mass, shape (3, n_dof)."""
    rows = np.zeros((3, 2 * n_motion * count))
    first = (2 * index + part) * n_motion
    rows[range(n_motion), range(first, first + n_motion)] = 1.0
    return rows


def _bodies(
    properties: AxleTable, index: int, rail_count: Literal[1, 2], rows: Sequence[Matrix]
) -> list[Body]:
    """A box for an axle's sprung mass, and its wheelset where that weighs something."""
    axle, offset = properties.axles[index], float(properties.offsets[index])
    mass = Body(
        name=f"mass {index + 1:02d}", kind="carbody", mass=axle.sprung_mass, offset=offset,
        drawn_offset=offset, length=_BOX_LENGTH, width=_BOX_WIDTH[rail_count], height=_BOX_HEIGHT,
        base_height=_BOX_BASE, rows=rows[0],
    )  # fmt: skip
    wheelset = Body(
        name=f"wheelset {index + 1:02d}", kind="wheelset", mass=axle.unsprung_mass, offset=offset,
        drawn_offset=offset, length=2 * WHEEL_RADIUS,
        width=properties.wheel_lateral_distance, height=2 * WHEEL_RADIUS, base_height=0.0,
        rows=rows[1],
    )  # fmt: skip
    return [mass, wheelset] if axle.unsprung_mass > 0.0 else [mass]
