"""What open 3D views cost while nothing moves, and what one costs that plays.

Run with ``pytest tests/benchmarks -s`` to read the rows.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator

import pytest
from websockets.sync.client import connect

from server.viewer import ViewerLimits
from server.viewer.guard import secret_headers
from server.viewer.session import Session, Sessions
from tests.server.viewer_client import PROTOCOL
from tests.server.viewer_small_runs import BeamRun

VIEWS = 5
SECONDS = 3.0


@contextlib.contextmanager
def watched(session: Session) -> Iterator[None]:
    """A client that receives and throws away."""
    with (
        session.watched(),
        connect(
            f"ws://127.0.0.1:{session.port}",
            subprotocols=[PROTOCOL],
            additional_headers=secret_headers(),
            max_size=None,
            compression=None,
            proxy=None,
        ) as client,
    ):
        with contextlib.suppress(TimeoutError):
            while True:
                client.recv(timeout=0.5)
        yield


def processor_share() -> float:
    """Processor time of this process over real time, for some seconds."""
    begun, used = time.monotonic(), time.process_time()
    time.sleep(SECONDS)
    return (time.process_time() - used) / (time.monotonic() - begun)


@pytest.mark.slow
def test_views_that_stand_still_cost_nothing() -> None:
    sessions = Sessions(ViewerLimits())
    with contextlib.ExitStack() as stack:
        stack.callback(sessions.close_all)
        baseline = processor_share()
        opened = [sessions.open("run", BeamRun(), "light") for _ in range(VIEWS)]
        for session in opened:
            stack.enter_context(watched(session))
        time.sleep(1.0)
        paused = processor_share()
        sessions.change(opened[0], playing=True, rate=0.01)
        playing = processor_share()
    print(
        f"\n{VIEWS} views that stand still: {1e3 * paused:.1f} ms of processor a second "
        f"(without views {1e3 * baseline:.1f}); with one of them playing {1e3 * playing:.1f}"
    )
    # Each looks once a second whether the run has grown: well under a millisecond. Ten leave room
    # for viser's own timers and a busy machine.
    assert paused - baseline < 0.010
    assert playing < 0.15
