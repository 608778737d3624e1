"""MKL PARDISO through a thin ctypes layer.

``pypardiso`` finds the library; its own ``solve`` checks and hashes the matrix at every call,
which costs as much as the solve itself, and does not offer the partial phases. Phases used
(Intel oneMKL, "Phases of PARDISO"): 12 analysis and factorisation, 33 solve, 331 forward and
333 backward substitution, which stop at and start from the Schur complement (iparm(36) = 2),
-1 release. ``pardiso_handle_store`` and ``_restore`` keep a factor between processes; they know
files only, so it passes through a private temporary folder.
"""

from __future__ import annotations

import ctypes
import shutil
import weakref
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from solver.arrays import Arrays, FloatArray, IntVector, Matrix, SparseMatrix, Vector
from solver.errors import SingularSystemError, SolverError
from solver.factorisation.mkl import load_mkl
from solver.factorisation.soundness import (
    require_accuracy,
    require_positive_diagonal,
    solve_complement,
)

__all__ = ["PardisoCondensation", "PardisoFactorisation", "library_kind"]

_POSITIVE_DEFINITE = 2
_OUT_OF_MEMORY, _ZERO_PIVOT, _SINGULAR_DIAGONAL, _INTEGER_OVERFLOW = -2, -4, -7, -8


# With the module: where there is no MKL it cannot be imported, and what a process has loaded its
# children find loaded.
_LIBRARY = load_mkl()
_LIBRARY.pardiso.restype = None


def library_kind() -> str:
    """Version of MKL and the instructions that it takes: by these the last bits may differ."""
    library, text = _LIBRARY, ctypes.create_string_buffer(200)
    library.MKL_Get_Version_String(text, ctypes.c_int(len(text)))
    branch = (library.MKL_CBWR_Get_Auto_Branch(), library.MKL_CBWR_Get(ctypes.c_int(1)))
    return f"{text.value.decode('ascii', 'replace').strip()}, branch {branch}"


def _loads(load: FloatArray, n_dof: int) -> FloatArray:
    """Loads as PARDISO reads them; a wrong length would let it read beyond the array."""
    if load.shape[0] != n_dof:
        raise ValueError(f"a load of {load.shape[0]} entries for {n_dof} unknowns")
    return np.asfortranarray(load, dtype=np.float64)


def _address(array: FloatArray | IntVector) -> ctypes.c_void_p:
    return array.ctypes.data_as(ctypes.c_void_p)


