"""A server as a process of its own, for measurements: started, looked at, stopped."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx
import psutil

from server.client import TrainbridgeClient

ROOT = Path(__file__).parents[2]
ENDED = {"done", "failed", "cancelled", "timed_out", "out_of_memory"}
PATIENCE = 300.0
"""Longest wait for anything. [s]"""


class Served:
    """A server that runs.

    Attributes:
        answered: From its start to its first answer. [s]
        client: Talks to it.
        http: The same without a word about what comes.
        began: When its process was started, of ``time.perf_counter``. [s]
    """

    def __init__(self, folder: Path, command: list[str], settings: dict[str, str]) -> None:
        inherited = {k: v for k, v in os.environ.items() if not k.startswith("TRAINBRIDGE_")}
        ours = {"DATA": str(folder), "PORT": "0", "CONCURRENT_BATCHES": "2", **settings}
        self.began = time.perf_counter()
        self._process = subprocess.Popen(
            [sys.executable, "-m", *command],
            stdout=subprocess.PIPE,
            text=True,
            cwd=ROOT,
            env=inherited | {f"TRAINBRIDGE_{name}": value for name, value in ours.items()},
        )
        assert self._process.stdout is not None
        found = re.search(r"http://\S+", self._process.stdout.readline())
        assert found is not None, "the server did not start"
        self.client = TrainbridgeClient(found.group())
        # Kept open, as browsers do.
        self.http = httpx.Client(base_url=f"{found.group()}/api/v1", timeout=PATIENCE)
        until(self._answers)
        self.answered = time.perf_counter() - self.began

    def _answers(self) -> bool:
        with suppress(httpx.TransportError):
            return self.http.get("/health").status_code == 200
        return False

    def end(self) -> None:
        """Stops it, and what it started."""
        self.client.close()
        self.http.close()
        self._process.send_signal(signal.SIGTERM)
        try:
            self._process.wait(PATIENCE)
        finally:
            self._process.kill()
            self._process.wait()
            assert self._process.stdout is not None
            self._process.stdout.close()

    def tree(self) -> list[psutil.Process]:
        """The server and everything below it."""
        process = psutil.Process(self._process.pid)
        return [process, *process.children(recursive=True)]

    def processor_time(self) -> float:
        """Of the whole tree and of those of its processes that have ended. [s]"""
        total = 0.0
        for process in self.tree():
            with suppress(psutil.NoSuchProcess):
                total += sum(process.cpu_times()[:4])
        return total

    def proportional_memory(self) -> float:
        """Of the whole tree: what processes share counts once. [B]"""
        total = 0.0
        for process in self.tree():
            with suppress(psutil.NoSuchProcess):
                total += process.memory_full_info().pss
        return total

    def get(self, path: str, **parameters: Any) -> bytes:
        """What is at an address of the API."""
        answer = self.http.get(path, params=parameters)
        answer.raise_for_status()
        return answer.content

    def wait(self, job: str) -> None:
        """Until a job is done."""
        until(lambda: self.client.job(job).state in ENDED)
        assert self.client.job(job).state == "done", self.client.log(job)[-2000:]


@contextmanager
def served(batch: str = "", *, idle_seconds: float = 60.0, **settings: str) -> Generator[Served]:
    """A server on an empty folder.

    Args:
        batch: What its batches do, of ``queue_batches.BATCHES``; ``run`` or empty for real runs.
        idle_seconds: After so long the solver's memory is given back; needs a ``batch``. [s]
        settings: Named as variables without their common prefix.
    """
    command = ["server", "serve"]
    if batch:
        command = ["tests.benchmarks.queue_server", batch, str(idle_seconds)]
    with TemporaryDirectory(prefix="trainbridge-benchmark-") as folder:
        server = Served(Path(folder) / "data", command, settings)
        try:
            yield server
        finally:
            server.end()


def until(so: Callable[[], Any], every: float = 0.01) -> None:
    """Looks until it is so."""
    limit = time.perf_counter() + PATIENCE
    while not so():
        assert time.perf_counter() < limit, "what was waited for did not come"
        time.sleep(every)


def seconds_until(so: Callable[[], Any], since: float | None = None) -> float:
    """How long it takes until it is so. [s]"""
    begin = time.perf_counter() if since is None else since
    until(so, 0.002)
    return time.perf_counter() - begin
