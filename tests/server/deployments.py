"""The whole service as processes that can be killed, in each way in which it is deployed."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Generator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import numpy as np
import psutil
import trustme

from server.client import ClientError, TrainbridgeClient
from server.settings import DATABASE_NAME
from server.store import BatchRecord, Database, EventRecord, RunReader, attempt_place, open_place
from tests.server.server_case import until

ROOT = Path(__file__).parents[2]

CHECKPOINT_SECONDS = 0.3
"""Time between two checkpoints. [s]"""

_AT_ONCE = 60.0
"""A process that ends by itself is gone within a moment; on a busy machine moments are long. [s]"""

_SHORT_INTERVALS = {
    "CHECKPOINT_SECONDS": str(CHECKPOINT_SECONDS),
    "CONCURRENT_BATCHES": "2",
    # On a busy machine what is asked to end may need long for its last checkpoint.
    "GRACE_SECONDS": "20",
    "POLL_SECONDS": "0.05",
    "PROGRESS_SECONDS": "0.05",
    "QUEUE_POLL_SECONDS": "0.05",
}


class Node:
    """A command of trainbridge as a process of its own.

    Attributes:
        process: The process.
        line: What it printed when it was ready.
    """

    def __init__(self, log: Path, environment: Mapping[str, str], *command: str) -> None:
        """Starts it, and waits until it is ready.

        Args:
            log: Takes what it writes to its error stream.
            environment: Settings, without their common prefix.
            command: The command and its options.
        """
        inherited = {k: v for k, v in os.environ.items() if not k.startswith("TRAINBRIDGE_")}
        settings = {f"TRAINBRIDGE_{name}": value for name, value in environment.items()}
        self._log = log
        with log.open("ab") as errors:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "server", *command],
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
                cwd=ROOT,
                env=inherited | settings,
            )
        assert self.process.stdout is not None
        self.line = self.process.stdout.readline()
        assert self.line, f"{command[0]} ended: {log.read_text()[-2000:]}"

    def kill(self) -> None:
        """SIGKILL."""
        self._leave(signal.SIGKILL)

    def end(self) -> None:
        """SIGTERM; one that does not end by it is a failure."""
        if self.process.poll() is None:
            code = self._leave(signal.SIGTERM)
            assert code == 0, self._log.read_text()[-2000:]

    def _leave(self, number: signal.Signals) -> int:
        self.process.send_signal(number)
        try:
            return self.process.wait(120)
        finally:
            self.process.kill()
            self.process.wait()
            assert self.process.stdout is not None
            self.process.stdout.close()


class Deployment:
    """A server with its engine and its database.

    Attributes:
        engine: ``local``, ``dask`` or ``tls``.
        client: Talks to the server that runs now.
        server: Its process.
        workers: Processes ``trainbridge worker``, where they are not the server's own.
    """

    client: TrainbridgeClient
    server: Node

    def __init__(self, folder: Path, engine: str, database: str = "", **settings: str) -> None:
        """Starts nothing yet.

        Args:
            folder: Of data, certificates and logs.
            engine: ``local``, ``dask`` or ``tls``: an external scheduler with two workers.
            database: URL; empty for SQLite in the data folder.
            settings: More of them, named as variables without their common prefix.
        """
        self.engine = engine
        self._folder = folder
        self._data = folder / "data"
        where = {"DATA": str(self._data), "ENGINE": engine}
        self._settings = {**_SHORT_INTERVALS, **settings, **where}
        if database:
            self._settings["DATABASE"] = database
        self.workers: list[Node] = []
        self._database_url = database or self._data / DATABASE_NAME
        self._held = ExitStack()

    def begin(self) -> None:
        """Starts everything."""
        if self.engine == "tls":
            self._start_cluster()
        self.start()
        self._database = Database(self._database_url)
        self._held.callback(self._database.close)

    def _start_cluster(self) -> None:
        self._settings |= {"ENGINE": "local", **_certificates(self._folder)}
        scheduler = self._node("scheduler", "--port", "0")
        found = re.search(r"tls://\S+", scheduler.line)
        assert found is not None, scheduler.line
        self._settings["ENGINE"] = found.group()
        for _ in range(2):
            self.add_worker()

    def _node(self, *command: str) -> Node:
        node = Node(self._folder / f"{command[0]}.log", self._settings, *command)
        self._held.callback(node.end)
        return node

    def add_worker(self) -> None:
        """One more ``trainbridge worker``, of one slot."""
        self.workers.append(self._node("worker", "--slots", "1"))

    def start(self) -> None:
        """Starts the server, which must not run."""
        self.server = self._node("serve", "--port", "0")
        found = re.search(r"http://\S+", self.server.line)
        assert found is not None, self.server.line
        self.client = TrainbridgeClient(found.group())
        self._held.callback(self.client.close)
        until(self._answers, bool)

    def kill_server(self) -> list[psutil.Process]:
        """SIGKILL; gives the processes that it had."""
        mine = psutil.Process(self.server.process.pid).children(recursive=True)
        self.client.close()
        self.server.kill()
        return mine

    def end(self) -> None:
        """Stops everything as people do, what began last first."""
        self._held.close()

    def _answers(self) -> bool:
        with suppress(ClientError):
            return self.client.health().status == "ok"
        return False

    # What computes.

    def computing(self) -> list[psutil.Process]:
        """The processes of batches: each is the child of a forkserver."""
        found: list[psutil.Process] = []
        for node in (self.server, *self.workers):
            with suppress(psutil.NoSuchProcess):
                found += _batches(psutil.Process(node.process.pid))
        return found

    def coordinator(self) -> psutil.Process | None:
        """The coordinator, where it is a process of its own."""
        children = psutil.Process(self.server.process.pid).children()
        found = [child for child in children if _has(child, "multiprocessing.spawn")]
        return found[0] if self.engine != "local" else None

    def kill_worker_of(self, batch: psutil.Process) -> None:
        """SIGKILL of the worker above a batch's process, which is replaced: by Dask's nanny, or
        here as whoever watches over machines would do."""
        forkserver = batch.parent()
        worker = None if forkserver is None else forkserver.parent()
        if worker is None:  # The batch, or the forkserver above it, has just ended.
            raise psutil.NoSuchProcess(batch.pid)
        known = [node for node in self.workers if node.process.pid == worker.pid]
        worker.kill()
        for node in known:
            node.kill()
            self.workers.remove(node)
            self.add_worker()

    # What is stored.

    def batches(self, job: str) -> list[BatchRecord]:
        """The batches of a job, as the database has them."""
        return self._database.batches_of(job)

    def events(self, job: str) -> list[EventRecord]:
        """Everything that was told of a job, oldest first."""
        return self._database.events_after(0, jobs=(job,), limit=1_000_000)

    def reader(self, run: str, attempt: int) -> RunReader:
        """What an attempt stored."""
        return RunReader(attempt_place(open_place(self._data), run, attempt))


@contextmanager
def deployed(
    folder: Path, engine: str, database: str = "", **settings: str
) -> Generator[Deployment]:
    """A deployment that is stopped in the end."""
    deployment = Deployment(folder, engine, database, **settings)
    try:
        deployment.begin()
        yield deployment
    finally:
        deployment.end()


def surviving(processes: list[psutil.Process], seconds: float = _AT_ONCE) -> list[psutil.Process]:
    """Those that still run then; a dead orphan may wait for its new parent to take note of it."""
    limit = time.monotonic() + seconds
    while (alive := [item for item in processes if _runs(item)]) and time.monotonic() < limit:
        time.sleep(0.01)
    return alive


def assert_same_bits(found: RunReader, expected: RunReader) -> None:
    """Every channel, every slab point, every frame."""
    names = [channel.name for channel in expected.plan.channels]
    assert found.committed == expected.committed == expected.plan.n_sample
    np.testing.assert_array_equal(found.times(), expected.times())
    np.testing.assert_array_equal(found.channel_rows(names), expected.channel_rows(names))
    for ours, theirs in zip(found.slab_blocks(64), expected.slab_blocks(64), strict=True):
        np.testing.assert_array_equal(ours[1], theirs[1])
    assert found.committed_frames == expected.committed_frames == expected.plan.n_frame
    for index in range(expected.committed_frames):
        ours, theirs = found.frame(index), expected.frame(index)
        np.testing.assert_array_equal(ours.displacement, theirs.displacement)
        np.testing.assert_array_equal(ours.bodies, theirs.bodies)


def _batches(process: psutil.Process) -> list[psutil.Process]:
    children = process.children(recursive=True)
    forkservers = {child.pid for child in children if _has(child, "multiprocessing.forkserver")}
    return [child for child in children if parent_of(child) in forkservers]


def parent_of(process: psutil.Process) -> int:
    """The number of a process's parent, 0 where it has ended."""
    try:
        return process.ppid()
    except psutil.Error:
        return 0


def _has(process: psutil.Process, module: str) -> bool:
    """Whether a process was started by a module; what it forks keeps its command line."""
    try:
        command: list[str] = process.cmdline()
    except psutil.Error:
        return False
    return any(module in word for word in command)


def _runs(process: psutil.Process) -> bool:
    try:
        return process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def _certificates(folder: Path) -> dict[str, str]:
    """A certificate authority and one certificate of it, as settings."""
    authority = trustme.CA()
    certificate = authority.issue_cert("127.0.0.1")
    pems = {
        "ca": authority.cert_pem,
        "cert": certificate.cert_chain_pems[0],
        "key": certificate.private_key_pem,
    }
    for name, pem in pems.items():
        pem.write_to_path(folder / f"{name}.pem")
    return {f"TLS_{name.upper()}_FILE": str(folder / f"{name}.pem") for name in pems}
