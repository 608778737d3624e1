"""A structure as named arrays and back: what a cache keeps of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from solver.arrays import Arrays, below, under
from solver.models.structure_model import StructureModel

__all__ = ["structure_arrays", "structure_from_arrays"]

_SPARSE = frozenset({"mass", "stiffness", "damping", "displacement_operator", "bearing_operator"})
_NUMBERS = frozenset({"mass_proportional", "stiffness_proportional"})
_NAMED = frozenset({"surfaces", "part_names"})


def structure_arrays(structure: StructureModel) -> Arrays:
    """All of a structure; entries of sparse matrices keep their order."""
    arrays: Arrays = {}
    for name in (field.name for field in fields(structure)):
        value: Any = getattr(structure, name)
        if name in _SPARSE:
            arrays |= under(name, _compressed(value))
        elif name not in _NAMED:
            arrays[name] = np.asarray(value)
    for index, faces in enumerate(structure.surfaces.values()):
        arrays[f"surfaces/{index}"] = faces
    arrays["surface_names"] = _letters(tuple(structure.surfaces))
    arrays["part_names"] = _letters(structure.part_names)
    return arrays


def structure_from_arrays(arrays: Mapping[str, NDArray[Any]]) -> StructureModel:
    """The structure that ``structure_arrays`` took apart."""
    values: dict[str, Any] = {
        "surfaces": {
            name: arrays[f"surfaces/{index}"]
            for index, name in enumerate(_words(arrays["surface_names"]))
        },
        "part_names": _words(arrays["part_names"]),
    }
    for name in (field.name for field in fields(StructureModel)):
        if name in _SPARSE:
            values[name] = _matrix(below(name, arrays))
        elif name in _NUMBERS:
            values[name] = float(arrays[name])
        elif name not in _NAMED:
            values[name] = arrays[name]
    return StructureModel(**values)


def _compressed(matrix: Any) -> Arrays:
    """Four bytes an index: half of what the assembly needs."""
    return {
        "data": matrix.data,
        "indices": matrix.indices.astype(np.int32),
        "indptr": matrix.indptr.astype(np.int32),
        "shape": np.array(matrix.shape),
    }


def _matrix(arrays: Mapping[str, NDArray[Any]]) -> Any:
    rows, columns = arrays["shape"].tolist()
    return sparse.csr_array(
        (arrays["data"], arrays["indices"], arrays["indptr"]), shape=(rows, columns)
    )


def _letters(words: tuple[str, ...]) -> NDArray[np.uint8]:
    """Words as bytes, a line each: a store needs no type for text."""
    return np.frombuffer("\n".join(words).encode(), dtype=np.uint8)


def _words(letters: NDArray[Any]) -> tuple[str, ...]:
    return tuple(letters.astype(np.uint8).tobytes().decode().split("\n"))
