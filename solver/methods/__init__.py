"""The methods of chapter 2 on one problem: direct, iterative, penalty, condensation."""

from __future__ import annotations

from solver.methods.direct import DirectMethod
from solver.methods.integrate import MethodName, integrate, make_method
from solver.methods.problem import FreeDrive, PrescribedSpeed, Problem, Wheels
from solver.methods.run import MethodRun
from solver.methods.settings import Settings, StepState

__all__ = [
    "DirectMethod",
    "FreeDrive",
    "MethodName",
    "MethodRun",
    "PrescribedSpeed",
    "Problem",
    "Settings",
    "StepState",
    "Wheels",
    "integrate",
    "make_method",
]
