"""The ten universal trains HSLM-A of EN 1991-2 as tables of axles."""

from __future__ import annotations

from typing import Any

from solver.data import load
from solver.models.axle_table import Axle, AxleTable

__all__ = ["hslm_a", "hslm_a_names"]


def hslm_a_names() -> tuple[str, ...]:
    """``A1`` to ``A10``."""
    return tuple(row["name"] for row in load("hslm_a")["trains"])


def hslm_a(name: str) -> AxleTable:
    """One of the ten trains.

    The standard's point forces are constant. The table's suspension is so soft (0.1 Hz, undamped)
    that the contact forces are constant to one part in ten thousand while the rail moves by some
    millimetres.

    Args:
        name: One of ``hslm_a_names``.

    Returns:
        Power car, end coach, N intermediate coaches, end coach, power car.

    References:
        EN 1991-2:2003 6.4.6.1.1, table 6.3 and figure 6.12.
    """
    data = load("hslm_a")
    row = next(row for row in data["trains"] if row["name"] == name)
    return AxleTable(
        name=f"HSLM-{name}",
        axles=tuple(Axle(position=x, load=row["point_force"]) for x in _positions(data, row)),
        bounce_frequency=data["bounce_frequency"],
        damping_ratio=0.0,
    )


def _positions(data: dict[str, Any], row: dict[str, Any]) -> list[float]:
    """Distances of the axles behind the first one. [m]

    A coach of length D begins in the middle of the gap between power car and coach; its far end,
    and both ends of an intermediate coach, are the middles of shared bogies.
    """
    car: list[float] = data["power_car_axles"]
    gap, length, half = data["gap"], row["coach_length"], row["bogie_spacing"] / 2
    first = car[-1] + gap + half
    second = car[-1] + gap / 2 + length
    bogies = [first, *(second + i * length for i in range(row["intermediate_coaches"] + 1))]
    bogies.append(bogies[-1] + second - first)
    coaches = [bogie + side for bogie in bogies for side in (-half, half)]
    rear = [coaches[-1] + gap + axle for axle in car]
    # Tenths of a millimetre, as the standard's own sums come out.
    return [round(axle, 4) for axle in (*car, *coaches, *rear)]
