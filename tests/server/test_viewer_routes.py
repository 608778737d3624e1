"""The viewer's routes, page and websocket, on a served application."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from fastapi import FastAPI
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from server.errors import MEDIA_TYPE, gone_missing, install_errors
from server.viewer import FrameSource, ViewerLimits, router
from tests.server.viewer_client import PROTOCOL, SceneClient, served
from tests.server.viewer_small_runs import BeamRun, ModalRun
from tests.server.viewer_waiting import PATIENCE, http, quiet, until

RUNS: dict[str, FrameSource] = {
    "run-1": BeamRun(),
    "before": BeamRun(motion=False),
    "modes": ModalRun("viaduct"),
}


def opened(run: str) -> FrameSource:
    """A run; none of another name is there."""
    if run not in RUNS:
        raise gone_missing("run", run)
    return RUNS[run]


def drain(connection: ClientConnection) -> None:
    """Receives until the connection is closed, and raises then."""
    while True:
        connection.recv(timeout=PATIENCE)


def heights(client: SceneClient) -> np.ndarray:
    """The deck's vertices as last sent, their z. [m]"""
    return client.nodes["/deck"]["vertices"].reshape(-1, 3)[:, 2]


def until_reaching(client: SceneClient, low: float, high: float) -> None:
    """Receives until the deck lies between two heights and reaches both. [m]"""

    def reached() -> bool:
        ends = heights(client).min(), heights(client).max()
        return ends == (pytest.approx(low, abs=1e-6), pytest.approx(high, abs=1e-6))

    until(client, reached, f"a deck from {low} to {high} m")


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    app = FastAPI()
    install_errors(app)
    app.include_router(router(opened, ViewerLimits(sessions=2, streams=1, idle=600.0)))
    with served(app) as address:
        yield address


@pytest.fixture
def session(address: str) -> Iterator[str]:
    answer = http.post(f"http://{address}/api/v1/runs/run-1/viewer", json={"theme": "dark"})
    assert answer.status_code == 201
    view = answer.json()
    assert answer.headers["location"] == f"/api/v1/viewer/{view['session']}"
    assert view["url"] == f"/viewer/{view['session']}/"
    yield view["session"]
    http.delete(f"http://{address}/api/v1/viewer/{view['session']}")


def test_the_subprotocol_is_passed_on(address: str, session: str) -> None:
    with SceneClient(address, session) as client:
        assert client.connection.subprotocol == PROTOCOL


def test_a_client_of_another_version_is_turned_away_by_viser(address: str, session: str) -> None:
    with (
        connect(
            f"ws://{address}/viewer/{session}",
            subprotocols=["viser-v0.0.1"],
            proxy=None,
            open_timeout=PATIENCE,
        ) as client,
        pytest.raises(ConnectionClosed),
    ):
        client.recv(timeout=PATIENCE)


def test_an_unknown_session_is_closed_with_a_code(address: str) -> None:
    with (
        connect(
            f"ws://{address}/viewer/{'0' * 32}",
            subprotocols=[PROTOCOL],
            proxy=None,
            open_timeout=PATIENCE,
        ) as client,
        pytest.raises(ConnectionClosed) as closed,
    ):
        client.recv(timeout=PATIENCE)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 4404


def test_text_from_a_browser_ends_only_its_own_connection(address: str, session: str) -> None:
    with SceneClient(address, session) as client:
        client.connection.send("not binary")
        with pytest.raises(ConnectionClosed):
            drain(client.connection)
    with SceneClient(address, session) as client:
        until(client, lambda: client.messages > 0, "the scene")


def test_the_page_is_self_contained_and_under_a_strict_policy(address: str, session: str) -> None:
    page = http.get(f"http://{address}/viewer/{session}/")
    assert page.status_code == 200
    policy = page.headers["content-security-policy"]
    assert policy.startswith("default-src 'none'")
    assert "frame-ancestors 'self'" in policy
    assert "http:" not in policy
    assert "'unsafe-eval'" not in policy
    assert "webgl-software-rendering" in page.text
    assert http.get(f"http://{address}/viewer/{'0' * 32}/").status_code == 404


