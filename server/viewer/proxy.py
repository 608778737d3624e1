"""Viser under our own origin: its page, and a websocket that is passed on to its port.

Who may come here at all (Host, Origin, token) is the business of ``server.security``; this module
only knows which sessions exist.
"""

from __future__ import annotations

import asyncio
import contextlib
from functools import cache
from importlib.resources import files

from starlette.responses import HTMLResponse, Response
from starlette.websockets import WebSocket, WebSocketDisconnect
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.typing import Subprotocol

from server.viewer.guard import secret_headers
from server.viewer.session import Session, Sessions

__all__ = ["PAGE_POLICY", "UNKNOWN_SESSION", "page", "page_script", "pass_on"]

PAGE_POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'; "
    "style-src 'unsafe-inline'; worker-src blob:; connect-src 'self' data: blob:; "
    "img-src data: blob:; font-src data:; frame-ancestors 'self'"
)
"""Measured to be the least with which viser's page works."""

UNKNOWN_SESSION = 4404
"""Close code of a websocket to a session that does not exist."""

_GONE = 1001

_STYLE = (
    b"<style>[data-floating-window], #root .mantine-Paper-root, #webgl-software-rendering"
    b" { display: none !important; }</style>"
)


def page() -> Response:
    """Viser's page with our script, one self-contained file, under a strict policy."""
    return HTMLResponse(
        _page_bytes(),
        headers={
            "Content-Security-Policy": PAGE_POLICY,
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",
            "Cache-Control": "private, max-age=3600",
        },
    )


@cache
def page_script() -> bytes:
    """The element that lets viser's page colour vertices; in a replay file too."""
    script = files("server.viewer").joinpath("client", "colours.mjs").read_bytes()
    return b'<script type="module">' + script + b"</script>"


@cache
def _page_bytes() -> bytes:
    """The packaged page without its own panel and notice: the dashboard around it has controls."""
    packaged = files("viser").joinpath("client", "build", "index.html").read_bytes()
    return packaged.replace(b"</head>", _STYLE + page_script() + b"</head>", 1)


async def pass_on(browser: WebSocket, sessions: Sessions, session_id: str) -> None:
    """Connects a browser with the session's viser server until either leaves.

    Args:
        browser: Not yet accepted.
        sessions: All sessions.
        session_id: From the path; unknown ones are closed with code 4404.
    """
    session = sessions.get(session_id)
    if session is None:
        # A handshake that is refused shows the browser no code: accept, then close.
        await browser.accept()
        await browser.close(UNKNOWN_SESSION, "no such view")
        return
    try:
        viewer = await _connect(session, browser.scope.get("subprotocols", []))
    except (OSError, InvalidHandshake):
        await browser.accept()
        await browser.close(_GONE, "the view has ended")
        return
    async with viewer:
        with session.watched():
            await browser.accept(subprotocol=viewer.subprotocol)
            await _both_ways(browser, viewer)


async def _connect(session: Session, subprotocols: list[str]) -> ClientConnection:
    return await connect(
        f"ws://127.0.0.1:{session.port}",
        subprotocols=[Subprotocol(name) for name in subprotocols] or None,
        additional_headers=secret_headers(),
        user_agent_header=None,
        max_size=None,
        compression=None,
        ping_interval=None,
        proxy=None,
        close_timeout=1.0,
    )


async def _both_ways(browser: WebSocket, viewer: ClientConnection) -> None:
    ways = (
        asyncio.create_task(_upwards(browser, viewer)),
        asyncio.create_task(_downwards(browser, viewer)),
    )
    try:
        await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for way in ways:
            way.cancel()
        await asyncio.gather(*ways, return_exceptions=True)
        with contextlib.suppress(RuntimeError, WebSocketDisconnect):
            await browser.close(_GONE)


async def _upwards(browser: WebSocket, viewer: ClientConnection) -> None:
    """Carries the browser's camera and clicks to viser."""
    with contextlib.suppress(WebSocketDisconnect, ConnectionClosed):
        while True:
            await viewer.send(await browser.receive_bytes())


async def _downwards(browser: WebSocket, viewer: ClientConnection) -> None:
    """Carries the scene to the browser; a slow browser holds viser's sender, not our memory."""
    with contextlib.suppress(WebSocketDisconnect, ConnectionClosed, RuntimeError):
        async for message in viewer:
            if isinstance(message, bytes):
                await browser.send_bytes(message)
