"""Simply supported beams between rigid approaches: the bridges of the closed-form comparisons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Ge, Gt, Le, Len

from solver.arrays import Vector
from solver.errors import InputError
from solver.models.beam_line import BeamLine
from solver.units import Units

__all__ = ["BeamBridge", "BeamSpan", "beam_bridge_line"]

BeamSpan = Annotated[float, Units.length, Ge(1.0), Le(200.0)]
"""Length of one span. [m]"""


@dataclass(frozen=True, kw_only=True)
class BeamBridge:
    """Simply supported Euler-Bernoulli beams, with rigid ground before and after them.

    The defaults are the beam of Yang and Yau.

    References:
        Neves (2016), sections 4.4.1 and 5.3.1.
    """

    __pydantic_config__: ClassVar[dict[str, Any]] = {
        "extra": "forbid",
        "use_attribute_docstrings": True,
    }

    type: Literal["beam"] = "beam"
    """Kind of viaduct."""
    spans: Annotated[tuple[BeamSpan, ...], Len(1, 20)] = (25.0,)
    """Lengths of the spans in the train's way; the first starts at x = 0."""
    young_modulus: Annotated[float, Units.young_modulus, Ge(1e6), Le(1e13)] = 2.87e9
    """Modulus of elasticity."""
    second_moment: Annotated[float, Units.second_moment, Ge(1e-9), Le(1e4)] = 2.90
    """Second moment of area about the horizontal axis."""
    mass_per_length: Annotated[float, Units.mass_per_length, Ge(1e-3), Le(1e6)] = 2303.0
    """Mass of one metre of beam."""
    elements_per_span: Annotated[int, Ge(2), Le(2000)] = 50
    """Number of beam elements a span; an even number puts a node at mid-span."""
    mass_damping: Annotated[float, Units.mass_damping, Ge(0.0), Le(1000.0)] = 0.0
    """Rayleigh damping proportional to mass."""
    stiffness_damping: Annotated[float, Units.stiffness_damping, Ge(0.0), Le(0.1)] = 0.0
    """Rayleigh damping proportional to stiffness."""
    width: Annotated[float, Units.length, Gt(0.0), Le(50.0)] = 4.0
    """Width, for drawing only."""

    @property
    def length(self) -> float:
        """Length of all spans. [m]"""
        return sum(self.spans)

    @property
    def joints(self) -> Vector:
        """Ends of the spans, shape (n_span + 1,). [m]"""
        return np.concatenate([[0.0], np.cumsum(self.spans)])

    @property
    def element_length(self) -> float:
        """Length of the shortest beam element. [m]"""
        return min(self.spans) / self.elements_per_span


def beam_bridge_line(bridge: BeamBridge, start: float, end: float) -> BeamLine:
    """The spans with rigid ground from ``start`` to 0 and from their end to ``end``.

    Args:
        bridge: The beams.
        start: x where the ground before them begins, negative. [m]
        end: x where the ground after them ends, beyond the last span. [m]

    Returns:
        One line; its spans are separate beams, each on its own two supports.

    Raises:
        InputError: There is no ground before or after the spans.
    """
    if not start < 0.0 or not end > bridge.length:
        raise InputError(
            "path", (start, end), f"leaves no ground outside 0 to {bridge.length:g} m",
            "Begin before the first span and end beyond the last.",
        )  # fmt: skip
    pieces = [np.array([start, 0.0])]
    for left, right in zip(bridge.joints[:-1], bridge.joints[1:], strict=True):
        pieces.append(np.linspace(left, right, bridge.elements_per_span + 1))
    pieces.append(np.array([bridge.length, end]))
    positions = np.concatenate(pieces)
    free = np.ones((positions.size, 2), dtype=bool)
    free[:2] = False
    free[-2:] = False
    node = 2
    for _ in bridge.spans:
        free[node, 0] = False
        node += bridge.elements_per_span + 1
        free[node - 1, 0] = False
    n_element = positions.size - 1
    return BeamLine.build(
        positions=positions,
        rigidity=np.full(n_element, bridge.young_modulus * bridge.second_moment),
        mass_per_length=np.full(n_element, bridge.mass_per_length),
        free=free,
        n_line=1,
        mass_proportional=bridge.mass_damping,
        stiffness_proportional=bridge.stiffness_damping,
    )
