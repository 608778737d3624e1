"""Where the cars and bogies of an articulated train stand, and which cars meet at which bogie."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Vector
from solver.errors import InputError
from solver.models.train_properties import ArticulatedTrain
from solver.models.vehicle import VehicleType

__all__ = ["BogiePlace", "CarPlace", "TrainLayout", "lay_out"]


@dataclass(frozen=True, kw_only=True)
class CarPlace:
    """One car of the consist.

    Attributes:
        vehicle: Its type.
        front_bogie: Index of the bogie under its front end.
        rear_bogie: Index of the bogie under its rear end.
        front_distance: From its centre of mass to the front bogie's centre. [m]
        rear_distance: From its centre of mass to the rear bogie's centre. [m]
        offset: x of its centre of mass minus x of the first axle. [m]
        hinged_in_front: It shares its front bogie with the car ahead.
        hinged_behind: It shares its rear bogie with the car behind.
    """

    vehicle: VehicleType
    front_bogie: int
    rear_bogie: int
    front_distance: float
    rear_distance: float
    offset: float
    hinged_in_front: bool
    hinged_behind: bool


@dataclass(frozen=True, kw_only=True)
class BogiePlace:
    """One bogie.

    Attributes:
        vehicle: The type of car whose bogie it is.
        offset: x of its centre minus x of the first axle. [m]
    """

    vehicle: VehicleType
    offset: float


@dataclass(frozen=True, kw_only=True)
class TrainLayout:
    """Cars and bogies from the front to the back.

    Attributes:
        cars: The cars.
        bogies: The bogies.
    """

    cars: tuple[CarPlace, ...]
    bogies: tuple[BogiePlace, ...]

    @property
    def axle_offsets(self) -> Vector:
        """Shape (n_axle,): x of each axle minus x of the first. [m]"""
        return np.array(
            [
                bogie.offset + side * bogie.vehicle.wheelbase / 2
                for bogie in self.bogies
                for side in (1.0, -1.0)
            ]
        )


@dataclass(frozen=True, kw_only=True)
class _OrientedCar:
    """A car with its way of running resolved."""

    vehicle: VehicleType
    reversed: bool

    @property
    def distances(self) -> tuple[float, float]:
        leading, trailing = self.vehicle.leading_distance, self.vehicle.trailing_distance
        return (trailing, leading) if self.reversed else (leading, trailing)

    def hinged(self, *, front: bool) -> bool:
        if self.vehicle.articulation == "trailing_end":
            return front == self.reversed
        return self.vehicle.articulation == "both_ends"


def lay_out(properties: ArticulatedTrain) -> TrainLayout:
    """Places the cars one behind the other and shares bogies where two hinged ends meet.

    A shared bogie is that of the car articulated at both ends (of the one ahead if both are).

    Args:
        properties: The train.

    Returns:
        The places of cars and bogies.

    Raises:
        InputError: A name in the consist is unknown or used twice, or a hinged end meets an end
            that is not hinged.
    """
    oriented = _orient(properties)
    _check_joints(oriented, properties.consist)
    bogies: list[BogiePlace] = []
    cars: list[CarPlace] = []
    front_offset = -oriented[0].vehicle.wheelbase / 2
    for i, car in enumerate(oriented):
        front, rear = car.distances
        hinged_in_front = car.hinged(front=True)
        if not hinged_in_front:
            bogies.append(BogiePlace(vehicle=car.vehicle, offset=front_offset))
        front_bogie = len(bogies) - 1
        rear_offset = front_offset - front - rear
        hinged_behind = car.hinged(front=False)
        owner = _shared_owner(car, oriented[i + 1]) if hinged_behind else car.vehicle
        bogies.append(BogiePlace(vehicle=owner, offset=rear_offset))
        cars.append(
            CarPlace(
                vehicle=car.vehicle,
                front_bogie=front_bogie,
                rear_bogie=front_bogie + 1,
                front_distance=front,
                rear_distance=rear,
                offset=front_offset - front,
                hinged_in_front=hinged_in_front,
                hinged_behind=hinged_behind,
            )
        )
        front_offset = rear_offset - (0.0 if hinged_behind else properties.bogie_gap)
    return TrainLayout(cars=tuple(cars), bogies=tuple(bogies))


def _orient(properties: ArticulatedTrain) -> list[_OrientedCar]:
    """Turns the cars of the second half round, and inner cars as their orientation says."""
    types = {vehicle.name: vehicle for vehicle in properties.vehicle_types}
    if len(types) < len(properties.vehicle_types):
        raise InputError(
            "train.vehicle_types",
            [vehicle.name for vehicle in properties.vehicle_types],
            "two vehicle types have the same name",
            "Give each type its own name.",
        )
    oriented: list[_OrientedCar] = []
    for i, name in enumerate(properties.consist):
        if name not in types:
            raise InputError(
                f"train.consist.{i}",
                name,
                "no vehicle type has this name",
                f"Use one of {', '.join(types)}.",
            )
        second_half = 2 * i >= len(properties.consist)
        inner = types[name].articulation == "both_ends"
        flipped = inner and properties.passenger_orientation == "leading_inwards"
        oriented.append(_OrientedCar(vehicle=types[name], reversed=second_half != flipped))
    return oriented


def _check_joints(oriented: list[_OrientedCar], consist: tuple[str, ...]) -> None:
    """Refuses a hinged end that meets an end with a bogie of its own, or nothing."""
    behind = [car.hinged(front=False) for car in oriented]
    ahead = [car.hinged(front=True) for car in oriented]
    for i, (rear, front) in enumerate(zip([False, *behind], [*ahead, False], strict=True)):
        if rear != front:
            place = min(max(i if front else i - 1, 0), len(consist) - 1)
            raise InputError(
                f"train.consist.{place}",
                consist[place],
                "its articulated end does not meet another articulated end",
                "Close the articulated set with cars articulated at their trailing end only.",
            )


def _shared_owner(ahead: _OrientedCar, behind: _OrientedCar) -> VehicleType:
    """The type of car whose bogie two hinged ends share."""
    inner = [car for car in (ahead, behind) if car.vehicle.articulation == "both_ends"]
    return (inner or [ahead])[0].vehicle
