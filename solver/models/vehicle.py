"""What one type of rail vehicle is made of: inputs only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Ge, Gt, Le, Len

from solver.units import Units

__all__ = ["VehicleType"]


@dataclass(frozen=True, kw_only=True)
class VehicleType:
    """Properties of one type of car, of its bogies and wheelsets.

    The leading end is the one that faces away from the middle of the train. A bogie carries a car
    end on two secondary suspensions (one a side) and rests on two wheelsets through four primary
    suspensions (one a wheel).

    References:
        Neves (2016), figure 6.2 and tables 6.1 to 6.3.
    """

    __pydantic_config__: ClassVar[dict[str, Any]] = {
        "extra": "forbid",
        "use_attribute_docstrings": True,
    }

    name: Annotated[str, Len(1, 40)]
    """Name by which the consist refers to this type."""
    articulation: Literal["none", "trailing_end", "both_ends"]
    """Ends that share a bogie with the neighbouring car."""
    carbody_mass: Annotated[float, Units.mass, Gt(0), Le(2e5)]
    """Mass of the carbody."""
    carbody_roll_inertia: Annotated[float, Units.rotary_inertia, Gt(0), Le(1e7)]
    """Rotary inertia of the carbody about the longitudinal axis."""
    carbody_pitch_inertia: Annotated[float, Units.rotary_inertia, Gt(0), Le(1e8)]
    """Rotary inertia of the carbody about the lateral axis."""
    bogie_mass: Annotated[float, Units.mass, Gt(0), Le(5e4)]
    """Mass of one bogie frame."""
    bogie_roll_inertia: Annotated[float, Units.rotary_inertia, Gt(0), Le(1e6)]
    """Rotary inertia of a bogie frame about the longitudinal axis."""
    bogie_pitch_inertia: Annotated[float, Units.rotary_inertia, Gt(0), Le(1e6)]
    """Rotary inertia of a bogie frame about the lateral axis."""
    wheelset_mass: Annotated[float, Units.mass, Gt(0), Le(2e4)]
    """Mass of one wheelset."""
    wheelset_roll_inertia: Annotated[float, Units.rotary_inertia, Gt(0), Le(1e5)]
    """Rotary inertia of a wheelset about the longitudinal axis."""
    primary_stiffness: Annotated[float, Units.stiffness, Gt(0), Le(1e10)]
    """Vertical stiffness of the primary suspension, per wheel."""
    primary_damping: Annotated[float, Units.damping, Ge(0), Le(1e8)]
    """Vertical damping of the primary suspension, per wheel."""
    secondary_stiffness: Annotated[float, Units.stiffness, Gt(0), Le(1e10)]
    """Vertical stiffness of the secondary suspension, per side of a bogie."""
    secondary_damping: Annotated[float, Units.damping, Ge(0), Le(1e8)]
    """Vertical damping of the secondary suspension, per side of a bogie."""
    leading_distance: Annotated[float, Units.length, Gt(0), Le(30)]
    """Distance L1 from the leading bogie's centre to the carbody's centre of mass."""
    trailing_distance: Annotated[float, Units.length, Gt(0), Le(30)]
    """Distance L2 from the carbody's centre of mass to the trailing bogie's centre."""
    wheelbase: Annotated[float, Units.length, Gt(0), Le(10)]
    """Distance between the two axles of a bogie."""
    primary_spacing: Annotated[float, Units.length, Gt(0), Le(5)]
    """Lateral distance b2 between the primary suspensions of a wheelset."""
    secondary_spacing: Annotated[float, Units.length, Gt(0), Le(5)]
    """Lateral distance b3 between the secondary suspensions of a bogie."""