def test_the_state_reads_back(address: str, session: str) -> None:
    resource = f"http://{address}/api/v1/viewer/{session}"
    before = http.get(resource).json()
    assert before["theme"] == "dark"
    assert before["playing"] is False
    assert before["layers"] == before["available_layers"]
    after = http.put(resource, json={"scale": 50, "layers": ["deck", "wheels"]}).json()
    assert after["scale"] == 50.0
    assert after["layers"] == ["deck", "wheels"]
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
        ('{"layers": "deck"}', "/layers"),
        ('{"colour": "red"}', "/colour"),
        ('{"colour": "peak"}', "/colour"),
        ('{"mode": -1}', "/mode"),
        ('{"mode": 1}', "/mode"),
        ('{"mode": 1.0}', "/mode"),
        ('{"run": "elsewhere"}', "/run"),
        ('{"run": 7}', "/run"),
        ('{"run": "modes", "mode": 3}', "/mode"),
        ('{"run": "modes", "layers": ["deck", "wheels"]}', "/layers/1"),
        ('{"run": "before", "colour": "velocity"}', "/colour"),
        ('{"place": [1, 2]}', "/place"),
        ('{"place": [1, 2, "3"]}', "/place/2"),
        ('{"place": [1, 2, 1e9]}', "/place/2"),
        ('{"picked": null}', "/picked"),
        ('{"paused": ""}', "/paused"),
        ("[]", ""),
    ],
)
def test_bad_input_is_refused(address: str, session: str, body: str, at: str) -> None:
    answer = http.put(
        f"http://{address}/api/v1/viewer/{session}",
        content=body,
        headers={"Content-Type": "application/json"},
    )
    assert answer.status_code == 422
    assert answer.headers["content-type"] == MEDIA_TYPE
    assert [error["pointer"] for error in answer.json()["errors"]] == [at]
    assert answer.json()["errors"][0]["remedy"]
    state = http.get(f"http://{address}/api/v1/viewer/{session}").json()
    assert state["run"] == "run-1", "what was refused has changed nothing"


def test_colours_come_with_a_bar_in_display_units(address: str, session: str) -> None:
    resource = f"http://{address}/api/v1/viewer/{session}"
    state = http.put(resource, json={"colour": "displacement"}).json()
    assert state["available_colours"] == ["none", "displacement", "velocity", "acceleration"]
    bar = state["colour_bar"]
    assert (bar["quantity"], bar["unit"], bar["minimum"]) == ("displacement", "mm", 0.0)
    # The half wave's amplitude is 1 mm; the frame of its peak need not be one that is looked at.
    assert 0.95 <= bar["maximum"] <= 1.0
    assert bar["stops"][0][0] == 0.0
    assert bar["stops"][-1][0] == 1.0
    assert all(len(colour) == 7 and colour[0] == "#" for _, colour in bar["stops"])
    assert http.put(resource, json={"colour": "none"}).json()["colour_bar"] is None


def test_the_run_is_switched_on_the_same_connection(address: str, session: str) -> None:
    resource = f"http://{address}/api/v1/viewer/{session}"
    with SceneClient(address, session) as client:
        until(client, lambda: "/deck" in client.nodes, "the deck")
        first = heights(client).copy()
        state = http.put(resource, json={"run": "modes", "mode": 1, "scale": 0.5}).json()
        assert (state["run"], state["modal"], state["mode"]) == ("modes", True, 1)
        assert (state["available_modes"], state["last_time"]) == (3, 1.0)
        assert "wheels" not in state["available_layers"]
        # The second mode of a beam is a whole wave: up at a quarter, down at three quarters.
        until_reaching(client, 0.5, 1.5)
        assert not np.array_equal(first, heights(client))
        back = http.put(resource, json={"run": "run-1"}).json()
        assert (back["modal"], back["available_modes"], back["theme"]) == (False, 0, "dark")
        assert back["last_time"] == pytest.approx(1.0)
        assert "wheels" in back["layers"]


@pytest.mark.slow
def test_a_mode_swings_while_it_plays_and_stands_while_it_does_not(
    address: str, session: str
) -> None:
    resource = f"http://{address}/api/v1/viewer/{session}"
    with SceneClient(address, session) as client:
        http.put(resource, json={"run": "modes", "scale": 1.0})
        until(client, lambda: "/deck" in client.nodes, "the deck")
        quiet(client, 0.6)
        for at, low, high in ((0.0, 1.0, 2.0), (0.25, 1.0, 1.0), (0.5, 0.0, 1.0)):
            http.put(resource, json={"time": at})
            until_reaching(client, low, high)
        quiet(client, 0.6)
        http.put(resource, json={"playing": True, "rate": 2.0})
        before = client.messages
        until(client, lambda: client.messages > before, "a swing")
        assert http.get(resource).json()["playing"]
        http.put(resource, json={"playing": False})


