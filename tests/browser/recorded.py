"""Answers the page from ``tests/js/snapshots``: every state has its face without computing.

The page's own files and its schema come from the real server; what jobs and runs there are comes
from the files that ``tests/server/test_snapshots.py`` compares with the real API.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, TypeAlias
from urllib.parse import urlsplit

__all__ = ["LOG", "QUIET_STREAM", "SILENT_STREAM", "answer", "job_address", "play"]

FOLDER = Path(__file__).parents[1] / "js" / "snapshots"

_STREAM = """
window.EventSource = class extends EventTarget {{
  constructor() {{
    super();
    this.readyState = 1;
    window.streams = [...(window.streams ?? []), this];
    setTimeout(() => this.{event}?.(new Event("{kind}")));
  }}
  close() {{ this.readyState = 2; }}
}};
window.EventSource.CLOSED = 2;
"""
QUIET_STREAM = _STREAM.format(event="onopen", kind="open")
"""An event stream that is open and has nothing to tell."""
SILENT_STREAM = _STREAM.format(event="onerror", kind="error")
"""One that does not come about."""

LOG = "2026-01-01T12:00:00Z  run 0 (runFailed)  began\n"
_Answers: TypeAlias = dict[tuple[str, str], dict[str, Any]]
_RUN = re.compile(r"/runs/run(?:Sweep|Running|Cancelled)\d?(/.+)$")
_MISSING = {"title": "Not recorded", "detail": "There is no such thing here.", "errors": []}


def job_address(label: str) -> str:
    """The page of a recorded job."""
    return "/#/jobs/job" + "".join(part.capitalize() for part in label.split("_"))


def _recorded() -> _Answers:
    found: _Answers = {}
    for file in FOLDER.glob("*.json"):
        document = json.loads(file.read_text(encoding="utf-8"))
        request = document["request"]
        found[request["method"], urlsplit(request["path"]).path] = document
    return found


def answer(name: str) -> Any:
    """The answer that is kept under a name."""
    return json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))["answer"]


def _found(recorded: _Answers, method: str, path: str) -> dict[str, Any] | None:
    """What is kept of a request; runs without histories of their own show those of another."""
    instead = _RUN.sub(r"/runs/runDone\1", path)
    return recorded.get((method, path)) or recorded.get((method, instead))


def play(page: Any, *, changes: dict[str, Any] | None = None, stream: str = QUIET_STREAM) -> None:
    """Has a page find what is recorded, and nothing else.

    Args:
        page: The page, before it goes anywhere.
        changes: Answers in place of the recorded ones, by path below ``/api/v1``; None has the
            request fail as it does where the server is gone.
        stream: The event stream that the page gets.
    """
    recorded = _recorded()
    changed = changes or {}

    def handle(route: Any) -> None:
        path = urlsplit(route.request.url).path
        below = path.removeprefix("/api/v1")
        if below == "/openapi.json":
            route.continue_()
        elif below in changed:
            if changed[below] is None:
                route.abort()
            else:
                route.fulfill(json=changed[below])
        elif (document := _found(recorded, route.request.method, path)) is not None:
            route.fulfill(status=document["status"], json=document["answer"])
        elif path.endswith("/log"):
            route.fulfill(content_type="text/plain", body=LOG)
        else:
            route.fulfill(status=404, json={**_MISSING, "status": 404})

    page.add_init_script(stream)
    page.route("**/api/v1/**", handle)
