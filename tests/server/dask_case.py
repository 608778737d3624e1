"""What the tests of the Dask engine share: orders, patience, nodes as processes, certificates."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil
import trustme

from server.jobs.dask_engine import DaskEngine
from server.jobs.dask_nodes import run_scheduler, run_worker
from server.jobs.engine import Engine
from server.jobs.orders import Compute, Order, OrderLimits, Report, RunTask
from server.settings import Settings

ROOT = Path(__file__).parents[2]


def engine_of(settings: Settings) -> DaskEngine:
    """The engine of a coordinator whose database lies in the data folder."""
    return DaskEngine(settings, str(settings.data))


def settings_for(folder: Path, engine: str, **changes: Any) -> Settings:
    """Settings with short intervals, but for the patience with nodes that start or start again."""
    values: dict[str, Any] = {
        "data": folder / "data",
        "engine": engine,
        "concurrent_batches": 2,
        "engine_seconds": 60.0,
        "grace_seconds": 20.0,
        "poll_seconds": 0.05,
    }
    return Settings(**{**values, **changes})


def order_for(
    folder: Path, compute: Compute, batch: str = "batch", attempt: int = 1, **changes: Any
) -> Order:
    """An order of two runs on a folder."""
    values: dict[str, Any] = {
        "batch": batch,
        "attempt": attempt,
        "job": "job",
        "purpose": "runs",
        "kind": "crossing",
        "study": {},
        "runs": (RunTask(id=f"{batch}a", index=0), RunTask(id=f"{batch}b", index=1)),
        "store": str(folder),
        "model": "",
        "limits": OrderLimits(
            seconds=600.0,
            memory_bytes=2_000_000_000,
            memory_fraction=0.8,
            grace_seconds=20.0,
            poll_seconds=0.05,
            progress_seconds=0.02,
            checkpoint_seconds=30.0,
        ),
        "compute": compute,
    }
    return Order(**{**values, **changes})


def until(condition: Callable[[], object], seconds: float = 180.0) -> None:
    """Waits for a condition; fails where it does not come."""
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit, "what was waited for did not come"
        time.sleep(0.01)


def hear(
    engine: Engine, enough: Callable[[Sequence[Report]], bool], seconds: float = 180.0
) -> list[Report]:
    """Reports until there are enough."""
    heard: list[Report] = []
    limit = time.monotonic() + seconds
    while not enough(heard):
        assert time.monotonic() < limit, heard
        heard += engine.reports(0.1)
    return heard


def ended(count: int) -> Callable[[Sequence[Report]], bool]:
    """Enough when so many attempts have ended."""
    return lambda heard: len(events(heard)) >= count


def told(kind: str, count: int = 1) -> Callable[[Sequence[Report]], bool]:
    """Enough when so many reports of a kind came."""
    return lambda heard: sum(report.kind == kind for report in heard) >= count


def events(heard: Sequence[Report]) -> dict[str, str]:
    """How each attempt ended, by its key."""
    return {item.key: item.data["event"] for item in heard if item.kind == "ended"}


def process_of(heard: Sequence[Report]) -> int:
    """The number of the process that computes."""
    return next(report.data["process"] for report in heard if report.kind == "started")


def gone(process: int) -> bool:
    """Whether a process has ended, even where nobody has taken note of it yet."""
    try:
        return psutil.Process(process).status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


def worker_of(process: int) -> psutil.Process:
    """The worker above a batch's process: its parent is the worker's forkserver."""
    return psutil.Process(process).parents()[1]


def certificates(folder: Path) -> dict[str, Path]:
    """A certificate authority and one certificate of it, as settings."""
    authority = trustme.CA()
    certificate = authority.issue_cert("127.0.0.1")
    files = {name: folder / f"{name}.pem" for name in ("ca", "cert", "key")}
    authority.cert_pem.write_to_path(files["ca"])
    certificate.cert_chain_pems[0].write_to_path(files["cert"])
    certificate.private_key_pem.write_to_path(files["key"])
    return {f"tls_{name}_file": path for name, path in files.items()}


class Node:
    """A scheduler, a worker or a coordinator in a process of its own."""

    def __init__(self, function: Callable[..., None], settings: Settings, **arguments: Any) -> None:
        code = (
            "import pickle, sys\n"
            "function, settings, arguments = pickle.load(sys.stdin.buffer)\n"
            "function(settings, **arguments)\n"
        )
        self.process = subprocess.Popen(
            [sys.executable, "-c", code],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=ROOT,
            env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "default"},
        )
        assert self.process.stdin is not None
        self.process.stdin.write(pickle.dumps((function, settings, arguments)))
        self.process.stdin.close()
        self.address = ""

    def ready(self) -> str:
        """Waits for its line, and gives the address in it."""
        assert self.process.stdout is not None
        line = self.process.stdout.readline().decode()
        if " ready at " not in line:
            assert self.process.stderr is not None
            raise AssertionError(line + self.process.stderr.read().decode())
        self.address = line.split()[3]
        return self.address

    def end(self) -> str:
        """Ends it by force, if it runs; what it wrote to its error stream."""
        self.process.kill()
        return self.wait()

    def wait(self, seconds: float = 180.0) -> str:
        """Waits for its end; what it wrote to its error stream."""
        self.process.stdin = None
        _, errors = self.process.communicate(timeout=seconds)
        return errors.decode()


def coordinate(settings: Settings, *, orders: Sequence[Order]) -> None:
    """A coordinator that begins orders, says so, and is then killed."""
    engine = engine_of(settings)
    engine.start()
    for order in orders:
        engine.run(order)
    heard = hear(engine, told("started", len(orders)))
    print(f"batch ready at {process_of(heard)}", flush=True)
    while True:
        engine.reports(1.0)


@contextmanager
def external_scheduler(folder: Path, workers: int = 2) -> Generator[tuple[Settings, list[Node]]]:
    """A tls:// scheduler with workers of one slot; yields settings, and scheduler and workers."""
    files = certificates(folder)
    listening = settings_for(folder, "local", **files)
    nodes = [Node(run_scheduler, listening, host="127.0.0.1", port=0)]
    try:
        address = nodes[0].ready()
        for _ in range(workers):
            nodes.append(Node(run_worker, listening, scheduler=address, slots=1))
        for node in nodes[1:]:
            node.ready()
        yield settings_for(folder, address, **files), nodes
    finally:
        for node in nodes:
            node.end()