def test_one_too_many_that_plays_says_why_another_stands(address: str, session: str) -> None:
    where = f"http://{address}/api/v1/viewer/"
    other = http.post(f"http://{address}/api/v1/runs/run-1/viewer").json()["session"]
    assert http.put(where + session, json={"playing": True, "rate": 0.01}).json()["playing"]
    assert http.put(where + other, json={"playing": True, "rate": 0.01}).json()["playing"]
    told = http.put(where + session, json={"playing": True, "time": 0.1}).json()
    assert not told["playing"]
    assert "at most 1 play at once" in told["paused"]
    assert http.put(where + other, json={"time": 0.2}).json()["playing"]
    assert http.put(where + session, json={"playing": True}).json()["paused"] == ""
    assert "at most 1" in http.get(where + other).json()["paused"]
    http.delete(where + other)


def test_a_place_from_a_shared_link_is_marked_as_a_click_is(address: str, session: str) -> None:
    resource = f"http://{address}/api/v1/viewer/{session}"
    with SceneClient(address, session) as client:
        until(client, lambda: "/deck" in client.nodes, "the deck")
        picked = http.put(resource, json={"place": [8.2, 1.5, 1.1]}).json()["picked"]
        assert picked == {"sequence": 0, "layer": "deck", "point": [8.0, 2.0, 1.0], "slab_point": 8}
        until(client, lambda: "/picked" in client.nodes, "the marker")
        assert http.put(resource, json={"place": None}).json()["picked"] is None


@pytest.mark.slow
def test_a_click_s_ray_becomes_a_point_and_a_marker(address: str, session: str) -> None:
    resource = f"http://{address}/api/v1/viewer/{session}"

    def picked() -> Any:
        return http.get(resource).json()["picked"]

    with SceneClient(address, session) as client:
        until(client, lambda: "/deck" in client.nodes, "the deck")
        assert picked() is None
        client.look((10.0, -8.0, 6.0), (10.0, 0.0, 1.0))
        client.click((8.1, 0.5, 6.0), (0.0, 0.0, -1.0))
        until(client, lambda: picked() is not None, "the clicked point")
        first = {"sequence": 1, "layer": "deck", "point": [8.0, 2.0, 1.0], "slab_point": 8}
        assert picked() == first
        until(client, lambda: 0.03 <= client.nodes["/picked"]["radius"] <= 0.6, "the marker")
        client.click((8.1, 0.5, 6.0), (0.0, 0.0, 1.0))
        client.settle()
        assert picked() == first, "the sky is no point"
        client.click((12.1, -0.5, 6.0), (0.0, 0.0, -1.0))
        until(client, lambda: picked() != first, "the next point")
        again = picked()
        assert (again["sequence"], again["point"]) == (2, [12.0, -2.0, 1.0]), "nor was it counted"
        http.put(resource, json={"time": 0.12, "scale": 100.0})

        def lowered() -> float:
            return client.poses["/picked"][2]

        def moves_with_its_point() -> bool:
            deck = client.nodes["/deck"]["vertices"].reshape(-1, 3)
            at = deck[(abs(deck[:, 0] - 12.0) < 1e-6) & (deck[:, 1] < 0)][0]
            return lowered() < 0.99 and abs(lowered() - at[2]) < 1e-6

        until(client, moves_with_its_point, "the marker lowered with its point")


def test_deleting_ends_the_session_and_its_clients(address: str, session: str) -> None:
    resource = f"http://{address}/api/v1/viewer/{session}"
    with SceneClient(address, session) as client:
        until(client, lambda: "/deck" in client.nodes, "the deck")
        assert http.delete(resource).status_code == 204
        with pytest.raises(ConnectionClosed):
            drain(client.connection)
    assert http.get(resource).status_code == 404
    assert http.delete(resource).status_code == 404


def test_a_view_too_many_is_refused(address: str) -> None:
    where = f"http://{address}/api/v1/runs/run-1/viewer"
    first, second = (http.post(where).json()["session"] for _ in range(2))
    with SceneClient(address, first), SceneClient(address, second):
        assert http.post(where).status_code == 429
    for session in (first, second):
        http.delete(f"http://{address}/api/v1/viewer/{session}")


def test_a_server_with_open_views_stops() -> None:
    app = FastAPI()
    app.include_router(router(opened))
    with served(app) as address:
        view = http.post(f"http://{address}/api/v1/runs/run-1/viewer").json()["session"]
        client = SceneClient(address, view)
        until(client, lambda: "/deck" in client.nodes, "the deck")
    # ``served`` has seen its thread end: an open view does not hold it up.
    with pytest.raises(ConnectionClosed):
        drain(client.connection)
