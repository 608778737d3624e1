"""Every access rule on every route and websocket."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from server.app import create_app
from server.security import COOKIE, LOGIN_PATHS, Access, Guard
from server.settings import Settings, SettingsError
from server.vendor import plotly_url
from tests.server import odd_batches
from tests.server.server_case import Client, every_route, serving, settings_for

TOKEN = "correct horse battery staple"
SAFE = {"GET", "HEAD"}


def walk() -> tuple[list[tuple[str, str]], list[str]]:
    """Every (method, path) and every websocket's path, parameters as their names."""
    requests: list[tuple[str, str]] = []
    sockets: list[str] = []
    for route in every_route(create_app(settings_for(Path("unused"))).routes):
        path = route.path.replace("{", "").replace(":path}", "").replace("}", "")
        methods = getattr(route, "methods", None)
        if type(route).__name__ == "Mount":
            requests.append(("GET", f"{path}/js/main.js"))
        elif methods is None:
            sockets.append(path)
        else:
            requests += [(method, path) for method in sorted(methods)]
    return sorted(requests), sorted(sockets)


REQUESTS, SOCKETS = walk()
CHANGING = [item for item in REQUESTS if item[0] not in SAFE]
STREAMS = [item for item in REQUESTS if item[1].endswith("/events")]


def test_the_walk_finds_every_kind_of_route() -> None:
    paths = {path for _, path in REQUESTS}
    assert {"/", "/login", "/static/js/main.js", plotly_url(), "/api/v1/jobs"} <= paths
    assert SOCKETS == ["/viewer/session_id"]
    assert {path for _, path in STREAMS} == {"/api/v1/events", "/api/v1/jobs/job_id/events"}
    assert len(CHANGING) >= 5


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """Without a token."""
    settings = settings_for(
        tmp_path_factory.mktemp("server"), allowed_hosts=("bridges.example.org",)
    )
    with serving(settings, compute=odd_batches.finish) as client:
        yield client


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """With a token."""
    settings = settings_for(tmp_path_factory.mktemp("guarded"), token=TOKEN)
    with serving(settings, compute=odd_batches.finish) as client:
        yield client


def websocket(address: str, headers: Mapping[str, str]) -> ClientConnection:
    """A connection, through no proxy, of a client with patience."""
    return connect(address, additional_headers=headers, proxy=None, open_timeout=60.0)


def status(client: Client, method: str, path: str, **headers: str) -> int:
    """The answer's status, without reading a stream to its end."""
    with client.stream(method, path, headers=headers) as answer:
        if answer.status_code not in (200, 204, 304):
            answer.read()
            if answer.status_code in (401, 403, 421):
                assert answer.headers["content-type"] == "application/problem+json"
            if answer.content:
                assert set(answer.json()) == {"type", "title", "status", "detail", "errors"}
        assert "access-control-allow-origin" not in answer.headers
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert "default-src 'none'" in answer.headers["content-security-policy"]
        return answer.status_code


@pytest.mark.parametrize(("method", "path"), REQUESTS)
@pytest.mark.parametrize(
    "host", ["evil.example.org", "127.0.0.1.evil.org", "localhost.evil.org", "", "8.8.8.8", "[::2]"]
)
def test_a_foreign_host_is_misdirected(client: Client, method: str, path: str, host: str) -> None:
    assert status(client, method, path, Host=host) == 421


@pytest.mark.parametrize(
    "host", ["localhost", "127.0.0.1:99", "[::1]:8000", "LOCALHOST", "bridges.example.org:8000"]
)
def test_our_hosts_are_taken(client: Client, host: str) -> None:
    assert status(client, "GET", "/api/v1/health", Host=host) == 200


@pytest.mark.parametrize(("method", "path"), CHANGING + STREAMS)
@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "https://evil.example.org"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
    ids=str,
)
def test_foreign_pages_can_neither_change_nor_listen(
    client: Client, method: str, path: str, headers: dict[str, str]
) -> None:
    assert status(client, method, path, **headers) == 403


