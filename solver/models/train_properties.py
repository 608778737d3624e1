"""What an articulated train is made of: inputs only, and the KHST from the package data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Ge, Gt, Le, Len

from solver.data import load
from solver.models.vehicle import VehicleType
from solver.units import Units

__all__ = ["ArticulatedTrain", "DamperHeights", "InterCarDampers", "khst"]

_FORBID_UNKNOWN: dict[str, Any] = {"extra": "forbid", "use_attribute_docstrings": True}


@dataclass(frozen=True, kw_only=True)
class InterCarDampers:
    """The two longitudinal dampers between articulated cars."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _FORBID_UNKNOWN

    upper: Annotated[float, Units.damping, Ge(0), Le(1e8)] = 49.5e3
    """Damping of the upper damper."""
    lower: Annotated[float, Units.damping, Ge(0), Le(1e8)] = 66.0e3
    """Damping of the lower damper."""


@dataclass(frozen=True, kw_only=True)
class DamperHeights:
    """Heights of the inter-car dampers above the hinge. The thesis does not print them: assumed."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _FORBID_UNKNOWN

    upper: Annotated[float, Units.length, Ge(-5), Le(5)] = 2.0
    """Height of the upper damper above the hinge."""
    lower: Annotated[float, Units.length, Ge(-5), Le(5)] = 0.5
    """Height of the lower damper above the hinge."""


@dataclass(frozen=True, kw_only=True)
class ArticulatedTrain:
    """A train whose inner cars share bogies at hinges.

    Cars of the first half run with their leading end (L1) ahead, those of the second half with
    their leading end behind, so that the train is symmetric about its middle.

    References:
        Neves (2016), section 6.2.
    """

    __pydantic_config__: ClassVar[dict[str, Any]] = _FORBID_UNKNOWN

    type: Literal["articulated"] = "articulated"
    """Kind of train."""
    name: Annotated[str, Len(1, 80)]
    """Name shown in results and verdicts."""
    vehicle_types: Annotated[tuple[VehicleType, ...], Len(1, 12)]
    """The types of car that the consist names."""
    consist: Annotated[tuple[Annotated[str, Len(1, 40)], ...], Len(1, 40)]
    """Names of the vehicle types, from the first car to the last."""
    bogie_gap: Annotated[float, Units.length, Gt(0), Le(30)]
    """Distance between neighbouring bogie centres of two cars that share no bogie."""
    wheel_lateral_distance: Annotated[float, Units.length, Gt(0), Le(3)] = 1.435
    """Lateral distance b1 between the contact points of a wheelset."""
    passenger_orientation: Literal["leading_outwards", "leading_inwards"] = "leading_outwards"
    """Which end of the cars articulated at both ends faces away from the train's middle."""
    roll_coupling: Literal["half_each", "rigid"] = "half_each"
    """How two cars share the roll springs of their bogie: half each, or cars rigid in roll."""
    inter_car_dampers: InterCarDampers = InterCarDampers()
    """Longitudinal dampers between articulated cars."""
    damper_heights: DamperHeights = DamperHeights()
    """Heights of these dampers above the hinge (assumed)."""


def khst() -> ArticulatedTrain:
    """The Korean high-speed train: 20 cars, 23 bogies, 46 axles.

    Returns:
        Its properties as printed, with the assumed ones at their defaults.

    References:
        Neves (2016), tables 6.1 to 6.3 and figure 6.1.
    """
    data = load("khst")
    return ArticulatedTrain(
        name=data["name"],
        vehicle_types=tuple(VehicleType(**entry) for entry in data["vehicle_types"]),
        consist=tuple(data["consist"]),
        bogie_gap=data["bogie_gap"],
        wheel_lateral_distance=data["wheel_lateral_distance"],
        passenger_orientation=data["passenger_orientation"],
        roll_coupling=data["roll_coupling"],
        inter_car_dampers=InterCarDampers(**data["inter_car_dampers"]),
        damper_heights=DamperHeights(**data["damper_heights"]),
    )
