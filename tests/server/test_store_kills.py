"""A process that writes a run is killed at any moment; readers beside it notice nothing."""

from __future__ import annotations

import itertools
import random
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from server.store import (
    RunReader,
    attempt_place,
    earlier_checkpoints,
    open_place,
    orphans,
    remove_orphans,
)
from tests.server.kills import campaigns
from tests.server.store_process import (
    CHECKPOINT_STEPS,
    N_STEP,
    SHARD_ROWS,
    check_committed,
    expected_values,
    start_attempt,
)

pytestmark = pytest.mark.slow


class Watcher(threading.Thread):
    """Reads the newest attempt over and over and checks every committed row."""

    def __init__(self, expected: np.ndarray) -> None:
        super().__init__()
        self.expected = expected
        self.place: Any = None
        self.failures: list[str] = []
        self.reads = 0
        self.ended = threading.Event()

    def run(self) -> None:
        """Until ``ended``; an exception is a failure, too."""
        while not self.ended.wait(0.002):
            if self.place is None:
                continue
            try:
                _, wrong = check_committed(self.place, self.expected)
            except Exception as error:
                wrong = repr(error)
            self.failures += [wrong] if wrong else []
            self.reads += 1


class Campaign:
    """Computes runs in processes that are killed, until so many were."""

    def __init__(self, folder: Path, kills: int) -> None:
        self.folder, self.kills = folder, kills
        self.store = open_place(folder)
        self.expected = expected_values()
        self.watcher = Watcher(self.expected)
        self.chance = random.Random(4)
        self.killed = self.resumed = 0

    def compute(self, run: str) -> None:
        """Computes one run to its end, in as many attempts as it takes."""
        for attempt in itertools.count(1):
            place = attempt_place(self.store, run, attempt)
            before = next(earlier_checkpoints(self.store, run, attempt), None)
            process = start_attempt(self.folder, run, attempt)
            self.watcher.place = place
            if self.killed < self.kills:
                self._wait(process, place, 0 if before is None else before[1].step)
                process.kill()
            process.join()
            if process.exitcode == 0:
                _check_finished(place, self.expected)
                return
            self.killed += 1
            self._check_killed(run, attempt, 0 if before is None else before[1].step)

    def _wait(self, process: Any, place: Any, step: int) -> None:
        """Until some moment of the attempt: its start, its steps or its end."""
        moment = self.chance.random()
        if moment < 0.2:
            process.join(self.chance.uniform(0.0, 0.05))
            return
        reader = RunReader(place)
        # Beyond the last step it ends, where nobody kills it just before.
        rows = self.chance.randint(step, step + N_STEP // 2)
        while process.is_alive() and reader.committed < rows:
            process.join(0.003)
        process.join(self.chance.uniform(0.0, 0.03))

    def _check_killed(self, run: str, attempt: int, step: int) -> None:
        committed, wrong = check_committed(attempt_place(self.store, run, attempt), self.expected)
        assert not wrong
        found = next(earlier_checkpoints(self.store, run, attempt + 1), None)
        if found is None:
            assert committed <= CHECKPOINT_STEPS + SHARD_ROWS
            return
        # Nothing that was checkpointed is lost, and at most an interval is computed again.
        assert found[1].step >= step
        assert committed - found[1].step <= CHECKPOINT_STEPS + 1
        self.resumed += found[1].step > step


@pytest.mark.parametrize("kills", campaigns(5, 100))
def test_no_kill_tears_what_is_read_or_loses_what_was_checkpointed(
    tmp_path: Path, kills: int
) -> None:
    campaign = Campaign(tmp_path, kills)
    runs: set[str] = set()
    campaign.watcher.start()
    try:
        while campaign.killed < kills:
            run = f"run-{len(runs)}"
            runs.add(run)
            campaign.compute(run)
    finally:
        campaign.watcher.ended.set()
        campaign.watcher.join()
    assert campaign.watcher.failures == []
    assert campaign.watcher.reads > kills
    assert campaign.resumed >= kills // 3

    found = orphans(campaign.store, runs=runs, jobs=(), models=())
    assert {orphan.kind for orphan in found} <= {"attempt", "leftover", "partial"}
    remove_orphans(found)
    for run in runs:
        [attempt] = campaign.store.child("runs", run).names()
        _check_finished(campaign.store.child("runs", run, attempt), campaign.expected)


def _check_finished(place: Any, expected: np.ndarray) -> None:
    reader = RunReader(place)
    assert reader.done
    assert reader.committed == N_STEP + 1
    assert reader.summary == {"steps": N_STEP}
    np.testing.assert_array_equal(reader.channel(reader.plan.channels[0].name), expected)
    np.testing.assert_array_equal(reader.filtered("filtered"), np.arange(N_STEP + 1.0))
