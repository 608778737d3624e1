"""A checkpoint: one document from which a run goes on as if nothing had happened."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from server.store.layout import CHECKPOINT, attempt_place
from server.store.packing import pack, unpack
from server.store.place import Place, as_place

__all__ = [
    "Checkpoint",
    "WaitingRows",
    "earlier_checkpoints",
    "read_checkpoint",
    "write_checkpoint",
]

_NUMBERS = ("base", "capacity")


@dataclass(frozen=True, kw_only=True)
class WaitingRows:
    """Where the writing of some arrays stood.

    Attributes:
        base: Rows in shards of the place.
        capacity: Rows of a shard, 0 where none was written yet.
        rows: Rows that waited in memory, by array.
    """

    base: int
    capacity: int
    rows: Mapping[str, NDArray[Any]]


@dataclass(frozen=True, kw_only=True)
class Checkpoint:
    """Everything that a new attempt goes on from.

    Attributes:
        step: The last step that was computed.
        state: Of the simulation, as ``Simulation.state`` gave it.
        samples: Where the writing of the samples stood.
        frames: Where the writing of the frames stood.
    """

    step: int
    state: Mapping[str, NDArray[Any]]
    samples: WaitingRows
    frames: WaitingRows


def write_checkpoint(place: Place, checkpoint: Checkpoint) -> None:
    """Stores a checkpoint in place of the last one.

    Raises:
        ValueError: The state holds Python objects.
        StoreError: The store cannot be written; the last checkpoint is still there.
    """
    arrays = {f"state/{name}": values for name, values in checkpoint.state.items()}
    facts: dict[str, Any] = {"step": checkpoint.step}
    for kind, waiting in (("samples", checkpoint.samples), ("frames", checkpoint.frames)):
        arrays |= {f"{kind}/{name}": values for name, values in waiting.rows.items()}
        facts[kind] = {"base": waiting.base, "capacity": waiting.capacity}
    place.write(CHECKPOINT, pack(arrays, facts))


def read_checkpoint(place: Place | Path) -> Checkpoint | None:
    """The last checkpoint of an attempt; None where there is none or where it is damaged."""
    found = unpack(as_place(place).read(CHECKPOINT))
    if found is None:
        return None
    arrays, facts = found
    return Checkpoint(
        step=int(facts["step"]),
        state=_below("state/", arrays),
        samples=_waiting("samples", arrays, facts),
        frames=_waiting("frames", arrays, facts),
    )


def earlier_checkpoints(store: Place, run: str, attempt: int) -> Iterator[tuple[Place, Checkpoint]]:
    """The checkpoints that a new attempt at a run may go on from, the newest first.

    An attempt that died before it had a checkpoint of its own is passed over.

    Args:
        store: The store.
        run: The run.
        attempt: The new attempt; only earlier ones are looked at.

    Yields:
        The place of the attempt that has it, and the checkpoint.
    """
    for earlier in range(attempt - 1, 0, -1):
        place = attempt_place(store, run, earlier)
        checkpoint = read_checkpoint(place)
        if checkpoint is not None:
            yield place, checkpoint


def _waiting(kind: str, arrays: dict[str, NDArray[Any]], facts: dict[str, Any]) -> WaitingRows:
    numbers = {name: int(facts[kind][name]) for name in _NUMBERS}
    return WaitingRows(rows=_below(f"{kind}/", arrays), **numbers)


def _below(prefix: str, arrays: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    return {
        name.removeprefix(prefix): values
        for name, values in arrays.items()
        if name.startswith(prefix)
    }
