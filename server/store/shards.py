"""Rows that wait in memory and leave as whole shards."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import zarr
from numpy.typing import NDArray

from server.store.layout import ArrayLayout, create_array, shard_key
from server.store.place import Place

__all__ = ["ShardBuffer"]


class ShardBuffer:
    """Rows of some arrays that are written together, in shards of one length.

    The first flush fixes that length. A shard is written once: a reader takes its index and its
    chunks in two looks, and a shard replaced between them would be torn. So nothing may follow a
    shard that is not full.

    Attributes:
        base: Rows in shards.
        waiting: Rows in memory.
        capacity: Rows of a shard; the most that may wait, before the first flush.
        fixed: Whether the capacity cannot change any more.
        arrays: The Zarr arrays, by name; empty before the first flush.
    """

    def __init__(self, layouts: Sequence[ArrayLayout], rows: int) -> None:
        """Allocates the buffers: all the memory that waiting rows ever take.

        Args:
            layouts: The arrays.
            rows: Most rows of a shard.
        """
        self.layouts = {layout.name: layout for layout in layouts}
        self.base = self.waiting = 0
        self.capacity = max(1, rows)
        self.fixed = self.ended = False
        self.arrays: dict[str, Any] = {}
        self._rows = {
            layout.name: np.empty((self.capacity, *layout.shape[1:]), layout.dtype)
            for layout in layouts
        }

    @property
    def count(self) -> int:
        """Rows taken so far."""
        return self.base + self.waiting

    @property
    def nbytes(self) -> int:
        """Memory of the buffers. [B]"""
        return sum(rows.nbytes for rows in self._rows.values())

    @property
    def full(self) -> bool:
        """Whether a shard is complete."""
        return self.waiting >= self.capacity

    def put(self, values: Mapping[str, Any]) -> None:
        """Takes one row of each array."""
        for name, rows in self._rows.items():
            rows[self.waiting] = values[name]
        self.waiting += 1

    def rows(self) -> dict[str, NDArray[Any]]:
        """Copies of the rows that wait."""
        return {name: rows[: self.waiting].copy() for name, rows in self._rows.items()}

    def flush(self, group: zarr.Group) -> None:
        """Writes what waits as one shard an array; where that fails, it still waits."""
        if not self.waiting:
            return
        if not self.fixed:
            self.capacity, self.fixed = self.waiting, True
        if not self.arrays:
            self._create(group)
        stop = self.base + self.waiting
        for name, array in self.arrays.items():
            array[self.base : stop] = self._rows[name][: self.waiting]
        self.ended = self.waiting < self.capacity
        self.base, self.waiting = stop, 0

    def restore(
        self,
        group: zarr.Group,
        *,
        base: int,
        capacity: int,
        rows: Mapping[str, NDArray[Any]],
        source: Place,
        target: Place,
    ) -> None:
        """Takes over what another buffer had written and what waited in it.

        Args:
            group: Where this buffer writes.
            base: Rows in shards.
            capacity: Rows of a shard, 0 where there is none yet.
            rows: Rows that waited.
            source: Place of the group that the other buffer wrote.
            target: Place of ``group``.

        Raises:
            FileNotFoundError: A shard is missing.
            ValueError: The arrays are not the same ones.
        """
        self.fixed = capacity > 0
        self.capacity = capacity or self.capacity
        for name, layout in self.layouts.items():
            waiting = rows[name]
            if waiting.shape[1:] != layout.shape[1:] or waiting.dtype != layout.dtype:
                raise ValueError(f"the checkpoint's {name} are of another run")
            self._rows[name] = np.empty((self.capacity, *layout.shape[1:]), layout.dtype)
            self._rows[name][: len(waiting)] = waiting
            self.waiting = len(waiting)
        self.base = base
        if base:
            self._create(group)
            for name, layout in self.layouts.items():
                _copy_shards(source.child(name), target.child(name), layout, base // capacity)

    def _create(self, group: zarr.Group) -> None:
        self.arrays = {
            name: create_array(group, layout, self.capacity)
            for name, layout in self.layouts.items()
        }


def _copy_shards(source: Place, target: Place, layout: ArrayLayout, count: int) -> None:
    """Copies the first shards of an array as they are."""
    if source.read("zarr.json") != target.read("zarr.json"):
        raise ValueError(f"the stored {layout.name} are of another run or another version")
    for index in range(count):
        target.copy(source, shard_key(layout, index))
