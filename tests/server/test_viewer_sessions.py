"""Sessions: shut to everyone but the proxy, counted, paused, reaped, closed."""

from __future__ import annotations

import gc
import threading
import time
import weakref
from collections.abc import Callable, Iterator

import httpx
import numpy as np
import pytest
import viser
from viser import _messages as messages
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from server.viewer import ViewerLimits
from server.viewer.guard import SECRET_HEADER, secret_headers, start_server, stop_server
from server.viewer.playback import Player
from server.viewer.session import Session, Sessions, TooManySessionsError
from solver.results import SlabPeaks
from tests.server.viewer_client import PROTOCOL
from tests.server.viewer_small_runs import BeamRun, ModalRun

RUN = BeamRun()


def until(met: Callable[[], bool], seconds: float = 60.0) -> bool:
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
        open_timeout=60.0,
    ).close()


@pytest.fixture(scope="module")
def guarded() -> Iterator[viser.ViserServer]:
    server = start_server()
    yield server
    stop_server(server)


@pytest.fixture
def sessions() -> Iterator[Sessions]:
    sessions = Sessions(ViewerLimits(sessions=2, idle=30.0))
    yield sessions
    sessions.close_all()


@pytest.fixture
def hasty() -> Iterator[Sessions]:
    sessions = Sessions(ViewerLimits(idle=2.0))
    yield sessions
    sessions.close_all()


@pytest.fixture
def crowd() -> Iterator[tuple[Sessions, list[Session]]]:
    """Three sessions of which two may play at once."""
    sessions = Sessions(ViewerLimits(sessions=3, streams=2, idle=30.0))
    yield sessions, [sessions.open(f"run {i}", RUN, "light") for i in range(3)]
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
    page = httpx.get(f"http://127.0.0.1:{port}/", headers=sent, timeout=60)
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


def test_a_view_of_a_run_without_a_shape_yet_opens_at_rest_and_goes_on(sessions: Sessions) -> None:
    """Between the first word of a run and its first shape lies a moment, or its end."""
    run = BeamRun()
    run.done, run.committed_frames, run.committed = False, 0, 0
    session = sessions.open("run", run, "light")
    sessions.change(session, colour="displacement")
    bar = session.player.colour_bar()
    assert bar is not None
    assert (session.player.timeline.last, session.player.state.time) == (0.0, 0.0)
    run.committed_frames, run.committed = 21, 201
    assert session.player.timeline.last == pytest.approx(0.2)
    grown = session.player.colour_bar()
    assert grown is not None
    assert grown.maximum == pytest.approx(1.0)  # 1 mm at a quarter of the period, 0.125 s


def test_the_one_that_nobody_has_watched_for_longest_makes_room(sessions: Sessions) -> None:
    first, second = (sessions.open("run", RUN, "light") for _ in range(2))
    with first.watched():
        pass  # a page that loads anew comes back at once
    sessions.open("run", RUN, "light")
    assert sessions.get(first.id) is first
    assert sessions.get(second.id) is None


def test_a_large_run_that_opens_holds_up_no_other_view(sessions: Sessions) -> None:
    begun, go_on = threading.Event(), threading.Event()

    class Large(BeamRun):
        def slab_peaks(self) -> SlabPeaks | None:
            begun.set()
            go_on.wait(60.0)
            return None

    first = sessions.open("run", RUN, "light")
    opening = threading.Thread(target=sessions.open, args=("large", Large(), "light"))
    opening.start()
    assert begun.wait(60.0)
    steered = threading.Thread(target=sessions.change, args=(first,), kwargs={"playing": True})
    steered.start()
    steered.join(30.0)
    held_up = steered.is_alive()
    go_on.set()
    opening.join(60.0)
    assert not held_up
    assert len(sessions) == 2


@pytest.mark.slow
def test_a_session_that_has_ended_keeps_no_histories(hasty: Sessions) -> None:
    session = weakref.ref(hasty.open("run", RUN, "light"))
    assert until(lambda: gc.collect() >= 0 and session() is None)


@pytest.mark.slow
def test_a_session_that_nobody_watches_ends(hasty: Sessions) -> None:
    session = hasty.open("run", RUN, "light")
    with session.watched():
        assert not until(lambda: session.ended, 3.0), "it ends only when unwatched"
    assert until(lambda: session.ended)
    assert hasty.get(session.id) is None
    assert until(lambda: port_is_closed(session))
    assert len(hasty) == 0


