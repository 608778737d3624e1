"""Disks that are full, read-only or broken, and object stores that are away."""

from __future__ import annotations

import errno
import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from obstore.exceptions import GenericError, PermissionDeniedError

from server.store import (
    RunReader,
    RunWriter,
    StoreError,
    StoreFullError,
    open_place,
    read_checkpoint,
)
from server.store import object_place as objects
from server.store.failures import explained
from tests.server.object_stores import object_store
from tests.server.store_case import make_plan, samples_of
from tests.server.store_process import SHARD_ROWS, fill_disk


def append_all(writer: RunWriter) -> None:
    """Appends what is left of a run."""
    for sample in samples_of(writer.plan, writer.expected_step):
        writer.append(sample)


def test_a_full_disk_is_named_and_what_was_committed_stays(tmp_path: Path) -> None:
    kind, text = fill_disk(tmp_path / "run")
    assert kind == "StoreFullError"
    assert "no room left" in text
    assert str(tmp_path / "run") in text
    assert "trainbridge clean" in text
    reader = RunReader(tmp_path / "run")
    assert reader.committed == 500 // SHARD_ROWS * SHARD_ROWS
    name = reader.plan.channels[1].name
    np.testing.assert_array_equal(reader.channel(name), np.arange(reader.committed) + 0.01)
    assert np.all(reader.frame(reader.committed_frames - 1).displacement > 0)
    checkpoint = read_checkpoint(tmp_path / "run")
    assert checkpoint is not None
    assert checkpoint.step == 400
    # Nothing unfinished takes the room that there is too little of.
    assert list((tmp_path / "run").rglob("*.partial")) == []


@pytest.mark.parametrize(
    ("code", "kind", "text"),
    [
        (errno.ENOSPC, StoreFullError, "no room left"),
        (errno.EDQUOT, StoreFullError, "no room left"),
        (errno.EROFS, StoreError, "right to write there"),
        (errno.EIO, StoreError, "Check the disk"),
    ],
)
def test_a_disk_that_refuses_for_a_while_can_be_gone_on_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: int, kind: type[StoreError], text: str
) -> None:
    writer = RunWriter(tmp_path / "1", make_plan(200))
    for sample in samples_of(writer.plan):
        if sample.step == 150:
            break
        writer.append(sample)
        if sample.step == 49:
            writer.flush()
    writer.checkpoint({"u": np.arange(3.0)})

    def refuse(*_: Any) -> None:
        raise OSError(code, os.strerror(code))

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", refuse)
        with pytest.raises(kind, match=text):
            writer.checkpoint({"u": np.arange(4.0)})
        with pytest.raises(kind, match=text):
            append_all(writer)
        writer.abort()
    assert RunReader(tmp_path / "1").committed == 150
    checkpoint = read_checkpoint(tmp_path / "1")
    assert checkpoint is not None
    assert list(checkpoint.state["u"]) == [0.0, 1.0, 2.0]
    again = RunWriter.resumed(tmp_path / "2", writer.plan, tmp_path / "1", checkpoint)
    append_all(again)
    again.finish({})
    np.testing.assert_array_equal(
        RunReader(tmp_path / "2").times(), [sample.time for sample in samples_of(writer.plan)]
    )


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(StoreError, match="file/store"):
        RunWriter(tmp_path / "file" / "store", make_plan(10))


def test_what_is_published_is_on_the_disk_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A power cut may lose everything that nobody waited for; markers must not outlive their data.
    synced: set[int] = set()
    markers: list[str] = []
    fsync, replace = os.fsync, os.replace

    def record(descriptor: int) -> None:
        fsync(descriptor)
        synced.add(os.fstat(descriptor).st_ino)

    def publish(source: Any, target: Any) -> None:
        if Path(target).parent == tmp_path and Path(target).name != "plan.json":
            below = [path for path in tmp_path.rglob("*") if path.name != "CLAIM"]
            lost = [path for path in below if path.stat().st_ino not in synced]
            assert lost == []
            markers.append(Path(target).name)
        replace(source, target)

    monkeypatch.setattr(os, "fsync", record)
    monkeypatch.setattr(os, "replace", publish)
    writer = RunWriter(tmp_path, make_plan(200))
    for sample in samples_of(writer.plan):
        writer.append(sample)
        if sample.step == 49:
            writer.flush()
        if sample.step == 75:
            writer.checkpoint({"u": np.arange(3.0)})
    writer.add_filtered({"f": np.zeros(201)})
    writer.finish({})
    commits = ["commit.json"] * 5  # 50, 100, 150, 200, 201 samples; once more for the long shards
    assert [name for name in markers if name == "commit.json"] == [*commits, "commit.json"]
    assert markers[1:3] == ["checkpoint", "commit.json"]
    assert markers[-2:] == ["summary.json", "DONE"]


def test_a_run_whose_folder_is_removed_ends_with_a_clear_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = RunWriter(tmp_path / "run", make_plan(200))
    samples = samples_of(writer.plan)
    writer.append(next(samples))

    def gone(*_: Any) -> None:
        raise FileNotFoundError(errno.ENOENT, "gone")

    monkeypatch.setattr(os, "fsync", gone)
    with pytest.raises(StoreError, match="was removed"):
        writer.flush()


def test_errors_travel_between_processes() -> None:
    error = pickle.loads(pickle.dumps(StoreFullError("full")))
    assert isinstance(error, StoreFullError)
    assert str(error) == "full"


@pytest.mark.parametrize(
    ("error", "kind", "text"),
    [
        (GenericError("Server returned error: 507 Insufficient Storage"), StoreFullError, "room"),
        (GenericError("<Code>XMinioStorageFull</Code>"), StoreFullError, "room"),
        (PermissionDeniedError("403"), StoreError, "AWS_ACCESS_KEY_ID"),
        (GenericError("error sending request"), StoreError, "AWS_ENDPOINT_URL"),
    ],
)
def test_what_object_stores_refuse_is_explained(
    error: Exception, kind: type[StoreError], text: str
) -> None:
    with pytest.raises(kind, match=text), explained("s3://bucket/x"):
        raise error


def test_an_object_store_that_goes_away_fails_the_run_clearly(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(objects, "_RETRY_SECONDS", 0.1)
    with object_store() as url:
        place = open_place(url).child("away")
        writer = RunWriter(place, make_plan(200))
        samples = samples_of(writer.plan)
        for _ in range(50):
            writer.append(next(samples))
        writer.flush()
        reader = RunReader(place)
        assert reader.committed == 50
        monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:9")
        with pytest.raises(StoreError, match="Check that it runs"):
            place.read("commit.json")
        with pytest.raises(StoreError, match="Check that it runs"):
            writer.checkpoint({})
