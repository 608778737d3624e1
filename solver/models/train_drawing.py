"""Boxes that stand for the bodies of a train in the viewer; no computation reads their sizes."""

from __future__ import annotations

from solver.arrays import Matrix
from solver.models.train_layout import BogiePlace, CarPlace
from solver.models.train_model import Body

__all__ = ["draw_bogie", "draw_carbody", "draw_wheelset"]

_CAR_WIDTH, _CAR_HEIGHT, _CAR_BASE = 2.9, 2.8, 1.0
_FREE_OVERHANG = 3.0
_GAP_BETWEEN_CARS = 0.6
_BOGIE_OVERHANG, _BOGIE_WIDTH, _BOGIE_HEIGHT, _BOGIE_BASE = 0.4, 2.4, 0.35, 0.55


def draw_carbody(name: str, car: CarPlace, rows: Matrix, bogie_gap: float) -> Body:
    """A carbody: a box from one end to the other, with a gap to its neighbours.

    Args:
        name: Its name.
        car: Its place.
        rows: Shape (3, n_dof): its bounce, roll and pitch.
        bogie_gap: Between bogie centres of cars that share no bogie. [m]

    Returns:
        The body.
    """
    overhang = min(_FREE_OVERHANG, (bogie_gap - _GAP_BETWEEN_CARS) / 2)
    hinged = -_GAP_BETWEEN_CARS / 2
    front = car.front_distance + (hinged if car.hinged_in_front else overhang)
    rear = car.rear_distance + (hinged if car.hinged_behind else overhang)
    return Body(
        name=name,
        kind="carbody",
        mass=car.vehicle.carbody_mass,
        offset=car.offset,
        drawn_offset=car.offset + (front - rear) / 2,
        length=front + rear,
        width=_CAR_WIDTH,
        height=_CAR_HEIGHT,
        base_height=_CAR_BASE,
        rows=rows,
    )


def draw_bogie(name: str, bogie: BogiePlace, rows: Matrix) -> Body:
    """A bogie frame: a flat box over its wheelbase.

    Args:
        name: Its name.
        bogie: Its place.
        rows: Shape (3, n_dof): its bounce, roll and pitch.

    Returns:
        The body.
    """
    return Body(
        name=name,
        kind="bogie",
        mass=bogie.vehicle.bogie_mass,
        offset=bogie.offset,
        drawn_offset=bogie.offset,
        length=bogie.vehicle.wheelbase + 2 * _BOGIE_OVERHANG,
        width=_BOGIE_WIDTH,
        height=_BOGIE_HEIGHT,
        base_height=_BOGIE_BASE,
        rows=rows,
    )


def draw_wheelset(
    name: str, bogie: BogiePlace, offset: float, rows: Matrix, *, width: float, radius: float
) -> Body:
    """A wheelset: a box round its two wheels.

    Args:
        name: Its name.
        bogie: The bogie it belongs to.
        offset: x of its axle minus x of the first axle. [m]
        rows: Shape (3, n_dof): its bounce, roll and pitch (none).
        width: Lateral distance between its contact points. [m]
        radius: Of its wheels. [m]

    Returns:
        The body.
    """
    return Body(
        name=name,
        kind="wheelset",
        mass=bogie.vehicle.wheelset_mass,
        offset=offset,
        drawn_offset=offset,
        length=2 * radius,
        width=width,
        height=2 * radius,
        base_height=0.0,
        rows=rows,
    )
