"""Choice of the sparse back end, and the contract that both keep.

*Factorisation*: the matrix is factorised once; ``solve`` may then be called any number of times.

*Condensed factorisation* (appendix A of Neves, 2016, with the interface as second block): the
unknowns are split into interior I and interface B,

    [K_II K_IB] [u_I]   [f_I]
    [K_BI K_BB] [u_B] = [f_B + P]

``condense`` eliminates I once: ``complement`` is K_BB - K_BI K_II^-1 K_IB. Each step then takes
one *forward* pass over the large factor (``forward``: the load that the interface feels), a small
problem on the interface that the caller solves, and one *backward* pass (``backward``: the
interior that belongs to the interface found). Together they are one large solve.
"""

from __future__ import annotations

from functools import cache
from typing import Any, Protocol

import numpy as np

from solver.arrays import FloatArray, IntVector, Matrix, SparseMatrix, Vector

__all__ = ["CondensedFactorisation", "Factorisation", "back_end_name", "condense", "factorise"]


class Factorisation(Protocol):
    """A factorised symmetric positive definite matrix."""

    def solve(self, load: FloatArray) -> FloatArray:
        """Solution for one load (n_dof,) or several (n_dof, n_load)."""
        ...


class CondensedFactorisation(Protocol):
    """A matrix factorised with an interface that is kept for a small problem."""

    complement: Matrix
    """Schur complement of the interface, shape (n_interface, n_interface)."""
    memory_bytes: int
    """Memory held by the factor. [B]"""

    def forward(self, load: Vector) -> Vector:
        """Load condensed on the interface, shape (n_interface,); keeps the interior part."""
        ...

    def backward(self, interface: Vector) -> Vector:
        """All unknowns, shape (n_dof,), once the interface's are known; follows ``forward``."""
        ...


@cache
def _pardiso() -> Any | None:
    """The MKL PARDISO back end, or None where MKL is not installed.

    Asked once: a failed import is not remembered by Python, and ``check`` asks for every run.
    """
    try:
        from solver.factorisation import pardiso
    except (ImportError, OSError):
        return None
    return pardiso


def back_end_name() -> str:
    """Name of the back end in use: ``MKL PARDISO`` or ``SuperLU``."""
    return "SuperLU" if _pardiso() is None else "MKL PARDISO"


def factorise(matrix: SparseMatrix, part: str) -> Factorisation:
    """Factorises a symmetric positive definite matrix.

    Args:
        matrix: Shape (n_dof, n_dof).
        part: Name of the part, for the error message.

    Raises:
        SingularSystemError: The part can move without resistance.
    """
    pardiso = _pardiso()
    if pardiso is not None:
        return pardiso.PardisoFactorisation(matrix, part)
    from solver.factorisation.superlu import SuperLUFactorisation

    return SuperLUFactorisation(matrix, part)


def condense(matrix: SparseMatrix, interface: IntVector, part: str) -> CondensedFactorisation:
    """Factorises a symmetric positive definite matrix and condenses it on an interface.

    Args:
        matrix: Shape (n_dof, n_dof).
        interface: Distinct indices of the interface's unknowns, in the order wanted.
        part: Name of the part, for the error message.

    Raises:
        SingularSystemError: The part can move without resistance.
    """
    interface = np.asarray(interface, dtype=np.int64)
    pardiso = _pardiso()
    if pardiso is not None:
        return pardiso.PardisoCondensation(matrix, interface, part)
    from solver.factorisation.superlu import SuperLUCondensation

    return SuperLUCondensation(matrix, interface, part)
