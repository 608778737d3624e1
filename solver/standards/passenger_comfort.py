"""EN 1990 A2.4.4.3.2: how comfortable the passengers find the crossing.

The levels are for the vertical acceleration inside the coach on the approach to, over and off the
structure. They are no limits that a structure has to keep: the level is agreed for the project.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from solver.data import load

__all__ = ["BEYOND", "CarPeak", "Comfort", "ComfortLevel", "passenger_comfort"]

BEYOND = "beyond acceptable"
"""Level of a car that none of the clause's levels holds for."""


@dataclass(frozen=True, kw_only=True)
class ComfortLevel:
    """A level of the table.

    Attributes:
        name: ``very good``, ``good`` or ``acceptable``.
        limit: Greatest vertical acceleration. [m/s2]
    """

    name: str
    limit: float


@dataclass(frozen=True, kw_only=True)
class CarPeak:
    """The greatest |acceleration| of one car.

    Attributes:
        name: For example ``carbody 03``.
        peak: At the car's centre of mass. [m/s2]
        time: When. [s]
        passengers: Whether it carries any.
        level: The best level that holds, or ``BEYOND``; filled by ``passenger_comfort``.
    """

    name: str
    peak: float
    time: float
    passengers: bool = True
    level: str = ""


@dataclass(frozen=True, kw_only=True)
class Comfort:
    """Comfort of a train's passengers.

    Attributes:
        clause: Standard, clause and table.
        levels: From the best to the worst.
        cars: From the first to the last.
        worst: The car with passengers that has the greatest peak.
        note: How it was measured.
    """

    clause: str
    levels: tuple[ComfortLevel, ...]
    cars: tuple[CarPeak, ...]
    worst: CarPeak
    note: str


def passenger_comfort(cars: Sequence[CarPeak]) -> Comfort:
    """Levels of comfort from the peaks of the cars.

    Args:
        cars: At least one, with passengers.

    Returns:
        The levels; every car has one, those with passengers decide.

    Raises:
        ValueError: No car carries passengers.

    References:
        EN 1990:2002/A1 A2.4.4.3.2, table A2.9.
    """
    rule = load("standards")["passenger_comfort"]
    levels = tuple(
        ComfortLevel(name=name, limit=float(limit)) for name, limit in rule["levels"].items()
    )
    rated = tuple(
        CarPeak(
            name=car.name, peak=car.peak, time=car.time, passengers=car.passengers,
            level=_level(car.peak, levels),
        )
        for car in cars
    )  # fmt: skip
    return Comfort(
        clause=rule["clause"],
        levels=levels,
        cars=rated,
        worst=max((car for car in rated if car.passengers), key=lambda car: car.peak),
        note=rule["note"],
    )


def _level(peak: float, levels: Sequence[ComfortLevel]) -> str:
    return next((level.name for level in levels if peak <= level.limit), BEYOND)
