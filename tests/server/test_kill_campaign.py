"""Kill -9 at random moments while a study computes: nothing is lost, nothing is done twice.

Servers, coordinators, workers and computing processes die; the server is started again each time.
Moments are seeded shares of the work, so that a busy machine sees the same campaign.
"""

from __future__ import annotations

import random
import re
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

from server.client import ClientError
from server.jobs.process import child_context
from server.jobs.submission import read_study
from server.jobs.worker import run_study
from server.store import EventRecord, RunReader
from tests.server.deployments import (
    Deployment,
    assert_same_bits,
    deployed,
    surviving,
)
from tests.server.kills import campaigns
from tests.server.server_case import ENDED, beam_study, until

pytestmark = pytest.mark.slow

SEED = 4
EVERY_STEP = "1e-9"
"""Interval between checkpoints: due after each step, so that rework can be counted in steps. [s]"""
LONG = 240.0
"""Time for what takes some seconds on a quiet machine. [s]"""


def sweep(runs: int) -> dict[str, Any]:
    """A sprung mass at so many speeds: a hundred steps and more each."""
    study = beam_study()
    study["integration"]["time_step"] = 4e-3
    study["sweep"]["speeds"] = np.linspace(40.0, 60.0, runs).tolist()
    return study


@dataclass
class Campaign:
    """Kills what a deployment consists of while a job computes.

    Attributes:
        deployment: Whose processes die.
        targets: What may be killed: ``server``, ``child``, ``worker``, ``coordinator``.
        kills: How often.
        seed: Of moments and targets.
        done: What was killed, in order.
    """

    deployment: Deployment
    targets: Sequence[str]
    kills: int
    seed: int = SEED
    done: list[str] = field(default_factory=list[str])

    def against(self, job: str) -> None:
        """Spreads the kills over the work of a job."""
        chance = random.Random(self.seed)
        moments = sorted(chance.uniform(0.0, 0.9) for _ in range(self.kills))
        for moment in moments:
            self._wait(job, moment)
            time.sleep(chance.uniform(0.0, 0.2))
            target = chance.choice(self.targets)
            # Between two batches there is no child to kill: the next one comes.
            until(lambda target=target: self._kill(target, chance), bool, LONG)
            self.done.append(target)

    def _wait(self, job: str, moment: float) -> None:
        def fraction() -> float:
            try:
                progress = self.deployment.client.job(job).progress
            except ClientError:
                return 0.0
            return 0.0 if progress is None else progress.fraction

        until(fraction, lambda found: found >= moment, LONG)

    def _kill(self, target: str, chance: random.Random) -> bool:
        if target == "server":
            assert surviving(self.deployment.kill_server()) == []
            self.deployment.start()
            return True
        batches = self.deployment.computing()
        if not batches:
            return False
        if target == "coordinator":
            coordinator = self.deployment.coordinator()
            if coordinator is None:
                return False
            below = coordinator.children(recursive=True)
            coordinator.kill()
            # Its server starts another one. What it had started ends with it.
            assert surviving(below) == []
            return True
        try:
            batch = chance.choice(batches)
            batch.kill() if target == "child" else self.deployment.kill_worker_of(batch)
        except psutil.NoSuchProcess:
            return False  # It had ended.
        return True


def assert_nothing_lost(deployment: Deployment, job: str, study: dict[str, Any]) -> None:
    """Every run done with its results, one gather, each attempt after the one before it."""
    found = until(lambda: deployment.client.job(job), lambda item: item.state in ENDED, LONG)
    assert found.state == "done", (found.error, deployment.client.log(job)[-3000:])
    assert [run.state for run in found.runs] == ["done"] * len(study["sweep"]["speeds"])
    assert [item.id for item in deployment.client.jobs()] == [job]
    batches = deployment.batches(job)
    assert Counter(batch.purpose for batch in batches) == {"runs": len(found.runs), "gather": 1}
    assert {batch.state for batch in batches} == {"done"}
    summary = deployment.client.summary(job)
    assert [item["run"] for item in summary["runs"]] == [run.id for run in found.runs]
    assert summary["judged"] == len(found.runs)
    for run in found.runs:
        states = [
            (event.data["attempt"], event.data["state"])
            for event in deployment.events(job)
            if event.kind == "state" and event.run == run.id
        ]
        # running 1, (queued 1, running 2, ...) done: no attempt twice, none left out, one end.
        begun = [attempt for attempt, state in states if state == "running"]
        assert begun == list(range(1, run.attempt + 1)), states
        assert [state for _, state in states if state in ENDED] == ["done"]
        assert states == sorted(states, key=lambda item: item[0])


