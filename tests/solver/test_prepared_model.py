"""What the runs of a sweep share: equal to the last bit, factorised once, never taken if torn."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from solver.factorisation import pardiso
from solver.factorisation import sparse as back_ends
from solver.irregularities import IsolatedDefect
from solver.simulation import Simulation
from solver.studies import Study, model_key, prepare, prepare_model, template
from solver.studies.study import Contact, Extent, Integration, Outputs, Sweep
from solver.system.statics import standing, static_start, static_state

ENTRIES = {"structure", "approach", "frequencies", "static start", "factor"}
FACTORISING, SOLVING = (11, 12, 22), (33,)
ROOT = Path(__file__).parents[2]


class Memory:
    """A cache in memory; what it gives out cannot be written to."""

    def __init__(self) -> None:
        self.entries: dict[str, dict[str, NDArray[Any]]] = {}
        self.saved: list[str] = []

    def load(self, name: str) -> Mapping[str, NDArray[Any]] | None:
        return self.entries.get(name)

    def save(self, name: str, arrays: Mapping[str, NDArray[Any]]) -> None:
        self.saved.append(name)
        self.entries[name] = {key: np.array(value) for key, value in arrays.items()}
        for value in self.entries[name].values():
            value.setflags(write=False)


@pytest.fixture(scope="module")
def study(small_study: Study) -> Study:
    """Two speeds; a short span, on which the first axle already stands."""
    return replace(
        small_study,
        viaduct=replace(small_study.viaduct, spans=(6.0,)),
        track=replace(small_study.track, embankment_length=3.0),
        extent=Extent(run_in=0.0, run_out=0.1),
        sweep=Sweep(speeds=(70.0, 95.0)),
    )


@pytest.fixture(scope="module")
def filled(study: Study) -> Memory:
    cache = Memory()
    prepare_model(study, cache)
    return cache


@pytest.fixture
def phases(monkeypatch: pytest.MonkeyPatch) -> Counter[int]:
    """Calls of PARDISO by phase."""
    calls: Counter[int] = Counter()
    original = pardiso._Handle.call

    def counted(self: Any, phase: int, *arguments: Any) -> None:
        calls[phase] += 1
        original(self, phase, *arguments)

    monkeypatch.setattr(pardiso._Handle, "call", counted)
    return calls


def equal(found: Simulation, wanted: Simulation, n_step: int = 25) -> None:
    """Plan, static start and the first steps, to the last bit."""
    assert found.plan.facts == wanted.plan.facts
    assert found.plan.channels == wanted.plan.channels
    layers = zip(found.plan.geometry.layers, wanted.plan.geometry.layers, strict=True)
    for one, other in layers:
        assert one.name == other.name
        np.testing.assert_array_equal(one.faces, other.faces)
    for name, value in vars(wanted.static).items():
        np.testing.assert_array_equal(getattr(found.static, name), value, err_msg=name)
    samples = zip(islice(found, n_step), islice(wanted, n_step), strict=True)
    for one, other in samples:
        np.testing.assert_array_equal(one.channels, other.channels)
        np.testing.assert_array_equal(one.slab, other.slab)
        if other.frame is not None:
            assert one.frame is not None
            np.testing.assert_array_equal(one.frame.displacement, other.frame.displacement)


def same_entry(found: Mapping[str, NDArray[Any]], wanted: Mapping[str, NDArray[Any]]) -> None:
    """All arrays, but for MKL's file: it holds addresses and spare room."""
    assert found.keys() == wanted.keys()
    for key in wanted.keys() - ({"factor", "content"} if "factor" in wanted else set()):
        np.testing.assert_array_equal(found[key], wanted[key], err_msg=key)


# -- with the cache and without ----------------------------------------------------------------


@pytest.mark.parametrize("run_index", [0, 1])
def test_a_run_with_the_cache_is_the_run_without(
    study: Study, filled: Memory, run_index: int
) -> None:
    assert filled.entries.keys() == ENTRIES
    equal(prepare(study, run_index, cache=filled), prepare(study, run_index))


@pytest.mark.parametrize("contact", [Contact(law="rigid"), Contact(law="nonlinear_hertz")])
def test_so_it_is_with_other_contact_laws(study: Study, contact: Contact) -> None:
    other, cache = replace(study, contact=contact), Memory()
    prepare_model(other, cache)
    equal(prepare(other, 1, cache=cache), prepare(other, 1), 10)


