"""Verification cases: what the solver finds against closed forms, semi-analytical solutions, prints
of the thesis, and other formulations.

Add a case by writing one file with a ``Case`` and naming it in ``registry``.
"""

from __future__ import annotations

from solver.verification.case import Case, Comparison, Figure, Progress, Result, Series
from solver.verification.registry import case, cases

__all__ = ["Case", "Comparison", "Figure", "Progress", "Result", "Series", "case", "cases"]
