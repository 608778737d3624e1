"""Viewing sessions: one viser server and one thread each, counted, reaped and closed."""

from __future__ import annotations

import contextlib
import logging
import secrets
import threading
import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import viser

from server.store.failures import StoreError
from server.store.reader import NotStoredError
from server.viewer.guard import start_server, stop_server
from server.viewer.palette import Theme
from server.viewer.picking import Ray
from server.viewer.playback import PlaybackState, Player
from server.viewer.source import FrameSource

__all__ = ["OpenReader", "Session", "Sessions", "TooManySessionsError", "ViewerLimits"]

_log = logging.getLogger("trainbridge.viewer")


@dataclass(frozen=True, kw_only=True)
class ViewerLimits:
    """How much the viewer may take.

    Attributes:
        sessions: Open at once.
        streams: That play at once.
        idle: A session without clients ends after this time. [s]
        frame_rate: Most pictures sent in a second. [Hz]
        patience: A run that has stored nothing new for this time may have a new attempt. [s]
    """

    sessions: int = 20
    streams: int = 5
    idle: float = 60.0
    frame_rate: float = 15.0
    patience: float = 3.0


OpenReader: TypeAlias = Callable[[str], FrameSource]
"""Opens the newest attempt at a run by the run's id."""


class TooManySessionsError(Exception):
    """Every session is taken and watched."""


