"""Closed-form and semi-analytical solutions of moving loads on beams, for comparison only."""

from __future__ import annotations

from solver.reference.beam import PerfectSurface, SimplySupportedBeam, Surface
from solver.reference.moving_loads import (
    Crossing,
    Response,
    moving_forces,
    moving_masses,
    moving_sprung_masses,
)

__all__ = [
    "Crossing",
    "PerfectSurface",
    "Response",
    "SimplySupportedBeam",
    "Surface",
    "moving_forces",
    "moving_masses",
    "moving_sprung_masses",
]
