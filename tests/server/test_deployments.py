"""The six things that no deployment may get wrong: submit, cancel, kill worker, restart, gather,
resume.

Each deployment's server is a process of its own, so that SIGKILL is what it says.
"""

from __future__ import annotations

import os
import re
import signal
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

from server.jobs.submission import read_study
from server.jobs.worker import run_study
from server.store import BatchRecord, RunReader
from solver import studies
from tests.server.deployments import Deployment, assert_same_bits, deployed, surviving
from tests.server.server_case import beam_study, short_study, until

LONG = 240.0
"""Time for what takes some seconds on a quiet machine. [s]"""
BEGINS = r"attempt (\d+) begins"
STORED = r"checkpoint of step (\d+) stored"
GOES_ON = r"goes on from the checkpoint of step (\d+)"

_SLOW = pytest.mark.slow


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(("local", "sqlite"), id="local"),
        pytest.param(("local", "postgresql"), id="local-postgresql", marks=_SLOW),
        pytest.param(("dask", "sqlite"), id="dask", marks=_SLOW),
        pytest.param(("tls", "sqlite"), id="tls", marks=_SLOW),
    ],
)
def deployment(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Deployment]:
    """Engine and database; shared by the cases, each of which leaves it at work."""
    engine, database = request.param
    url = ""
    if database == "postgresql":
        url = request.getfixturevalue("postgresql").new_database()
    with deployed(tmp_path_factory.mktemp("deployment"), engine, url) as found:
        yield found


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> RunReader:
    """What ``long_study`` gives in this process, in one go; with one thread, as everywhere."""
    assert os.environ["OMP_NUM_THREADS"] == os.environ["MKL_NUM_THREADS"] == "1"
    place = tmp_path_factory.mktemp("undisturbed")
    run_study(read_study(long_study()), 0, place, lambda _: None)
    return RunReader(place)


def long_study() -> dict[str, Any]:
    """Two seconds of steps."""
    study = beam_study()
    study["integration"]["time_step"] = 2e-4
    study["extent"]["run_out"] = 0.4
    return study


def endless_study() -> dict[str, Any]:
    """Many minutes of tiny steps."""
    study = beam_study()
    study["integration"]["time_step"] = 1e-6
    study["outputs"]["frame_interval"] = 1.0
    return study


def deck_sweep() -> dict[str, Any]:
    """A power car on one short span, at three speeds: a second of preparation, then of steps."""
    study = studies.to_json(studies.template("khst-alverca").study)
    study["train"]["consist"] = ["power_car"]
    study["viaduct"]["spans"] = [12.0]
    study["track"]["embankment_length"] = 6.0
    study["extent"] = {"run_in": 5.0, "run_out": 0.0}
    study["integration"]["time_step"] = 1e-3
    study["sweep"]["speeds"] = [70.0, 80.0, 90.0]
    return study


def begun(deployment: Deployment, job: str, step: int = 1) -> psutil.Process:
    """The process of a job that has come to a step; nothing else computes."""
    until(
        lambda: deployment.client.job(job).progress,
        lambda progress: progress is not None and progress.step >= step,
        LONG,
    )
    [process] = deployment.computing()
    return process


def done(deployment: Deployment, job: str) -> Any:
    """The job's first run, when the job is done."""
    found = deployment.client.wait(job, seconds=LONG)
    assert found.state == "done", (found, deployment.client.log(job))
    return found.runs[0]


def numbers(pattern: str, log: str) -> list[int]:
    """The number in each entry of a log that fits, oldest first."""
    return [int(found) for found in re.findall(pattern, log)]


def stored_by(log: str, attempt: int) -> list[int]:
    """The steps of the checkpoints that an attempt told of."""
    _, _, since = log.partition(f"attempt {attempt} begins")
    return numbers(STORED, since.partition(f"attempt {attempt + 1} begins")[0])


def attempt_of(deployment: Deployment, job: str, attempt: int) -> BatchRecord:
    """The only batch of a job, when it has come to an attempt."""
    [batch] = until(
        lambda: deployment.batches(job),
        lambda batches: [batch.attempt for batch in batches] == [attempt],
        LONG,
    )
    return batch


def require_kept(deployment: Deployment, job: str, undisturbed: RunReader) -> None:
    """An external worker's attempt went on; another one was begun anywhere else."""
    attempts = [1] if deployment.engine == "tls" else [1, 2]
    run = done(deployment, job)
    log = deployment.client.log(job)
    assert numbers(BEGINS, log) == attempts
    # What an engine tells again when it is reattached is not logged again.
    assert len(set(numbers(STORED, log))) == len(numbers(STORED, log))
    assert run.attempt == attempts[-1]
    assert_same_bits(deployment.reader(run.id, run.attempt), undisturbed)


@pytest.mark.slow
def test_submit(deployment: Deployment) -> None:
    client = deployment.client
    run = client.run(done(deployment, client.submit(short_study()).id).id)
    assert run.attempt == 1
    assert run.summary is not None
    assert run.summary["unjudged"].startswith("Not judged: a plain beam")
    history = client.channel(run.id, "mid-span 1/displacement")
    assert len(history) == client.channels(run.id).samples
    assert history[:, 1].min() < 0.0


