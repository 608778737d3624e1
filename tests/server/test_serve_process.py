"""The server as a process of its own: how it stops, second servers, what it refuses."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Generator
from contextlib import contextmanager
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from server.jobs.environment import FORKSERVER_OF
from server.jobs.lock import FolderInUseError, FolderLock
from tests.server.deployments import surviving
from tests.server.server_case import beam_study, until

ROOT = Path(__file__).parents[2]


@contextmanager
def server_process(data: Path, *options: str) -> Generator[tuple[subprocess.Popen[str], str]]:
    """``trainbridge serve`` on a free port, and its address."""
    command = [sys.executable, "-m", "server", "serve", "--port", "0", "--data", str(data)]
    process = subprocess.Popen([*command, *options], stdout=subprocess.PIPE, text=True, cwd=ROOT)
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        assert "http://" in line, line
        address = line.split()[2]
        until(lambda: answers(address), bool)
        yield process, address
    finally:
        process.kill()
        process.wait()
        process.stdout.close()  # type: ignore[union-attr]


def answers(address: str) -> bool:
    try:
        return httpx.get(f"{address}/api/v1/health").status_code == 200
    except httpx.TransportError:
        return False


def submit(address: str, study: dict[str, Any]) -> str:
    answer = httpx.post(f"{address}/api/v1/jobs", json={"study": study}, timeout=60)
    assert answer.status_code == 202, answer.text
    return answer.json()["id"]


def job(address: str, number: str) -> dict[str, Any]:
    return httpx.get(f"{address}/api/v1/jobs/{number}", timeout=60).json()


def long_study() -> dict[str, Any]:
    """Some seconds of steps."""
    study = beam_study()
    study["integration"]["time_step"] = 2e-4
    study["extent"]["run_out"] = 1.0
    return study


@pytest.mark.slow
def test_it_stops_with_streams_open_and_runs_computing(tmp_path: Path) -> None:
    for number in (signal.SIGTERM, signal.SIGINT):
        with server_process(tmp_path / str(int(number))) as (process, address):
            made = submit(address, long_study())
            until(lambda: job(address, made)["state"], lambda state: state == "running")  # noqa: B023
            children = psutil.Process(process.pid).children(recursive=True)
            listening = [threading.Event() for _ in range(3)]

            def listen(opened: threading.Event, address: str = address) -> None:
                with httpx.stream("GET", f"{address}/api/v1/events", timeout=120) as answer:
                    for _ in answer.iter_lines():
                        opened.set()

            threads = [threading.Thread(target=listen, args=(event,)) for event in listening]
            for thread in threads:
                thread.start()
            assert all(event.wait(120) for event in listening)
            process.send_signal(number)
            assert process.wait(timeout=180) == 0
            for thread in threads:
                thread.join(120)
            assert surviving(children) == []


def test_a_forkserver_whose_server_is_gone_loads_nothing() -> None:
    """Killed just as it starts one, a server would be outlived by seconds of imports."""
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    found = subprocess.run(
        [sys.executable, "-X", "importtime", "-c", "import server.jobs.preload; print('loaded')"],
        env=os.environ | {FORKSERVER_OF: str(gone.pid)},
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert (found.returncode, found.stdout) == (0, "")
    assert "server.jobs.environment" in found.stderr
    assert "numpy" not in found.stderr


@pytest.mark.slow
def test_an_idle_connection_outlives_what_clients_keep(tmp_path: Path) -> None:
    """A server that closes first answers a request now and then with a closed connection."""
    with server_process(tmp_path) as (_, address):
        connection = HTTPConnection(address.removeprefix("http://"), timeout=60)
        for idle in (0.0, 6.0):  # httpx keeps one for 5 s, uvicorn as it comes too
            time.sleep(idle)
            connection.request("GET", "/api/v1/health")
            answer = connection.getresponse()
            assert answer.status == 200
            answer.read()
        connection.close()


@pytest.mark.slow
def test_a_second_server_on_the_same_folder_is_refused(tmp_path: Path) -> None:
    with server_process(tmp_path) as (process, _):
        second = serve_briefly("--data", str(tmp_path), "--port", "0")
        assert second.returncode == 1
        assert f"(process {process.pid}) works in the data folder" in second.stderr
        assert "--data" in second.stderr
    # The lock died with its holder.
    FolderLock(tmp_path).release()


@pytest.mark.slow
def test_a_port_in_use_is_said(tmp_path: Path) -> None:
    with server_process(tmp_path / "a") as (_, address):
        port = address.rsplit(":", 1)[1]
        second = serve_briefly("--data", str(tmp_path / "b"), "--port", port)
    assert second.returncode == 1
    assert f"Port {port}" in second.stderr
    assert "--port" in second.stderr


def test_the_network_needs_a_token(tmp_path: Path) -> None:
    refused = serve_briefly("--data", str(tmp_path), "--host", "0.0.0.0", "--port", "0")
    assert refused.returncode == 1
    assert "TRAINBRIDGE_TOKEN" in refused.stderr
    assert "--token-file" in refused.stderr
    assert "Traceback" not in refused.stderr


@pytest.mark.slow
def test_a_folder_of_another_version_is_refused(tmp_path: Path) -> None:
    import sqlite3

    from server.store import Database

    Database(tmp_path / "trainbridge.sqlite").close()
    with sqlite3.connect(tmp_path / "trainbridge.sqlite") as connection:
        connection.execute("UPDATE alembic_version SET version_num = '9999'")
    connection.close()
    refused = serve_briefly("--data", str(tmp_path), "--port", "0")
    assert refused.returncode == 1
    assert "9999" in refused.stderr
    assert "--data" in refused.stderr


def test_a_lock_names_its_holder(tmp_path: Path) -> None:
    with FolderLock(tmp_path), pytest.raises(FolderInUseError, match=f"process {os.getpid()}"):
        FolderLock(tmp_path)


def serve_briefly(*options: str) -> subprocess.CompletedProcess[str]:
    """A server that should end by itself."""
    environment = {k: v for k, v in os.environ.items() if k != "TRAINBRIDGE_TOKEN"}
    return subprocess.run(
        [sys.executable, "-m", "server", "serve", *options],
        capture_output=True,
        text=True,
        timeout=240,
        cwd=ROOT,
        env=environment,
        check=False,
    )
