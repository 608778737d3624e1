"""Request bodies, before any route sees them: their type, their size, and what JSON they hold.

One ASGI layer for every route that takes a body, so that no route can forget. The parsed value
waits in the scope; the bytes are handed on for routes that FastAPI parses itself.
"""

from __future__ import annotations

from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from server.errors import Problem
from server.jobs.strict_json import read_json

__all__ = ["BodyGuard", "parsed_body"]

_KEY = "trainbridge.body"
_METHODS = frozenset({"POST", "PUT", "PATCH", "DELETE"})
_SMALL = 16 * 1024
"""Bodies up to this are parsed at once; larger ones in a thread. [B]"""


_DRAINED = 16
"""Times the limit that is read and thrown away: who still sends would never see the answer."""


class _GoneError(Exception):
    """The sender left before its body was complete."""


class BodyGuard:
    """Reads, limits and parses bodies."""

    def __init__(self, app: ASGIApp, limit: int) -> None:
        """Refuses bodies of more than ``limit`` bytes."""
        self.app = app
        self.limit = limit

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """One request; everything else passes."""
        if scope["type"] != "http" or scope["method"] not in _METHODS:
            await self.app(scope, receive, send)
            return
        try:
            body = await self._read(Headers(scope=scope), receive)
            if body:
                _require_json(Headers(scope=scope))
                if len(body) <= _SMALL:
                    scope[_KEY] = read_json(body)
                else:
                    scope[_KEY] = await run_in_threadpool(read_json, body)
        except _GoneError:
            return
        except Problem as problem:
            await problem.response()(scope, receive, send)
            return
        await self.app(scope, _replayed(body, receive), send)

    async def _read(self, headers: Headers, receive: Receive) -> bytes:
        announced = headers.get("content-length", "0")
        size = int(announced) if announced.isdigit() and len(announced) < 16 else 0
        parts = bytearray()
        received, more = 0, True
        while more:
            if received > _DRAINED * self.limit:
                raise self._too_large()
            message = await receive()
            if message["type"] == "http.disconnect":
                raise _GoneError
            part = message.get("body", b"")
            received += len(part)
            more = message.get("more_body", False)
            if max(received, size) <= self.limit:
                parts += part
        if max(received, size) > self.limit:
            raise self._too_large()
        return bytes(parts)

    def _too_large(self) -> Problem:
        size = self.limit / 1024 / 1024
        return Problem(
            413,
            "Body too large",
            f"A body may have at most {size:g} MiB. Send less.",
            headers={"Connection": "close"},
        )


def parsed_body(request: Request) -> Any:
    """The JSON value of the request's body.

    Raises:
        Problem: 400, there is none.
    """
    if _KEY not in request.scope:
        raise Problem(400, "Body missing", "This address takes a JSON body. Send one.")
    return request.scope[_KEY]


def _require_json(headers: Headers) -> None:
    kind = headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/json":
        raise Problem(
            415,
            "Not JSON",
            "Bodies are JSON here. Send the header 'Content-Type: application/json'.",
        )


def _replayed(body: bytes, receive: Receive) -> Receive:
    """A ``receive`` that gives the body once more, then what follows."""
    waiting = [True]

    async def replay() -> Message:
        if waiting:
            waiting.clear()
            return {"type": "http.request", "body": body, "more_body": False}
        return await receive()

    return replay