def test_closing_closes_the_port(sessions: Sessions) -> None:
    session = sessions.open("run", RUN, "light")
    assert sessions.close(session.id)
    assert port_is_closed(session)
    assert not sessions.close(session.id)


def test_the_limits_are_those_promised() -> None:
    limits = ViewerLimits()
    assert (limits.sessions, limits.streams, limits.idle) == (20, 5, 60.0)


def test_one_too_many_that_plays_pauses_the_one_that_has_played_longest(
    crowd: tuple[Sessions, list[Session]],
) -> None:
    sessions, [first, second, third] = crowd
    with first.watched(), second.watched(), third.watched():
        sessions.change(second, playing=True, rate=0.01)
        sessions.change(first, playing=True, rate=0.01)
        sessions.change(second, scale=20.0)  # steering is not beginning anew
        sessions.change(third, playing=True, rate=0.01)
    assert [held.player.state.playing for held in (first, second, third)] == [True, False, True]
    assert "at most 2 play at once" in second.tell_pause()
    assert first.tell_pause() == third.tell_pause() == ""


def test_one_that_nobody_watches_is_paused_first(crowd: tuple[Sessions, list[Session]]) -> None:
    sessions, [first, second, third] = crowd
    with first.watched(), third.watched():
        for session in (first, second, third):
            sessions.change(session, playing=True, rate=0.01)
    assert [held.player.state.playing for held in (first, second, third)] == [True, False, True]


def test_a_page_that_has_not_heard_of_its_pause_does_not_end_it(
    crowd: tuple[Sessions, list[Session]],
) -> None:
    """Pages say every two seconds that they play: else views would pause each other in turn."""
    sessions, [first, second, third] = crowd
    for session in (first, second, third):
        sessions.change(session, playing=True, rate=0.01)
    assert not sessions.change(first, playing=True, time=0.2).playing
    assert second.player.state.playing
    assert first.tell_pause()
    assert sessions.change(first, playing=True).playing, "somebody has read it and pressed play"
    assert first.tell_pause() == ""
    assert not second.player.state.playing


def test_another_run_is_shown_on_the_same_server(sessions: Sessions) -> None:
    session = sessions.open("beam", RUN, "dark")
    port = session.port
    session.change(layers=frozenset({"deck", "wheels"}), colour="velocity", camera="side")
    session.switch("modes", ModalRun("viaduct"))
    state = session.player.state
    assert (session.run, session.port) == ("modes", port)
    assert (state.theme, state.camera) == ("dark", "side")
    assert state.colour == "none", "modes have no velocity"
    assert state.layers == {"deck"}, "what was hidden stays hidden"
    assert not state.playing
    nodes = {name.split("/")[1] for name in session._server.scene._handle_from_node_name}
    assert "wheels" not in nodes
    assert "deck" in nodes


@pytest.mark.parametrize("part", ["viaduct", "track", "train"])
def test_modes_swing_without_end(part: str) -> None:
    """At time 0 the shape is whole, half a cycle later it is mirrored; playing never ends."""
    run, clock = ModalRun(part), [0.0]
    server = start_server()
    player = Player(server, run, "light", clock=lambda: clock[0])
    player.change(mode=1, playing=True, rate=1.0, time=0.0)
    swings = []
    for clock[0] in (0.0, 0.25, 0.5, 1000.0):
        player.draw()
        picture = player._picture
        moved = picture.vertices if part != "train" else picture.body_centres
        swings.append(moved[:, 2].copy())
    stop_server(server)
    whole, rest, mirrored, later = swings
    assert np.abs(whole - rest).max() > 1e-3
    np.testing.assert_allclose(whole - rest, rest - mirrored, atol=1e-9)
    # A thousand cycles later, 1e-13 of each are lost to rounding.
    np.testing.assert_allclose(later, whole, atol=1e-9)
    assert player.state.playing
    assert player.state.time == pytest.approx(1000.0)


def port_is_closed(session: Session) -> bool:
    try:
        httpx.get(f"http://127.0.0.1:{session.port}/", timeout=60)
    except httpx.ConnectError:
        return True
    except httpx.TransportError:
        return False  # It was taken, and dropped while the port was closed.
    return False
