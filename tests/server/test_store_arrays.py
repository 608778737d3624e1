"""Results on disk: what is written is read, in bounded memory, and never torn."""

from __future__ import annotations

import json
import shutil
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from server.store import NotStoredError, RunReader, RunWriter, SlabPeaks
from tests.server.store_case import N_VERTEX, make_plan, samples_of


@pytest.mark.slow
def test_what_is_written_is_read(tmp_path: Path) -> None:
    plan = make_plan(5000)
    writer = RunWriter(tmp_path / "run", plan)
    for sample in samples_of(plan):
        writer.append(sample)
    writer.finish({"peaks": {"contact force": np.float64(1.5), "none": float("nan")}})
    reader = RunReader(tmp_path / "run")

    assert reader.done
    assert reader.committed == 5001
    assert reader.committed_frames == 251
    assert reader.summary == {"peaks": {"contact force": 1.5, "none": None}}
    steps = np.arange(5001.0)
    np.testing.assert_array_equal(reader.times(), steps * 1e-3)
    np.testing.assert_array_equal(reader.channel("wheel 36 right/contact force"), steps + 0.36)
    rows = reader.channel_rows(["wheel 20 right/contact force", "wheel 02 right/contact force"], 9)
    np.testing.assert_array_equal(rows, (steps[9:, None] + np.array([0.20, 0.02])))
    np.testing.assert_allclose(reader.slab_point(149, 10, 12), [10.149, 11.149], rtol=1e-7)
    # In blocks of 64 frames: 150 of them cross two borders.
    heights = reader.heights(np.array([0, N_VERTEX - 1]), range(1, 151))
    np.testing.assert_array_equal(heights, np.outer(np.arange(20.0, 3001.0, 20.0), [1.0, 1.0]))
    assert reader.heights(np.array([0, 1]), range(0)).shape == (0, 2)
    frame = reader.frame(7)
    assert reader.frame_step(7) == 140
    assert frame.displacement.shape == (N_VERTEX, 3)
    assert np.all(frame.displacement == 140)
    assert np.all(frame.bodies == -140)
    # Single precision: seven digits.
    np.testing.assert_allclose(frame.velocity, 140.0 + np.arange(N_VERTEX) / 100.0, rtol=1e-7)
    np.testing.assert_allclose(frame.acceleration, -140.0 - np.arange(N_VERTEX) / 100.0, rtol=1e-7)
    blocks = list(reader.slab_blocks(64))
    assert [len(indices) for indices, _ in blocks] == [64, 64, 22]
    # Single precision at values of up to 5000.
    np.testing.assert_allclose(blocks[2][1][:, 21], steps + 0.149, rtol=1e-6)


def test_the_plan_comes_back_whole(tmp_path: Path) -> None:
    plan = make_plan(10)
    RunWriter(tmp_path / "run", plan)
    stored = RunReader(tmp_path / "run").plan

    assert stored.channels == plan.channels
    assert stored.facts == plan.facts
    assert stored.slab.named == plan.slab.named
    assert stored.geometry.bodies == plan.geometry.bodies
    assert stored.geometry.wheels.names == plan.geometry.wheels.names
    np.testing.assert_array_equal(stored.geometry.vertices, plan.geometry.vertices)
    np.testing.assert_array_equal(stored.geometry.layers[0].faces, plan.geometry.layers[0].faces)
    assert (stored.n_sample, stored.n_frame, stored.speed) == (11, 1, 120.0)
    assert (stored.modal, stored.frame_motion) == (False, True)


def test_a_run_of_before_has_frames_without_motion_and_no_slab_peaks(tmp_path: Path) -> None:
    """What was stored before plans knew of motion, of modes and of peaks."""
    plan = replace(make_plan(40), frame_motion=False)
    writer = RunWriter(tmp_path / "run", plan)
    for sample in samples_of(plan):
        frame = sample.frame and replace(sample.frame, velocity=None, acceleration=None)
        writer.append(replace(sample, frame=frame))
    writer.finish({})
    path = tmp_path / "run" / "plan.json"
    document = json.loads(path.read_text())
    for name in ("modal", "frame_motion"):
        del document[name]
    path.write_text(json.dumps(document))
    reader = RunReader(tmp_path / "run")

    assert not reader.plan.modal
    frame = reader.frame(1)
    assert np.all(frame.displacement == 20)
    assert frame.velocity is None
    assert frame.acceleration is None
    assert reader.slab_peaks() is None


