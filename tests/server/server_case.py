"""What the server's tests share: a server on a temporary folder, studies, patience."""

from __future__ import annotations

import socket
import ssl
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import uvicorn
from fastapi import FastAPI

from server.app import create_app
from server.settings import DATABASE_NAME, Settings
from solver import studies
from tests.server.database_case import lay_database

_NO_TLS = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
"""For clients of plain HTTP: each would read the system's certificates for itself."""

ENDED = {"done", "failed", "cancelled", "timed_out", "out_of_memory"}


def settings_for(folder: Path, **changes: Any) -> Settings:
    """Settings with short intervals."""
    values = {
        "data": folder / "data",
        "progress_seconds": 0.02,
        "heartbeat_seconds": 0.2,
        "grace_seconds": 0.3,
        "poll_seconds": 0.05,
        "concurrent_batches": 1,
    }
    return Settings(**{**values, **changes})


class Client(httpx.Client):
    """Talks to a server in a thread of this process."""

    def __init__(self, port: int, app: FastAPI) -> None:
        super().__init__(base_url=f"http://127.0.0.1:{port}", timeout=120.0, verify=_NO_TLS)
        self.port = port
        self.app = app

    def json(self, path: str, **parameters: Any) -> Any:
        """The JSON at an address of the API."""
        answer = self.get(f"/api/v1/{path}", params=parameters)
        assert answer.status_code == 200, answer.text
        return answer.json()


@contextmanager
def serving(settings: Settings, *, makes_tables: bool = False, **parts: Any) -> Iterator[Client]:
    """A real server on a free port, and a client of it.

    Args:
        settings: Of the server; a new SQLite database is there before it.
        makes_tables: The server makes its new database itself.
        parts: Of the application.
    """
    file = settings.data / DATABASE_NAME
    if not (makes_tables or settings.database or file.exists()):
        settings.data.mkdir(parents=True, exist_ok=True)
        lay_database(file)
    app = create_app(settings, **parts)
    # As the server itself makes it: with the protocol named, answers are not held back.
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listener.bind(("127.0.0.1", 0))
    listener.listen()
    port = listener.getsockname()[1]
    server = uvicorn.Server(uvicorn.Config(app, log_level="error", timeout_graceful_shutdown=3))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
    thread.start()
    try:
        until(lambda: server.started or not thread.is_alive(), bool)
        assert server.started, "the server did not start"
        with Client(port, app) as client:
            yield client
    finally:
        app.state.changes.end()
        server.should_exit = True
        thread.join(timeout=60)
        listener.close()


def every_route(routes: Iterable[Any]) -> Iterator[Any]:
    """All routes, those of included routers too (newer versions of FastAPI keep them nested)."""
    for route in routes:
        inner = getattr(route, "original_router", None)
        if inner is None:
            yield route
        else:
            yield from every_route(inner.routes)


def beam_study(**changes: Any) -> dict[str, Any]:
    """The sprung mass on a beam: a run of about a second."""
    return {**studies.to_json(studies.template("sprung-mass-beam").study), **changes}


def short_study(**changes: Any) -> dict[str, Any]:
    """The same with long steps: a run of some hundredths of a second."""
    study = beam_study(**changes)
    study["integration"]["time_step"] = 2e-3
    return study


def submit(client: Client, study: dict[str, Any], **parts: Any) -> dict[str, Any]:
    """Submits a study and gives the job."""
    answer = client.post("/api/v1/jobs", json={"study": study, **parts})
    assert answer.status_code == 202, answer.text
    assert answer.headers["location"] == f"/api/v1/jobs/{answer.json()['id']}"
    return answer.json()


def ended(client: Client, job: str, seconds: float = 180.0) -> dict[str, Any]:
    """The job when it has ended."""
    return until(
        lambda: client.get(f"/api/v1/jobs/{job}").json(), lambda j: j["state"] in ENDED, seconds
    )


def until(look: Callable[[], Any], is_so: Callable[[Any], bool], seconds: float = 120.0) -> Any:
    """Looks until it is so."""
    limit = time.monotonic() + seconds
    while True:
        seen = look()
        if is_so(seen):
            return seen
        assert time.monotonic() < limit, f"not so after {seconds} s: {seen}"
        time.sleep(0.02)
