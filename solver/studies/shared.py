"""What the runs of a sweep share: made once, kept in a cache, and taken only where it fits.

A crossing is prepared in steps that do not depend on the speed: the structure's matrices, the
approach track's bed, the frequencies of the deciding span, the static start, the factor of the
effective matrix. Each is an entry of the cache, sealed by two digests: of what it was made from
(with the solver's own source, the libraries and the processor, by which last bits differ) and of
its content. An entry that is torn, or was made from anything else, is made anew.
"""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Arrays, Cache, IntVector, SparseMatrix, attributes_of
from solver.factorisation import (
    CondensedFactorisation,
    arithmetic,
    back_end_name,
    condense,
    restored,
)
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.mesh_level import MeshLevel
from solver.models.rails import ApproachTrack
from solver.models.structure import build_structure
from solver.models.structure_arrays import structure_arrays, structure_from_arrays
from solver.models.structure_model import StructureModel
from solver.models.viaduct import ViaductProperties
from solver.studies.json import to_json
from solver.studies.member_modes import member_frequencies
from solver.studies.study import Study
from solver.system import System
from solver.system.statics import StaticState, at_rest_beyond, standing, static_start
from solver.system.track_compliance import matched_approach

__all__ = ["Shared", "model_key", "source_digest"]

_ORIGIN, _CONTENT = "origin", "content"
"""Names of the two digests in an entry."""
_OF_ONE_RUN = ("name", "outputs", "sweep", "modes", "line_speed", "schema_version")
"""Parts of a study that nothing shared depends on."""


def model_key(study: Study) -> str | None:
    """Under which key a store keeps what a study's runs share.

    Returns:
        32 hexadecimal digits, the same for studies that differ in name, speeds, outputs and
        run-out only; None for plain beams, which are prepared in milliseconds.
    """
    if isinstance(study.viaduct, BeamBridge):
        return None
    parts = {name: value for name, value in to_json(study).items() if name not in _OF_ONE_RUN}
    parts["extent"].pop("run_out")
    kind = f"{platform.system()} {platform.machine()}, {back_end_name()}"
    return _digest(source_digest(), kind, parts).hex()[:32]


class Shared:
    """Makes what runs share, or takes it from a cache.

    Args:
        cache: Where entries are kept; None makes all anew.
        saves: Whether entries that are made are saved.
    """

    def __init__(self, cache: Cache | None = None, saves: bool = False) -> None:
        self._cache, self._saves = cache, saves

    def structure(
        self, viaduct: ViaductProperties, track: TrackProperties, level: MeshLevel
    ) -> StructureModel:
        """Viaduct and track."""
        return structure_from_arrays(
            self._take(
                "structure",
                (asdict(viaduct), asdict(track), level),
                lambda: structure_arrays(build_structure(viaduct, track, level)),
            )
        )

    def approach(
        self, track: TrackProperties, approach: ApproachTrack, level: MeshLevel
    ) -> ApproachTrack:
        """The approach track with its bed's stiffness."""

        def make() -> Arrays:
            return {
                "bed_stiffness": np.array(matched_approach(track, approach, level).bed_stiffness)
            }

        found = self._take("approach", (asdict(track), asdict(approach), level), make)
        return replace(approach, bed_stiffness=float(found["bed_stiffness"]))

    def frequencies(self, structure: StructureModel, spans: tuple[int, ...]) -> list[float]:
        """Frequencies of the deciding spans. [Hz]"""
        found = self._take(
            "frequencies",
            (structure.stiffness, structure.mass, spans),
            lambda: {"frequencies": np.array(member_frequencies(structure, spans))},
        )
        return found["frequencies"].tolist()

    def static_start(self, system: System) -> StaticState:
        """The static start of a system with a structure: the same at every speed."""
        short = standing(system)
        if system.structure is None:
            return at_rest_beyond(static_start(short), system)
        found = self._take(
            "static start", _what_stands(short), lambda: attributes_of(static_start(short))
        )
        return at_rest_beyond(StaticState(**found), system)

    def condense(
        self, matrix: SparseMatrix, interface: IntVector, part: str
    ) -> CondensedFactorisation:
        """The factor of the effective matrix; for ``Simulation``."""
        name = "factor"
        if self._cache is None:
            return condense(matrix, interface, part)
        origin = _origin(name, matrix, interface)
        found = _sound(self._cache.load(name), origin)
        taken = None if found is None else restored(matrix, interface, part, found)
        if taken is not None:
            return taken
        made = condense(matrix, interface, part)
        arrays = made.stored() if self._saves else None
        if arrays is not None:
            self._cache.save(name, _sealed(arrays, origin))
        return made

    def _take(self, name: str, origins: tuple[object, ...], make: Callable[[], Arrays]) -> Arrays:
        """An entry of the cache, or what ``make`` gives."""
        if self._cache is None:
            return make()
        origin = _origin(name, *origins)
        found = _sound(self._cache.load(name), origin)
        if found is not None:
            return found
        made = make()
        if self._saves:
            self._cache.save(name, _sealed(made, origin))
        return made


