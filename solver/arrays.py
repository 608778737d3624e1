"""Array aliases and shape symbols, fixed once for the whole solver.

Shape symbols in docstrings: ``n_dof`` degrees of freedom, ``n_step`` time steps, ``n_wheel``
wheels, ``n_axle`` axles, ``n_seat`` rail seats of one rail, ``n_mode`` modes, ``n_node`` nodes,
``n_element`` elements. Time is always the first axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Arrays",
    "BoolVector",
    "Cache",
    "FloatArray",
    "IntArray",
    "IntVector",
    "Matrix",
    "SparseMatrix",
    "Vector",
    "attributes_of",
    "below",
    "put_back",
    "under",
]

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
Arrays: TypeAlias = dict[str, NDArray[Any]]
"""Named arrays, a path in the name (``motions/0/velocity``): what checkpoints and caches hold."""


class Cache(Protocol):
    """Keeps named arrays between processes; the server's store implements it."""

    def load(self, name: str) -> Mapping[str, NDArray[Any]] | None:
        """What was saved under a name, or None where there is nothing sound."""
        ...

    def save(self, name: str, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Saves arrays under a name."""
        ...


# -- state: what an object keeps from one step to the next ------------------------------------


def attributes_of(owner: object) -> Arrays:
    """Copies of all attributes of an object whose attributes are arrays and numbers."""
    return {name: np.array(value) for name, value in vars(owner).items()}


def put_back(owner: object, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Sets the attributes that ``attributes_of`` took; numbers become numbers again."""
    for name, value in vars(owner).items():
        found = np.array(arrays[name], order="C")
        setattr(owner, name, found if isinstance(value, np.ndarray) else found.item())


def under(prefix: str, arrays: Mapping[str, NDArray[Any]]) -> Arrays:
    """The same arrays one level further down."""
    return {f"{prefix}/{name}": value for name, value in arrays.items()}


def below(prefix: str, arrays: Mapping[str, NDArray[Any]]) -> Arrays:
    """The arrays of one level, their names counted from there: undoes ``under``."""
    start = f"{prefix}/"
    return {
        name.removeprefix(start): value for name, value in arrays.items() if name.startswith(start)
    }
