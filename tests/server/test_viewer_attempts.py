"""A view goes on where its run does: with the next attempt, or to the end of what is left."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Iterator
from pathlib import Path

import numpy as np
import pytest

from server.errors import gone_missing
from server.store import NotStoredError, RunReader, RunWriter
from server.viewer import FrameSource, StoppedRun, ViewerLimits
from server.viewer.guard import start_server, stop_server
from server.viewer.picture import PictureMaker
from server.viewer.playback import Player
from server.viewer.session import Sessions
from server.viewer.timeline import Timeline
from solver.results import Frame, Sample
from tests.server.test_viewer_sessions import until
from tests.server.viewer_small_runs import BeamRun, ModalRun


class Attempt(BeamRun):
    """One attempt at a run; of a removed one nothing can be read."""

    def __init__(self, identity: str, *, done: bool, frames: int = 101) -> None:
        super().__init__()
        self.identity, self.done = identity, done
        self.committed_frames, self.committed = frames, 10 * (frames - 1) + 1
        self.removed = False
        self.asked: list[tuple[str, ...]] = []

    def frame(self, index: int, *, motion: Collection[str] = ("velocity", "acceleration")) -> Frame:
        """A frame, and what was asked of it."""
        if self.removed:
            raise NotStoredError("removed")
        self.asked.append(tuple(motion))
        return super().frame(index, motion=motion)


@pytest.fixture
def follow() -> Iterator[Callable[[Callable[[str], FrameSource]], Sessions]]:
    opened: list[Sessions] = []

    def make(newest: Callable[[str], FrameSource]) -> Sessions:
        opened.append(Sessions(ViewerLimits(idle=30.0, patience=0.1), newest))
        return opened[-1]

    yield make
    for sessions in opened:
        sessions.close_all()


def test_a_view_goes_on_with_the_next_attempt_as_it_was(follow) -> None:
    """A worker died: its attempt says never that it is done, and gets no more frames."""
    first = Attempt("run/001", done=False, frames=51)
    second = Attempt("run/002", done=False, frames=71)
    newest: list[FrameSource] = [first]
    sessions = follow(lambda _: newest[0])
    session = sessions.open("run", first, "dark")
    with session.watched():
        sessions.change(session, time=0.4, scale=7.0, colour="velocity", layers=frozenset({"deck"}))
        sessions.change(session, camera="side", playing=True, rate=1e-6)
        assert not until(lambda: session.player.timeline.last > 0.5, 0.5), "it may just be slow"
        newest[0] = second
        assert until(lambda: session.player.timeline.last == pytest.approx(0.7))
        state = session.player.state
        assert (state.scale, state.colour, state.camera) == (7.0, "velocity", "side")
        assert (state.theme, state.layers, state.playing) == ("dark", frozenset({"deck"}), True)
        assert state.time == pytest.approx(0.4, abs=0.05)
        assert not session.ended


def test_an_attempt_that_is_removed_while_it_is_shown_is_left_for_the_next(follow) -> None:
    first = Attempt("run/001", done=False)
    second = Attempt("run/002", done=True, frames=61)
    sessions = follow(lambda _: second)
    session = sessions.open("run", first, "light")
    first.removed = True
    with session.watched():
        sessions.change(session, time=0.3)
        assert until(lambda: session.player.timeline.last == pytest.approx(0.6))
        assert not session.ended


def test_a_view_of_a_deleted_run_ends_without_a_stack_of_calls(follow, caplog) -> None:
    run = Attempt("run/001", done=False)

    def missing(_: str) -> FrameSource:
        raise gone_missing("run", "run")

    sessions = follow(missing)
    session = sessions.open("run", run, "light")
    run.removed = True
    with session.watched():
        sessions.change(session, time=0.3)
        assert until(lambda: session.ended)
    assert not [record for record in caplog.records if record.exc_info]


@pytest.mark.slow
def test_a_database_that_is_away_ends_no_view(follow) -> None:
    run = Attempt("run/001", done=False)
    looked = threading.Event()

    def away(_: str) -> FrameSource:
        looked.set()
        raise OSError("the database is away")

    sessions = follow(away)
    session = sessions.open("run", run, "light")
    with session.watched():
        assert looked.wait(60.0)
        sessions.change(session, time=0.3)
        assert not until(lambda: session.ended, 0.3)


def test_playing_ends_with_the_last_frame_of_a_run_that_failed(tmp_path: Path) -> None:
    """It never will be done: without saying so its view would wait, and stream, for ever."""
    run, clock = BeamRun(), [0.0]
    writer = RunWriter(tmp_path, run.plan)
    for step in range(201):
        frame = run.frame(step // 10) if step % 10 == 0 else None
        channels = np.full(len(run.plan.channels), 80e3)
        slab = np.zeros(len(run.plan.slab.coordinates))
        writer.append(
            Sample(step=step, time=step * 1e-3, channels=channels, slab=slab, frame=frame)
        )
    writer.flush()
    computing, stopped = RunReader(tmp_path), StoppedRun(tmp_path)
    assert computing.identity != stopped.identity
    server = start_server()
    for source, playing in ((computing, True), (stopped, False)):
        player = Player(server, source, "light", clock=lambda: clock[0])
        player.change(time=0.0, rate=1.0, playing=True)
        clock[0] += 10.0
        player.draw()
        assert player.state.time == pytest.approx(0.2)
        assert player.state.playing is playing
    stop_server(server)


def test_a_picture_reads_only_what_its_colours_tell() -> None:
    """Each array of a frame costs a millisecond at 50,000 vertices."""
    run = Attempt("run/001", done=True)
    maker = PictureMaker(run)
    maker.colour_bar("acceleration")
    for colour, read in (
        ("none", ()),
        ("displacement", ()),
        ("velocity", ("velocity",)),
        ("acceleration", ("acceleration",)),
    ):
        run.asked.clear()
        maker.picture(30, 1.0, colour)
        assert set(run.asked) - {()} == ({read} if read else set())


def test_a_finished_run_is_not_asked_again_whether_it_is_done() -> None:
    """Where results lie in an object store each question is a request."""
    asked = 0

    class Asked(BeamRun):
        @property
        def done(self) -> bool:
            nonlocal asked
            asked += 1
            return True

        @done.setter
        def done(self, value: bool) -> None: ...

    timeline = Timeline(Asked())
    assert all(timeline.done for _ in range(100))
    assert asked == 1


@pytest.mark.parametrize(("part", "size"), [("viaduct", 1.0), ("train", 1.0), ("track", 0.5)])
def test_shapes_of_modes_are_first_drawn_as_large_as_can_be_believed(part, size) -> None:
    assert PictureMaker(ModalRun(part)).scale() == size
