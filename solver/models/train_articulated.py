"""Assembles an articulated train from its layout.

Degrees of freedom (the vertical set): the height of every car end (shared at a hinge) and the roll
of every car; height, roll and pitch of every bogie; height and roll of every wheelset. A car's
bounce and pitch follow from the heights of its two ends, so hinges hold exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Matrix, Vector
from solver.models.train_assembly import RigidBodyAssembly, end_height_row, side_height_row
from solver.models.train_drawing import draw_bogie, draw_carbody, draw_wheelset
from solver.models.train_layout import BogiePlace, CarPlace, TrainLayout, lay_out
from solver.models.train_model import LEFT, RIGHT, WHEEL_RADIUS, Body, TrainModel
from solver.models.train_properties import ArticulatedTrain

__all__ = ["articulated_train"]

_SIDES = (0.5, -0.5)


@dataclass(frozen=True, kw_only=True)
class _Kinematics:
    """Rows (bounce, roll, pitch) of every body over the degrees of freedom, and their names."""

    cars: list[Matrix]
    bogies: list[Matrix]
    wheelsets: list[Matrix]
    dof_names: tuple[str, ...]

    @property
    def n_dof(self) -> int:
        return len(self.dof_names)


def articulated_train(properties: ArticulatedTrain) -> TrainModel:
    """Assembles the train's matrices, weights, wheels and bodies.

    Args:
        properties: The train.

    Returns:
        Its model; wheels run from the first axle to the last, left before right.

    Raises:
        InputError: The consist cannot be put together.

    References:
        Neves (2016), section 6.2.2.
    """
    layout = lay_out(properties)
    kinematics = _kinematics(layout, rigid_roll=properties.roll_coupling == "rigid")
    assembly = RigidBodyAssembly(kinematics.n_dof)
    _add_bodies(assembly, layout, kinematics)
    for i, bogie in enumerate(layout.bogies):
        _add_primary(assembly, bogie, kinematics.bogies[i], kinematics.wheelsets[2 * i : 2 * i + 2])
    for car, rows in zip(layout.cars, kinematics.cars, strict=True):
        _add_secondary(assembly, layout, car, rows, kinematics.bogies)
    _add_inter_car_dampers(assembly, properties, layout, kinematics)
    half = properties.wheel_lateral_distance / 2
    axle_offsets = layout.axle_offsets
    n_axle = len(axle_offsets)
    return TrainModel(
        name=properties.name,
        mass=assembly.mass,
        damping=assembly.damping,
        stiffness=assembly.stiffness,
        weight=assembly.weight,
        wheel_rows=np.array(
            [
                side_height_row(rows[0], rows[1], side)
                for rows in kinematics.wheelsets
                for side in (half, -half)
            ]
        ),
        wheel_offsets=np.repeat(axle_offsets, 2),
        wheel_rail=np.tile(np.array([LEFT, RIGHT], dtype=np.int64), n_axle),
        wheel_lateral=np.tile([half, -half], n_axle),
        wheel_names=tuple(
            f"wheel {axle:02d} {side}"
            for axle in range(1, n_axle + 1)
            for side in ("left", "right")
        ),
        wheel_radius=WHEEL_RADIUS,
        axle_offsets=axle_offsets,
        bodies=_bodies(properties, layout, kinematics),
        dof_names=kinematics.dof_names,
    )


def _kinematics(layout: TrainLayout, *, rigid_roll: bool) -> _Kinematics:
    """Numbers the degrees of freedom and writes every body's motion over them."""
    names: list[str] = []

    def new(name: str) -> int:
        names.append(name)
        return len(names) - 1

    ends: list[tuple[int, int, int]] = []
    for i, car in enumerate(layout.cars):
        label = f"carbody {i + 1:02d}"
        front = ends[-1][2] if car.hinged_in_front else new(f"{label} front height")
        shares_roll = car.hinged_in_front and rigid_roll
        roll = ends[-1][1] if shares_roll else new(f"{label} roll")
        end = "hinge" if car.hinged_behind else "rear"
        ends.append((front, roll, new(f"{label} {end} height")))
    bogies = [
        [new(f"bogie {i + 1:02d} {motion}") for motion in ("bounce", "roll", "pitch")]
        for i in range(len(layout.bogies))
    ]
    wheelsets = [
        [new(f"wheelset {i + 1:02d} {motion}") for motion in ("bounce", "roll")]
        for i in range(2 * len(layout.bogies))
    ]
    unit = np.eye(len(names))
    return _Kinematics(
        cars=[
            _car_rows(car, *(unit[dof] for dof in dofs))
            for car, dofs in zip(layout.cars, ends, strict=True)
        ],
        bogies=[unit[dofs] for dofs in bogies],
        wheelsets=[np.vstack([unit[dofs], np.zeros(len(names))]) for dofs in wheelsets],
        dof_names=tuple(names),
    )