def test_a_stream_is_known_by_what_is_accepted(client: Client) -> None:
    headers = {"Accept": "text/event-stream", "Origin": "https://evil.example.org"}
    assert status(client, "GET", "/api/v1/jobs", **headers) == 403


@pytest.mark.parametrize(("method", "path"), CHANGING + STREAMS)
def test_our_own_page_may(client: Client, method: str, path: str) -> None:
    own = {"Origin": f"http://127.0.0.1:{client.port}", "Sec-Fetch-Site": "same-origin"}
    assert status(client, method, path, **own) not in (401, 403, 421, 500)


@pytest.mark.parametrize(("method", "path"), REQUESTS)
def test_without_the_token_nothing_is_told(guarded: Client, method: str, path: str) -> None:
    answer = status(guarded, method, path)
    if path in LOGIN_PATHS:
        assert answer != 401
    else:
        assert answer == 401
        assert status(guarded, method, path, Authorization="Bearer wrong") == 401
        assert status(guarded, method, path, Authorization=f"Basic {TOKEN}") == 401
        assert status(guarded, method, path, Cookie=f"{COOKIE}={TOKEN}") == 401
        assert status(guarded, method, path, Authorization=f"Bearer {TOKEN}") not in (401, 403)


def test_nothing_beside_the_routes_is_told_either(guarded: Client) -> None:
    for path in ("/static/js/api.js", "/none", "/api/v1/openapi.json", "/docs", "/login/x"):
        assert status(guarded, "GET", path) == 401


@pytest.mark.parametrize("path", SOCKETS)
@pytest.mark.parametrize(
    ("headers", "expected"),
    [
        ({"Host": "evil.example.org"}, 421),
        ({"Origin": "https://evil.example.org"}, 403),
        ({"Sec-Fetch-Site": "cross-site"}, 403),
    ],
    ids=str,
)
def test_websockets_refuse_strangers(
    client: Client, path: str, headers: dict[str, str], expected: int
) -> None:
    assert asyncio.run(handshake(Access(), path, headers)) == expected
    if "Host" in headers:
        return  # This client cannot send a second Host.
    with (
        pytest.raises(InvalidStatus) as refused,
        websocket(f"ws://127.0.0.1:{client.port}{path}", headers),
    ):
        pass
    assert refused.value.response.status_code == expected


@pytest.mark.parametrize("path", SOCKETS)
def test_websockets_need_the_token(guarded: Client, path: str) -> None:
    address = f"ws://127.0.0.1:{guarded.port}{path}"
    with pytest.raises(InvalidStatus) as refused, websocket(address, {}):
        pass
    assert refused.value.response.status_code == 401
    # With it the proxy answers: it accepts, and closes because there is no such session.
    headers = {"Authorization": f"Bearer {TOKEN}"}
    with websocket(address, headers) as socket:
        with pytest.raises(ConnectionClosed):
            socket.recv(timeout=60)
        assert socket.close_code == 4404


async def handshake(access: Access, path: str, headers: dict[str, str]) -> int:
    """The status with which the guard answers a websocket's handshake."""

    async def never(scope: Any, receive: Any, send: Any) -> None:
        raise AssertionError("a stranger came through")

    given = {"Host": "127.0.0.1", **headers}
    raw = [(name.lower().encode(), value.encode()) for name, value in given.items()]
    scope = {
        "type": "websocket",
        "path": path,
        "headers": raw,
        "extensions": {"websocket.http.response": {}},
    }
    sent: list[Any] = []

    async def receive() -> Any:
        return {"type": "websocket.connect"}

    async def send(message: Any) -> None:
        sent.append(message)

    await Guard(never, access)(scope, receive, send)
    return sent[0]["status"]


