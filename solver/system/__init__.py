"""Train, rails and structure, coupled through rail pads and wheel-rail contact."""

from solver.system.coupled import CoupledState, EffectiveSystem, System
from solver.system.parts import Coefficients

__all__ = ["Coefficients", "CoupledState", "EffectiveSystem", "System"]