def test_with_a_filled_cache_nothing_large_is_factorised(
    study: Study, filled: Memory, phases: Counter[int]
) -> None:
    """No factorisation, no solve for modes or compliances: one pass that checks the factor."""
    before = list(filled.saved)
    simulation = prepare(study, 1, cache=filled)
    assert not any(phases[phase] for phase in (*FACTORISING, *SOLVING))
    assert (phases[331], phases[333]) == (1, 1)
    assert filled.saved == before
    for _ in islice(simulation, 11):
        pass
    assert (phases[331], phases[333]) == (11, 11)


def test_without_a_cache_everything_is_factorised_once(study: Study, phases: Counter[int]) -> None:
    prepare(study, 1)
    # Modes: 12. Static start, effective matrix and the track that the approach is matched to: 22.
    assert [phases[phase] for phase in (12, 11, 22)] == [1, 3, 3]


def test_a_filled_cache_is_left_as_it_is(
    study: Study, filled: Memory, phases: Counter[int]
) -> None:
    before = list(filled.saved)
    prepare_model(study, filled)
    assert filled.saved == before
    assert not any(phases[phase] for phase in FACTORISING)


def test_a_run_makes_what_is_missing_and_saves_nothing(study: Study, filled: Memory) -> None:
    wanted = prepare(study, 0)
    for name in ENTRIES:
        cache = Memory()
        cache.entries = {key: value for key, value in filled.entries.items() if key != name}
        equal(prepare(study, 0, cache=cache), wanted, 1)
        assert cache.saved == []
        prepare_model(study, cache)
        assert cache.saved == [name]
        same_entry(cache.entries[name], filled.entries[name])


def test_another_process_goes_on_to_the_same(study: Study, filled: Memory, tmp_path: Path) -> None:
    """From a state of a run without the cache; with the factor, though MKL's structures live only
    as long as their process."""
    run = prepare(study, 1)
    for _ in islice(run, 6):
        pass
    for name, arrays in (*filled.entries.items(), ("state", run.state())):
        np.savez(tmp_path / f"{name}.npz", **arrays)
    (tmp_path / "study.py").write_text(f"{_IMPORTS}\nSTUDY = {study!r}\n", encoding="utf-8")
    environment = os.environ | {"PYTHONPATH": f"{ROOT}{os.pathsep}{tmp_path}"}
    subprocess.run(
        [sys.executable, "-W", "error", "-c", _OTHER_PROCESS, str(tmp_path)],
        env=environment, check=True, timeout=300,
    )  # fmt: skip
    wanted = [sample.channels for sample in islice(run, 8)]
    np.testing.assert_array_equal(np.load(tmp_path / "found.npy"), wanted)


_IMPORTS = """
from solver.irregularities import NoIrregularity
from solver.models.ballasted_track import TrackProperties
from solver.models.rails import ApproachTrack
from solver.models.train import *
from solver.models.viaduct import ViaductProperties
from solver.studies.study import *
"""
_OTHER_PROCESS = """
import sys
from itertools import islice
from pathlib import Path
import numpy as np
from solver.factorisation import pardiso
from solver.studies import prepare
from study import STUDY

folder = Path(sys.argv[1])

class Files:
    def load(self, name):
        with np.load(folder / f"{name}.npz") as file:
            return dict(file)

def refused(self, *arguments):
    raise AssertionError("factorised anew")

pardiso.PardisoCondensation.__init__ = refused
pardiso.PardisoFactorisation.__init__ = refused
files = Files()
run = prepare(STUDY, 1, cache=files)
run.restore(files.load("state"))
np.save(folder / "found.npy", [sample.channels for sample in islice(run, 8)])
"""


# -- torn and foreign entries ------------------------------------------------------------------