def test_the_login_page_leads_in(guarded: Client) -> None:
    visit = guarded.get("/", headers={"Accept": "text/html"})
    assert (visit.status_code, visit.headers["location"]) == (303, "/login")
    page = guarded.get("/login")
    assert "<form" in page.text
    assert "unsafe" not in page.headers["content-security-policy"]
    assert guarded.post("/login", json={"token": "wrong, but long enough"}).status_code == 401
    answer = guarded.post("/login", json={"token": TOKEN})
    assert answer.status_code == 204
    cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "samesite=strict" in cookie.lower()
    assert TOKEN not in cookie
    value = cookie.split(";")[0]
    assert status(guarded, "GET", "/api/v1/jobs", Cookie=f"a=1; {value}; b=2") == 200
    guarded.cookies.clear()


def test_two_hosts_are_none() -> None:
    async def call() -> int:
        sent: list[Any] = []

        async def send(message: Any) -> None:
            sent.append(message)

        async def nothing(*_: Any) -> None:
            raise AssertionError("passed")

        scope = {
            "type": "http",
            "method": "GET",
            "path": "/",
            "headers": [(b"host", b"localhost"), (b"host", b"evil.example.org")],
        }
        await Guard(nothing, Access())(scope, nothing, send)
        return sent[0]["status"]

    assert asyncio.run(call()) == 421


def test_the_network_needs_a_token(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="TRAINBRIDGE_TOKEN"):
        Settings.from_environment({}, host="0.0.0.0")
    with pytest.raises(SettingsError, match="fewer than 16"):
        Settings.from_environment({"TRAINBRIDGE_TOKEN": "short"}, host="0.0.0.0")
    file = tmp_path / "token"
    file.write_text(f"{TOKEN}\n")
    settings = Settings.from_environment({}, host="::", token_file=file)
    assert settings.token == TOKEN
    assert TOKEN not in repr(settings)
    assert Settings.from_environment({}, host="::1").token == ""


def test_the_page_and_its_library_are_served(client: Client) -> None:
    page = client.get("/")
    assert page.headers["content-type"].startswith("text/html")
    assert "Trainbridge" in page.text
    script = client.get("/static/js/main.js")
    assert script.headers["content-type"].startswith("text/javascript")
    library = client.get(client.json("meta")["plotly_url"])
    assert len(library.content) > 1_000_000
    assert library.headers["content-encoding"] == "gzip"
    assert "immutable" in library.headers["cache-control"]
    for path in (
        "/static/package.json",
        "/static/../pyproject.toml",
        "/static/node_modules/x.js",
        "/vendor/plotly-0/plotly.min.js",
        "/static/%2e%2e/server/app.py",
    ):
        assert client.get(path).status_code == 404


def test_openapi_tells_units_bounds_and_examples(client: Client) -> None:
    document = client.json("openapi.json")
    schemas = document["components"]["schemas"]
    step = schemas["Integration"]["properties"]["time_step"]
    assert step["unit"] == {"symbol": "s", "display": "ms", "scale": 1000.0}
    assert step["minimum"] < step["default"] < step["maximum"]
    assert step["description"]
    [example] = schemas["Submission"]["examples"]
    answer = client.post("/api/v1/studies/validate", json=example)
    assert answer.json()["errors"] == []
    references = set()

    def collect(part: Any) -> None:
        if isinstance(part, dict):
            references.add(part.get("$ref"))
            for item in part.values():
                collect(item)
        elif isinstance(part, list):
            for item in part:
                collect(item)

    collect(document)
    names = {str(ref).removeprefix("#/components/schemas/") for ref in references if ref}
    assert names <= set(schemas), json.dumps(sorted(names - set(schemas)))


def test_an_error_of_our_own_says_nothing_of_the_inside(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        client.app.state.service.database.jobs = lambda **_: 1 / 0
        answer: httpx.Response = client.get("/api/v1/jobs")
    assert answer.status_code == 500
    assert answer.headers["content-type"] == "application/problem+json"
    assert "division" not in answer.text
