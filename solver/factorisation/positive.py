"""Small symmetric positive definite matrices: solution and inverse, with a check that they are."""

from __future__ import annotations

import numpy as np
import scipy.linalg as dense
from scipy.linalg import lapack

from solver.arrays import Matrix, Vector
from solver.errors import SingularSystemError

__all__ = ["positive_inverse", "positive_solve"]


def positive_solve(matrix: Matrix, load: Vector, part: str) -> Vector:
    """Solution of a small symmetric positive definite system.

    Raises:
        SingularSystemError: It is not positive definite.
    """
    if load.size == 0:
        return load
    factor, info = lapack.dpotrf(matrix)
    if info or _reciprocal_condition(factor, matrix) < np.finfo(float).eps:
        raise SingularSystemError(part, "its equations depend on each other")
    solution = lapack.dpotrs(factor, load)[0]
    if not np.isfinite(solution).all():
        raise SingularSystemError(part, "its compliance is not a number")
    return solution


def _reciprocal_condition(factor: Matrix, matrix: Matrix) -> float:
    """Estimate of 1 / condition from a Cholesky factor; not a number counts as none."""
    reciprocal = float(lapack.dpocon(factor, np.abs(matrix).sum(axis=0).max())[0])
    return reciprocal if np.isfinite(reciprocal) else 0.0


def positive_inverse(matrix: Matrix, part: str) -> Matrix:
    """Inverse of a symmetric positive definite matrix, exactly symmetric.

    Raises:
        SingularSystemError: It is not, or only by rounding.
    """
    if matrix.size == 0:
        return matrix
    scale = 1.0 / np.sqrt(np.maximum(matrix.diagonal(), np.finfo(float).tiny))
    scaled = matrix * np.outer(scale, scale)
    factor, info = lapack.dpotrf(scaled)
    if info or _reciprocal_condition(factor, scaled) < np.finfo(float).eps:
        raise SingularSystemError(part, "something moves without resistance")
    inverse = dense.cho_solve((factor, False), np.diag(scale)) * scale[:, None]
    return 0.5 * (inverse + inverse.T)
