"""A run that goes on from a checkpoint is stored exactly as one that was never interrupted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from server.store import (
    CheckpointError,
    RunReader,
    RunWriter,
    claim,
    open_place,
    read_checkpoint,
)
from server.store.packing import pack, unpack
from tests.server.store_case import make_plan, samples_of

STATE = {
    "motions/0/displacement": np.array([1.0, -0.0, np.nan]),
    "extremes/0": np.array(3.5),
    "statuses": np.array([True, False]),
    "empty": np.empty((0, 3), np.int64),
}


def write(writer: RunWriter, stop: int, flushes: tuple[int, ...] = ()) -> None:
    """Appends the samples up to ``stop``, flushing after some."""
    for sample in samples_of(writer.plan, writer.expected_step):
        if sample.step == stop:
            break
        writer.append(sample)
        if sample.step in flushes:
            writer.flush()


def stored(folder: Path) -> dict[str, Any]:
    """Everything that a reader gets of a finished run."""
    reader = RunReader(folder)
    plan = reader.plan
    assert reader.done
    return {
        "times": reader.times(),
        "channels": reader.channel_rows([channel.name for channel in plan.channels]),
        "slab": next(iter(reader.slab_blocks(1000)))[1],
        "frames": np.array([reader.frame(i).displacement for i in range(plan.n_frame)]),
        "velocity": np.array([reader.frame(i).velocity for i in range(plan.n_frame)]),
        "acceleration": np.array([reader.frame(i).acceleration for i in range(plan.n_frame)]),
        "bodies": np.array([reader.frame(i).bodies for i in range(plan.n_frame)]),
        "counts": np.array([reader.committed, reader.committed_frames]),
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stops", "flushes"),
    [
        ((1,), ()),  # nothing in shards yet
        ((97,), (96,)),  # exactly at the end of a shard
        ((450, 451, 980), (96,)),  # in the middle of shards, one step later, and near the end
        ((1001,), (96,)),  # after the last step
    ],
)
def test_a_resumed_run_is_stored_as_an_uninterrupted_one(
    tmp_path: Path, stops: tuple[int, ...], flushes: tuple[int, ...]
) -> None:
    plan = make_plan(1000)
    whole = RunWriter(tmp_path / "whole", plan)
    write(whole, plan.n_sample, flushes)
    whole.finish({})

    writer = RunWriter(tmp_path / "0", plan)
    for attempt, stop in enumerate(stops, start=1):
        write(writer, stop, flushes)
        writer.checkpoint(STATE)
        # What comes after the checkpoint is computed again.
        write(writer, min(stop + 60, plan.n_sample))
        writer.abort()
        previous = tmp_path / str(attempt - 1)
        checkpoint = read_checkpoint(previous)
        assert checkpoint is not None
        assert checkpoint.step == stop - 1
        writer = RunWriter.resumed(tmp_path / str(attempt), plan, previous, checkpoint)
        assert writer.expected_step == stop
        open_place(previous).remove()
    write(writer, plan.n_sample, flushes)
    writer.finish({})

    expected, found = stored(tmp_path / "whole"), stored(tmp_path / str(len(stops)))
    for name, values in expected.items():
        np.testing.assert_array_equal(found[name], values, err_msg=name)


def test_the_state_comes_back_bit_for_bit(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path, make_plan(100))
    write(writer, 30)
    writer.checkpoint(STATE)
    checkpoint = read_checkpoint(tmp_path)
    assert checkpoint is not None
    assert list(checkpoint.state) == list(STATE)
    for name, values in STATE.items():
        assert checkpoint.state[name].tobytes() == values.tobytes()
        assert checkpoint.state[name].shape == values.shape
        assert checkpoint.state[name].dtype == values.dtype


def test_a_resumed_attempt_has_a_checkpoint_of_its_own(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path / "1", make_plan(200))
    write(writer, 130, (40,))
    writer.checkpoint(STATE)
    first = read_checkpoint(tmp_path / "1")
    assert first is not None
    RunWriter.resumed(tmp_path / "2", writer.plan, tmp_path / "1", first)
    second = read_checkpoint(tmp_path / "2")
    assert second is not None
    assert second.step == 129
    assert (second.samples.base, second.samples.capacity) == (123, 41)
    # The samples that were published stay published.
    assert RunReader(tmp_path / "2").committed == 123


def test_a_damaged_checkpoint_is_none(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path, make_plan(100))
    assert read_checkpoint(tmp_path) is None
    write(writer, 30)
    writer.checkpoint(STATE)
    path = tmp_path / "checkpoint"
    whole = path.read_bytes()
    for damaged in (b"", whole[:10], whole[:-1], whole[:-5] + b"\0" + whole[-4:], b"x" + whole):
        path.write_bytes(damaged)
        assert read_checkpoint(tmp_path) is None
    path.write_bytes(whole)
    assert read_checkpoint(tmp_path) is not None


def test_python_objects_are_neither_stored_nor_read() -> None:
    with pytest.raises(ValueError, match=r"[Oo]bject"):
        pack({"thing": np.array([{}], dtype=object)})
    assert unpack(b"\x80\x04N.") is None


def test_an_earlier_attempt_of_another_run_is_refused(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path / "1", make_plan(200))
    write(writer, 130, (40,))
    writer.checkpoint(STATE)
    checkpoint = read_checkpoint(tmp_path / "1")
    assert checkpoint is not None
    for plan in (make_plan(200, n_point=5), make_plan(300)):
        with pytest.raises(CheckpointError, match="from its beginning"):
            RunWriter.resumed(tmp_path / "2", plan, tmp_path / "1", checkpoint)
    open_place(tmp_path / "1" / "live.zarr").remove()
    with pytest.raises(CheckpointError, match="from its beginning"):
        RunWriter.resumed(tmp_path / "2", writer.plan, tmp_path / "1", checkpoint)


def test_a_run_that_was_killed_while_it_was_sealed_goes_on(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path / "1", make_plan(200))
    write(writer, 130, (40,))
    writer.checkpoint(STATE)
    write(writer, 201)
    writer.seal()
    checkpoint = read_checkpoint(tmp_path / "1")
    assert checkpoint is not None
    again = RunWriter.resumed(tmp_path / "2", writer.plan, tmp_path / "1", checkpoint)
    write(again, 201)
    again.finish({})
    assert RunReader(tmp_path / "2").committed == 201
    with pytest.raises(ValueError, match="nothing that a checkpoint"):
        again.checkpoint(STATE)


def test_only_one_worker_has_the_claim_and_it_outlives_the_writers_start(tmp_path: Path) -> None:
    place = open_place(tmp_path / "run" / "001")
    assert claim(place, "worker 1")
    RunWriter(place, make_plan(10))
    assert not claim(place, "worker 2")
    assert place.read("CLAIM") == b"worker 1"
