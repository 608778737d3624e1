"""Who may come here at all: one pure ASGI layer around everything.

On every request and websocket:

- ``Host`` names loopback or an allowed host (421): a foreign page cannot rebind its name to us.
- Whatever changes something, every websocket and every event stream refuses a foreign ``Origin``
  and ``Sec-Fetch-Site`` (403): a foreign page cannot make a visitor's browser act here.
- With a token: ``Authorization: Bearer``, or the cookie that the login page sets (401).

No cross-origin header is ever sent. Answers carry a strict content policy and ``nosniff``.
"""

from __future__ import annotations

import hashlib
import hmac
import json
from collections.abc import Iterable
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from ipaddress import ip_address
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

__all__ = ["COOKIE", "LOGIN_PATHS", "PAGE_POLICY", "Access", "Guard"]

COOKIE = "trainbridge_session"
LOGIN_PATHS = frozenset({"/login", "/login/login.js", "/login/login.css"})
"""What a visitor without the token may see."""

PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; font-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'self'; "
    "frame-ancestors 'none'"
)
"""Nothing from elsewhere, nothing inline."""

_SAFE_METHODS = frozenset({"GET", "HEAD"})
_OWN_SITES = frozenset({"", "same-origin", "none"})
_POLICY_VIOLATION = 1008


@dataclass(frozen=True, kw_only=True)
class Access:
    """The rules of one server.

    Attributes:
        allowed_hosts: Names besides loopback that ``Host`` may carry.
        token: The shared secret, empty for none.
    """

    allowed_hosts: tuple[str, ...] = ()
    token: str = ""

    def host_allowed(self, host: str) -> bool:
        """Whether a ``Host`` header names this server."""
        try:
            name = (urlsplit(f"//{host}").hostname or "").rstrip(".").lower()
        except ValueError:
            return False
        if name == "localhost" or name in {item.lower() for item in self.allowed_hosts}:
            return True
        try:
            return ip_address(name).is_loopback
        except ValueError:
            return False

    def token_matches(self, given: str) -> bool:
        """Whether a secret is the token, in constant time."""
        return hmac.compare_digest(_digest(given), _digest(self.token))

    def cookie_value(self) -> str:
        """What the login page's cookie holds: proof of the token, not the token."""
        key = self.token.encode()
        return hmac.new(key, b"trainbridge session", hashlib.sha256).hexdigest()

    def cookie_matches(self, given: str) -> bool:
        """Whether a cookie proves the token, in constant time."""
        return hmac.compare_digest(_digest(given), _digest(self.cookie_value()))


@dataclass(frozen=True)
class _Refusal:
    status: int
    title: str
    detail: str


class Guard:
    """The layer: refuses, or passes on and adds headers to the answer."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self.app = app
        self.access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """One request, websocket or lifespan."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        refusal = self._refusal(scope, headers)
        if scope["type"] == "websocket":
            if refusal is None:
                await self.app(scope, receive, send)
            else:
                await _refuse_websocket(refusal, scope, receive, send)
        elif refusal is None:
            await self.app(scope, receive, _with_headers(send))
        elif refusal.status == 401 and _is_navigation(scope, headers):
            await _answer(303, b"", [(b"location", b"/login")], _with_headers(send))
        else:
            await _refuse(refusal, _with_headers(send))

    def _refusal(self, scope: Scope, headers: Headers) -> _Refusal | None:
        hosts = headers.getlist("host")
        if len(hosts) != 1 or not self.access.host_allowed(hosts[0]):
            return _Refusal(
                421,
                "Misdirected request",
                "This server does not answer to that name. Start it with --allowed-host NAME.",
            )
        if _must_be_ours(scope, headers) and not _is_ours(headers, hosts[0]):
            return _Refusal(
                403, "Foreign page", "A page of another origin may not do this. Use this server's."
            )
        if self.access.token and not self._is_known(scope, headers):
            return _Refusal(
                401,
                "Token needed",
                "Send the token as 'Authorization: Bearer ...', or log in at /login.",
            )
        return None

    def _is_known(self, scope: Scope, headers: Headers) -> bool:
        if scope["path"] in LOGIN_PATHS and scope["type"] == "http":
            return True
        scheme, _, given = headers.get("authorization", "").partition(" ")
        if scheme.lower() == "bearer" and self.access.token_matches(given.strip()):
            return True
        return any(self.access.cookie_matches(value) for value in _cookies(headers))


def _must_be_ours(scope: Scope, headers: Headers) -> bool:
    if scope["type"] == "websocket" or scope["method"] not in _SAFE_METHODS:
        return True
    streams = "text/event-stream" in headers.get("accept", "")
    return streams or scope["path"].rstrip("/").endswith("/events")


def _is_ours(headers: Headers, host: str) -> bool:
    """Whether the sender is this server's own page, or no page at all (curl)."""
    if headers.get("sec-fetch-site", "").lower() not in _OWN_SITES:
        return False
    origins = headers.getlist("origin")
    if not origins:
        return True
    try:
        own = [urlsplit(origin).netloc.lower() == host.lower() for origin in origins]
    except ValueError:
        return False
    return all(own)


def _cookies(headers: Headers) -> Iterable[str]:
    for header in headers.getlist("cookie"):
        try:
            morsel = SimpleCookie(header).get(COOKIE)
        except CookieError:
            continue
        if morsel is not None:
            yield morsel.value


def _is_navigation(scope: Scope, headers: Headers) -> bool:
    return scope["method"] == "GET" and "text/html" in headers.get("accept", "")


def _digest(text: str) -> bytes:
    """Of equal length whatever the text: the comparison tells nothing about the secret's."""
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).digest()


def _with_headers(send: Send) -> Send:
    async def send_with_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            headers.setdefault("Content-Security-Policy", PAGE_POLICY)
            headers.setdefault("X-Content-Type-Options", "nosniff")
            headers.setdefault("Referrer-Policy", "no-referrer")
            headers.setdefault("Cross-Origin-Resource-Policy", "same-origin")
            headers.setdefault("Cross-Origin-Opener-Policy", "same-origin")
            headers.setdefault("Cache-Control", "no-store")
        await send(message)

    return send_with_headers


async def _answer(status: int, body: bytes, headers: list[tuple[bytes, bytes]], send: Send) -> None:
    length = (b"content-length", str(len(body)).encode())
    await send({"type": "http.response.start", "status": status, "headers": [*headers, length]})
    await send({"type": "http.response.body", "body": body})


async def _refuse(refusal: _Refusal, send: Send) -> None:
    document = {
        "type": "about:blank",
        "title": refusal.title,
        "status": refusal.status,
        "detail": refusal.detail,
        "errors": [],
    }
    headers = [(b"content-type", b"application/problem+json")]
    if refusal.status == 401:
        headers.append((b"www-authenticate", b'Bearer realm="trainbridge"'))
    await _answer(refusal.status, json.dumps(document).encode(), headers, send)


async def _refuse_websocket(refusal: _Refusal, scope: Scope, receive: Receive, send: Send) -> None:
    """Refuses the handshake itself, with the same status where the server can say it."""
    await receive()
    if "websocket.http.response" in scope.get("extensions", {}):
        start = {
            "type": "websocket.http.response.start",
            "status": refusal.status,
            "headers": [(b"content-type", b"text/plain")],
        }
        await send(start)
        await send({"type": "websocket.http.response.body", "body": refusal.detail.encode()})
    else:
        await send({"type": "websocket.close", "code": _POLICY_VIOLATION})
