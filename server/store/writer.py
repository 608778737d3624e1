"""Writes a run's samples as they are computed, in bounded memory.

Rows gather in buffers of a fixed size and leave as whole shards. A shard's length is chosen from
the run's own pace, so that one fills in a few seconds; at the end the arrays are rewritten into
long shards, from which one channel or one frame is read quickly. On a local disk a large frame is a
shard of its own; small ones, of which a beam has hundreds a second, and those in an object store,
where every object costs a request, gather like rows.

What a power cut leaves: everything that ``commit.json``, ``checkpoint`` or ``DONE`` speaks of is
on the disk before they are.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from numpy.typing import NDArray

from server.store.checkpoint import Checkpoint, WaitingRows, write_checkpoint
from server.store.documents import write_document
from server.store.failures import CheckpointError, StoreError, explained, explained_writing
from server.store.layout import (
    CHECKPOINT,
    COMMIT,
    DONE,
    LIVE,
    RESULT,
    SUMMARY,
    ArrayLayout,
    array_layouts,
    create_array,
    open_group,
)
from server.store.place import CLAIM, Place, as_place
from server.store.plan import write_plan
from server.store.shards import ShardBuffer
from solver.arrays import Vector
from solver.results import Frame, RunPlan, Sample, SlabPeaks

__all__ = ["RunWriter", "write_summary"]

_BUFFER_BYTES = 32 * 1024 * 1024
"""Most memory that waiting rows take, and waiting frames. [B]"""
_BUFFER_ROWS = 2048
"""Most rows that wait, where rows are short."""
_SHARD_SECONDS = 2.0
"""A shard's length is what the first rows reach in this time: a run that slows down to less than
half its pace still fills one within 5 s. [s]"""
_LOCAL_FRAMES_BYTES = 64 * 1024
"""Frames of a shard on a local disk: making its files takes as long as writing so much. [B]"""
_LONG_SHARD_BYTES = 64 * 1024 * 1024
"""Size of the final shards, and memory of the rewriting. [B]"""
_LONG_SHARD_ROWS = 16384


class RunWriter:
    """Stores one attempt at a run.

    Every method that writes raises ``StoreError`` where the store fails and ``StoreFullError``
    where it is full; what was committed before stays readable.

    Example:
        writer = RunWriter(place, simulation.plan)
        for sample in simulation.samples():
            writer.append(sample)
        writer.seal()
        writer.finish(summary)
    """

    def __init__(
        self,
        place: Place | Path,
        plan: RunPlan,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Empties the place (but for its claim) and stores the plan.

        Args:
            place: Of this attempt.
            plan: The run's plan.
            clock: Time that sets the shards' length. [s]
        """
        self.place = as_place(place)
        self.plan = plan
        self._clock = clock
        self._started: float | None = None
        self._sealed = False
        self._layouts = array_layouts(plan)
        self._samples = _sample_buffer(plan, self._layouts)
        self._frames = _frame_buffer(plan, self._layouts, local=self.place.local is not None)
        with self._writing():
            for name in self.place.names():
                if name != CLAIM:
                    self.place.remove(name)
            write_plan(self.place, plan)
            self._group, self._store = open_group(self.place, LIVE, "w")

    @classmethod
    def resumed(
        cls,
        place: Place | Path,
        plan: RunPlan,
        previous: Place | Path,
        checkpoint: Checkpoint,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> RunWriter:
        """A writer that goes on where an earlier attempt's checkpoint stands.

        What that attempt had stored up to its checkpoint is taken over (shards that never change,
        so that it does not matter if it still writes), with a checkpoint of its own: this attempt
        does not need the earlier one any more. The next sample is ``checkpoint.step + 1``.

        Args:
            place: Of this attempt.
            plan: The run's plan, the same as before.
            previous: Place of the earlier attempt.
            checkpoint: As ``read_checkpoint(previous)`` gave it.
            clock: Time that sets the shards' length. [s]

        Raises:
            CheckpointError: The earlier attempt's shards are gone or of another run: begin anew.
            StoreError: The store fails.
        """
        writer = cls(place, plan, clock=clock)
        source, target = as_place(previous).child(LIVE), writer.place.child(LIVE)
        try:
            with explained(writer.place.url):
                for buffer, stood in (
                    (writer._samples, checkpoint.samples),
                    (writer._frames, checkpoint.frames),
                ):
                    buffer.restore(
                        writer._group,
                        base=stood.base,
                        capacity=stood.capacity,
                        rows=stood.rows,
                        source=source,
                        target=target,
                    )
        except (FileNotFoundError, KeyError, ValueError) as error:
            raise CheckpointError(
                f"The checkpoint of step {checkpoint.step} at {as_place(previous).url} cannot be "
                f"continued ({error}). Compute the run from its beginning."
            ) from error
        writer._publish(LIVE)
        writer.checkpoint(checkpoint.state)
        return writer

    @property
    def expected_step(self) -> int:
        """The step of the next sample."""
        return self._samples.count

    @property
    def buffered_rows(self) -> int:
        """Rows that wait in memory."""
        return self._samples.waiting

    @property
    def buffer_bytes(self) -> int:
        """Memory of the buffers: fixed when the writer is made. [B]"""
        return self._samples.nbytes + self._frames.nbytes

    def append(self, sample: Sample) -> None:
        """Takes one sample; writes a shard when it is full.

        Raises:
            ValueError: The sample is not the next one, or its frame is missing or out of turn.
        """
        expected = self.expected_step
        if self._sealed or self._samples.ended or sample.step != expected:
            raise ValueError(f"sample {sample.step} came where {expected} was expected")
        if self._started is None:
            self._started = self._clock()
        if sample.frame is not None:
            self._append_frame(sample.step, sample.frame)
        self._samples.put({"time": sample.time, "channels": sample.channels, "slab": sample.slab})
        if self._samples.full or self._pace_is_known():
            self.flush()

    def flush(self) -> None:
        """Writes and publishes what waits; the first flush fixes the shards' length."""
        if not self._samples.waiting:
            return
        with self._writing():
            self._samples.flush(self._group)
            if self._samples.ended or not self._frames.fixed:
                self._frames.flush(self._group)
        self._publish(LIVE)

    def checkpoint(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Stores everything that a new attempt needs to go on after the last sample.

        Args:
            state: Of the simulation at the last sample, as ``Simulation.state`` gives it.

        Raises:
            ValueError: No sample can follow the last one, or there is none yet.
        """
        if self._sealed or self._samples.ended or not self._samples.count:
            raise ValueError("there is nothing that a checkpoint could go on from")
        with self._writing():
            self.place.sync(self._store)
        write_checkpoint(
            self.place,
            Checkpoint(
                step=self.expected_step - 1,
                state=state,
                samples=_standing(self._samples),
                frames=_standing(self._frames),
            ),
        )

    def seal(self) -> None:
        """Writes the rest and rewrites every array into long shards.

        The short ones stay until ``finish``: an attempt that is killed before goes on from them.
        """
        if self._sealed:
            return
        self._flush_all()
        with self._writing():
            group, store = open_group(self.place, RESULT, "w")
            for buffer in (self._samples, self._frames):
                for name, array in buffer.arrays.items():
                    _rewrite(group, buffer.layouts[name], array, buffer.base)
            steps = np.arange(self.plan.n_frame, dtype=np.int64) * self.plan.frame_stride
            group.create_array("frame_step", data=steps)
            self.place.sync(store)
        self._sealed = True
        self._publish(RESULT)

    def add_filtered(self, histories: Mapping[str, Vector]) -> None:
        """Stores filtered histories of the whole run beside the channels, by name, SI."""
        self.seal()
        if not histories:
            return
        names = list(histories)
        layout = ArrayLayout(
            name="filtered", shape=(self.plan.n_sample, len(names)), dtype="float64"
        )
        with self._writing():
            group, store = open_group(self.place, RESULT, "a")
            array = create_array(group, layout, _LONG_SHARD_ROWS)
            array[:] = np.column_stack([histories[name] for name in names])
            array.attrs["names"] = names
            self.place.sync(store)

    def add_slab_peaks(self, peaks: SlabPeaks) -> None:
        """Stores the greatest accelerations of the slab's points."""
        self.seal()
        rows = [peaks.raw, peaks.raw_time, peaks.filtered, peaks.filtered_time]
        values = np.array([row for row in rows if row is not None])
        if not values.size:
            return
        with self._writing():
            group, store = open_group(self.place, RESULT, "a")
            group.create_array("slab_peaks", data=values)
            self.place.sync(store)

    def finish(self, summary: Mapping[str, Any]) -> None:
        """Seals the arrays, stores the summary and sets the marker that all of it is there."""
        self.seal()
        write_summary(self.place, summary)
        # Only now: a reader that still looked at the short shards sees the new group and reads
        # again, and nobody goes on from a run that is done.
        self.place.remove(CHECKPOINT)
        self.place.remove(LIVE)

    def abort(self) -> None:
        """Publishes what waits, so that an interrupted run can be looked at up to its end."""
        if self._sealed:
            return
        # What interrupted the run is what people shall read, not that the rest has no room.
        with suppress(StoreError):
            self._flush_all()

    def _flush_all(self) -> None:
        self.flush()
        if self._frames.waiting:
            with self._writing():
                self._frames.flush(self._group)
            self._publish(LIVE)

    def _append_frame(self, step: int, frame: Frame) -> None:
        if step != self._frames.count * self.plan.frame_stride:
            raise ValueError(f"the frame of step {step} came out of turn")
        values = {
            "frames": frame.displacement,
            "bodies": frame.bodies,
            "velocity": frame.velocity,
            "acceleration": frame.acceleration,
        }
        self._frames.put(values)
        if self._frames.full:
            with self._writing():
                self._frames.flush(self._group)

    def _pace_is_known(self) -> bool:
        if self._samples.fixed or self._started is None:
            return False
        return self._clock() - self._started >= _SHARD_SECONDS

    def _publish(self, group: str) -> None:
        """Says what can be read, after it is on the disk."""
        document = {"group": group, "samples": self._samples.base, "frames": self._frames.base}
        with self._writing():
            self.place.sync(self._store)
            write_document(self.place, COMMIT, document)

    def _writing(self) -> AbstractContextManager[None]:
        return explained_writing(self.place.url)


def write_summary(place: Place | Path, summary: Mapping[str, Any]) -> None:
    """Stores a summary and then the marker that all of the attempt is there."""
    place = as_place(place)
    write_document(place, SUMMARY, summary)
    write_document(place, DONE, {"files": "complete"})


def _sample_buffer(plan: RunPlan, layouts: tuple[ArrayLayout, ...]) -> ShardBuffer:
    chosen = [layout for layout in layouts if not layout.by_frame]
    row_bytes = sum(layout.row_bytes for layout in chosen)
    return ShardBuffer(chosen, min(_BUFFER_ROWS, _BUFFER_BYTES // row_bytes, plan.n_sample))


def _frame_buffer(plan: RunPlan, layouts: tuple[ArrayLayout, ...], *, local: bool) -> ShardBuffer:
    chosen = [layout for layout in layouts if layout.by_frame]
    row_bytes = sum(layout.row_bytes for layout in chosen)
    if not row_bytes:
        return ShardBuffer(chosen, 1)
    if local:
        return ShardBuffer(chosen, min(_BUFFER_ROWS, -(-_LOCAL_FRAMES_BYTES // row_bytes)))
    return ShardBuffer(chosen, min(_BUFFER_ROWS, _BUFFER_BYTES // row_bytes, plan.n_frame))


def _standing(buffer: ShardBuffer) -> WaitingRows:
    return WaitingRows(
        base=buffer.base, capacity=buffer.capacity if buffer.fixed else 0, rows=buffer.rows()
    )


def _rewrite(group: zarr.Group, layout: ArrayLayout, source: Any, filled: int) -> None:
    rows = max(1, min(_LONG_SHARD_ROWS, _LONG_SHARD_BYTES // layout.row_bytes))
    target = create_array(group, layout, rows)
    for start in range(0, filled, rows):
        stop = min(start + rows, filled)
        target[start:stop] = source[start:stop]
