"""What the queue costs: start, memory, overhead, latency, serving; beside what was promised.

Run with ``python -m tests.benchmarks.queue`` (three minutes or so on two free cores; ``--quick``
takes fewer runs and leaves Dask out) and read the table. Nothing else should compute meanwhile: the
load of the machine is printed with it.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import psutil

from server.store import RunWriter, read_checkpoint
from solver import studies
from tests.benchmarks.queue_batches import CHANNEL_SAMPLES
from tests.benchmarks.queue_served import Served, seconds_until, served, until
from tests.benchmarks.table import Row, print_table
from tests.server.deployments import parent_of

ENGINES = ("local", "dask")
IDLE_SECONDS = 1.0
"""Instead of a minute. [s]"""
REPEATS = 20


def beam_study(speeds: int = 1, time_step: float = 2e-3) -> dict[str, Any]:
    """The sprung mass on a beam, at so many speeds."""
    study = studies.to_json(studies.template("sprung-mass-beam").study)
    study["integration"]["time_step"] = time_step
    study["sweep"]["speeds"] = np.linspace(20.0, 60.0, speeds).tolist()
    return study


def starting(engine: str) -> Iterator[Row]:
    """From the start of ``trainbridge serve`` to its first answer, and to the first run."""
    with served(ENGINE=engine) as server:
        yield Row(name=f"web answers, {engine}", unit="s", value=server.answered, bound=3.0)
        job = server.client.submit(beam_study()).id
        until(lambda: server.client.job(job).state != "queued")
        ready = time.perf_counter() - server.began
        bound = 8.0 if engine == "dask" else None
        yield Row(name=f"first run begins, {engine}", unit="s", value=ready, bound=bound)
        server.wait(job)


def idling() -> Iterator[Row]:
    """Memory of a server with all its processes: before its first job, and after one."""
    with served() as server:
        fresh = server.proportional_memory() / 1e6
        yield Row(name="idle memory, fresh", unit="MB", value=fresh, bound=220.0)
    with served("run", idle_seconds=IDLE_SECONDS) as server:
        server.wait(server.client.submit(beam_study()).id)
        busy = len(server.tree())
        time.sleep(0.1)
        loaded = server.proportional_memory() / 1e6
        yield Row(name=f"memory just after a job, {busy} processes", unit="MB", value=loaded)
        until(lambda: not any("forkserver" in command(item) for item in server.tree()), 0.1)
        rested = server.proportional_memory() / 1e6
        yield Row(name="idle memory, a minute after a job", unit="MB", value=rested, bound=220.0)


def command(process: psutil.Process) -> str:
    """The command line of a process, empty where it has ended."""
    try:
        return " ".join(process.cmdline())
    except psutil.Error:
        return ""


def throughput(engine: str, runs: int) -> Iterator[Row]:
    """Runs of one second of a core each, two at once; and runs that take no time at all."""
    bound = {"local": 40.0, "dask": 60.0}[engine] * runs / 50
    with served("burn", ENGINE=engine) as server:
        # The engine is there, the solver is loaded.
        server.wait(server.client.submit(beam_study()).id)
        begin = time.perf_counter()
        job = server.client.submit(beam_study(runs)).id
        server.wait(job)
        elapsed = time.perf_counter() - begin
        computed = sum(
            json.loads(server.get(f"runs/{run.id}/verdicts"))["items"][0]["value"]
            for run in server.client.job(job).runs
        )
    name = f"{runs} one-second runs on 2 cores, {engine}"
    yield Row(name=name, unit="s", value=elapsed, bound=bound)
    # On a machine that others use a run takes longer than its second: that is not the queue's.
    over = 1e3 * (elapsed - computed / 2) / runs
    promised = 50.0 if engine == "local" else None
    yield Row(name=f"overhead of each, {engine}", unit="ms", value=over, bound=promised)
    with served("finish", ENGINE=engine) as server:
        server.wait(server.client.submit(beam_study()).id)
        begin, worked = time.perf_counter(), server.processor_time()
        server.wait(server.client.submit(beam_study(runs)).id)
        each = 1e3 * (time.perf_counter() - begin) / runs
        worked = 1e3 * (server.processor_time() - worked) / runs
    yield Row(name=f"a run that does nothing, {engine}", unit="ms", value=each)
    yield Row(name=f"processor time of it, {engine}", unit="ms", value=worked)


def accepting() -> Iterator[Row]:
    """500 runs in one request, of the smallest study and of a whole train on a whole viaduct."""
    whole = studies.to_json(studies.template("khst-alverca").study)
    whole["outputs"]["frame_interval"] = 0.5
    whole["sweep"]["speeds"] = np.linspace(30.0, 90.0, 500).tolist()
    with served("hang") as server:
        for name, study in (("beam", beam_study(500)), ("viaduct", whole)):
            begin = time.perf_counter()
            server.client.submit(study)
            elapsed = time.perf_counter() - begin
            yield Row(name=f"500 runs accepted, {name}", unit="s", value=elapsed, bound=0.5)


def telling() -> Iterator[Row]:
    """Progress from a batch's process to a client of the event stream."""
    delays: list[float] = []
    with served("tell_the_time") as server:
        server.wait(server.client.submit(beam_study()).id)
        job = server.client.submit(beam_study()).id
        with server.http.stream("GET", f"jobs/{job}/events") as answer:
            for kind, data in _events(answer.iter_lines()):
                if kind == "progress" and "sent" in data:
                    delays.append(time.time() - data["sent"])
                if kind == "job" and data["state"] == "done":
                    break
    median, most = np.percentile(delays, [50, 95])
    yield Row(name="progress reaches a client, p50", unit="ms", value=1e3 * float(median))
    yield Row(name="progress reaches a client, p95", unit="ms", value=1e3 * float(most), bound=200)


