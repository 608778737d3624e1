"""One interface to the four methods of chapter 2.

The direct method is the one to use. The others solve the same steps of the same problem, bilateral
contact only, and exist to be compared with it: only the solution of a step differs. The time
integration, the start, and the restart of a rigid contact after a kink are the same code.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal, TypeAlias, get_args

from solver.errors import InputError
from solver.methods.condensation import CondensationContactSolver
from solver.methods.direct import DirectMethod
from solver.methods.iterative import IterativeContactSolver, IterativeOptions
from solver.methods.partitioned import require_bilateral
from solver.methods.penalty import PenaltyContactSolver, PenaltyOptions
from solver.methods.problem import Problem
from solver.methods.run import MethodRun
from solver.methods.settings import Settings, StepState

__all__ = ["MethodName", "integrate", "make_method"]

MethodName: TypeAlias = Literal["direct", "iterative", "penalty", "condensation"]
"""The methods of chapter 2."""


def make_method(
    problem: Problem, settings: Settings, method: MethodName = "direct", **options: Any
) -> MethodRun:
    """Factorises what a method factorises once, and finds the start; ``states`` runs it.

    Args:
        problem: What to solve.
        settings: How.
        method: Which method.
        options: Of ``IterativeOptions`` or ``PenaltyOptions``.

    Raises:
        InputError: An unknown method or option; a problem that only the direct method can solve.
        SingularSystemError: A part can move without resistance.
    """
    if method not in get_args(MethodName):
        raise InputError("method", method, "is unknown", f"Use {', '.join(get_args(MethodName))}.")
    if method != "direct":
        require_bilateral(problem, method)
    if method == "iterative":
        sweeps = IterativeOptions(**_known(method, options, IterativeOptions))
        return MethodRun(problem, settings, lambda a, b, c: IterativeContactSolver(a, b, c, sweeps))
    if method == "penalty":
        springs = PenaltyOptions(**_known(method, options, PenaltyOptions))
        return MethodRun(problem, settings, lambda a, b, c: PenaltyContactSolver(a, b, c, springs))
    _known(method, options, None)
    if method == "condensation":
        return MethodRun(problem, settings, CondensationContactSolver)
    return DirectMethod(problem, settings)


def integrate(
    problem: Problem, settings: Settings, method: MethodName = "direct", **options: Any
) -> Iterator[StepState]:
    """Runs a problem by one of the four methods.

    Args:
        problem: What to solve.
        settings: How.
        method: ``direct``; or, for bilateral contact with a linear law at a prescribed speed,
            ``iterative``, ``penalty`` or ``condensation``.
        options: Of ``IterativeOptions`` (tolerance, relaxation, acceleration, ...) or
            ``PenaltyOptions`` (factor, penalty, solution).

    Returns:
        The start, then the state after every step.

    Raises:
        InputError: An unknown method or option; a problem that only the direct method can solve.
        SingularSystemError: A part can move without resistance.
        ConvergenceError: While iterating: a step did not settle (``DivergenceError`` for the
            iterative method).
    """
    return make_method(problem, settings, method, **options).states()


def _known(method: str, options: dict[str, Any], kind: type[Any] | None) -> dict[str, Any]:
    """The options, if the method has them all."""
    names = [] if kind is None else list(kind.__dataclass_fields__)
    for name, value in options.items():
        if name not in names:
            raise InputError(
                f"{method}.{name}", value, f"is no option of the {method} method",
                f"It has {', '.join(names) or 'none'}.",
            )  # fmt: skip
    return options