class Session:
    """One viewing session: a viser server that shows one run, and later perhaps another.

    It runs in a thread of its own until it is closed, or nobody has watched for a while. Viser's
    server starts in the constructor, which takes some 50 ms: keep it off the event loop.

    Attributes:
        id: 128 random bits.
        run: The run's name.
        port: Viser's loopback port, shut to everyone but the proxy.
    """

    def __init__(
        self,
        run: str,
        source: FrameSource,
        theme: Theme,
        limits: ViewerLimits,
        newest: OpenReader | None = None,
        forget: Callable[[str], None] | None = None,
    ) -> None:
        self.id = secrets.token_hex(16)
        self.run = run
        self._source = source
        self._newest, self._forget = newest, forget
        self._looked, self._committed = time.monotonic(), source.committed
        self._limits = limits
        self._server = start_server()
        self.port = self._server.get_port()
        try:
            self._player = Player(self._server, source, theme)
        except BaseException:
            stop_server(self._server)
            raise
        self._wake = threading.Event()
        self._closing = threading.Event()
        self._drawing = threading.Lock()
        self._lock = threading.Lock()
        self._clients = 0
        self._watched = time.monotonic()
        self._streams_since = self._watched
        self._paused, self._told, self._trouble = "", True, ""
        self._server.scene.on_click()(self._clicked)
        self._server.on_client_connect(self._welcome)
        self._thread = threading.Thread(target=self._show, name="viewer", daemon=True)
        self._thread.start()

    @property
    def player(self) -> Player:
        """What is shown."""
        return self._player

    @property
    def clients(self) -> int:
        """Browsers that watch now."""
        return self._clients

    @property
    def watched_until(self) -> float:
        """When its last client left, or it was opened."""
        return self._watched

    @property
    def ended(self) -> bool:
        """Whether the session can no longer be watched."""
        return self._closing.is_set()

    @property
    def streaming(self) -> bool:
        """Whether pictures go out, or would if somebody watched."""
        return not self.ended and self._player.state.playing

    @property
    def streams_since(self) -> float:
        """When it began to play."""
        return self._streams_since

    @property
    def may_play(self) -> bool:
        """Not before somebody has read why it was paused.

        A dashboard says again and again that it plays; one that has not heard of the pause yet
        would end it, and another view's pause would answer that.
        """
        return self._told

    def change(self, **changes: object) -> PlaybackState:
        """Changes fields of the playback state and shows it at once."""
        if changes.get("playing"):
            self._paused = ""
            if not self._player.state.playing:
                self._streams_since = time.monotonic()
        state = self._player.change(**changes)
        self._wake.set()
        return state

    def mark(self, place: Sequence[float] | None) -> None:
        """Marks the point nearest to a place, or none.

        Args:
            place: At rest, (x, y, z). [m]
        """
        self._player.mark(place)
        self._wake.set()

    def pause(self, reason: str) -> None:
        """Stops the time for a reason that its viewers should read."""
        self._player.change(playing=False)
        self._paused, self._told = reason, False

    def tell_pause(self) -> str:
        """Why it was paused, empty where it was not; from now on it may play again."""
        self._told = True
        return self._paused

    def switch(self, run: str, source: FrameSource) -> None:
        """Shows another run on the same server, to the same clients.

        Args:
            run: Its name.
            source: Its frames.
        """
        with self._drawing:
            before = self._player
            self._player = Player(self._server, source, before.state.theme, before)
            self.run, self._source = run, source
        self._wake.set()

    @contextlib.contextmanager
    def watched(self) -> Generator[None]:
        """Counts a client for as long as it is connected."""
        with self._lock:
            self._clients += 1
        self._wake.set()
        try:
            yield
        finally:
            with self._lock:
                self._clients -= 1
                self._watched = time.monotonic()

    def close(self) -> None:
        """Ends the session; its clients are disconnected. Returns when its port is closed."""
        self._closing.set()
        self._wake.set()
        self._thread.join(timeout=10.0)

    def _welcome(self, client: viser.ClientHandle) -> None:
        client.camera.on_update(lambda _: self._player.notice(client))
        self._player.welcome(client)

    def _clicked(self, event: viser.SceneClickEvent) -> None:
        """Viser tells clicks from drags, which move the camera, and gives the ray of a click."""
        eye = event.client.camera
        direction = np.array(event.ray_direction)
        forward = (eye.look_at - eye.position) / np.linalg.norm(eye.look_at - eye.position)
        begin = eye.near / max(float(direction @ forward), 1e-3)
        if self._player.pick(
            Ray(origin=np.array(event.ray_origin), direction=direction, begin=begin)
        ):
            self._wake.set()

    def _show(self) -> None:
        try:
            while not self._closing.is_set():
                begun = time.monotonic()
                if self._clients:
                    self._draw_if_possible()
                elif begun - self._watched > self._limits.idle:
                    break
                self._rest(begun)
        except NotStoredError as error:
            _log.info("the 3D view of run %s ended: %s", self.run, error)
        except Exception:
            _log.exception("the 3D view of run %s ended", self.run)
        finally:
            self._closing.set()
            stop_server(self._server)
            if self._forget is not None:
                self._forget(self.id)

    def _draw_if_possible(self) -> None:
        """A store that does not answer may do so again: what is shown stays until then."""
        try:
            with self._drawing:
                self._draw()
            self._trouble = ""
        except StoreError as error:
            if str(error) != self._trouble:
                _log.warning("the 3D view of run %s waits: %s", self.run, error)
            self._trouble = str(error)

    def _draw(self) -> None:
        """Shows the state now, of the newest attempt where the one before has stopped."""
        now = time.monotonic()
        if now - self._looked > self._limits.patience and not self._player.timeline.done:
            committed = self._source.committed
            if committed == self._committed:
                self._go_on()
            self._looked, self._committed = now, committed
        try:
            self._player.draw()
        except NotStoredError:
            if not self._go_on():
                raise

    def _go_on(self) -> bool:
        """Shows another attempt at the run as this one was shown; says whether there is one."""
        try:
            source = self._newest(self.run) if self._newest else self._source
        except Exception as error:
            # Neither a database that is away for a moment nor a deleted run is the view's fault.
            _log.info("the 3D view of run %s cannot look for news: %s", self.run, error)
            return False
        if source.identity == self._source.identity:
            return False
        before = self._player
        player = Player(self._server, source, before.state.theme, before)
        player.resume(before.state)
        # Not before it shows what the other one did: a change meanwhile would be taken back.
        self._player, self._source = player, source
        return True

    def _rest(self, begun: float) -> None:
        """Waits for the next picture's turn, and longer while nothing moves."""
        turn = 1.0 / self._limits.frame_rate
        self._closing.wait(max(0.0, turn - (time.monotonic() - begun)))
        if not (self._clients and self._player.state.playing):
            self._wake.wait(min(1.0, self._limits.idle / 4.0))
        self._wake.clear()


