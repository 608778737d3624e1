"""Masses on springs that roll on one rail: the vehicles of the closed-form comparisons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Ge, Gt, Le, Len

from solver.models.train_assembly import RigidBodyAssembly
from solver.models.train_model import LEFT, WHEEL_RADIUS, Body, TrainModel
from solver.units import Units

__all__ = ["SprungMasses", "sprung_mass_train"]


@dataclass(frozen=True, kw_only=True)
class SprungMasses:
    """Equal masses, each on a spring and dashpot over a massless contact point.

    The defaults are the sprung mass of Yang and Yau.

    References:
        Neves (2016), sections 4.4.1 and 5.3.1.
    """

    __pydantic_config__: ClassVar[dict[str, Any]] = {
        "extra": "forbid",
        "use_attribute_docstrings": True,
    }

    type: Literal["sprung_masses"] = "sprung_masses"
    """Kind of train."""
    name: Annotated[str, Len(1, 80)] = "sprung mass"
    """Name shown in results and verdicts."""
    mass: Annotated[float, Units.mass, Gt(0), Le(1e6)] = 5750.0
    """Suspended mass."""
    stiffness: Annotated[float, Units.stiffness, Gt(0), Le(1e12)] = 1.595e6
    """Stiffness of the spring."""
    damping: Annotated[float, Units.damping, Ge(0), Le(1e9)] = 0.0
    """Damping of the dashpot beside the spring."""
    count: Annotated[int, Ge(1), Le(100)] = 1
    """Number of masses."""
    spacing: Annotated[float, Units.length, Gt(0), Le(1000)] = 20.0
    """Distance between neighbouring masses."""


# The box that stands for a mass in the viewer; no computation reads it.
_BOX = {"length": 2.0, "width": 2.0, "height": 1.2, "base_height": 1.0}


def sprung_mass_train(properties: SprungMasses) -> TrainModel:
    """Assembles the masses: two degrees of freedom each, mass and contact point.

    Args:
        properties: The masses' properties.

    Returns:
        The train; every wheel is on rail 0, at y = 0.
    """
    count = properties.count
    rows = np.eye(2 * count)
    assembly = RigidBodyAssembly(2 * count)
    offsets = -properties.spacing * np.arange(count, dtype=np.float64)
    bodies: list[Body] = []
    for i in range(count):
        centre = np.zeros((3, 2 * count))
        centre[0] = rows[2 * i]
        assembly.add_body(centre, properties.mass)
        elongation = rows[2 * i] - rows[2 * i + 1]
        assembly.add_spring(elongation, properties.stiffness, properties.damping)
        bodies.append(
            Body(
                name=f"mass {i + 1:02d}",
                kind="carbody",
                mass=properties.mass,
                offset=float(offsets[i]),
                drawn_offset=float(offsets[i]),
                rows=centre,
                **_BOX,
            )
        )
    return TrainModel(
        name=properties.name,
        mass=assembly.mass,
        damping=assembly.damping,
        stiffness=assembly.stiffness,
        weight=assembly.weight,
        wheel_rows=rows[1::2].copy(),
        wheel_offsets=offsets,
        wheel_rail=np.full(count, LEFT, dtype=np.int64),
        wheel_lateral=np.zeros(count),
        wheel_names=tuple(f"wheel {i + 1:02d}" for i in range(count)),
        wheel_radius=WHEEL_RADIUS,
        axle_offsets=offsets.copy(),
        bodies=tuple(bodies),
        dof_names=tuple(
            f"{part} {i + 1:02d} bounce" for i in range(count) for part in ("mass", "contact point")
        ),
    )
