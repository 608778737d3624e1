"""Writes a run's samples as they are computed, in bounded memory.

Rows gather in buffers of a fixed size and leave as whole shards. A shard's length is chosen from
the run's own pace, so that one fills in a few seconds; at the end the arrays are rewritten into
long shards, from which one channel or one frame is read quickly.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from server.store.documents import write_document
from server.store.layout import (
    COMMIT,
    DONE,
    LIVE,
    RESULT,
    SUMMARY,
    ArrayLayout,
    array_layouts,
    create_array,
)
from server.store.plan import write_plan
from solver.arrays import Vector
from solver.results import Frame, RunPlan, Sample

__all__ = ["RunWriter", "write_summary"]

_BUFFER_BYTES = 32 * 1024 * 1024
"""Most memory that waiting rows take. [B]"""
_BUFFER_ROWS = 2048
"""Most rows that wait, where rows are short."""
_SHARD_SECONDS = 2.0
"""A shard's length is what the first rows reach in this time: a run that slows down to less than
half its pace still fills one within 5 s. [s]"""
_LONG_SHARD_BYTES = 64 * 1024 * 1024
"""Size of the final shards, and memory of the rewriting. [B]"""
_LONG_SHARD_ROWS = 16384


class RunWriter:
    """Stores one attempt at a run.

    Example:
        writer = RunWriter(folder, simulation.plan)
        for sample in simulation.samples():
            writer.append(sample)
        writer.seal()
        writer.finish(summary)
    """

    def __init__(
        self,
        folder: Path,
        plan: RunPlan,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Creates the folder and stores the plan.

        Args:
            folder: Of this attempt; anything left in it by an earlier one is removed.
            plan: The run's plan.
            clock: Time that sets the shards' length. [s]
        """
        self.folder = folder
        self.plan = plan
        self._clock = clock
        self._layouts = {layout.name: layout for layout in array_layouts(plan)}
        self._by_sample = [item for item in self._layouts.values() if not item.by_frame]
        row_bytes = sum(layout.row_bytes for layout in self._by_sample)
        self._capacity = max(1, min(_BUFFER_ROWS, _BUFFER_BYTES // row_bytes, plan.n_sample))
        self._buffers = {
            layout.name: np.empty((self._capacity, *layout.shape[1:]), layout.dtype)
            for layout in self._by_sample
        }
        self._arrays: dict[str, Any] = {}
        self._started: float | None = None
        self._base = self._waiting = self._frames = 0
        self._ended = self._sealed = False
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        write_plan(folder, plan)
        self._group = zarr.open_group(folder / LIVE, mode="w")
        self._frame_arrays = {
            layout.name: create_array(self._group, layout, 1)
            for layout in self._layouts.values()
            if layout.by_frame
        }

    @property
    def buffered_rows(self) -> int:
        """Rows that wait in memory."""
        return self._waiting

    @property
    def buffer_bytes(self) -> int:
        """Memory of the buffers: fixed when the writer is made. [B]"""
        return sum(buffer.nbytes for buffer in self._buffers.values())

    def append(self, sample: Sample) -> None:
        """Takes one sample; writes a shard when it is full.

        Raises:
            ValueError: The sample is not the next one, or its frame is missing or out of turn.
        """
        expected = self._base + self._waiting
        if self._ended or sample.step != expected:
            raise ValueError(f"sample {sample.step} came where {expected} was expected")
        if self._started is None:
            self._started = self._clock()
        row = self._waiting
        self._buffers["time"][row] = sample.time
        for name, values in (("channels", sample.channels), ("slab", sample.slab)):
            if name in self._buffers:
                self._buffers[name][row] = values
        if sample.frame is not None:
            self._append_frame(sample.step, sample.frame)
        self._waiting += 1
        if self._waiting >= self._capacity or self._pace_is_known():
            self.flush()

    def flush(self) -> None:
        """Writes and publishes what waits; the first flush fixes the shards' length.

        A shard is written once: a reader takes its index and its chunks in two looks, and a shard
        replaced between them would be torn. So no sample may follow a shard that is not full.
        """
        if not self._waiting:
            return
        if not self._arrays:
            self._capacity = self._waiting
            self._arrays = {
                layout.name: create_array(self._group, layout, self._capacity)
                for layout in self._by_sample
            }
        stop = self._base + self._waiting
        for name, array in self._arrays.items():
            array[self._base : stop] = self._buffers[name][: self._waiting]
        self._ended = self._waiting < self._capacity
        self._base, self._waiting = stop, 0
        self._publish(LIVE, stop)

    def seal(self) -> None:
        """Writes the rest and rewrites every array into long shards."""
        if self._sealed:
            return
        self.flush()
        committed = self._base
        group = zarr.open_group(self.folder / RESULT, mode="w")
        for layout in self._layouts.values():
            source = self._frame_arrays if layout.by_frame else self._arrays
            filled = self._frames if layout.by_frame else committed
            if layout.name in source:
                _rewrite(group, layout, source[layout.name], filled)
        group.create_array(
            "frame_step", data=np.arange(self.plan.n_frame, dtype=np.int64) * self.plan.frame_stride
        )
        self._sealed = True
        self._publish(RESULT, committed)
        # Only now: a reader that still looked at the short shards sees the new group and reads
        # again.
        shutil.rmtree(self.folder / LIVE, ignore_errors=True)

    def add_filtered(self, histories: Mapping[str, Vector]) -> None:
        """Stores filtered histories of the whole run beside the channels, by name, SI."""
        self.seal()
        if not histories:
            return
        names = list(histories)
        layout = ArrayLayout(
            name="filtered", shape=(self.plan.n_sample, len(names)), dtype="float64"
        )
        group = zarr.open_group(self.folder / RESULT, mode="a")
        array = create_array(group, layout, _LONG_SHARD_ROWS)
        array[:] = np.column_stack([histories[name] for name in names])
        array.attrs["names"] = names

    def finish(self, summary: Mapping[str, Any]) -> None:
        """Seals the arrays, stores the summary and sets the marker that all of it is there."""
        self.seal()
        write_summary(self.folder, summary)

    def abort(self) -> None:
        """Publishes what waits, so that an interrupted run can be looked at up to its end."""
        if not self._sealed:
            self.flush()

    def _append_frame(self, step: int, frame: Frame) -> None:
        if step != self._frames * self.plan.frame_stride:
            raise ValueError(f"the frame of step {step} came out of turn")
        for name, values in (("frames", frame.displacement), ("bodies", frame.bodies)):
            if name in self._frame_arrays:
                self._frame_arrays[name][self._frames] = values.astype(np.float32)
        self._frames += 1

    def _pace_is_known(self) -> bool:
        if self._arrays or self._started is None:
            return False
        return self._clock() - self._started >= _SHARD_SECONDS

    def _publish(self, group: str, samples: int) -> None:
        document = {"group": group, "samples": samples, "frames": self._frames}
        write_document(self.folder / COMMIT, document)


def write_summary(folder: Path, summary: Mapping[str, Any]) -> None:
    """Stores a summary and marks the folder as complete, also on the disk itself."""
    folder.mkdir(parents=True, exist_ok=True)
    write_document(folder / SUMMARY, summary)
    for path in folder.rglob("*"):
        if path.is_file():
            with path.open("rb") as file:
                os.fsync(file.fileno())
    write_document(folder / DONE, {"files": "complete"})


def _rewrite(group: zarr.Group, layout: ArrayLayout, source: Any, filled: int) -> None:
    rows = max(1, min(_LONG_SHARD_ROWS, _LONG_SHARD_BYTES // layout.row_bytes))
    target = create_array(group, layout, rows)
    for start in range(0, filled, rows):
        stop = min(start + rows, filled)
        target[start:stop] = source[start:stop]
