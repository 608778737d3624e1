"""Where MKL lies: by the list of files of the package that brought it.

``pypardiso`` looks for it in every folder of the environment when it is loaded and again for each
solver: a second in each process that computes.
"""

from __future__ import annotations

import ctypes
import os
from importlib.metadata import PackageNotFoundError, files
from typing import Any

__all__ = ["load_mkl"]

_VARIABLE = "PYPARDISO_MKL_RT"
"""Read by pypardiso, which takes the library of this path and searches no more."""
_NAMES = ("libmkl_rt", "mkl_rt")
_KINDS = (".so", ".dll", ".dylib")


def load_mkl() -> Any:
    """MKL's functions, by a handle of our own: pypardiso's declares types of arguments.

    Raises:
        ImportError: There is no pypardiso, or it finds no MKL.
    """
    path = _installed()
    if path is not None:
        os.environ.setdefault(_VARIABLE, path)
    from pypardiso import PyPardisoSolver

    return ctypes.CDLL(PyPardisoSolver().libmkl._name)


def _installed() -> str | None:
    """The library of the installed package; None where it came in another way."""
    try:
        listed = files("mkl") or []
    except PackageNotFoundError:
        return None
    for file in listed:
        if file.name.startswith(_NAMES) and any(kind in file.name for kind in _KINDS):
            path = file.locate()
            if os.path.exists(path):
                return os.path.realpath(path)
    return None
