"""A private PostgreSQL server for a test session: in a temporary folder, on a socket of its own.

It listens on loopback too, so that a URL without a folder in it works. Nothing of a server that the
machine may run is touched.
"""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import tempfile
import uuid
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psycopg

MISSING = "PostgreSQL is missing: apt-get install postgresql"
START_SECONDS = 120
# A killed server keeps what it was given; only a power cut would lose it, and there is none.
_QUICK = "fsync=off full_page_writes=off autovacuum=off shared_buffers=16MB"


def find_programs() -> Path | None:
    """The folder of ``initdb`` and ``postgres``, the newest one; None where there is none."""
    found = [path.parent for path in Path("/usr/lib/postgresql").glob("*/bin/initdb")]
    on_path = shutil.which("initdb")
    found += [Path(on_path).resolve().parent] if on_path else []
    usable = [folder for folder in found if (folder / "pg_ctl").exists()]
    return max(usable, key=lambda folder: _version(folder), default=None)


def _version(folder: Path) -> int:
    name = folder.parent.name
    return int(name) if name.isdigit() else 0


@dataclass(frozen=True, kw_only=True)
class PostgresqlServer:
    """A server that runs.

    Attributes:
        port: Where it listens on loopback.
        start: Starts it again.
        stop: Stops it at once, as if its machine had lost power.
    """

    port: int
    start: Callable[[], None]
    stop: Callable[[], None]

    def url(self, database: str = "postgres") -> str:
        """Of a database, as users write it."""
        return f"postgresql://trainbridge@127.0.0.1:{self.port}/{database}"

    def new_database(self, copy_of: str = "") -> str:
        """URL of an empty database, or of a copy of one that nobody is connected to."""
        name = f"test_{uuid.uuid4().hex}"
        template = f' TEMPLATE "{_name(copy_of)}"' if copy_of else ""
        self._execute(f'CREATE DATABASE "{name}"{template}')
        return self.url(name)

    def drop(self, url: str) -> None:
        """Removes a database, whoever is connected."""
        self._execute(f'DROP DATABASE IF EXISTS "{_name(url)}" WITH (FORCE)')

    def _execute(self, statement: str) -> None:
        with closing(psycopg.connect(self.url(), autocommit=True)) as connection:
            connection.execute(statement.encode())


def _name(url: str) -> str:
    """A database's name."""
    return url.rpartition("/")[2]


@contextmanager
def running_server(programs: Path) -> Iterator[PostgresqlServer]:
    """Makes a cluster, starts it, and removes it in the end."""
    folder = Path(tempfile.mkdtemp(prefix="trainbridge-postgresql-"))
    owner = _owner()
    if owner is not None:
        os.chown(folder, owner.pw_uid, owner.pw_gid)

    def run(program: str, *arguments: str) -> None:
        with (folder / f"{program}.log").open("ab") as log_file:
            answer = subprocess.run(
                [programs / program, *arguments],
                cwd=folder,
                user=None if owner is None else owner.pw_uid,
                group=None if owner is None else owner.pw_gid,
                extra_groups=None if owner is None else [],
                stdin=subprocess.DEVNULL,
                stdout=log_file,
                stderr=subprocess.STDOUT,
                timeout=2 * START_SECONDS,
                check=False,
            )
        log = (folder / f"{program}.log").read_text(errors="replace")
        assert answer.returncode == 0, f"{program} failed: {log[-2000:]}"

    def control(action: str, *arguments: str) -> None:
        wait = ("-w", "-t", str(START_SECONDS))
        run("pg_ctl", action, "-D", str(folder / "cluster"), *wait, *arguments)

    try:
        cluster = ("-D", str(folder / "cluster"), "-U", "trainbridge", "-A", "trust", "-N")
        run("initdb", *cluster, "--locale=C", "-E", "UTF8")
        # Only now: what takes long before the port is used gives others the time to take it.
        with socket.create_server(("127.0.0.1", 0)) as probe:
            port = int(probe.getsockname()[1])
        settings = [f"port={port}", "listen_addresses=127.0.0.1", *_QUICK.split()]
        settings.append(f"unix_socket_directories={folder}")
        options = " ".join(f"-c {setting}" for setting in settings)
        log = str(folder / "server.log")

        def start() -> None:
            control("start", "-l", log, "-o", options)

        def stop() -> None:
            control("stop", "-m", "immediate")

        start()
        try:
            yield PostgresqlServer(port=port, start=start, stop=stop)
        finally:
            stop()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _owner() -> Any:
    """Whom to run as, as the system's list of users has it: PostgreSQL refuses root."""
    if os.geteuid() != 0:
        return None
    import pwd

    for name in ("postgres", "nobody"):
        try:
            return pwd.getpwnam(name)
        except KeyError:
            continue
    raise AssertionError("PostgreSQL refuses to run as root, and there is no user for it")