@pytest.mark.parametrize("judged", [True, False])
def test_slab_peaks_come_back(tmp_path: Path, judged: bool) -> None:
    plan = make_plan(20)
    values = np.random.default_rng(1).uniform(0.0, 9.0, (4, 150))
    peaks = SlabPeaks(
        raw=values[0],
        raw_time=values[1],
        filtered=values[2] if judged else None,
        filtered_time=values[3] if judged else None,
    )
    writer = RunWriter(tmp_path / "run", plan)
    reader = RunReader(tmp_path / "run")
    for sample in samples_of(plan):
        writer.append(sample)
    writer.flush()
    assert reader.slab_peaks() is None, "not before the run is judged"
    writer.add_slab_peaks(peaks)
    writer.finish({})

    stored = reader.slab_peaks()
    assert stored is not None
    np.testing.assert_array_equal(stored.raw, values[0])
    np.testing.assert_array_equal(stored.raw_time, values[1])
    if judged:
        np.testing.assert_array_equal(stored.filtered, values[2])
        np.testing.assert_array_equal(stored.filtered_time, values[3])
    else:
        assert stored.filtered is None
        assert stored.filtered_time is None


@pytest.mark.parametrize(("n_vertex", "shards"), [(N_VERTEX, 1), (4000, 3)])
def test_small_frames_share_a_file_and_large_ones_do_not(
    tmp_path: Path, n_vertex: int, shards: int
) -> None:
    """A beam has hundreds of frames a second, each of four arrays: files for all of them would cost
    more than the run itself. A viaduct's frame leaves the memory at once."""
    plan = make_plan(40)
    plan = replace(plan, geometry=replace(plan.geometry, vertices=np.zeros((n_vertex, 3))))
    writer = RunWriter(tmp_path / "run", plan)
    for sample in samples_of(plan):
        frame = sample.frame and replace(
            sample.frame,
            displacement=np.full((n_vertex, 3), float(sample.step)),
            velocity=np.zeros(n_vertex),
            acceleration=np.zeros(n_vertex),
        )
        writer.append(replace(sample, frame=frame))
    writer.flush()
    live = tmp_path / "run" / "live.zarr" / "frames"
    assert len([file for file in live.rglob("c*") if file.is_file()]) == shards
    reader = RunReader(tmp_path / "run")
    assert reader.committed_frames == plan.n_frame == 3
    assert [reader.frame(index).displacement[0, 0] for index in range(3)] == [0.0, 20.0, 40.0]


def test_a_run_without_slab_or_frames_is_stored(tmp_path: Path) -> None:
    plan = make_plan(30, n_point=0)
    writer = RunWriter(tmp_path / "run", plan)
    for sample in samples_of(plan):
        writer.append(sample)
    writer.finish({})

    assert list(RunReader(tmp_path / "run").slab_blocks(64)) == []


@pytest.mark.slow
def test_memory_does_not_grow_with_steps(tmp_path: Path) -> None:
    held = []
    for n_step in (4000, 40_000):
        plan = make_plan(n_step, n_point=8)
        writer = RunWriter(tmp_path / str(n_step), plan)
        most = 0
        for sample in samples_of(plan):
            writer.append(sample)
            most = max(most, writer.buffered_rows)
        held.append((most, writer.buffer_bytes))
    assert held[0] == held[1]


def test_shards_follow_the_runs_own_pace(tmp_path: Path) -> None:
    # 0.1 s a step: the first shard closes after 2 s, and every later one after as many rows.
    plan = make_plan(100)
    now = 0.0
    writer = RunWriter(tmp_path / "run", plan, clock=lambda: now)
    reader = RunReader(tmp_path / "run")
    seen = set()
    for sample in samples_of(plan):
        now += 0.1
        writer.append(sample)
        seen.add(reader.committed)
    assert sorted(seen)[:3] == [0, 21, 42]


def test_an_aborted_run_can_be_read_up_to_its_end(tmp_path: Path) -> None:
    plan = make_plan(1000)
    writer = RunWriter(tmp_path / "run", plan)
    for sample in samples_of(plan):
        if sample.step == 333:
            break
        writer.append(sample)
    writer.abort()
    reader = RunReader(tmp_path / "run")

    assert reader.committed == 333
    assert not reader.done
    assert reader.channel("wheel 00 right/contact force")[-1] == 332


def test_a_shard_is_written_once(tmp_path: Path) -> None:
    # A second writing of the same shard could tear a concurrent reading.
    writer = RunWriter(tmp_path / "run", make_plan(5000))
    samples = samples_of(writer.plan)
    for _ in range(50):
        writer.append(next(samples))
    writer.flush()
    for _ in range(50):
        writer.append(next(samples))
    writer.flush()
    writer.append(next(samples))
    writer.flush()
    with pytest.raises(ValueError, match="sample 101"):
        writer.append(next(samples))


