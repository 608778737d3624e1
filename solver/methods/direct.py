"""The direct method: displacements and contact forces solved together (chapters 4 and 5).

A linear problem (rigid or linear Hertz contact) takes the 2 x 2 solver of appendix A, one with
Hertz's law or other nonlinear elements the 3 x 3 solver of appendix B. Either factorises its large
block once for each step length in use.
"""

from __future__ import annotations

from solver.contact.laws import NonlinearHertz
from solver.factorisation.blocks import FirstBlock
from solver.integrators.hht import HHT
from solver.methods.border import Borders
from solver.methods.linear_contact import LinearContactSolver
from solver.methods.nonlinear_contact import NonlinearContactSolver
from solver.methods.problem import Problem
from solver.methods.run import MethodRun
from solver.methods.settings import Settings
from solver.methods.stacked import Stacked

__all__ = ["DirectMethod"]


class DirectMethod(MethodRun):
    """Integrates a problem by the direct method.

    Attributes:
        first_block: The large block of undivided steps, for measurements of cost.

    Args:
        problem: What to solve.
        settings: How.

    Raises:
        InputError: The path ends before the run does, or a wheel steps over a whole element.
        SingularSystemError: A part can move without resistance.
    """

    first_block: FirstBlock

    def __init__(self, problem: Problem, settings: Settings) -> None:
        super().__init__(problem, settings, self._make_direct)

    def _make_direct(
        self, stacked: Stacked, borders: Borders, method: HHT
    ) -> LinearContactSolver | NonlinearContactSolver:
        nonlinear = bool(stacked.nonlinear) or isinstance(self.problem.law, NonlinearHertz)
        kind = NonlinearContactSolver if nonlinear else LinearContactSolver
        solver = kind(stacked, borders, self.settings, method)
        if method.time_step == self.settings.time_step:
            self.first_block = solver.blocks
        return solver