class Sessions:
    """All viewing sessions of the process; safe to use from several threads."""

    def __init__(self, limits: ViewerLimits, newest: OpenReader | None = None) -> None:
        self._limits = limits
        self._newest = newest
        self._lock = threading.Lock()
        self._open: dict[str, Session] = {}
        self._opening = 0

    def open(self, run: str, source: FrameSource, theme: Theme) -> Session:
        """Opens a session; the longest unwatched one makes room where all are taken.

        Raises:
            TooManySessionsError: All are watched.
        """
        spare = self._make_room()
        if spare is not None:
            spare.close()
        try:
            # Not under the lock: a large run takes a second, and others want to play meanwhile.
            session = Session(run, source, theme, self._limits, self._newest, self._forget)
            with self._lock:
                self._open[session.id] = session
        finally:
            with self._lock:
                self._opening -= 1
        return session

    def get(self, session_id: str) -> Session | None:
        """A session that can be watched, by its id."""
        session = self._open.get(session_id)
        return None if session is None or session.ended else session

    def change(self, session: Session, **changes: object) -> PlaybackState:
        """Changes what a session shows; one that begins to play may pause another.

        Args:
            session: Which.
            **changes: Fields of ``PlaybackState``, and ``pose`` of the camera.
        """
        with self._lock:
            if changes.get("playing") and not session.may_play:
                changes["playing"] = False
            elif changes.get("playing"):
                self._make_way(session)
            return session.change(**changes)

    def close(self, session_id: str) -> bool:
        """Closes a session; false where there is none."""
        with self._lock:
            session = self._open.pop(session_id, None)
        if session is None:
            return False
        session.close()
        return True

    def close_all(self) -> None:
        """Closes every session, all at once."""
        with self._lock:
            sessions, self._open = list(self._open.values()), {}
        closers = [threading.Thread(target=session.close) for session in sessions]
        for closer in closers:
            closer.start()
        for closer in closers:
            closer.join()

    def __len__(self) -> int:
        with self._lock:
            self._forget_ended()
            return len(self._open)

    def _make_room(self) -> Session | None:
        """Counts a session that is about to open; gives the one that has to end for it, if any."""
        with self._lock:
            self._forget_ended()
            spare = None
            if len(self._open) + self._opening >= self._limits.sessions:
                unwatched = [held for held in self._open.values() if not held.clients]
                if not unwatched:
                    raise TooManySessionsError(f"{len(self._open)} views are open")
                spare = min(unwatched, key=lambda held: held.watched_until)
                del self._open[spare.id]
            self._opening += 1
            return spare

    def _make_way(self, session: Session) -> None:
        """Pauses those that have played longest, unwatched ones first."""
        most = self._limits.streams
        others = [held for held in self._open.values() if held is not session and held.streaming]
        others.sort(key=lambda held: (held.clients > 0, held.streams_since))
        for held in others[: max(0, len(others) + 1 - most)]:
            held.pause(
                f"Paused, because another 3D view began to play: at most {most} play at once. "
                "Press play to go on here."
            )

    def _forget(self, session_id: str) -> None:
        """Lets a session that has ended by itself go, and with it the histories it has read."""
        with self._lock:
            self._open.pop(session_id, None)

    def _forget_ended(self) -> None:
        self._open = {key: held for key, held in self._open.items() if not held.ended}
