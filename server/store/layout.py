"""Where a store keeps what. Below the store's place:

    runs/<run>/<attempt>/    one attempt at a run, the attempt in three digits
    jobs/<job>/              what a job's runs gave together
    models/<key>/            what the runs of a sweep share
    OWNER                    the database that knows what of this is needed

Below an attempt's:

    CLAIM          who computes it
    plan.json      what is known before the first step
    plan.zarr      its arrays: vertices, faces, wheels, slab points
    commit.json    how many samples a reader may read, and from which group
    live.zarr      until all is stored: short shards, each written once and whole
    checkpoint     while the run computes: everything that a new attempt goes on from
    result.zarr    when it has ended: the same arrays in long shards
    summary.json   verdicts, peaks, timings, versions
    DONE           the marker: everything above is complete

The arrays of ``live.zarr`` and ``result.zarr``, time first:

    time       float64  (n_sample,)                [s]
    channels   float64  (n_sample, n_channel)      SI
    slab       float32  (n_sample, n_point)        [m/s2]
    frames     float32  (n_frame, n_vertex, 3)     [m]
    bodies     float32  (n_frame, n_body, 3)       [m, rad, rad]
    velocity   float32  (n_frame, n_vertex)        [m/s], where the plan has frame_motion
    acceleration  likewise                         [m/s2]
    frame_step int64    (n_frame,)                 only in result.zarr
    filtered   float64  (n_sample, n_name)         only in result.zarr, SI
    slab_peaks float64  (2 or 4, n_point)          only in result.zarr [m/s2, s]: raw, its time,
                                                   then filtered and its time where it is judged
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import zarr
from zarr.codecs import BloscCodec

from server.store.place import Place
from solver.results import RunPlan

__all__ = [
    "CHECKPOINT",
    "COMMIT",
    "DONE",
    "JOBS",
    "LIVE",
    "MODELS",
    "PLAN",
    "PLAN_ARRAYS",
    "RESULT",
    "RUNS",
    "SUMMARY",
    "ArrayLayout",
    "array_layouts",
    "attempt_place",
    "create_array",
    "job_place",
    "model_place",
    "open_group",
    "run_place",
    "shard_key",
]

PLAN = "plan.json"
PLAN_ARRAYS = "plan.zarr"
COMMIT = "commit.json"
LIVE = "live.zarr"
RESULT = "result.zarr"
SUMMARY = "summary.json"
DONE = "DONE"
CHECKPOINT = "checkpoint"

RUNS = "runs"
JOBS = "jobs"
MODELS = "models"

_COLUMNS_PER_CHUNK = {"channels": 16, "slab": 64, "filtered": 1}
"""Columns read together: one channel is asked for at a time, slab points in blocks."""


@dataclass(frozen=True, kw_only=True)
class ArrayLayout:
    """Shape and type of one stored array.

    Attributes:
        name: As in the module's table.
        shape: Of the whole run.
        dtype: NumPy name.
        by_frame: Rows are frames, not samples.
    """

    name: str
    shape: tuple[int, ...]
    dtype: str
    by_frame: bool = False

    @property
    def row_bytes(self) -> int:
        """Size of one row. [B]"""
        size = 8 if self.dtype == "float64" else 4
        for extent in self.shape[1:]:
            size *= extent
        return size

    def chunk(self, rows: int) -> tuple[int, ...]:
        """The chunk inside a shard of so many rows."""
        if self.by_frame:
            return (1, *self.shape[1:])
        columns = _COLUMNS_PER_CHUNK.get(self.name)
        return (rows,) if columns is None else (rows, min(columns, self.shape[1]))

    def shard(self, rows: int) -> tuple[int, ...]:
        """The shard of so many rows: the chunk's width rounded up to hold every column."""
        chunk = self.chunk(rows)
        if self.by_frame or len(chunk) == 1:
            return (rows, *self.shape[1:])
        return (rows, -(-self.shape[1] // chunk[1]) * chunk[1])


def attempt_place(store: Place, run: str, attempt: int) -> Place:
    """The place of one attempt at a run."""
    return store.child(RUNS, run, f"{attempt:03d}")


def run_place(store: Place, run: str) -> Place:
    """The place of all attempts at a run."""
    return store.child(RUNS, run)


def job_place(store: Place, job: str) -> Place:
    """The place of what a job's runs gave together."""
    return store.child(JOBS, job)


def model_place(store: Place, key: str) -> Place:
    """The place of what the runs of a sweep share."""
    return store.child(MODELS, key)


def open_group(place: Place, name: str, mode: Literal["r", "w", "a"]) -> tuple[zarr.Group, Any]:
    """A Zarr group of a place, and the store under it (for ``place.sync``)."""
    store = place.zarr(name, read_only=mode == "r")
    return zarr.open_group(store, mode=mode, zarr_format=3), store


def shard_key(layout: ArrayLayout, index: int) -> str:
    """Name of the object that holds a shard: shards divide the first axis only."""
    return ".".join(["c", str(index), *["0"] * (len(layout.shape) - 1)])


def array_layouts(plan: RunPlan) -> tuple[ArrayLayout, ...]:
    """The arrays that a run fills; those without columns are left out."""
    n_vertex = int(plan.geometry.vertices.shape[0])
    samples, frames = plan.n_sample, plan.n_frame
    motion = ("velocity", "acceleration") if plan.frame_motion else ()
    arrays = (
        ArrayLayout(name="time", shape=(samples,), dtype="float64"),
        ArrayLayout(name="channels", shape=(samples, len(plan.channels)), dtype="float64"),
        ArrayLayout(
            name="slab", shape=(samples, int(plan.slab.coordinates.shape[0])), dtype="float32"
        ),
        ArrayLayout(name="frames", shape=(frames, n_vertex, 3), dtype="float32", by_frame=True),
        ArrayLayout(
            name="bodies",
            shape=(frames, len(plan.geometry.bodies), 3),
            dtype="float32",
            by_frame=True,
        ),
        *(
            ArrayLayout(name=name, shape=(frames, n_vertex), dtype="float32", by_frame=True)
            for name in motion
        ),
    )
    return tuple(array for array in arrays if all(array.shape))


def create_array(group: zarr.Group, layout: ArrayLayout, rows: int) -> Any:
    """Creates one array, its shape given from the start, in shards of so many rows."""
    rows = max(1, min(rows, layout.shape[0]))
    chunk, shard = layout.chunk(rows), layout.shard(rows)
    return group.create_array(
        layout.name,
        shape=layout.shape,
        dtype=layout.dtype,
        chunks=chunk,
        shards=None if shard == chunk else shard,
        compressors=BloscCodec(cname="zstd", clevel=1, shuffle="shuffle"),
        fill_value=float("nan"),
        # A shard is one object directly below its array, even where it holds nothing but NaN.
        chunk_key_encoding={"name": "default", "separator": "."},
        config={"write_empty_chunks": True},
        overwrite=True,
    )
