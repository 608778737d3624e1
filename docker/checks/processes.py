"""Processes on loopback for the check: each ends with it, whatever happens."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Generator, Mapping, Sequence
from pathlib import Path


class CheckError(Exception):
    """What the check found wrong."""


def free_port(host: str = "127.0.0.1") -> int:
    """A port of loopback that nobody listens on now."""
    with socket.create_server((host, 0)) as probe:
        return int(probe.getsockname()[1])


def until(what: str, holds: Callable[[], bool], seconds: float) -> float:
    """Waits until something holds, and gives how long that took.

    Raises:
        CheckError: It did not in time.
    """
    begin = time.monotonic()
    while not holds():
        if time.monotonic() > begin + seconds:
            raise CheckError(f"{what}: not within {seconds:g} s")
        time.sleep(0.1)
    return time.monotonic() - begin


class Process:
    """A program with a log file, in a session of its own."""

    def __init__(
        self,
        name: str,
        command: Sequence[str],
        environment: Mapping[str, str],
        folder: Path,
        user: str | None = None,
    ) -> None:
        """Starts it in ``folder``, with these variables only."""
        self.name = name
        self.log = folder / f"{name}.log"
        with self.log.open("wb") as log:
            self._process = subprocess.Popen(
                command,
                env=dict(environment),
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                user=user,
                group=user,
                extra_groups=None if user is None else [],
            )
        self.pid = self._process.pid

    def require_alive(self) -> None:
        """Raises ``CheckError`` with the end of the log where it has ended."""
        status = self._process.poll()
        if status is not None:
            raise CheckError(f"{self.name} ended with status {status}:\n{self.tail()}")

    def tail(self) -> str:
        """The end of its log."""
        return self.log.read_text(errors="replace")[-3000:]

    def terminate(self) -> None:
        """Sends SIGTERM."""
        self._process.terminate()

    def wait(self, seconds: float) -> int:
        """Its status when it has ended.

        Raises:
            CheckError: It has not by then.
        """
        try:
            return self._process.wait(max(0.0, seconds))
        except subprocess.TimeoutExpired:
            raise CheckError(f"{self.name} goes on after SIGTERM:\n{self.tail()}") from None

    def kill(self) -> None:
        """Ends it and all that it started."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)
        self._process.wait()


def run(command: Sequence[str], environment: Mapping[str, str], seconds: float = 60) -> str:
    """What a command prints.

    Raises:
        CheckError: It fails, or takes too long.
    """
    answer = subprocess.run(
        command,
        env=dict(environment),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=seconds,
        check=False,
    )
    if answer.returncode:
        raise CheckError(
            f"{' '.join(command)} ended with status {answer.returncode}: "
            f"{answer.stderr[-2000:] or answer.stdout[-2000:]}"
        )
    return answer.stdout


@contextlib.contextmanager
def postgresql(folder: Path, user: str, password: str) -> Generator[str]:
    """A PostgreSQL server that asks for a password; gives its host and port."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin"), key=lambda path: path.parent.name)
    if not found:
        raise CheckError("PostgreSQL is missing: apt-get install postgresql")
    programs = found[-1]
    # It refuses to run as root.
    owner = "postgres" if os.geteuid() == 0 else None
    home = folder / "postgresql"
    home.mkdir()
    secret = home / "password"
    secret.write_text(password, encoding="utf-8")
    if owner is not None:
        subprocess.run(["chown", "-R", owner, str(home)], check=True)
    port = free_port()
    cluster = str(home / "cluster")
    options = ["-U", user, "-N", "--auth=scram-sha-256", f"--pwfile={secret}"]
    subprocess.run(
        [programs / "initdb", "-D", cluster, *options],
        check=True,
        user=owner,
        stdout=subprocess.DEVNULL,
        cwd=home,
    )
    command = [str(programs / "postgres"), "-D", cluster, "-p", str(port), "-h", "127.0.0.1"]
    server = Process("postgresql", [*command, "-k", str(home), "-F"], os.environ, home, owner)
    client = {**os.environ, "PGPASSWORD": password}
    there = ["-h", "127.0.0.1", "-p", str(port), "-U", user]
    try:
        ready = [programs / "pg_isready", *there, "-q"]
        until("PostgreSQL", lambda: subprocess.run(ready, check=False).returncode == 0, 30)
        run([str(programs / "createdb"), *there, user], client)
        yield f"127.0.0.1:{port}"
    finally:
        # At once: nothing of it is kept.
        server.kill()


@contextlib.contextmanager
def object_store(folder: Path, bucket: str) -> Generator[str]:
    """A server that speaks S3, with a bucket; gives its host and port."""
    # Loopback, but by no usual name of it: a store that is spoken to as one on the network is.
    host = "127.0.0.2"
    port = free_port(host)
    command = [sys.executable, "-m", "moto.server", "-H", host, "-p", str(port)]
    server = Process("store", command, os.environ, folder)
    address = f"http://{host}:{port}/{bucket}"
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))

    def created() -> bool:
        server.require_alive()
        try:
            opener.open(urllib.request.Request(address, method="PUT"), timeout=5).close()
        except OSError:
            return False
        return True

    try:
        until("the object store", created, 30)
        yield f"{host}:{port}"
    finally:
        server.kill()
