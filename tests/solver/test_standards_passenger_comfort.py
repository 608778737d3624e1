"""Passenger comfort: the levels of EN 1990 A2.4.4.3.2, and whose acceleration decides."""

from __future__ import annotations

import pytest

from solver.standards import CarPeak, passenger_comfort


@pytest.mark.parametrize(
    ("peak", "level"),
    [
        (0.2, "very good"),
        (1.0, "very good"),
        (1.01, "good"),
        (1.3, "good"),
        (1.9, "acceptable"),
        (2.01, "beyond acceptable"),
    ],
)
def test_a_car_has_the_best_level_that_holds(peak: float, level: str) -> None:
    found = passenger_comfort([CarPeak(name="carbody 01", peak=peak, time=1.0)])
    assert found.worst.level == found.cars[0].level == level
    assert [step.limit for step in found.levels] == [1.0, 1.3, 2.0]
    assert "A2.4.4.3.2" in found.clause


def test_power_cars_have_a_level_but_do_not_decide() -> None:
    cars = [
        CarPeak(name="carbody 01", peak=2.5, time=1.0, passengers=False),
        CarPeak(name="carbody 02", peak=1.2, time=2.0),
        CarPeak(name="carbody 03", peak=0.4, time=3.0),
    ]
    found = passenger_comfort(cars)
    assert found.worst.name == "carbody 02"
    assert [car.level for car in found.cars] == ["beyond acceptable", "good", "very good"]
