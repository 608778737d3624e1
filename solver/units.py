"""Units: SI inside, a display unit at the edge.

A ``Unit`` sits in the ``Annotated`` metadata of every input and on every channel. It says the SI
symbol in which the value is stored, the symbol people read, and the factor between them:
``display = value * scale``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

__all__ = ["Unit", "Units"]


@dataclass(frozen=True)
class Unit:
    """A physical unit and the one shown in its place.

    Attributes:
        symbol: SI symbol, as stored.
        display: Symbol shown to people.
        scale: Display value over stored value.
    """

    symbol: str
    display: str = ""
    scale: float = 1.0

    @property
    def shown(self) -> str:
        """The symbol shown to people."""
        return self.display or self.symbol

    def __get_pydantic_json_schema__(self, core_schema: Any, handler: Any) -> Any:
        """Adds the unit to a JSON schema (duck-typed: the solver imports no pydantic)."""
        schema = handler(core_schema)
        schema["unit"] = {"symbol": self.symbol, "display": self.shown, "scale": self.scale}
        return schema


class Units:
    """The units in use, by what they measure."""

    none = Unit("1", "", 1.0)
    length = Unit("m")
    small_length = Unit("m", "mm", 1e3)
    time = Unit("s")
    time_step = Unit("s", "ms", 1e3)
    speed = Unit("m/s", "km/h", 3.6)
    velocity = Unit("m/s")
    acceleration = Unit("m/s2")
    frequency = Unit("Hz")
    mass = Unit("kg", "t", 1e-3)
    small_mass = Unit("kg")
    mass_per_length = Unit("kg/m")
    density = Unit("kg/m3")
    rotary_inertia = Unit("kg m2")
    force = Unit("N", "kN", 1e-3)
    stiffness = Unit("N/m", "MN/m", 1e-6)
    damping = Unit("N s/m", "kN s/m", 1e-3)
    young_modulus = Unit("Pa", "GPa", 1e-9)
    area = Unit("m2")
    second_moment = Unit("m4")
    wave_number = Unit("1/m")
    mass_damping = Unit("1/s")
    stiffness_damping = Unit("s")
    angle = Unit("rad")