def _events(lines: Iterator[str]) -> Iterator[tuple[str, Any]]:
    kind = ""
    for line in lines:
        name, _, value = line.partition(": ")
        if name == "event":
            kind = value
        elif name == "data":
            yield kind, json.loads(value)


def cancelling() -> Iterator[Row]:
    """A process that sleeps, and one that does not listen to SIGTERM."""
    for batch, name in (("hang", "that listens"), ("hang_stubbornly", "that does not")):
        with served(batch) as server:
            job = server.client.submit(beam_study()).id
            until(lambda job=job, server=server: computing(server) and step(server, job) > 0)
            [process] = computing(server)
            begin = time.perf_counter()
            server.client.cancel(job)
            recorded = seconds_until(
                lambda job=job, server=server: server.client.job(job).state == "cancelled", begin
            )
            gone = seconds_until(lambda process=process: ended(process), begin)
        yield Row(name=f"cancel recorded, process {name}", unit="s", value=recorded, bound=1.0)
        yield Row(name=f"cancelled process gone, {name}", unit="s", value=gone, bound=3.0)


def step(server: Served, job: str) -> int:
    """How far a job has come."""
    progress = server.client.job(job).progress
    return 0 if progress is None else progress.step


def computing(server: Served) -> list[psutil.Process]:
    """The processes of batches: children of a forkserver."""
    tree = server.tree()
    forkservers = [item.pid for item in tree if "forkserver" in command(item)]
    return [item for item in tree if parent_of(item) in forkservers]


def ended(process: psutil.Process) -> bool:
    """Whether a process has ended, even where nobody has taken note of it yet."""
    try:
        return process.status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


def serving() -> Iterator[Row]:
    """A history of 20,000 samples and a shape, as the browser asks for them."""
    with served("store") as server:
        job = server.client.submit(beam_study()).id
        server.wait(job)
        run = f"runs/{server.client.job(job).runs[0].id}"
        channel = f"{run}/channels/wheel 03 right/contact force.csv"
        assert server.get(channel).count(b"\r\n") == CHANNEL_SAMPLES + 1
        whole = typical(lambda: server.get(channel))
        yield Row(name="20,000 samples served as CSV", unit="ms", value=1e3 * whole, bound=50.0)
        frame = typical(lambda: server.get(f"{run}/frames", index=7))
        yield Row(name="a shape served", unit="ms", value=1e3 * frame, bound=20.0)


def typical(act: Callable[[], Any]) -> float:
    """The median time of it, after a first time. [s]"""
    act()
    times: list[float] = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        act()
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


def checkpointing(template: str) -> Iterator[Row]:
    """A checkpoint of a simulation, and a new attempt that goes on from it."""
    study = studies.template(template).study
    simulation = studies.prepare(study)
    with TemporaryDirectory() as folder:
        writer = RunWriter(Path(folder) / "1", simulation.plan)
        for sample in simulation.samples():
            writer.append(sample)
            if sample.step == 20:
                break
        write = typical(lambda: writer.checkpoint(simulation.state()))
        size = (Path(folder) / "1" / "checkpoint").stat().st_size / 1e6
        fresh = studies.prepare(study)
        begin = time.perf_counter()
        checkpoint = read_checkpoint(Path(folder) / "1")
        assert checkpoint is not None
        RunWriter.resumed(Path(folder) / "2", fresh.plan, Path(folder) / "1", checkpoint)
        fresh.restore(checkpoint.state)
        resume = time.perf_counter() - begin
    yield Row(name=f"checkpoint of {size:.2g} MB stored, {template}", unit="ms", value=1e3 * write)
    yield Row(name=f"checkpoint gone on from, {template}", unit="ms", value=1e3 * resume)


def rows(*, quick: bool) -> Iterator[Row]:
    """Every measurement, as it is made."""
    engines = ENGINES[:1] if quick else ENGINES
    for engine in engines:
        yield from starting(engine)
    yield from idling()
    for engine in engines:
        yield from throughput(engine, 4 if quick else 50)
    yield from accepting()
    yield from telling()
    yield from cancelling()
    yield from serving()
    for template in ("sprung-mass-beam",) if quick else ("sprung-mass-beam", "khst-alverca"):
        yield from checkpointing(template)


def main(arguments: Sequence[str] | None = None) -> None:
    """Prints the table."""
    print_table(__doc__, rows, arguments, quick="few runs, without Dask")


if __name__ == "__main__":
    main()
