"""A run that is written in a process of its own, so that a test can kill it at any moment."""

from __future__ import annotations

import multiprocessing
import resource
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from server.store import (
    RunReader,
    RunWriter,
    StoreError,
    attempt_place,
    earlier_checkpoints,
    open_place,
)
from solver.results import RunPlan, Sample
from tests.server.store_case import make_plan, samples_of

N_STEP = 1500
CHECKPOINT_STEPS = 137
SHARD_ROWS = 53

_context = multiprocessing.get_context("forkserver")
_context.set_forkserver_preload(["tests.server.store_process"])


def plan() -> RunPlan:
    """The plan of every run here."""
    return make_plan(N_STEP, n_point=8)


class Recurrence:
    """A simulation whose every value depends on all steps before, with state and restore."""

    def __init__(self) -> None:
        self.step = -1
        self.value = np.array(0.5)

    def state(self) -> dict[str, Any]:
        return {"value": self.value.copy()}

    def restore(self, state: Any, step: int) -> None:
        self.value = state["value"].copy()
        self.step = step

    def samples(self) -> Iterator[Sample]:
        """The samples after the last one."""
        for sample in samples_of(plan(), self.step + 1):
            self.step = sample.step
            self.value = np.array(3.9 * self.value * (1.0 - self.value))  # logistic map: chaotic
            channels = sample.channels.copy()
            channels[0] = self.value
            yield replace(sample, channels=channels)


def write_attempt(store: str, run: str, attempt: int) -> None:
    """Computes a run from the last checkpoint on, to its end if nobody kills the process."""
    place = open_place(store)
    simulation = Recurrence()
    target = attempt_place(place, run, attempt)
    found = next(earlier_checkpoints(place, run, attempt), None)
    if found is None:
        writer = RunWriter(target, plan())
    else:
        previous, checkpoint = found
        writer = RunWriter.resumed(target, plan(), previous, checkpoint)
        simulation.restore(checkpoint.state, checkpoint.step)
    for sample in simulation.samples():
        writer.append(sample)
        if sample.step == SHARD_ROWS - 1:
            writer.flush()
        if sample.step % CHECKPOINT_STEPS == 0:
            writer.checkpoint(simulation.state())
    writer.seal()
    writer.add_filtered({"filtered": np.arange(float(N_STEP + 1))})
    writer.finish({"steps": N_STEP})


def start_attempt(store: Path, run: str, attempt: int) -> Any:
    """Starts a process that writes an attempt."""
    process = _context.Process(target=write_attempt, args=(str(store), run, attempt))
    process.start()
    return process


def write_until_full(folder: str, connection: Any) -> None:
    """Writes a run whose files may not grow any more from step 500 on; tells the error's text."""
    writer = RunWriter(Path(folder), plan())
    try:
        for sample in samples_of(plan()):
            if sample.step == 500:
                resource.setrlimit(resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))
            writer.append(sample)
            if sample.step == SHARD_ROWS - 1:
                writer.flush()
            if sample.step == 400:
                writer.checkpoint({"u": np.arange(5.0)})
    except StoreError as error:
        writer.abort()
        connection.send((type(error).__name__, str(error)))
    else:
        connection.send(("", "nothing was refused"))


def fill_disk(folder: Path) -> tuple[str, str]:
    """Class and text of what a writer raises when its disk is full."""
    receiver, sender = _context.Pipe(duplex=False)
    process = _context.Process(target=write_until_full, args=(str(folder), sender))
    process.start()
    sender.close()
    told = receiver.recv()
    process.join(120)
    receiver.close()
    return told


def expected_values() -> np.ndarray:
    """The first channel of an uninterrupted run."""
    return np.array([sample.channels[0] for sample in Recurrence().samples()])


def check_committed(place: Any, expected: np.ndarray) -> tuple[int, str]:
    """Compares everything that a reader gets with what it must be.

    Returns:
        Samples that were committed, and what was wrong (empty where nothing was).
    """
    reader = RunReader(place)
    if not reader.has_plan:
        return 0, ""
    committed, frames = reader.committed, reader.committed_frames
    names = [channel.name for channel in reader.plan.channels]
    steps = np.arange(float(committed))
    rows = reader.channel_rows([names[0], names[36]], 0, committed)
    if not np.array_equal(rows[:, 0], expected[:committed]):
        return committed, f"channel 0 of {committed} samples"
    if not np.array_equal(rows[:, 1], steps + 0.36):
        return committed, f"channel 36 of {committed} samples"
    if not np.array_equal(reader.slab_point(5, 0, committed), np.float32(steps + 0.005)):
        return committed, f"slab of {committed} samples"
    for index in {0, frames // 2, frames - 1} if frames else set[int]():
        if not np.all(reader.frame(index).displacement == 20.0 * index):
            return committed, f"frame {index} of {frames}"
    return committed, ""