def torn(arrays: Mapping[str, NDArray[Any]]) -> Iterator[dict[str, NDArray[Any]] | None]:
    """An entry with one bit flipped in each of its greatest arrays, and otherwise incomplete."""
    yield None
    yield {}
    names = sorted(arrays, key=lambda name: arrays[name].nbytes)
    for name in (names[-1], names[0], "origin", "content"):
        flipped = np.array(arrays[name])
        flipped.reshape(-1).view(np.uint8)[flipped.nbytes // 2] ^= 1
        yield {**arrays, name: flipped}
        yield {key: value for key, value in arrays.items() if key != name}
    longest = arrays[names[-1]]
    yield {**arrays, names[-1]: longest.reshape(-1)[:-1]}
    yield {**arrays, "more": np.zeros(3)}


@pytest.mark.parametrize("name", sorted(ENTRIES))
def test_a_torn_entry_is_made_anew(study: Study, filled: Memory, name: str) -> None:
    for bad in torn(filled.entries[name]):
        cache = Memory()
        cache.entries = dict(filled.entries)
        if bad is not None:
            cache.entries[name] = bad
        else:
            del cache.entries[name]
        prepare_model(study, cache)
        assert cache.saved == [name]
        same_entry(cache.entries[name], filled.entries[name])


def test_entries_of_another_study_are_not_taken(study: Study, filled: Memory) -> None:
    """Each entry knows what it was made from; what is alike may be taken."""
    stiffer = replace(study, viaduct=replace(study.viaduct, slab_modulus=40e9))
    for other, changed in (
        (stiffer, ENTRIES - {"approach"}),
        (replace(study, integration=Integration(time_step=4e-4)), {"factor"}),
        (replace(study, extent=Extent(run_in=5.0)), {"static start"}),
        (replace(study, track=replace(study.track, pad_stiffness=200e6)), {"approach"}),
    ):
        assert model_key(other) != model_key(study)
        cache = Memory()
        cache.entries = dict(filled.entries)
        equal(prepare(other, 0, cache=cache), prepare(other, 0), 3)
        prepare_model(other, cache)
        assert changed <= set(cache.saved)


# -- MKL's file --------------------------------------------------------------------------------


def test_no_file_is_left_behind(
    study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    cache = Memory()
    prepare_model(study, cache)
    prepare(study, 0, cache=cache)
    assert list(tmp_path.iterdir()) == []


def test_without_room_for_the_file_runs_factorise_anew(
    study: Study, filled: Memory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted = prepare(study, 0)
    usage = pardiso.shutil.disk_usage(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(pardiso.shutil, "disk_usage", lambda folder: usage._replace(free=1000))
        cache = Memory()
        prepare_model(study, cache)
        assert cache.entries.keys() == ENTRIES - {"factor"}
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "missing"))
    equal(prepare(study, 0, cache=filled), wanted, 3)


def test_superlu_takes_nothing_of_mkl_and_shares_all_but_its_factor(
    study: Study, filled: Memory, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(back_ends, "_pardiso", lambda: None)
    back_ends.arithmetic.cache_clear()
    try:
        cache = Memory()
        cache.entries = dict(filled.entries)
        prepare_model(study, cache)
        assert set(cache.saved) == ENTRIES - {"factor"}
        equal(prepare(study, 0, cache=cache), prepare(study, 0), 3)
    finally:
        back_ends.arithmetic.cache_clear()


# -- one static start for all speeds -----------------------------------------------------------


def test_the_static_start_is_the_one_of_the_whole_path(study: Study) -> None:
    """Rails far beyond train and structure are left out: nothing moves there."""
    systems = [prepare(study, index).system for index in (0, 1)]
    long = replace(study, extent=Extent(run_in=0.0, run_out=2.0))
    systems.append(prepare(long, 1).system)
    shortened = [standing(system) for system in systems]
    assert {system.line.n_node for system in shortened} == {shortened[0].line.n_node}
    assert systems[2].line.n_node > shortened[2].line.n_node
    for system in systems:
        whole, found = static_start(system), static_state(system)
        for name, value in vars(whole).items():
            # Rounding of two chains of different length.
            limit = 1e-13 * np.abs(value).max(initial=0.0)
            np.testing.assert_allclose(getattr(found, name), value, rtol=0.0, atol=limit)


# -- the key -----------------------------------------------------------------------------------


def test_plain_beams_share_nothing() -> None:
    assert model_key(template("sprung-mass-beam").study) is None


def test_studies_that_differ_in_what_is_asked_share_a_model(study: Study) -> None:
    key = model_key(study)
    assert key is not None
    assert len(key) == 32
    assert int(key, 16) >= 0
    for other in (
        replace(study, name="another"),
        replace(study, sweep=Sweep(speeds=(50.0,))),
        replace(study, outputs=Outputs(frame_interval=0.1)),
        replace(study, line_speed=80.0),
        replace(study, extent=replace(study.extent, run_out=3.0)),
    ):
        assert model_key(other) == key


def test_studies_that_differ_in_the_model_do_not(study: Study) -> None:
    others = [
        replace(study, mesh_level="standard"),
        replace(study, integration=Integration(alpha=-0.1, time_step=5e-4)),
        replace(study, contact=Contact(law="rigid")),
        replace(study, irregularity=IsolatedDefect()),
        replace(study, extent=replace(study.extent, run_in=1.0)),
        replace(study, train=replace(study.train, consist=study.train.consist[1:])),
        replace(study, viaduct=replace(study.viaduct, spans=(6.0, 6.0))),
        replace(study, track=replace(study.track, embankment_length=7.0)),
        replace(study, approach=replace(study.approach, bed_damping=1e4)),
    ]
    keys = {model_key(other) for other in [study, *others]}
    assert len(keys) == len(others) + 1
