"""Sessions: shut to everyone but the proxy, counted, reaped, closed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import httpx
import pytest
import viser
from viser import _messages as messages
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from server.viewer import ViewerLimits
from server.viewer.guard import SECRET_HEADER, secret_headers, start_server, stop_server
from server.viewer.session import Session, Sessions, TooManySessionsError
from tests.server.viewer_client import PROTOCOL
from tests.server.viewer_run import ExampleRun

RUN = ExampleRun()


def until(met: Callable[[], bool], seconds: float = 5.0) -> bool:
    """Waits for something to become true."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if met():
            return True
        time.sleep(0.01)
    return False


def open_directly(port: int, headers: dict[str, str]) -> None:
    connect(
        f"ws://127.0.0.1:{port}",
        subprotocols=[PROTOCOL],
        additional_headers=headers,
        proxy=None,
        compression=None,
    ).close()


@pytest.fixture(scope="module")
def guarded() -> Iterator[viser.ViserServer]:
    server = start_server()
    yield server
    stop_server(server)


@pytest.fixture
def sessions() -> Iterator[Sessions]:
    sessions = Sessions(ViewerLimits(sessions=2, idle=0.5))
    yield sessions
    sessions.close_all()


@pytest.mark.parametrize(
    "headers", [{}, {SECRET_HEADER: ""}, {SECRET_HEADER: "guess"}, {SECRET_HEADER: "\u00e9"}]
)
def test_viser_s_port_refuses_everyone_without_the_secret(
    guarded: viser.ViserServer, headers: dict[str, str]
) -> None:
    port = guarded.get_port()
    with pytest.raises(InvalidStatus) as refused:
        open_directly(port, headers)
    assert refused.value.response.status_code == 403
    sent = {name: value.encode("utf-8") for name, value in headers.items()}
    page = httpx.get(f"http://127.0.0.1:{port}/", headers=sent)
    assert page.status_code == 403
    assert page.content == b""


def test_the_proxy_s_secret_opens_the_port(guarded: viser.ViserServer) -> None:
    open_directly(guarded.get_port(), secret_headers())


def test_viser_listens_on_loopback_only(guarded: viser.ViserServer) -> None:
    assert guarded.get_host() == "127.0.0.1"


def test_no_client_can_ask_for_a_public_tunnel(guarded: viser.ViserServer) -> None:
    handlers = guarded._websock_server._incoming_handlers
    assert messages.ShareUrlRequest not in handlers
    assert messages.ShareUrlDisconnect not in handlers


def test_the_guard_leaves_other_websocket_servers_alone() -> None:
    from viser.infra import _infra
    from websockets.asyncio import server

    assert _infra.websockets.asyncio.server.serve is server.serve


def test_starting_says_nothing_on_the_terminal(capfd: pytest.CaptureFixture[str]) -> None:
    server = start_server()
    stop_server(server)
    assert capfd.readouterr() == ("", "")


def test_session_ids_are_not_to_be_guessed(sessions: Sessions) -> None:
    first, second = (sessions.open("run", RUN, "light").id for _ in range(2))
    assert len(first) == len(second) == 32  # 128 bits in hexadecimal digits
    assert first != second


def test_an_unwatched_session_makes_room_and_a_watched_one_does_not(sessions: Sessions) -> None:
    first = sessions.open("run", RUN, "light")
    second = sessions.open("run", RUN, "light")
    with first.watched():
        third = sessions.open("run", RUN, "light")
        assert sessions.get(second.id) is None
        assert port_is_closed(second)
        with third.watched(), pytest.raises(TooManySessionsError):
            sessions.open("run", RUN, "light")
    assert len(sessions) == 2


def test_a_session_that_nobody_watches_ends(sessions: Sessions) -> None:
    session = sessions.open("run", RUN, "light")
    with session.watched():
        assert not until(lambda: session.ended, 1.2), "it ends only when unwatched"
    assert until(lambda: session.ended)
    assert sessions.get(session.id) is None
    assert until(lambda: port_is_closed(session))
    assert len(sessions) == 0


def test_closing_closes_the_port(sessions: Sessions) -> None:
    session = sessions.open("run", RUN, "light")
    assert sessions.close(session.id)
    assert port_is_closed(session)
    assert not sessions.close(session.id)


def port_is_closed(session: Session) -> bool:
    try:
        httpx.get(f"http://127.0.0.1:{session.port}/")
    except httpx.ConnectError:
        return True
    return False