def test_filtered_histories_lie_beside_the_channels(tmp_path: Path) -> None:
    plan = make_plan(200)
    writer = RunWriter(tmp_path / "run", plan)
    for sample in samples_of(plan):
        writer.append(sample)
    name = "mid-span 2, axis/acceleration (filtered)"
    writer.add_filtered({name: np.linspace(0.0, 1.0, 201), "other": np.zeros(201)})
    writer.finish({})
    reader = RunReader(tmp_path / "run")

    np.testing.assert_array_equal(reader.filtered(name), np.linspace(0.0, 1.0, 201))
    with pytest.raises(NotStoredError, match="no filtered history"):
        reader.filtered("mid-span 2, axis/acceleration")


def test_unknown_things_are_refused(tmp_path: Path) -> None:
    reader = RunReader(tmp_path / "run")
    assert reader.committed == 0
    assert not reader.has_plan
    with pytest.raises(NotStoredError, match="no histories yet"):
        _ = reader.plan
    RunWriter(tmp_path / "run", make_plan(10))
    with pytest.raises(NotStoredError, match="no channel"):
        reader.channel("nothing")
    with pytest.raises(NotStoredError, match="Frame 0"):
        reader.frame(0)


@pytest.mark.slow
def test_a_reader_beside_the_writer_never_sees_a_torn_step(tmp_path: Path) -> None:
    # The rewriting into long shards happens under the reader's hands as well.
    plan = make_plan(2000, n_point=8)
    # Shards are as long as the first flush makes them, however slow the machine is.
    writer = RunWriter(tmp_path / "run", plan, clock=lambda: 0.0)
    failures: list[str] = []
    ended = threading.Event()

    def read() -> None:
        reader = RunReader(tmp_path / "run")
        while not ended.is_set():
            committed = reader.committed
            history = reader.channel("wheel 00 right/contact force", 0, committed)
            if not np.array_equal(history, np.arange(float(committed))):
                failures.append(f"{committed} samples")

    thread = threading.Thread(target=read)
    thread.start()
    try:
        for sample in samples_of(plan):
            writer.append(sample)
            if sample.step == 96:
                writer.flush()
        writer.finish({})
    finally:
        ended.set()
        thread.join()
    assert failures == []


def test_live_arrays_give_way_to_long_ones(tmp_path: Path) -> None:
    plan = make_plan(300)
    writer = RunWriter(tmp_path / "run", plan)
    for sample in samples_of(plan):
        writer.append(sample)
    writer.finish({})
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert names == {
        "plan.json",
        "plan.zarr",
        "commit.json",
        "result.zarr",
        "summary.json",
        "DONE",
    }
    assert json.loads((tmp_path / "run" / "commit.json").read_text())["samples"] == 301


@pytest.mark.parametrize("sealed", [False, True])
@pytest.mark.parametrize("leaves", ["nothing", "commit", "all but shards"])
def test_an_attempt_removed_under_its_reader_is_said_to_be_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sealed: bool, leaves: str
) -> None:
    """Zarr alone would give NaN for every row."""
    plan = make_plan(300)
    writer = RunWriter(tmp_path / "run", plan)
    for sample in samples_of(plan):
        writer.append(sample)
    if sealed:
        writer.finish({})
    else:
        writer.flush()
    name = "wheel 00 right/contact force"
    look = RunReader._commit  # pyright: ignore[reportPrivateUsage]

    def remove() -> None:
        if leaves == "nothing":
            shutil.rmtree(tmp_path / "run", ignore_errors=True)
        elif leaves == "commit":
            for group in ("live.zarr", "result.zarr"):
                shutil.rmtree(tmp_path / "run" / group, ignore_errors=True)
        else:
            for shard in (tmp_path / "run").rglob("c.*"):
                shard.unlink()

    def removed_after(reader: RunReader) -> Any:
        commit = look(reader)
        remove()
        return commit

    readers = [RunReader(tmp_path / "run") for _ in range(2)]
    assert np.all(np.isfinite(readers[0].channel(name)))
    assert np.all(readers[0].frame(3).displacement == 60)
    with monkeypatch.context() as patch:
        patch.setattr(RunReader, "_commit", removed_after)
        for reader in readers:
            with pytest.raises(NotStoredError):
                reader.channel(name)
    with pytest.raises(NotStoredError):
        readers[0].times()
    with pytest.raises(NotStoredError):
        readers[0].frame(3)
