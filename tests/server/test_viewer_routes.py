"""The viewer's routes, page and websocket, on a served application."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest
from fastapi import FastAPI
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from server.errors import MEDIA_TYPE, install_errors
from server.viewer import ViewerLimits, router
from tests.server.viewer_client import PROTOCOL, SceneClient, served
from tests.server.viewer_run import ExampleRun

RUN = ExampleRun()


def drain(connection: ClientConnection) -> None:
    """Receives until the connection is closed, and raises then."""
    while True:
        connection.recv(timeout=5.0)


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    app = FastAPI()
    install_errors(app)
    app.include_router(router(lambda _: RUN, ViewerLimits(sessions=2, idle=30.0)))
    with served(app) as address:
        yield address


@pytest.fixture
def session(address: str) -> Iterator[str]:
    answer = httpx.post(f"http://{address}/api/v1/runs/run-1/viewer", json={"theme": "dark"})
    assert answer.status_code == 201
    opened = answer.json()
    assert answer.headers["location"] == f"/api/v1/viewer/{opened['session']}"
    assert opened["url"] == f"/viewer/{opened['session']}/"
    yield opened["session"]
    httpx.delete(f"http://{address}/api/v1/viewer/{opened['session']}")


def test_the_subprotocol_is_passed_on(address: str, session: str) -> None:
    with SceneClient(address, session) as client:
        assert client.connection.subprotocol == PROTOCOL


def test_a_client_of_another_version_is_turned_away_by_viser(address: str, session: str) -> None:
    with (
        connect(
            f"ws://{address}/viewer/{session}", subprotocols=["viser-v0.0.1"], proxy=None
        ) as client,
        pytest.raises(ConnectionClosed),
    ):
        client.recv(timeout=5.0)


def test_an_unknown_session_is_closed_with_a_code(address: str) -> None:
    with (
        connect(f"ws://{address}/viewer/{'0' * 32}", subprotocols=[PROTOCOL], proxy=None) as client,
        pytest.raises(ConnectionClosed) as closed,
    ):
        client.recv(timeout=5.0)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 4404


def test_text_from_a_browser_ends_only_its_own_connection(address: str, session: str) -> None:
    with SceneClient(address, session) as client:
        client.connection.send("not binary")
        with pytest.raises(ConnectionClosed):
            drain(client.connection)
    with SceneClient(address, session) as client:
        assert client.settle() > 0


def test_the_page_is_self_contained_and_under_a_strict_policy(address: str, session: str) -> None:
    page = httpx.get(f"http://{address}/viewer/{session}/")
    assert page.status_code == 200
    policy = page.headers["content-security-policy"]
    assert policy.startswith("default-src 'none'")
    assert "frame-ancestors 'self'" in policy
    assert "http:" not in policy
    assert "'unsafe-eval'" not in policy
    assert "webgl-software-rendering" in page.text
    assert httpx.get(f"http://{address}/viewer/{'0' * 32}/").status_code == 404


def test_the_state_reads_back(address: str, session: str) -> None:
    resource = f"http://{address}/api/v1/viewer/{session}"
    before = httpx.get(resource).json()
    assert before["theme"] == "dark"
    assert before["playing"] is False
    assert before["layers"] == before["available_layers"]
    after = httpx.put(resource, json={"scale": 50, "layers": ["slab", "wheels"]}).json()
    assert after["scale"] == 50.0
    assert after["layers"] == ["slab", "wheels"]
    assert after["time"] == before["time"]


@pytest.mark.parametrize(
    ("body", "at"),
    [
        ('{"time": -1}', "/time"),
        ('{"time": 1e999}', "/time"),
        ('{"time": NaN}', "/time"),
        ('{"time": "1"}', "/time"),
        ('{"playing": 1}', "/playing"),
        ('{"rate": 0}', "/rate"),
        ('{"scale": 1e9}', "/scale"),
        ('{"camera": "behind"}', "/camera"),
        ('{"layers": ["roof"]}', "/layers/0"),
        ('{"layers": "slab"}', "/layers"),
        ('{"colour": "red"}', "/colour"),
        ("[]", ""),
    ],
)
def test_bad_input_is_refused(address: str, session: str, body: str, at: str) -> None:
    answer = httpx.put(
        f"http://{address}/api/v1/viewer/{session}",
        content=body,
        headers={"Content-Type": "application/json"},
    )
    assert answer.status_code == 422
    assert answer.headers["content-type"] == MEDIA_TYPE
    assert [error["pointer"] for error in answer.json()["errors"]] == [at]
    assert answer.json()["errors"][0]["remedy"]


def test_deleting_ends_the_session_and_its_clients(address: str, session: str) -> None:
    resource = f"http://{address}/api/v1/viewer/{session}"
    with SceneClient(address, session) as client:
        client.settle()
        assert httpx.delete(resource).status_code == 204
        with pytest.raises(ConnectionClosed):
            client.connection.recv(timeout=5.0)
    assert httpx.get(resource).status_code == 404
    assert httpx.delete(resource).status_code == 404


def test_a_view_too_many_is_refused(address: str) -> None:
    where = f"http://{address}/api/v1/runs/run-1/viewer"
    first, second = (httpx.post(where).json()["session"] for _ in range(2))
    with SceneClient(address, first), SceneClient(address, second):
        assert httpx.post(where).status_code == 429
    for session in (first, second):
        httpx.delete(f"http://{address}/api/v1/viewer/{session}")


def test_a_server_with_open_views_stops() -> None:
    app = FastAPI()
    app.include_router(router(lambda _: RUN))
    with served(app) as address:
        opened = httpx.post(f"http://{address}/api/v1/runs/run-1/viewer").json()["session"]
        client = SceneClient(address, opened)
        client.settle()
    # ``served`` has seen its thread end: an open view does not hold it up.
    with pytest.raises(ConnectionClosed):
        drain(client.connection)
