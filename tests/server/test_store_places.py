"""Places: the same promises on a local disk and in an object store."""

from __future__ import annotations

import pickle
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from server.store import (
    ModelStore,
    NotStoredError,
    Place,
    PlaceError,
    RunReader,
    RunWriter,
    StoreError,
    attempt_place,
    check_place,
    claim,
    job_place,
    model_place,
    open_place,
    orphans,
    read_checkpoint,
    remove_orphans,
    used_bytes,
)
from server.store.layout import LIVE
from tests.server.object_stores import object_store
from tests.server.store_case import make_plan, samples_of


@pytest.fixture(scope="module")
def bucket() -> Iterator[str]:
    """URL of a prefix in an object store."""
    with object_store() as url:
        yield url


@pytest.fixture(params=["disk", "object store"])
def place(request: pytest.FixtureRequest, tmp_path: Path) -> Place:
    """A new place of each kind."""
    if request.param == "disk":
        return open_place(tmp_path / "a store")
    return open_place(request.getfixturevalue("bucket")).child(tmp_path.name)


def test_documents_are_written_read_and_removed(place: Place) -> None:
    assert place.read("a") is None
    assert not place.exists("a")
    assert place.names() == []
    assert place.size() == 0
    place.write("a", b"one")
    place.write("a", b"three")
    place.child("b", "c").write("d", b"12")
    assert place.read("a") == b"three"
    assert place.exists("a")
    assert not place.exists("b")
    assert place.names() == ["a", "b"]
    assert place.child("b").names() == ["c"]
    assert place.size() == 7
    place.remove("a")
    place.remove("a")
    place.remove("b")
    place.child("nothing").remove()
    assert place.names() == []
    place.remove()


def test_a_name_that_begins_like_another_is_another(place: Place) -> None:
    place.child("run").write("x", b"1")
    place.child("run2").write("x", b"12")
    assert place.child("run").size() == 1
    place.remove("run")
    assert place.child("run2").read("x") == b"12"


