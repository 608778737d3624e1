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

import platform
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, Protocol, TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from solver.arrays import Arrays, FloatArray, IntVector, Matrix, SparseMatrix, Vector

__all__ = [
    "Condense",
    "CondensedFactorisation",
    "Factorisation",
    "arithmetic",
    "back_end_name",
    "condense",
    "factorise",
    "restored",
]


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

    def stored(self) -> Arrays | None:
        """The factorisation for ``restored`` in another process, None where it cannot be had."""
        ...


Condense: TypeAlias = Callable[[SparseMatrix, IntVector, str], CondensedFactorisation]
"""``condense``, or what stands in for it: something that remembers factors."""


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


@cache
def arithmetic() -> str:
    """All that the last bits of a result depend on: processor, libraries, their versions."""
    pardiso = _pardiso()
    configuration: Any = np.show_config(mode="dicts")
    instructions = configuration.get("SIMD Extensions", {}).get("found", [])
    return "; ".join(
        [
            f"{platform.system()} {platform.machine()} {' '.join(instructions)}",
            f"numpy {np.__version__}, scipy {scipy.__version__}",
            back_end_name() if pardiso is None else pardiso.library_kind(),
        ]
    )


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


def restored(
    matrix: SparseMatrix, interface: IntVector, part: str, arrays: Mapping[str, NDArray[Any]]
) -> CondensedFactorisation | None:
    """What ``condense`` gives, from its ``stored`` arrays made on a machine of one ``arithmetic``.

    Returns:
        The factorisation, equal to the last bit, or None where the back end does not take it.
    """
    pardiso = _pardiso()
    if pardiso is None:
        return None
    interface = np.asarray(interface, dtype=np.int64)
    return pardiso.PardisoCondensation.restored(matrix, interface, part, arrays)
