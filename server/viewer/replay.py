"""A replay: one self-contained page that shows a stretch of a run, from disk and without a network.

Viser's own serializer records the scene and every picture; its packaged page plays them. A file is
bounded in pictures and in bytes; its caption says what it leaves out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from server.viewer import camera, captions
from server.viewer.guard import start_server, stop_server
from server.viewer.kinematics import nearest_frame
from server.viewer.offline_page import offline_page
from server.viewer.palette import Colouring, Theme
from server.viewer.picture import PictureMaker
from server.viewer.scene import Scene
from server.viewer.source import FrameSource
from server.viewer.timeline import Timeline
from solver.arrays import IntVector

__all__ = ["Replay", "ReplayLimits", "ReplayOptions", "replay"]

ASPECT = 1.9
"""Width over height of a window that has not been seen."""
_MODE_PICTURES = 30
"""Of one cycle of a mode, two seconds long."""


@dataclass(frozen=True, kw_only=True)
class ReplayLimits:
    """How large a file may become.

    Attributes:
        pictures: Most pictures.
        data: Most bytes of their arrays before compression, about what the file has after it. [B]
        rate: Pictures shown in a second. [Hz]
    """

    pictures: int = 300
    data: int = 48 * 1024 * 1024
    rate: float = 15.0


@dataclass(frozen=True, kw_only=True)
class ReplayOptions:
    """What a replay shows.

    Attributes:
        start: In the run, None for its first frame. [s]
        stop: None for its last frame. [s]
        mode: The mode of a modal run, counted from 0.
        camera: Where it opens; everybody then looks from where they like.
        pose: Where somebody moved the camera; None for the preset's own place.
        colour: What the surface's colours say.
        scale: Deformation scale, None for one at which the deformation is well seen.
        theme: Light or dark.
    """

    start: float | None = None
    stop: float | None = None
    mode: int = 0
    camera: camera.Preset = "overview"
    pose: camera.Pose | None = None
    colour: Colouring = "none"
    scale: float | None = None
    theme: Theme = "light"


@dataclass(frozen=True, kw_only=True)
class Replay:
    """A file.

    Attributes:
        page: The whole of it.
        caption: What it shows and what it leaves out, as it says itself.
    """

    page: bytes
    caption: str


_Asked: TypeAlias = tuple[int, float, Colouring, float]
"""Index, scale, colouring and phase: what a picture is made from."""


@dataclass(frozen=True, kw_only=True)
class _Stretch:
    """Stored frames that become pictures."""

    indices: IntVector
    every: int
    stored: int
    interval: float


def replay(source: FrameSource, options: ReplayOptions, limits: ReplayLimits) -> Replay:
    """Makes the file; takes seconds: keep it off the event loop.

    Args:
        source: The run, finished or still running.
        options: What to show.
        limits: How large it may become.
    """
    maker, timeline = PictureMaker(source), Timeline(source)
    scale = maker.scale() if options.scale is None else options.scale
    if timeline.modal:
        times = np.arange(_MODE_PICTURES) / _MODE_PICTURES
        moments = [timeline.frame(time, options.mode) for time in times.tolist()]
        words = [captions.mode_name(source, options.mode)]
    else:
        stretch = _stretch(source, timeline, options, limits)
        moments = [(int(index), 1.0) for index in stretch.indices]
        words = _words(source, stretch, limits)
    pictures: list[_Asked] = [(index, scale, options.colour, phase) for index, phase in moments]
    caption = captions.SEPARATOR.join([*words, captions.exaggeration(scale)])
    recorded = _recorded(source, maker, pictures, options, limits)
    page = offline_page(recorded, caption, maker.colour_bar(options.colour), options.theme)
    return Replay(page=page.encode(), caption=caption)


def _recorded(
    source: FrameSource,
    maker: PictureMaker,
    pictures: list[_Asked],
    options: ReplayOptions,
    limits: ReplayLimits,
) -> str:
    """Plays the pictures on a server that nobody watches, and writes down what it would send."""
    server = start_server()
    try:
        first = maker.picture(*pictures[0])
        scene = Scene(server, source.plan.geometry, first, options.theme)
        geometry = source.plan.geometry
        usual = camera.view(options.camera, geometry, first.first_axle, ASPECT)
        camera.set_initial(server, camera.posed(usual, options.pose))
        recorder = server.get_scene_serializer()
        for picture in pictures[1:]:
            recorder.insert_sleep(1.0 / limits.rate)
            scene.show(maker.picture(*picture), "playing")
        if len(pictures) > 1:
            recorder.insert_sleep(1.0 / limits.rate)
        return recorder.as_html(dark_mode=options.theme == "dark")
    finally:
        stop_server(server)


def _stretch(
    source: FrameSource, timeline: Timeline, options: ReplayOptions, limits: ReplayLimits
) -> _Stretch:
    """The stored frames of the asked stretch, thinned out where they are too many."""
    count, interval = source.committed_frames, timeline.interval
    start = 0.0 if options.start is None else options.start
    stop = timeline.last if options.stop is None else options.stop
    first = nearest_frame(start, interval, count)
    last = max(nearest_frame(stop, interval, count), first)
    stored = last - first + 1
    most = int(np.clip(limits.data // _picture_bytes(source), 2, limits.pictures))
    every = -(-stored // most)
    return _Stretch(
        indices=np.arange(first, last + 1, every), every=every, stored=stored, interval=interval
    )


def _picture_bytes(source: FrameSource) -> int:
    """What one picture adds: vertices and colours of the layers, poses of the train. [B]"""
    geometry = source.plan.geometry
    vertices = sum(len(np.unique(layer.faces)) for layer in geometry.layers)
    return 15 * vertices + 64 * (len(geometry.wheels.names) + len(geometry.bodies)) + 1000


def _words(source: FrameSource, stretch: _Stretch, limits: ReplayLimits) -> list[str]:
    """What the file shows and what it leaves out."""
    first, last = (float(stretch.indices[end]) * stretch.interval for end in (0, -1))
    rate = stretch.every * stretch.interval * limits.rate
    words = [captions.crossing(source.plan)] if source.plan.speed else []
    words.append(f"t = {first:.3f} to {last:.3f} s at {rate:.2g} × real time")
    if stretch.every > 1:
        kept, left = len(stretch.indices), stretch.stored - len(stretch.indices)
        words.append(
            f"every {_ordinal(stretch.every)} stored shape: {kept} of {stretch.stored}, "
            f"{left} left out to bound this file"
        )
    if not source.done or source.committed_frames < source.plan.n_frame:
        words.append("the run was not finished")
    return words


def _ordinal(number: int) -> str:
    ending = {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{'th' if 10 < number % 100 < 14 else ending}"
