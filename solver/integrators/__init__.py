"""Time integration: HHT-alpha, of which Newmark's method is alpha = 0."""

from solver.integrators.hht import HHT, CoupledSystem, HHTIntegrator, Motion

__all__ = ["HHT", "CoupledSystem", "HHTIntegrator", "Motion"]