def _what_stands(system: System) -> tuple[object, ...]:
    """All that a static start is found from."""
    line, train, structure, law = (
        system.line, system.train, system.structure, system.nonlinear_hertz,
    )  # fmt: skip
    assert structure is not None
    x = system.wheel_positions(0.0)
    return (
        line.positions, line.free, line.stiffness, line.n_line, system.seat_nodes,
        structure.stiffness, structure.seats, structure.pad_stiffness, structure.weight,
        train.stiffness, train.weight, train.wheel_rows, train.wheel_lines, train.wheel_rest,
        x, system.irregularity(train.wheel_lines, x), system.contact_compliance,
        None if law is None else asdict(law),
    )  # fmt: skip


# -- seals ---------------------------------------------------------------------------------------


def _sealed(arrays: Arrays, origin: bytes) -> Arrays:
    """An entry as it is saved."""
    seals = {_ORIGIN: origin, _CONTENT: _content(arrays)}
    return arrays | {name: np.frombuffer(seal, dtype=np.uint8) for name, seal in seals.items()}


def _sound(entry: Mapping[str, NDArray[Any]] | None, origin: bytes) -> Arrays | None:
    """The arrays of an entry, or None where it is missing, torn, or was made from other things."""
    if entry is None or not {_ORIGIN, _CONTENT} <= entry.keys():
        return None
    if entry[_ORIGIN].tobytes() != origin:
        return None
    arrays = {name: value for name, value in entry.items() if name not in (_ORIGIN, _CONTENT)}
    return arrays if entry[_CONTENT].tobytes() == _content(arrays) else None


def _content(arrays: Arrays) -> bytes:
    state = hashlib.sha256()
    for name in sorted(arrays):
        state.update(name.encode())
        _feed(state, arrays[name])
    return state.digest()


def _origin(*parts: object) -> bytes:
    """Of things that an entry is made from, with all else that its last bits depend on."""
    return _digest(source_digest(), arithmetic(), *parts)


def _digest(*parts: object) -> bytes:
    state = hashlib.sha256()
    for part in parts:
        _feed(state, part)
    return state.digest()


def _feed(state: Any, part: object) -> None:
    """Adds numbers, text, plain data, arrays and sparse matrices to a digest."""
    if isinstance(part, np.ndarray):
        state.update(f"{part.dtype.str}{part.shape}".encode())
        state.update(np.ascontiguousarray(part).data)
    elif hasattr(part, "indptr"):
        matrix: Any = part
        for array in (matrix.data, matrix.indices, matrix.indptr):
            _feed(state, array)
    else:
        state.update(json.dumps(part, sort_keys=True).encode())
    state.update(b";")


@cache
def source_digest() -> str:
    """Digest of the solver's own source and data: what another one has stored may mean otherwise.

    Returns:
        64 hexadecimal digits.
    """
    state = hashlib.sha256()
    for path, text in sorted(_texts(files("solver"), "")):
        state.update(path.encode())
        state.update(text)
    return state.hexdigest()


def _texts(folder: Traversable, prefix: str) -> list[tuple[str, bytes]]:
    """Every source and data file below a folder of the package."""
    found: list[tuple[str, bytes]] = []
    for entry in folder.iterdir():
        path = f"{prefix}/{entry.name}"
        if entry.is_dir():
            found += _texts(entry, path)
        elif entry.name.endswith((".py", ".json")):
            found.append((path, entry.read_bytes()))
    return found