def assert_same_results(deployment: Deployment, job: str, study: Any, folder: Path) -> None:
    """Every channel, frame and slab point of every run is that of an undisturbed run."""
    runs = deployment.client.job(job).runs
    with ProcessPoolExecutor(2, mp_context=child_context()) as pool:
        places = [folder / str(index) for index in range(len(runs))]
        list(pool.map(compute_undisturbed, [study] * len(runs), range(len(runs)), places))
    for run, place in zip(runs, places, strict=True):
        assert_same_bits(deployment.reader(run.id, run.attempt), RunReader(place))


def compute_undisturbed(study: dict[str, Any], index: int, place: Path) -> None:
    """In one go, in a process of its own."""
    run_study(read_study(study), index, place, lambda _: None)


@dataclass(frozen=True)
class Rework:
    """What an attempt that was followed by another had done for nothing.

    Attributes:
        stored: Step of the newest checkpoint that it, or one before it, told of.
        resumed: Step at which the next one went on, 0 for the beginning.
        reached: The last step that it told of.
    """

    stored: int
    resumed: int
    reached: int


def reworks(events: Sequence[EventRecord]) -> list[Rework]:
    """The rework after each attempt of a run but the last, from its events."""
    starts = [
        place
        for place, event in enumerate(events)
        if event.kind == "state" and event.data["state"] == "running"
    ]
    attempts = [events[a:b] for a, b in pairwise([*starts, len(events)])]
    # One that died before it told of a step repeats nothing and says nothing.
    attempts = [item for item in attempts if any(_computes(event) for event in item)]
    found: list[Rework] = []
    stored = resumed = 0
    for attempt, following in pairwise(attempts):
        stored = max([stored, *_steps(attempt, r"checkpoint of step (\d+) stored")])
        begin = resumed
        resumed = max([0, *_steps(following, r"goes on from the checkpoint of step (\d+)")])
        steps = [event.data["step"] for event in attempt if event.kind == "progress"]
        found.append(Rework(stored, resumed, max([begin, *steps])))
    return found


def _computes(event: EventRecord) -> bool:
    return event.kind == "progress" and event.data["stage"] == "computing"


def _steps(events: Sequence[EventRecord], pattern: str) -> list[int]:
    """The steps in the log's lines that fit."""
    text = "\n".join(str(event.data["text"]) for event in events if event.kind == "log")
    return [int(step) for step in re.findall(pattern, text)]


def assert_little_rework(deployment: Deployment, job: str) -> list[Rework]:
    """Each attempt goes on at the last checkpoint: a step before its predecessor's last, at most.

    That step's own checkpoint may not have been there yet.
    """
    events = deployment.events(job)
    found = [
        rework
        for run in deployment.client.job(job).runs
        for rework in reworks([event for event in events if event.run == run.id])
    ]
    for rework in found:
        assert rework.stored <= rework.resumed, rework
        assert rework.reached - rework.resumed <= 1, rework
    return found


def run_campaign(
    folder: Path, engine: str, study: dict[str, Any], targets: Sequence[str], kills: int
) -> list[Rework]:
    """A whole campaign; gives the rework of each attempt that was lost."""
    print(f"campaign: {kills} kills of {', '.join(targets)}, seed {SEED}")
    # A process that is killed thrice in a row is not given up here: it is we who kill it.
    settings = {"ATTEMPTS_LIMIT": "1000", "CHECKPOINT_SECONDS": EVERY_STEP}
    with deployed(folder, engine, **settings) as deployment:
        job = deployment.client.submit(study).id
        campaign = Campaign(deployment, targets, kills)
        try:
            campaign.against(job)
            assert_nothing_lost(deployment, job, study)
            found = assert_little_rework(deployment, job)
            assert_same_results(deployment, job, study, folder)
        finally:
            print(f"killed so far: {' '.join(campaign.done)}")
    assert len(campaign.done) == kills
    print(f"{len(found)} attempts lost, {sum(item.resumed > 0 for item in found)} gone on from")
    return found


@pytest.mark.parametrize(("runs", "kills"), campaigns((4, 5), (40, 20)))
def test_a_study_survives_kills(tmp_path: Path, runs: int, kills: int) -> None:
    found = run_campaign(tmp_path, "local", sweep(runs), ("server", "child"), kills)
    # Two compute at once, and nearly always one does.
    assert len(found) >= kills // 2
    assert any(item.resumed > 0 for item in found)


def test_a_study_survives_kills_on_dask(tmp_path: Path) -> None:
    targets = ("server", "coordinator", "worker", "child")
    run_campaign(tmp_path, "dask", sweep(16), targets, 6)