class _Handle:
    """One PARDISO instance: the upper triangle, the settings, the call."""

    def __init__(self, matrix: SparseMatrix, interface: IntVector | None, part: str) -> None:
        require_positive_diagonal(matrix, part)
        upper = sparse.triu(matrix, format="csr")
        upper.sort_indices()
        self.n_dof = int(upper.shape[0])
        self._part = part
        self._values = np.ascontiguousarray(upper.data, dtype=np.float64)
        self._rows = (upper.indptr + 1).astype(np.int32)
        self._columns = (upper.indices + 1).astype(np.int32)
        self._memory = np.zeros(64, dtype=np.int64)
        self.settings = np.zeros(64, dtype=np.int32)
        self.settings[0] = 1  # our settings, not the defaults
        self.settings[1] = 2  # nested dissection
        self.settings[17] = -1  # report the entries of the factor
        self._selection = np.zeros(self.n_dof, dtype=np.int32)
        if interface is not None:
            self.settings[35] = 2  # Schur complement with partial substitutions
            self._selection[interface] = 1
        self._library = _LIBRARY
        self._nothing = np.zeros(1)
        weakref.finalize(self, _release, self._library, self._memory, self.settings, self.n_dof)

    def call(self, phase: int, load: FloatArray, solution: FloatArray, n_load: int = 1) -> None:
        """One PARDISO call; arrays must be contiguous, several loads one after the other."""
        error = _pardiso_call(
            self._library, self._memory, self.settings, phase, self.n_dof,
            (self._values, self._rows, self._columns, self._selection), n_load, load, solution,
        )  # fmt: skip
        if error in (_ZERO_PIVOT, _SINGULAR_DIAGONAL):
            raise SingularSystemError(self._part, "its stiffness is not positive definite")
        if error in (_OUT_OF_MEMORY, _INTEGER_OVERFLOW):
            raise MemoryError(f"not enough memory to factorise {self._part}")
        if error:
            raise SolverError(
                f"MKL PARDISO could not treat {self._part} (phase {phase}, code {error}). Check "
                "its matrices for values that are not numbers, or use SuperLU (without pypardiso)."
            )

    def stored(self) -> NDArray[np.uint8] | None:
        """The factor as bytes, or None where the temporary folder has no room for it."""
        with TemporaryDirectory(prefix="trainbridge-") as folder:
            # MKL does not say when a disk fills up while it writes.
            if shutil.disk_usage(folder).free < 2 * self.memory_bytes:
                return None
            if _handle_file(self._library.pardiso_handle_store, self._memory, folder):
                return None
            return np.fromfile(Path(folder, _HANDLE_FILE), dtype=np.uint8)

    def restore(self, factor: NDArray[np.uint8]) -> bool:
        """Takes a factor that ``stored`` gave; False where it cannot be had."""
        try:
            with TemporaryDirectory(prefix="trainbridge-") as folder:
                np.ascontiguousarray(factor).tofile(Path(folder, _HANDLE_FILE))
                return not _handle_file(self._library.pardiso_handle_restore, self._memory, folder)
        except OSError:
            return False

    @property
    def memory_bytes(self) -> int:
        """Memory of the factor, as PARDISO reports it. [B]"""
        return 1024 * int(self.settings[16] + self.settings[15])


def _pardiso_call(
    library: Any,
    memory: IntVector,
    settings: Any,
    phase: int,
    n_dof: int,
    arrays: tuple[Any, Any, Any, Any],
    n_load: int,
    load: FloatArray,
    solution: FloatArray,
) -> int:
    """Calls ``pardiso`` and returns its error code."""
    one = ctypes.byref(ctypes.c_int(1))
    error = ctypes.c_int(0)
    values, rows, columns, selection = arrays
    library.pardiso(
        _address(memory), one, one,
        ctypes.byref(ctypes.c_int(_POSITIVE_DEFINITE)),
        ctypes.byref(ctypes.c_int(phase)),
        ctypes.byref(ctypes.c_int(n_dof)),
        _address(values), _address(rows), _address(columns), _address(selection),
        ctypes.byref(ctypes.c_int(n_load)),
        _address(settings),
        ctypes.byref(ctypes.c_int(0)),
        _address(load), _address(solution),
        ctypes.byref(error),
    )  # fmt: skip
    return error.value


_HANDLE_FILE = "handle.pds"
"""Name that MKL gives to the file of a factor."""


def _handle_file(call: Any, memory: IntVector, folder: str) -> int:
    """Calls ``pardiso_handle_store`` or ``_restore`` and returns the error code."""
    error = ctypes.c_int(0)
    # MKL reads a Fortran string of 1023 characters at most.
    name = ctypes.create_string_buffer(folder.encode(), 1024)
    call.restype = None
    call(_address(memory), name, ctypes.byref(error))
    return error.value


def _release(library: Any, memory: IntVector, settings: Any, n_dof: int) -> None:
    """Gives the factor's memory back when its owner is collected."""
    nothing = np.zeros(1)
    integers = np.zeros(1, dtype=np.int32)
    arrays = (nothing, integers, integers, integers)
    _pardiso_call(library, memory, settings, -1, n_dof, arrays, 1, nothing, nothing)


