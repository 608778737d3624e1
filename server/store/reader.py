"""Reads a run's arrays, also while they are being written."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypeVar

import numpy as np

from server.store.documents import read_document
from server.store.failures import explained
from server.store.layout import (
    COMMIT,
    DONE,
    LIVE,
    RESULT,
    SUMMARY,
    array_layouts,
    open_group,
)
from server.store.place import Place, as_place
from server.store.plan import StoredPlan, read_plan
from solver.arrays import IntVector, Matrix, Vector
from solver.results import Frame, SlabPeaks

__all__ = ["Motion", "NotStoredError", "RunReader"]

_Values = TypeVar("_Values")

Motion: TypeAlias = Literal["velocity", "acceleration"]
"""What a frame may hold besides displacements."""

_FRAMES_AT_ONCE = 64
"""Frames of 50,000 vertices take 38 MB."""


class NotStoredError(LookupError):
    """What was asked for is not in the store (not yet, or not at all)."""


@dataclass(frozen=True)
class _Commit:
    group: str
    samples: int
    frames: int


class RunReader:
    """One attempt's plan, histories, frames and summary.

    Samples beyond the committed count do not exist for a reader, so that it never sees a part of
    a step; and what was committed is read whole, or ``NotStoredError`` says that the attempt was
    removed. All values are SI.
    """

    def __init__(self, place: Place | Path) -> None:
        """Opens nothing yet: a place that is still empty has nothing committed.

        Args:
            place: Of one attempt.
        """
        self.place = as_place(place)
        self._last_commit: _Commit | None = None
        self._seen = 0
        self._groups: dict[str, dict[str, Any]] = {}
        self._plan: StoredPlan | None = None

    @property
    def identity(self) -> str:
        """Differs between attempts at a run."""
        return self.place.url

    @property
    def plan(self) -> StoredPlan:
        """What was known before the first step.

        Raises:
            NotStoredError: The run has not come to its first step.
        """
        if self._plan is None:
            try:
                self._plan = read_plan(self.place)
            except (FileNotFoundError, KeyError) as error:
                raise self._removed() from error
        if self._plan is None:
            raise NotStoredError("The run has no histories yet.")
        return self._plan

    @property
    def has_plan(self) -> bool:
        """Whether the run has stated its plan."""
        try:
            return bool(self.plan)
        except NotStoredError:
            return False

    @property
    def committed(self) -> int:
        """Samples that can be read."""
        return self._commit().samples

    @property
    def committed_frames(self) -> int:
        """Frames that can be read."""
        return self._commit().frames

    @property
    def done(self) -> bool:
        """Whether the run ended and everything is stored."""
        return self.place.exists(DONE)

    @property
    def summary(self) -> dict[str, Any] | None:
        """Verdicts, peaks, timings, versions; None before the run has ended."""
        return read_document(self.place, SUMMARY)

    def times(self, start: int = 0, stop: int | None = None) -> Vector:
        """Times of the samples from ``start`` up to ``stop``. [s]"""
        return self._rows("time", start, stop, None)

    def channel(self, name: str, start: int = 0, stop: int | None = None) -> Vector:
        """One channel's history, SI.

        Raises:
            NotStoredError: There is no such channel.
        """
        return self._rows("channels", start, stop, self._column(name))

    def channel_rows(self, names: Sequence[str], start: int = 0, stop: int | None = None) -> Matrix:
        """Histories of several channels, shape (n_sample, n_name), SI.

        Raises:
            NotStoredError: There is no such channel.
        """
        columns = [self._column(name) for name in names]
        if not columns:
            return np.empty((len(self.times(start, stop)), 0))
        low = min(columns)
        block = self._rows("channels", start, stop, slice(low, max(columns) + 1))
        return np.ascontiguousarray(block[:, [column - low for column in columns]])

    def filtered(self, name: str) -> Vector:
        """A filtered history of a finished run, SI.

        Raises:
            NotStoredError: There is no such history.
        """

        def read(commit: _Commit) -> Vector:
            array = self._array(RESULT, "filtered") if commit.group == RESULT else None
            names = [] if array is None else list(array.attrs["names"])
            if array is None or name not in names:
                raise NotStoredError(f"There is no filtered history {name[:80]!r}.")
            return np.asarray(array[:, names.index(name)])

        return self._consistent(read)

    def frame_step(self, index: int) -> int:
        """The step of a frame."""
        return index * self.plan.frame_stride

    def frame(
        self, index: int, *, motion: Collection[Motion] = ("velocity", "acceleration")
    ) -> Frame:
        """The displaced state of a frame.

        Args:
            index: The frame.
            motion: What else is read of the vertices; each costs as much as the displacements.

        Raises:
            NotStoredError: The frame is not there (yet).
        """
        if not 0 <= index < self.committed_frames:
            raise NotStoredError(f"Frame {index} is not stored; there are {self.committed_frames}.")
        plan = self.plan
        n_vertex = plan.geometry.vertices.shape[0]
        read = motion if plan.frame_motion else ()
        return Frame(
            displacement=self._frame_values("frames", index, (n_vertex, 3)),
            bodies=self._frame_values("bodies", index, (len(plan.geometry.bodies), 3)),
            **{name: self._frame_values(name, index, (n_vertex,)) for name in read},
        )

    def heights(self, vertices: IntVector, frames: range) -> Matrix:
        """Upward displacements of some vertices in several frames.

        One of a frame's arrays is read, and in blocks: many times faster than frame by frame.

        Args:
            vertices: Indices, shape (n_vertex,).
            frames: Indices of committed frames.

        Returns:
            Shape (n_frame, n_vertex). [m]
        """
        blocks = [
            self._heights(vertices, frames[at : at + _FRAMES_AT_ONCE])
            for at in range(0, len(frames), _FRAMES_AT_ONCE)
        ]
        return np.concatenate(blocks) if blocks else np.empty((0, vertices.size))

    def _heights(self, vertices: IntVector, frames: range) -> Matrix:
        def read(commit: _Commit) -> Matrix:
            array = self._array(commit.group, "frames")
            if array is None:
                return np.zeros((len(frames), vertices.size))
            rows = array[frames.start : frames.stop : frames.step]
            return np.asarray(rows[:, vertices, 2], dtype=np.float64)

        return self._consistent(read)

    def slab_peaks(self) -> SlabPeaks | None:
        """Greatest |acceleration| of every slab point; None before a run is judged.

        Runs of before have none either.
        """

        def read(commit: _Commit) -> SlabPeaks | None:
            array = self._array(RESULT, "slab_peaks") if commit.group == RESULT else None
            if array is None:
                return None
            names = ("raw", "raw_time", "filtered", "filtered_time")
            return SlabPeaks(**dict(zip(names, np.asarray(array[...]), strict=False)))

        return self._consistent(read)

    def slab_point(self, index: int, start: int = 0, stop: int | None = None) -> Vector:
        """Vertical acceleration of one slab point. [m/s2]"""
        return self._rows("slab", start, stop, index)

    def slab_blocks(self, points_per_block: int) -> Iterator[tuple[IntVector, Matrix]]:
        """Accelerations of the slab's points, some points at a time, over all samples.

        Args:
            points_per_block: Points read together; multiples of 64 read every chunk once.

        Yields:
            Point indices, shape (n_block,), and histories, shape (n_sample, n_block). [m/s2]
        """
        n_point = int(self.plan.slab.coordinates.shape[0])
        for start in range(0, n_point, points_per_block):
            stop = min(start + points_per_block, n_point)
            indices = np.arange(start, stop, dtype=np.int64)
            yield indices, self._rows("slab", 0, None, slice(start, stop))

    def _column(self, name: str) -> int:
        try:
            return self._columns[name]
        except KeyError:
            raise NotStoredError(f"There is no channel {name[:80]!r}.") from None

    @cached_property
    def _columns(self) -> dict[str, int]:
        return {channel.name: index for index, channel in enumerate(self.plan.channels)}

    def _rows(self, name: str, start: int, stop: int | None, columns: int | slice | None) -> Any:
        def read(commit: _Commit) -> Any:
            last = commit.samples if stop is None else min(stop, commit.samples)
            first = max(0, min(start, last))
            rows: Any = slice(first, last)
            selection = rows if columns is None else (rows, columns)
            array = self._array(commit.group, name) if first < last else None
            if array is None:
                return np.empty(_empty_shape(columns))
            return np.asarray(array[selection], dtype=np.float64)

        return self._consistent(read)

    def _frame_values(self, name: str, index: int, shape: tuple[int, ...]) -> Any:
        def read(commit: _Commit) -> Any:
            array = self._array(commit.group, name)
            if array is None:
                return np.zeros(shape)
            return np.asarray(array[index], dtype=np.float64)

        return self._consistent(read)

    def _consistent(self, read: Callable[[_Commit], _Values]) -> _Values:
        """Reads again where the arrays were rewritten into long shards meanwhile.

        Raises:
            NotStoredError: The attempt was removed meanwhile: deleted, or replaced by a later one.
        """
        while True:
            # Asked first: another thread that reads here may see more meanwhile.
            seen = self._seen
            before = self._commit()
            if before.samples < seen:
                raise self._removed()
            self._seen = max(self._seen, before.samples)
            try:
                with explained(self.place.url):
                    return read(before)
            except (FileNotFoundError, KeyError) as error:
                after = self._commit()
                if after.group == before.group or after.samples < before.samples:
                    raise self._removed() from error

    def _commit(self) -> _Commit:
        if self._last_commit is not None:
            return self._last_commit
        document = read_document(self.place, COMMIT)
        if document is None:
            return _Commit(LIVE, 0, 0)
        commit = _Commit(document["group"], document["samples"], document["frames"])
        if commit.group == RESULT:  # the last one of an attempt
            self._last_commit = commit
        return commit

    def _removed(self) -> NotStoredError:
        return NotStoredError("The run's results were removed while they were read. Read again.")

    def _array(self, group: str, name: str) -> Any:
        """A stored array; None where the run has none of this name."""
        arrays = self._groups.setdefault(group, {})
        if name not in arrays:
            opened = open_group(self.place, group, "r")[0].get(name)
            if opened is None:
                if any(layout.name == name for layout in array_layouts(self.plan)):
                    raise FileNotFoundError(f"{self.place.url}/{group}/{name}")
                return None
            arrays[name] = opened
        return arrays[name]


def _empty_shape(columns: int | slice | None) -> tuple[int, ...]:
    if isinstance(columns, slice):
        return (0, columns.stop - columns.start)
    return (0,)
