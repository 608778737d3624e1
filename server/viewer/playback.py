"""Time: what the dashboard asked for, and what is shown of it.

The dashboard owns the time. It says where and how fast; the player carries it on between its
words, from the same anchor, so that both sides compute the same instant.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import viser

from server.viewer import camera
from server.viewer.kinematics import nearest_frame
from server.viewer.palette import Theme
from server.viewer.picture import PictureMaker
from server.viewer.scene import Scene, available_layers
from server.viewer.source import FrameSource

__all__ = ["PlaybackState", "Player", "advanced"]

SLOW_MOTION = 0.1
"""Simulated over real seconds, to begin with."""
OPENING_ASPECT = 1.9
"""Width over height of a picture that has not been seen yet."""


@dataclass(frozen=True, kw_only=True)
class PlaybackState:
    """What is shown and how.

    Attributes:
        time: In the run. [s]
        playing: Whether the time runs.
        rate: Simulated over real seconds; slow motion below 1.
        scale: Deformation scale.
        layers: What is visible.
        camera: Preset, or ``free``.
        theme: Of the page around the view.
    """

    time: float
    playing: bool
    rate: float
    scale: float
    layers: frozenset[str]
    camera: camera.Preset
    theme: Theme


def advanced(state: PlaybackState, elapsed: float, last: float, done: bool) -> PlaybackState:
    """The state some real time later.

    Args:
        state: At the anchor.
        elapsed: Real time since. [s]
        last: Time of the last stored frame. [s]
        done: Whether the run has ended: playing ends with its last frame, else it waits there.
    """
    reached = state.time + (state.rate * elapsed if state.playing else 0.0)
    ended = done and reached >= last
    return replace(state, time=min(max(reached, 0.0), last), playing=state.playing and not ended)


class Player:
    """Shows one run on one server; only what changed is sent.

    Args:
        server: The session's server.
        source: The run.
        theme: Of the page around the view.
        clock: Seconds that never go back.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        source: FrameSource,
        theme: Theme,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._server = server
        self._source = source
        self._geometry = source.plan.geometry
        self._maker = PictureMaker(source)
        self.interval = source.plan.frame_stride * source.plan.time_step
        self._clock = clock
        self._lock = threading.Lock()
        self._anchor = clock()
        self._camera_asked = False
        self._state = self._first_state(theme)
        self._shown = self._state
        self._drawn = (self._frame_index(self._state.time), self._state.scale)
        picture = self._maker.picture(*self._drawn)
        self._scene = Scene(server, self._geometry, picture, theme)
        opening = camera.view("overview", self._geometry, picture.first_axle, OPENING_ASPECT)
        camera.set_initial(server, opening)

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of everything that can be shown."""
        return available_layers(self._geometry)

    @property
    def last(self) -> float:
        """Time of the last frame that can be shown. [s]"""
        return max(self._source.committed_frames - 1, 0) * self.interval

    @property
    def done(self) -> bool:
        """Whether no more frames will come."""
        return self._source.done

    @property
    def state(self) -> PlaybackState:
        """The state now."""
        with self._lock:
            return self._advance()

    def change(self, **changes: object) -> PlaybackState:
        """Changes some of the state, from now on; shown by the next ``draw``.

        Args:
            **changes: Fields of ``PlaybackState``.
        """
        with self._lock:
            state = replace(self._advance(), **changes)  # pyright: ignore[reportArgumentType]
            self._state = advanced(state, 0.0, self.last, self.done)
            self._camera_asked = self._camera_asked or "camera" in changes
            return self._state

    def draw(self) -> bool:
        """Shows the state now; says whether anything had to be sent."""
        state = self.state
        shown, self._shown = self._shown, state
        wanted = (self._frame_index(state.time), state.scale)
        layers_changed = state.layers != shown.layers
        if state.theme != shown.theme:
            picture = self._maker.picture(*wanted)
            self._scene = Scene(self._server, self._geometry, picture, state.theme)
            self._scene.show_layers(state.layers)
        elif layers_changed or wanted != self._drawn:
            picture = self._maker.picture(*wanted)
            if layers_changed:
                self._scene.show_layers(state.layers)
            self._scene.show(picture)
        moved = self._move_camera(state, shown)
        drew = wanted != self._drawn or layers_changed or state.theme != shown.theme
        self._drawn = wanted
        return drew or moved

    def _move_camera(self, state: PlaybackState, shown: PlaybackState) -> bool:
        plan = self._source.plan
        first_axle = plan.start_position + plan.speed * state.time
        with self._lock:
            asked, self._camera_asked = self._camera_asked, False
        if asked:
            camera.move(self._server, state.camera, self._geometry, first_axle)
        elif state.camera == "follow" and state.time != shown.time:
            camera.follow(self._server, self._geometry, first_axle)
        else:
            return False
        return True

    def _advance(self) -> PlaybackState:
        now = self._clock()
        self._state = advanced(self._state, now - self._anchor, self.last, self.done)
        self._anchor = now
        return self._state

    def _frame_index(self, at: float) -> int:
        return nearest_frame(at, self.interval, self._source.committed_frames)

    def _first_state(self, theme: Theme) -> PlaybackState:
        """The train in the middle of the viaduct, if it has come that far."""
        plan, spans = self._source.plan, self._geometry.spans
        centre = float(np.mean(spans)) if len(spans) else 0.0
        reach = min(40.0, float(-np.min(self._geometry.wheels.offsets, initial=0.0)))
        at = (centre + 0.5 * reach - plan.start_position) / plan.speed if plan.speed else 0.0
        return PlaybackState(
            time=min(max(at, 0.0), self.last),
            playing=False,
            rate=SLOW_MOTION,
            scale=self._maker.scale(),
            layers=frozenset(self.layers),
            camera="overview",
            theme=theme,
        )
