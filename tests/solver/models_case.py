"""Crossings that tests share: what is the same in two studies is built and factorised once.

With a cache a simulation is to the last bit what it is without: that is what test_prepared_model
asserts, and why the other tests may take the quicker way.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from solver import studies
from solver.arrays import Arrays
from solver.simulation import Simulation
from solver.studies import Study

__all__ = ["prepare"]


class _Memory:
    """Entries of one study."""

    def __init__(self, entries: Mapping[str, Arrays]) -> None:
        self.entries = dict(entries)

    def load(self, name: str) -> Mapping[str, NDArray[Any]] | None:
        return self.entries.get(name)

    def save(self, name: str, arrays: Mapping[str, NDArray[Any]]) -> None:
        self.entries[name] = dict(arrays)


_models: dict[str, _Memory] = {}


def prepare(study: Study, *, factor_anew: bool = False) -> Simulation:
    """The first run of a study, ready for its first step.

    Args:
        study: The study.
        factor_anew: The large matrix is factorised for this very simulation.
    """
    key = studies.model_key(study)
    if key is None:
        return studies.prepare(study)
    if key not in _models:
        # What an earlier study has in common with this one fits; the rest is made anew.
        earlier = next(iter(_models.values()), _Memory({}))
        _models[key] = _Memory(earlier.entries)
        studies.prepare_model(study, _models[key])
    entries = _models[key].entries
    taken = {name: entry for name, entry in entries.items() if name != "factor" or not factor_anew}
    return studies.prepare(study, cache=_Memory(taken))