def test_of_many_claims_one_succeeds(place: Place) -> None:
    results: list[bool] = []
    barrier = threading.Barrier(8)

    def take(name: str) -> None:
        barrier.wait()
        results.append(claim(place, name))

    threads = [threading.Thread(target=take, args=(f"worker {i}",)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(results) == [False] * 7 + [True]


def test_places_travel_and_compare(place: Place) -> None:
    place.write("a", b"here")
    again = pickle.loads(pickle.dumps(place))
    by_url = open_place(place.url)
    assert again == place == by_url
    assert len({again, place, by_url}) == 1
    assert by_url.read("a") == b"here"
    assert open_place(place.child("b").url) == place.child("b")
    assert len(pickle.dumps(place)) < 1000


@pytest.mark.parametrize("name", ["", ".", "..", "a/b", "../a", "a\\b", "a\0"])
def test_no_name_leads_out_of_a_place(place: Place, name: str) -> None:
    for use in (place.read, place.child, place.remove, place.exists):
        with pytest.raises(ValueError, match="not the name"):
            use(name)


@pytest.mark.parametrize(
    ("url", "text"),
    [
        ("", "s3://bucket/prefix"),
        ("memory://", "Nothing can be stored at"),
        ("http://somewhere/x", "Nothing can be stored at"),
        ("s3://", "names no bucket"),
        ("s3://bucket/../x", "names no bucket"),
        ("file://elsewhere/x", "three slashes"),
    ],
)
def test_urls_that_cannot_be_used_say_what_to_give(url: str, text: str) -> None:
    with pytest.raises(PlaceError, match=text):
        open_place(url)


def test_layout_below_the_store(tmp_path: Path) -> None:
    store = open_place(str(tmp_path))
    assert attempt_place(store, "ab", 2).local == tmp_path / "runs" / "ab" / "002"
    assert job_place(store, "cd").local == tmp_path / "jobs" / "cd"
    assert model_place(store, "ef").local == tmp_path / "models" / "ef"


def test_a_store_that_does_not_answer_says_so(bucket: str) -> None:
    missing = open_place("s3://no-such-bucket/x")
    with pytest.raises(StoreError, match="no bucket"):
        check_place(missing)
    with pytest.raises(StoreError, match="no bucket"):
        missing.read("a")
    check_place(open_place(bucket))


@pytest.mark.slow
def test_a_run_is_stored_resumed_and_read_in_any_place(place: Place) -> None:
    plan = make_plan(400)
    first, second = attempt_place(place, "run", 1), attempt_place(place, "run", 2)
    assert claim(first, "worker")
    writer = RunWriter(first, plan)
    for sample in samples_of(plan):
        if sample.step == 250:
            break
        writer.append(sample)
        if sample.step == 99:
            writer.flush()
    writer.checkpoint({"u": np.arange(3.0)})
    reader = RunReader(first)
    assert reader.committed == 200
    # In an object store, frames gather: five of them came before the first flush.
    assert reader.committed_frames == 10
    name = plan.channels[3].name
    np.testing.assert_array_equal(reader.channel(name), np.arange(200) + 0.03)
    np.testing.assert_array_equal(reader.frame(9).displacement, np.full((12, 3), 180.0))

    checkpoint = read_checkpoint(first)
    assert checkpoint is not None
    writer = RunWriter.resumed(second, plan, first, checkpoint)
    for sample in samples_of(plan, writer.expected_step):
        writer.append(sample)
    writer.add_filtered({"f": np.arange(401.0)})
    writer.finish({"verdicts": []})
    reader = RunReader(second)
    assert reader.done
    assert reader.summary == {"verdicts": []}
    assert LIVE not in second.names()
    np.testing.assert_array_equal(reader.channel(name), np.arange(401) + 0.03)
    np.testing.assert_array_equal(reader.filtered("f"), np.arange(401.0))
    for index in range(plan.n_frame):
        assert np.all(reader.frame(index).displacement == 20 * index)


def test_an_object_store_gets_few_objects_while_a_run_computes(bucket: str) -> None:
    place = open_place(bucket).child("few")
    plan = make_plan(400)
    writer = RunWriter(place, plan)
    for sample in samples_of(plan):
        writer.append(sample)
        if sample.step == 99:
            writer.flush()
    writer.abort()
    # Four full shards and the last sample, of each array.
    for array in ("time", "channels", "slab", "frames", "bodies"):
        shards = [name for name in place.child(LIVE, array).names() if name.startswith("c.")]
        assert len(shards) == 5, array


def test_prepared_models_are_whole_or_absent(place: Place) -> None:
    model = ModelStore(model_place(place, "0" * 32))
    arrays = {"basis": np.arange(12.0).reshape(3, 4), "count": np.array(4)}
    assert model.load("basis/half") is None
    assert not model.complete()
    model.save("basis/half", arrays)
    model.finish()
    assert model.complete()
    loaded = model.load("basis/half")
    assert loaded is not None
    assert list(loaded) == ["basis", "count"]
    np.testing.assert_array_equal(loaded["basis"], arrays["basis"])
    loaded["basis"][0, 0] = 5.0  # an array of the caller's own
    [name] = [name for name in model.place.names() if name != "DONE"]
    data = model.place.read(name)
    assert data is not None
    model.place.write(name, data[:-1])
    assert model.load("basis/half") is None


def test_what_no_job_refers_to_is_found_and_removed(place: Place) -> None:
    for run, attempt in (("a1", 1), ("a1", 2), ("b2", 1), ("c3", 1)):
        attempt_place(place, run, attempt).write("plan.json", b"{}")
    attempt_place(place, "a1", 2).write("DONE", b"{}")
    attempt_place(place, "a1", 2).write("checkpoint", b"123")
    attempt_place(place, "b2", 2).write("plan.json", b"{}")
    job_place(place, "j1").write("summary.json", b"{}")
    job_place(place, "j2").write("summary.json", b"{}")
    model_place(place, "m1").write("DONE", b"12345")
    place.write("trainbridge.sqlite", b"database")
    place.child("runs").write("notes.txt", b"mine")
    place.child("runs", "mine").write("notes.txt", b"mine")
    assert used_bytes(place) == 12 + 3 + 4 + 5 + 8

    found = orphans(place, runs={"a1", "b2"}, jobs={"j1"}, models={"m1"})
    assert [(orphan.kind, orphan.name, orphan.bytes) for orphan in found] == [
        ("run", "c3", 2),
        ("attempt", "a1", 2),
        ("leftover", "a1", 3),
        ("job", "j2", 2),
    ]
    # A job that came meanwhile keeps its files.
    assert remove_orphans(found, runs={"a1", "b2", "c3"}) == 7
    assert place.child("runs").names() == ["a1", "b2", "c3", "mine", "notes.txt"]
    assert place.child("runs", "a1").names() == ["002"]
    assert place.child("runs", "b2").names() == ["001", "002"]
    assert attempt_place(place, "a1", 2).names() == ["DONE", "plan.json"]
    assert place.child("jobs").names() == ["j1"]
    assert model_place(place, "m1").exists("DONE")
    assert place.names() == ["jobs", "models", "runs", "trainbridge.sqlite"]


def test_rows_that_were_removed_are_not_read_as_nan(place: Place) -> None:
    plan = make_plan(40)
    writer = RunWriter(place, plan)
    for sample in samples_of(plan):
        writer.append(sample)
    writer.flush()
    reader = RunReader(place)
    name = plan.channels[0].name
    np.testing.assert_array_equal(reader.channel(name), np.arange(41.0))
    shards = place.child("live.zarr", "channels")
    for shard in shards.names():
        if shard.startswith("c."):
            shards.remove(shard)
    with pytest.raises(NotStoredError, match="removed"):
        reader.channel(name)
