"""Array aliases and shape symbols, fixed once for the whole solver.

Shape symbols in docstrings: ``n_dof`` degrees of freedom, ``n_step`` time steps, ``n_wheel``
wheels, ``n_axle`` axles, ``n_seat`` rail seats of one rail, ``n_mode`` modes, ``n_node`` nodes,
``n_element`` elements. Time is always the first axis.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["BoolVector", "FloatArray", "IntArray", "IntVector", "Matrix", "SparseMatrix", "Vector"]

FloatArray: TypeAlias = NDArray[np.floating[Any]]
"""Array of floats of any dimension; double precision but where a docstring says otherwise."""
Vector: TypeAlias = FloatArray
"""One-dimensional array of floats."""
Matrix: TypeAlias = FloatArray
"""Two-dimensional array of floats."""
IntArray: TypeAlias = NDArray[np.integer[Any]]
"""Array of integers of any dimension."""
IntVector: TypeAlias = IntArray
"""One-dimensional array of integers."""
BoolVector: TypeAlias = NDArray[np.bool_]
"""One-dimensional array of truth values."""
SparseMatrix: TypeAlias = Any
"""``scipy.sparse.csr_array``: compressed rows (SciPy ships no types, hence Any)."""
