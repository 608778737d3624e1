"""Viser servers that talk to nobody but our proxy.

Viser has no authentication, and any web page may open a websocket to a loopback port. Every
handshake and page request must therefore carry a secret of this process, which only the proxy
knows; and the handlers that would open a public tunnel are gone.
"""

from __future__ import annotations

import asyncio
import contextlib
import hmac
import http
import importlib
import secrets
import threading
from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from typing import Any

import rich
import viser
from viser import _messages as messages
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

__all__ = ["SECRET_HEADER", "UnguardedServerError", "secret_headers", "start_server", "stop_server"]

_infrastructure: Any = importlib.import_module("viser.infra._infra")
"""The module in which viser starts its websockets server."""

SECRET_HEADER = "X-Trainbridge-Viewer"
_SECRET = secrets.token_urlsafe(32)
_starting = threading.Lock()


class UnguardedServerError(RuntimeError):
    """The installed viser starts its websockets server in a way that we cannot guard."""


def secret_headers() -> dict[str, str]:
    """The header that opens a viewer's port; for the proxy only."""
    return {SECRET_HEADER: _SECRET}


def start_server() -> viser.ViserServer:
    """Starts a guarded viser server on a free loopback port; takes about 20 ms.

    Raises:
        UnguardedServerError: The guard did not take hold, or the server is not on loopback.
    """
    with _starting, _quiet, _guarded_serve() as guarded:
        server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    if not guarded or server.get_host() != "127.0.0.1":
        stop_server(server)
        raise UnguardedServerError(f"viser {viser.__version__} cannot be guarded")
    _refuse_sharing(server)
    # Once only: clients that are told again go back to their first camera.
    server.scene.set_up_direction("+z")
    return server


def stop_server(server: viser.ViserServer) -> None:
    """Stops a server and joins its thread; may take a second."""
    with _quiet:
        server.stop()


def _refuse_sharing(server: viser.ViserServer) -> None:
    """Removes the handlers by which any client could ask for a public tunnel."""
    connection = server._websock_server  # pyright: ignore[reportPrivateUsage]
    connection.unregister_handler(messages.ShareUrlRequest)
    connection.unregister_handler(messages.ShareUrlDisconnect)


@contextlib.contextmanager
def _guarded_serve() -> Generator[list[bool]]:
    """Wraps ``process_request`` of the servers that viser starts meanwhile.

    Viser passes no such option on, so its module sees a ``websockets`` whose ``serve`` is ours.
    """
    original: Any = _infrastructure.websockets
    guarded: list[bool] = []

    def serve(*args: Any, process_request: Callable[..., Any] | None = None, **options: Any) -> Any:
        guarded.append(True)
        return original.asyncio.server.serve(
            *args, process_request=_checked(process_request), **options
        )

    server = _Overlay(original.asyncio.server, serve=serve)
    overlay: Any = _Overlay(original, asyncio=_Overlay(original.asyncio, server=server))
    _infrastructure.websockets = overlay
    try:
        yield guarded
    finally:
        _infrastructure.websockets = original


def _checked(answer: Callable[..., Any] | None) -> Callable[[ServerConnection, Request], Any]:
    def process_request(connection: ServerConnection, request: Request) -> Any:
        given = request.headers.get_all(SECRET_HEADER)
        if [_is_secret(text) for text in given] != [True]:
            return Response(
                http.HTTPStatus.FORBIDDEN, "Forbidden", Headers({"Connection": "close"}), b""
            )
        return answer(connection, request) if answer else None

    return process_request


def _is_secret(text: str) -> bool:
    return hmac.compare_digest(text.encode(errors="replace"), _SECRET.encode())


class _WakingEvent(asyncio.Event):
    """An event that loses no waiter where viser's other threads set it beside their loop.

    ``asyncio.Event`` is not made for that: set between a waiter's look at it and its lying down, it
    counts as set, wakes nobody, and whatever sets it later finds nothing to do. The page then gets
    nothing more. Here another thread only notes it down; the loop, which viser asks to set it as
    well, wakes whoever waits, each time.
    """

    def set(self) -> None:
        """Notes it down; wakes those who wait, in their loop."""
        self._value = True
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            return
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(True)


@dataclass
class _WakingBuffer(_infrastructure.AsyncMessageBuffer):
    """Viser's messages to one client, or to all."""

    message_event: asyncio.Event = field(default_factory=_WakingEvent)


# Buffers are made whenever a client comes, not only while a server starts.
_infrastructure.AsyncMessageBuffer = _WakingBuffer


class _Overlay:
    """A module with some names replaced."""

    def __init__(self, module: Any, **replacements: Any) -> None:
        self._module = module
        self.__dict__.update(replacements)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._module, name)


class _Quiet:
    """Keeps viser's banners, which name the port, off the terminal; several threads may ask."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._asked = 0
        self._before = False

    def __enter__(self) -> None:
        with self._lock:
            if self._asked == 0:
                self._before = rich.get_console().quiet
                rich.get_console().quiet = True
            self._asked += 1

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._asked -= 1
            if self._asked == 0:
                rich.get_console().quiet = self._before


_quiet = _Quiet()
