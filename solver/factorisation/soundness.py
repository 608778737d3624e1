"""Whether a matrix can be factorised, and whether its factor can be trusted.

A structure that moves without resistance need not stop a factorisation: rounding turns its zero
pivots into tiny ones, and every later answer is noise that looks like a result.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from solver.arrays import Matrix, SparseMatrix, Vector
from solver.errors import SingularSystemError

__all__ = ["require_accuracy", "require_positive_diagonal", "solve_complement"]

_WORST_ERROR = 1e-3
"""Relative error of a known displacement; sound structures stay below 1e-6."""


def require_positive_diagonal(matrix: SparseMatrix, part: str) -> None:
    """Refuses a matrix with an unknown that nothing resists.

    PARDISO would read beyond its arrays where a diagonal entry is missing.

    Raises:
        SingularSystemError: A diagonal entry is missing, not positive or not a number.
    """
    sound = matrix.diagonal() > 0.0
    if not sound.all():
        raise SingularSystemError(part, f"nothing resists unknown {int(np.argmin(sound))}")


def require_accuracy(matrix: SparseMatrix, solve: Callable[[Vector], Vector], part: str) -> None:
    """Refuses a factor that does not give back a known displacement.

    Args:
        matrix: The factorised matrix.
        solve: Solution by its factor for one load.
        part: Name of the part, for the error message.

    Raises:
        SingularSystemError: The displacement found is another one, or the matrix is not positive.
    """
    known = np.random.default_rng(0).uniform(-1.0, 1.0, matrix.shape[0])
    load = matrix @ known
    found = solve(load)
    error = float(np.linalg.norm(found - known) / np.linalg.norm(known))
    if not error <= _WORST_ERROR or not known @ load > 0.0:
        raise SingularSystemError(part, "something moves without resistance")


def solve_complement(complement: Matrix, load: Vector, part: str) -> Vector:
    """Displacement of an interface from its Schur complement.

    Raises:
        SingularSystemError: The interface can move without resistance.
    """
    try:
        return np.linalg.solve(complement, load)
    except np.linalg.LinAlgError as error:
        raise SingularSystemError(part, "something moves without resistance") from error