@pytest.mark.slow
def test_cancel(deployment: Deployment) -> None:
    client = deployment.client
    doomed = client.submit(endless_study()).id
    process = begun(deployment, doomed)
    other = client.submit(beam_study()).id
    until(deployment.computing, lambda processes: len(processes) == 2)
    client.cancel(doomed)
    # How soon is a row of the benchmarks.
    until(lambda: client.job(doomed).state, lambda state: state == "cancelled")
    assert surviving([process]) == []
    assert done(deployment, other).attempt == 1
    [run] = client.job(doomed).runs
    assert (run.state, run.attempt) == ("cancelled", 1)


@_SLOW
def test_kill_worker(deployment: Deployment, undisturbed: RunReader) -> None:
    """Its batch goes to another worker and was not to blame; one that dies by itself was."""
    job = deployment.client.submit(long_study()).id
    attempt = 1
    if deployment.engine != "local":  # There the server is the worker: see the restart.
        process = begun(deployment, job)
        deployment.kill_worker_of(process)
        assert surviving([process]) == []
        attempt = 2
        assert attempt_of(deployment, job, attempt).deaths == 0
    begun(deployment, job).kill()
    assert attempt_of(deployment, job, attempt + 1).deaths == 1
    run = done(deployment, job)
    assert run.attempt == attempt + 1
    assert_same_bits(deployment.reader(run.id, run.attempt), undisturbed)


@_SLOW
def test_restart(deployment: Deployment, undisturbed: RunReader) -> None:
    """What computes with the server ends with it; an external worker goes on without it."""
    client, goes_on = deployment.client, deployment.engine == "tls"
    kept = done(deployment, client.submit(short_study()).id)
    coordinator = deployment.coordinator()
    if coordinator is not None:  # Of its own, it is started again by the server.
        job = client.submit(long_study()).id
        begun(deployment, job)
        coordinator.kill()
        assert client.health().status == "ok"
        require_kept(deployment, job, undisturbed)
    job = client.submit(long_study()).id
    process = begun(deployment, job, step=3000)
    if goes_on:
        process.suspend()  # Else it has ended before the server is back.
    assert surviving(deployment.kill_server()) == []
    assert surviving([process], 0.0) == ([process] if goes_on else [])
    deployment.start()
    done(deployment, deployment.client.submit(short_study()).id)
    if goes_on:
        process.resume()
    require_kept(deployment, job, undisturbed)
    assert deployment.client.run(kept.id).state == "done"
    assert deployment.reader(kept.id, 1).done


@_SLOW
@pytest.mark.parametrize(("study", "prepares"), [(short_study, 0), (deck_sweep, 1)])
def test_gather(deployment: Deployment, study: Any, prepares: int) -> None:
    asked = study()
    asked["sweep"]["speeds"] = [70.0, 80.0, 90.0]
    job = deployment.client.submit(asked).id
    done(deployment, job)
    batches = deployment.batches(job)
    assert Counter(batch.purpose for batch in batches) == Counter(
        prepare=prepares, runs=3, gather=1
    )
    assert {(batch.state, batch.attempt) for batch in batches} == {("done", 1)}
    summary = deployment.client.summary(job)
    runs = summary["runs"]
    assert [run["parameters"]["speed"] for run in runs] == asked["sweep"]["speeds"]
    assert summary["judged"] == 3
    values = {
        run["run"]: verdict["value"] for run in runs for verdict in run["verdicts"]
    }  # One rule a run.
    worst = {verdict["run"]: verdict["value"] for verdict in summary["verdicts"]}
    assert len(values) == (3 if prepares else 0)  # Plain beams are not judged.
    assert worst == dict(sorted(values.items(), key=lambda item: item[1])[-1:])


@_SLOW
def test_resume(deployment: Deployment, undisturbed: RunReader) -> None:
    """Killed, then asked to end: no step before the last checkpoint is taken again."""
    client = deployment.client
    job = client.submit(long_study()).id
    for attempt, number in ((1, signal.SIGKILL), (2, signal.SIGTERM)):
        until(lambda: stored_by(client.log(job), attempt), bool, LONG)  # noqa: B023
        [process] = deployment.computing()
        process.send_signal(number)
    run = done(deployment, job)
    log = client.log(job)
    assert numbers(BEGINS, log) == [1, 2, 3]
    assert run.attempt == 3
    second, third = numbers(GOES_ON, log)
    # A kill may come between a checkpoint and the word of it.
    assert second >= stored_by(log, 1)[-1] > 0
    # Asked to end, it stores one more: nothing is computed twice.
    assert third == stored_by(log, 2)[-1] > second
    assert_same_bits(deployment.reader(run.id, 3), undisturbed)


@_SLOW
def test_a_whole_group_is_asked_to_end(tmp_path: Path, undisturbed: RunReader) -> None:
    """As systemd and Slurm do: the run stores its checkpoint, and no death is counted."""
    with deployed(tmp_path, "local") as deployment:
        client = deployment.client
        job = client.submit(long_study()).id
        until(lambda: stored_by(client.log(job), 1), bool, LONG)
        group = psutil.Process(deployment.server.process.pid).children(recursive=True)
        for process in group:
            process.terminate()
        deployment.server.end()
        assert surviving(group) == []
        [batch] = deployment.batches(job)
        assert (batch.state, batch.deaths) == ("queued", 0)
        deployment.start()
        run = done(deployment, job)
        log = deployment.client.log(job)
        assert numbers(GOES_ON, log)[0] == stored_by(log, 1)[-1]
        assert_same_bits(deployment.reader(run.id, run.attempt), undisturbed)