def _car_rows(car: CarPlace, front: Vector, roll: Vector, rear: Vector) -> Matrix:
    """A car's bounce, roll and pitch from the heights of its two ends; pitch is nose down."""
    length = car.front_distance + car.rear_distance
    bounce = (car.rear_distance * front + car.front_distance * rear) / length
    return np.array([bounce, roll, (rear - front) / length])


def _add_bodies(assembly: RigidBodyAssembly, layout: TrainLayout, kinematics: _Kinematics) -> None:
    for car, rows in zip(layout.cars, kinematics.cars, strict=True):
        vehicle = car.vehicle
        assembly.add_body(
            rows, vehicle.carbody_mass, vehicle.carbody_roll_inertia, vehicle.carbody_pitch_inertia
        )
    for i, bogie in enumerate(layout.bogies):
        vehicle = bogie.vehicle
        assembly.add_body(
            kinematics.bogies[i],
            vehicle.bogie_mass,
            vehicle.bogie_roll_inertia,
            vehicle.bogie_pitch_inertia,
        )
        for rows in kinematics.wheelsets[2 * i : 2 * i + 2]:
            assembly.add_body(rows, vehicle.wheelset_mass, vehicle.wheelset_roll_inertia)


def _add_primary(
    assembly: RigidBodyAssembly, bogie: BogiePlace, rows: Matrix, wheelsets: list[Matrix]
) -> None:
    """Four springs between a bogie frame and its two wheelsets."""
    vehicle = bogie.vehicle
    for end, wheelset in zip(_SIDES, wheelsets, strict=True):
        frame = end_height_row(rows, end * vehicle.wheelbase)
        for side in _SIDES:
            lateral = side * vehicle.primary_spacing
            elongation = side_height_row(frame, rows[1], lateral) - side_height_row(
                wheelset[0], wheelset[1], lateral
            )
            assembly.add_spring(elongation, vehicle.primary_stiffness, vehicle.primary_damping)


def _add_secondary(
    assembly: RigidBodyAssembly,
    layout: TrainLayout,
    car: CarPlace,
    rows: Matrix,
    bogies: list[Matrix],
) -> None:
    """Two springs between each car end and its bogie; half of each where two cars share it.

    Both halves act on the one height of the hinge, so there the springs act once.
    """
    ends = (
        (car.front_bogie, car.front_distance, car.hinged_in_front),
        (car.rear_bogie, -car.rear_distance, car.hinged_behind),
    )
    for bogie, ahead, shared in ends:
        vehicle = layout.bogies[bogie].vehicle
        share = 0.5 if shared else 1.0
        height = end_height_row(rows, ahead)
        for side in _SIDES:
            lateral = side * vehicle.secondary_spacing
            elongation = side_height_row(height, rows[1], lateral) - side_height_row(
                bogies[bogie][0], bogies[bogie][1], lateral
            )
            assembly.add_spring(
                elongation, share * vehicle.secondary_stiffness, share * vehicle.secondary_damping
            )


def _add_inter_car_dampers(
    assembly: RigidBodyAssembly,
    properties: ArticulatedTrain,
    layout: TrainLayout,
    kinematics: _Kinematics,
) -> None:
    """Longitudinal dampers: at height h above the hinge they feel h times the relative pitch."""
    dampers, heights = properties.inter_car_dampers, properties.damper_heights
    for i, car in enumerate(layout.cars):
        if car.hinged_behind:
            bend = kinematics.cars[i][2] - kinematics.cars[i + 1][2]
            assembly.add_spring(heights.upper * bend, 0.0, dampers.upper)
            assembly.add_spring(heights.lower * bend, 0.0, dampers.lower)


def _bodies(
    properties: ArticulatedTrain, layout: TrainLayout, kinematics: _Kinematics
) -> tuple[Body, ...]:
    """Every body with its motion and the box that stands for it."""
    bodies = [
        draw_carbody(f"carbody {i + 1:02d}", car, rows, properties.bogie_gap)
        for i, (car, rows) in enumerate(zip(layout.cars, kinematics.cars, strict=True))
    ]
    bodies += [
        draw_bogie(f"bogie {i + 1:02d}", bogie, rows)
        for i, (bogie, rows) in enumerate(zip(layout.bogies, kinematics.bogies, strict=True))
    ]
    bodies += [
        draw_wheelset(
            f"wheelset {i + 1:02d}",
            layout.bogies[i // 2],
            float(offset),
            rows,
            width=properties.wheel_lateral_distance,
            radius=WHEEL_RADIUS,
        )
        for i, (offset, rows) in enumerate(
            zip(layout.axle_offsets, kinematics.wheelsets, strict=True)
        )
    ]
    return tuple(bodies)
