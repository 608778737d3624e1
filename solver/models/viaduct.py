"""A viaduct of simply supported spans with a single-cell box deck; the defaults are Alverca's.

Sources: Neves (2016), table 7.1, figures 7.5 to 7.9, sections 6.3.5 and 7.2. Two things are not
printed and are therefore parameters with a reading: the mid-lines of figure 7.5 and the places of
the bearings.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Ge, Le, Len

from solver.arrays import Vector
from solver.errors import InputError
from solver.units import Units

__all__ = ["SpanLength", "ViaductProperties"]

SpanLength = Annotated[float, Units.length, Ge(6.0), Le(60.0)]
"""Length of one span. [m]"""


@dataclass(frozen=True, kw_only=True)
class ViaductProperties:
    """Geometry, materials, bearings and damping of the viaduct."""

    __pydantic_config__: ClassVar[dict[str, Any]] = {
        "extra": "forbid",
        "use_attribute_docstrings": True,
    }

    type: Literal["u_girder"] = "u_girder"
    """Kind of viaduct."""

    spans: Annotated[tuple[SpanLength, ...], Len(1, 20)] = (16.5, 21.0, 21.0)
    """Lengths of the spans in the train's way; the first starts at x = 0."""
    slab_width: Annotated[float, Units.length, Ge(3.0), Le(20.0)] = 7.20
    """Width of the upper slab."""
    slab_thickness: Annotated[float, Units.length, Ge(0.05), Le(2.0)] = 0.27
    """Thickness of the upper slab."""
    slab_level: Annotated[float, Units.length, Ge(0.3), Le(10.0)] = 1.335
    """Height of the upper slab's mid-plane above the underside of the beam."""
    web_position: Annotated[float, Units.length, Ge(0.3), Le(9.0)] = 1.55
    """Distance of a web's mid-plane from the axis."""
    web_thickness: Annotated[float, Units.length, Ge(0.05), Le(2.0)] = 0.20
    """Thickness of a web of the precast beam."""
    bottom_thickness: Annotated[float, Units.length, Ge(0.05), Le(2.0)] = 0.18
    """Thickness of the bottom plate of the precast beam."""
    wall_position: Annotated[float, Units.length, Ge(0.5), Le(9.9)] = 2.15
    """Distance of a ballast retaining wall's mid-plane from the axis."""
    wall_thickness: Annotated[float, Units.length, Ge(0.05), Le(1.0)] = 0.25
    """Thickness of a ballast retaining wall."""
    wall_height: Annotated[float, Units.length, Ge(0.1), Le(3.0)] = 0.70
    """Height of a ballast retaining wall above the upper slab's mid-plane."""
    slab_modulus: Annotated[float, Units.young_modulus, Ge(1e9), Le(1e11)] = 35.4e9
    """Modulus of elasticity of the concrete of the upper slab and the walls."""
    beam_modulus: Annotated[float, Units.young_modulus, Ge(1e9), Le(1e11)] = 40.9e9
    """Modulus of elasticity of the concrete of the precast beam."""
    poisson_ratio: Annotated[float, Units.none, Ge(0.0), Le(0.45)] = 0.2
    """Poisson's ratio of the concrete."""
    density: Annotated[float, Units.density, Ge(500.0), Le(5000.0)] = 2469.8
    """Density of the concrete."""
    edge_mass: Annotated[float, Units.mass_per_length, Ge(0.0), Le(5000.0)] = 200.0
    """Mass of edge beam and safeguard along each edge of the slab; an assumption, not printed."""
    bearing_inset: Annotated[float, Units.length, Ge(0.0), Le(2.0)] = 0.6
    """Distance of a bearing from the end of its span."""
    bearing_position: Annotated[float, Units.length, Ge(0.1), Le(9.0)] = 1.55
    """Distance of a bearing from the axis."""
    bearing_stiffness: Annotated[float, Units.stiffness, Ge(1e6), Le(1e12)] = 5.2e9
    """Vertical stiffness of one bearing."""
    guided_stiffness: Annotated[float, Units.stiffness, Ge(0.0), Le(1e10)] = 3.6e6
    """Longitudinal stiffness of one guided bearing, at the far end of each span."""
    mass_damping: Annotated[float, Units.mass_damping, Ge(0.0), Le(100.0)] = 2.48
    """Rayleigh damping proportional to mass."""
    stiffness_damping: Annotated[float, Units.stiffness_damping, Ge(0.0), Le(0.1)] = 1.58e-4
    """Rayleigh damping proportional to stiffness."""
    damping: Literal["deck", "material"] = "deck"
    """Whose damping the ballast on a span has: the deck's that carries it, or the track's."""

    def __post_init__(self) -> None:
        _check(self)

    @property
    def length(self) -> float:
        """Length of all spans. [m]"""
        return sum(self.spans)

    @property
    def slab_top(self) -> float:
        """Height of the upper slab's top. [m]"""
        return self.slab_level + 0.5 * self.slab_thickness

    @property
    def joints(self) -> Vector:
        """Ends of the spans along the track, shape (n_span + 1,). [m]"""
        return np.concatenate([[0.0], np.cumsum(self.spans)])


def _check(viaduct: ViaductProperties) -> None:
    """Relations between fields that make a section and its bearings possible."""
    order = (
        ("web_position", viaduct.web_position, viaduct.wall_position - 0.1, "walls"),
        ("wall_position", viaduct.wall_position, 0.5 * viaduct.slab_width - 0.1, "slab's edges"),
        ("bearing_position", viaduct.bearing_position, viaduct.web_position, "webs"),
    )
    for field, value, greatest, neighbour in order:
        if value > greatest + 1e-9:
            raise InputError(
                f"viaduct.{field}",
                value,
                f"must be at most {greatest:.3g} m to lie inside the {neighbour}",
                "Move one of the two.",
            )
    if viaduct.slab_level < 0.5 * viaduct.bottom_thickness + 0.2:
        raise InputError(
            "viaduct.slab_level",
            viaduct.slab_level,
            "leaves no height for the webs",
            "Raise the slab or make the bottom plate thinner.",
        )
