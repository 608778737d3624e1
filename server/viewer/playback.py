"""Time: what the dashboard asked for, and what is shown of it.

The dashboard owns the time. It says where and how fast; the player carries it on between its
words, from the same anchor, so that both sides compute the same instant.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import viser

from server.viewer import camera
from server.viewer.cameras import Cameras
from server.viewer.colour_map import ColourBar
from server.viewer.palette import Colouring, Theme
from server.viewer.picking import Marker, Picked, Picker, Ray
from server.viewer.picture import Picture, PictureMaker
from server.viewer.scene import Scene, available_layers
from server.viewer.scene_part import Detail
from server.viewer.source import FrameSource
from server.viewer.timeline import Timeline
from solver.arrays import Matrix

__all__ = ["Choices", "PlaybackState", "Player", "advanced"]

SLOW_MOTION = 0.1
"""Simulated over real seconds, to begin with."""
MODE_RATE = 0.5
"""Cycles of a mode in a second, to begin with."""
OPENING_ASPECT = 1.9
"""Width over height of a picture that has not been seen yet."""


@dataclass(frozen=True, kw_only=True)
class PlaybackState:
    """What is shown and how.

    Attributes:
        time: In the run; of the animation in a modal one. [s]
        playing: Whether the time runs.
        rate: Simulated over real seconds; slow motion below 1. Cycles a second of a mode.
        scale: Deformation scale.
        layers: What is visible.
        camera: Preset, or ``free``.
        theme: Of the page around the view.
        colour: What the surface's colours say.
        mode: Which mode of a modal run, counted from 0.
        smooth: Colours per vertex; else per element, for a browser without the page's script.
        picked: The vertex that was clicked last.
    """

    time: float
    playing: bool
    rate: float
    scale: float
    layers: frozenset[str]
    camera: camera.Preset
    theme: Theme
    colour: Colouring = "none"
    mode: int = 0
    smooth: bool = True
    picked: Picked | None = None


@dataclass(frozen=True, kw_only=True)
class Choices:
    """What can be asked of a run.

    Attributes:
        layers: Names of everything that can be shown.
        colours: Colourings that the run has data for.
        modes: How many modes there are; none in a history.
    """

    layers: tuple[str, ...]
    colours: tuple[Colouring, ...]
    modes: int

    @classmethod
    def of(cls, source: FrameSource) -> Choices:
        """The choices of a run as far as it has come."""
        return cls(
            layers=available_layers(source.plan.geometry, modal=source.plan.modal),
            colours=PictureMaker(source).available_colourings,
            modes=Timeline(source).modes,
        )


@dataclass(frozen=True)
class _Drawn:
    """What decides how the surface looks; drawn again where it changes."""

    index: int
    scale: float
    colour: Colouring
    phase: float
    detail: Detail


def advanced(state: PlaybackState, elapsed: float, last: float, done: bool) -> PlaybackState:
    """The state some real time later.

    Args:
        state: At the anchor.
        elapsed: Real time since. [s]
        last: Time of the last stored frame; infinite for modes, which never end. [s]
        done: Whether the run has ended: playing ends with its last frame, else it waits there.
    """
    reached = state.time + (state.rate * elapsed if state.playing else 0.0)
    ended = done and reached >= last
    return replace(state, time=min(max(reached, 0.0), last), playing=state.playing and not ended)


class Player:
    """Shows one run on one server; only what changed is sent.

    Args:
        server: The session's server; what it showed before is cleared.
        source: The run.
        theme: Of the page around the view.
        before: What showed another run on this server, to go on alike.
        clock: Seconds that never go back.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        source: FrameSource,
        theme: Theme,
        before: Player | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._server = server
        self._source = source
        self._plan = source.plan
        self._geometry = source.plan.geometry
        self._maker = PictureMaker(source)
        self.timeline = Timeline(source)
        self._picker = Picker(self._geometry, self._plan.slab)
        self._marker = Marker(server)
        self._clicks = 0
        self._clock = clock
        self._lock = threading.Lock()
        self._anchor = clock()
        self._camera_asked = before is not None
        self._state = self._first_state(theme, before)
        self._shown = self._state
        self._drawn = self._wanted(self._state)
        self._picture = self._made(self._drawn)
        if before is not None:
            before.leave()
        self._scene = self._built(self._state)
        self._cameras = before.cameras if before is not None else Cameras(server)
        if before is not None and before.mount.rides != self.mount.rides:
            self._cameras.ask(None, self.mount)
        opening = camera.view("overview", self._geometry, self._picture.first_axle, OPENING_ASPECT)
        self._cameras.open_at(opening)

    @property
    def choices(self) -> Choices:
        """What can be asked of the run now."""
        return Choices(
            layers=available_layers(self._geometry, modal=self.timeline.modal),
            colours=self._maker.available_colourings,
            modes=self.timeline.modes,
        )

    @property
    def state(self) -> PlaybackState:
        """The state now."""
        with self._lock:
            return self._advance()

    @property
    def cameras(self) -> Cameras:
        """Those of the clients; they stay when another run is shown."""
        return self._cameras

    @property
    def mount(self) -> camera.Mount:
        """What the cameras stand on now."""
        return self._mount(self.state)

    @property
    def pose(self) -> camera.Pose | None:
        """Where somebody moved the camera; None where the preset has it."""
        return self._cameras.pose(self.mount)

    def colour_bar(self) -> ColourBar | None:
        """What the colours mean that are shown now."""
        return self._maker.colour_bar(self.state.colour)

    def change(self, **changes: object) -> PlaybackState:
        """Changes some of the state, from now on; shown by the next ``draw``.

        Args:
            **changes: Fields of ``PlaybackState``, and ``pose`` of the camera, None for the place
                that its preset has.
        """
        pose = changes.pop("pose", None) if (aimed := "pose" in changes) else None
        with self._lock:
            before = self._advance()
            state = replace(before, **changes)  # pyright: ignore[reportArgumentType]
            self._state = advanced(state, 0.0, self.timeline.last, self.timeline.done)
            if aimed or "camera" in changes:
                self._aim(before, pose)  # pyright: ignore[reportArgumentType]
                self._camera_asked = True
            return self._state

    def _aim(self, before: PlaybackState, pose: camera.Pose | None) -> None:
        """Tells the cameras where to go; nobody sends ``free`` ones anywhere without a pose."""
        state = self._state
        if pose is not None or state.camera != "free":
            moment = state if pose is None or pose.time is None else replace(state, time=pose.time)
            self._cameras.ask(pose, self._mount(moment))
        elif before.camera != "free":
            self._cameras.release(self._mount(before))

    def resume(self, state: PlaybackState) -> None:
        """Goes on as another attempt at the same run was shown; the cameras stay."""
        with self._lock:
            self._anchor, self._camera_asked = self._clock(), False
            self._clicks = state.picked.sequence if state.picked else 0
            self._state = advanced(state, 0.0, self.timeline.last, self.timeline.done)

    def pick(self, ray: Ray) -> bool:
        """Takes a click on what is displayed; one that meets nothing changes nothing.

        Returns:
            Whether a point was picked.
        """
        picture, layers = self._picture, self.state.layers
        picked = self._picker.pick(ray, picture.vertices, layers, self._clicks + 1)
        if picked is None:
            return False
        with self._lock:
            self._clicks = picked.sequence
            self._state = replace(self._advance(), picked=picked)
        return True

    def mark(self, place: Sequence[float] | None) -> PlaybackState:
        """Marks the vertex nearest to a place, as if it had been clicked; None marks nothing.

        Args:
            place: At rest, (x, y, z). [m]
        """
        eye = camera.view("overview", self._geometry, self._picture.first_axle, OPENING_ASPECT)
        picked = None
        if place is not None:
            picked = self._picker.nearest(np.array(place), eye.position, self._clicks)
        return self.change(picked=picked)

    def draw(self) -> bool:
        """Shows the state now; says whether anything had to be sent."""
        state, shown = self.state, self._shown
        wanted = self._wanted(state)
        repainted = (state.theme, state.smooth) != (shown.theme, shown.smooth)
        layers_changed = state.layers != shown.layers
        drew = repainted or layers_changed or wanted != self._drawn
        if wanted != self._drawn:
            self._picture = self._made(wanted)
        self._shown = state
        if repainted:
            self._scene = self._built(state)
        if repainted or layers_changed:
            self._scene.show_layers(state.layers)
        if drew:
            self._scene.show(self._picture, wanted.detail)
        self._drawn = wanted
        if drew or state.picked != shown.picked:
            self._mark(state.picked, state.layers, fresh=state.picked != shown.picked)
            drew = True
        return self._move_camera(state, shown) or drew

    def leave(self) -> None:
        """Takes everything off the server, for another run to be shown there."""
        self._marker.remove()
        self._scene.clear()

    def _built(self, state: PlaybackState) -> Scene:
        return Scene(
            self._server,
            self._geometry,
            self._picture,
            state.theme,
            smooth=state.smooth,
            landmarks=_landmarks(self._source),
        )

    def _mark(self, picked: Picked | None, layers: frozenset[str], *, fresh: bool) -> None:
        """Carries the marker along with the picked vertex."""
        where = None
        if picked is not None and picked.layer in layers:
            where = self._picker.position(picked.vertex, self._picture.vertices)
        self._marker.show(picked, where, fresh=fresh)

    def welcome(self, client: viser.ClientHandle) -> None:
        """Aims the camera of a new client: only now the shape of its picture is known."""
        self._cameras.welcome(client, self.mount)

    def notice(self, client: viser.ClientHandle) -> None:
        """Takes in that a client's camera has moved."""
        state = self.state
        self._cameras.notice(client, self._mount(state), running=state.playing)

    def _mount(self, state: PlaybackState) -> camera.Mount:
        return camera.Mount(
            preset=state.camera,
            geometry=self._geometry,
            first_axle=self._first_axle(state),
            modal=self.timeline.modal,
        )

    def _first_axle(self, state: PlaybackState) -> float:
        """Where the train is; in a modal run it stands. [m]"""
        run = 0.0 if self.timeline.modal else self._plan.speed * state.time
        return self._plan.start_position + run

    def _move_camera(self, state: PlaybackState, shown: PlaybackState) -> bool:
        with self._lock:
            asked, self._camera_asked = self._camera_asked, False
            # Somebody may have asked while the picture was made.
            mount = self._mount(replace(state, camera=self._state.camera))
        moves = asked or (mount.rides and state.time != shown.time)
        if moves:
            self._cameras.place(mount)
        return moves

    def _advance(self) -> PlaybackState:
        now = self._clock()
        elapsed, self._anchor = now - self._anchor, now
        self._state = advanced(self._state, elapsed, self.timeline.last, self.timeline.done)
        return self._state

    def _wanted(self, state: PlaybackState) -> _Drawn:
        index, phase = self.timeline.frame(state.time, state.mode)
        detail: Detail = "playing" if state.playing else "paused"
        return _Drawn(index, state.scale, state.colour, phase, detail)

    def _made(self, wanted: _Drawn) -> Picture:
        return self._maker.picture(wanted.index, wanted.scale, wanted.colour, wanted.phase)

    def _first_state(self, theme: Theme, before: Player | None) -> PlaybackState:
        choices = self.choices
        first = PlaybackState(
            time=self.timeline.opening(),
            playing=False,
            rate=MODE_RATE if self.timeline.modal else SLOW_MOTION,
            scale=self._maker.scale(),
            layers=frozenset(choices.layers),
            camera="overview",
            theme=theme,
        )
        if before is None:
            return first
        was = before.state
        hidden = frozenset(before.choices.layers) - was.layers
        return replace(
            first,
            layers=first.layers - hidden,
            camera=was.camera,
            smooth=was.smooth,
            colour=was.colour if was.colour in choices.colours else "none",
        )


def _landmarks(source: FrameSource) -> Matrix:
    """The point of the peak stays on the surface while it moves, shape (n, 3). [m]"""
    peaks = source.slab_peaks()
    coordinates = source.plan.slab.coordinates
    if peaks is None or not len(coordinates):
        return np.empty((0, 3))
    values = peaks.raw if peaks.filtered is None else peaks.filtered
    return coordinates[[int(np.argmax(values))]]