def _aligned(size: int) -> Vector:
    """Zeros that begin on a cache line: MKL's sums then take the same order in every process."""
    line = 64
    raw = np.zeros(size + line // 8)
    start = (-raw.ctypes.data % line) // 8
    return raw[start : start + size]


class PardisoFactorisation:
    """A factorised matrix; see ``solver.factorisation.sparse`` for the contract."""

    def __init__(self, matrix: SparseMatrix, part: str) -> None:
        self._handle = _Handle(matrix, None, part)
        nothing = np.zeros(1)
        self._handle.call(12, nothing, nothing)
        require_accuracy(matrix, self.solve, part)

    def solve(self, load: FloatArray) -> FloatArray:
        """Solution for one load (n_dof,) or several (n_dof, n_load)."""
        columns = _loads(load, self._handle.n_dof)
        solution = np.zeros(columns.shape, order="F")
        n_load = 1 if columns.ndim == 1 else columns.shape[1]
        self._handle.call(33, columns, solution, n_load)
        return solution


class PardisoCondensation:
    """A matrix condensed on its interface; see ``solver.factorisation.sparse``."""

    complement: Matrix
    memory_bytes: int

    def __init__(self, matrix: SparseMatrix, interface: IntVector, part: str) -> None:
        # PARDISO returns the complement in ascending order of the indices.
        order = np.argsort(interface, kind="stable")
        rank = np.empty_like(order)
        rank[order] = np.arange(order.size)
        self._begin(matrix, interface, part)
        complement = np.zeros((interface.size, interface.size))
        nothing = np.zeros(1)
        self._handle.call(11, nothing, nothing)
        self._handle.call(22, nothing, complement)
        # The two triangles may differ in the last bits: keep the matrix exactly symmetric.
        complement = 0.5 * (complement + complement.T)
        self.complement = np.ascontiguousarray(complement[np.ix_(rank, rank)])
        self._end(matrix)

    def _begin(self, matrix: SparseMatrix, interface: IntVector, part: str) -> None:
        self._interface, self._part = interface, part
        self._handle = _Handle(matrix, interface, part)
        self._load = _aligned(self._handle.n_dof)
        self._forward = _aligned(self._handle.n_dof)
        self._solution = _aligned(self._handle.n_dof)

    def _end(self, matrix: SparseMatrix) -> None:
        self.memory_bytes = self._handle.memory_bytes
        require_accuracy(matrix, self._solve, self._part)
        self._forward[:] = 0.0

    def stored(self) -> Arrays | None:
        """The factor and the complement for another process; see ``restored``."""
        factor = self._handle.stored()
        if factor is None:
            return None
        settings = self._handle.settings.copy()
        return {"factor": factor, "complement": self.complement, "settings": settings}

    @classmethod
    def restored(
        cls,
        matrix: SparseMatrix,
        interface: IntVector,
        part: str,
        stored: Mapping[str, NDArray[Any]],
    ) -> PardisoCondensation | None:
        """The same as factorised, from what ``stored`` gave for the same matrix and interface.

        A tenth of the time that factorising takes, and equal to the last bit. None where MKL does
        not take it.
        """
        found = cls.__new__(cls)
        found._begin(matrix, interface, part)
        if not found._handle.restore(stored["factor"]):
            return None
        found._handle.settings[:] = stored["settings"]
        found.complement = np.array(stored["complement"], order="C")
        found._end(matrix)
        return found

    def forward(self, load: Vector) -> Vector:
        """Load condensed on the interface; see the contract."""
        self._load[:] = _loads(load, self._handle.n_dof)
        self._handle.call(331, self._load, self._forward)
        return self._forward[self._interface]

    def backward(self, interface: Vector) -> Vector:
        """All unknowns; the array returned is overwritten by the next call."""
        self._forward[self._interface] = interface
        self._handle.call(333, self._forward, self._solution)
        return self._solution

    def _solve(self, load: Vector) -> Vector:
        """All unknowns under a load, the interface's from the complement."""
        return self.backward(solve_complement(self.complement, self.forward(load), self._part))
