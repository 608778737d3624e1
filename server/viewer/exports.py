"""What leaves the dashboard: stills and replays over HTTP."""

from __future__ import annotations

import threading
from collections.abc import Awaitable, Callable, Generator
from contextlib import contextmanager
from typing import Annotated, TypeAlias

from fastapi import APIRouter, Query, Response
from starlette.concurrency import run_in_threadpool

from server.errors import Finding, Problem, shortened
from server.viewer.camera import Pose, Preset
from server.viewer.palette import Colouring, Theme
from server.viewer.picture import PictureMaker
from server.viewer.replay import Replay, ReplayLimits, ReplayOptions, replay
from server.viewer.source import FrameSource
from server.viewer.states import PoseChange
from server.viewer.stills import Still, StillOptions, draw_still, read_still
from server.viewer.timeline import Timeline

__all__ = ["DrawStill", "add_exports", "draw_here"]

DrawStill: TypeAlias = Callable[[Still], Awaitable[bytes]]
"""Draws off the event loop."""

_PATIENCE = 20.0
"""A replay waits this long for the one before it. [s]"""
_WAITING = 4
"""Replays that wait at once: each holds a thread that other answers need."""

Time = Annotated[
    float | None, Query(ge=0.0, le=1e6, allow_inf_nan=False, description="Time in the run. [s]")
]
From = Annotated[
    float | None,
    Query(alias="from", ge=0.0, le=1e6, allow_inf_nan=False, description="Begin. [s]"),
]
To = Annotated[
    float | None, Query(alias="to", ge=0.0, le=1e6, allow_inf_nan=False, description="End. [s]")
]
Scale = Annotated[
    float | None,
    Query(ge=0.0, le=1e5, allow_inf_nan=False, description="Deformation scale; a fitting one."),
]
Mode = Annotated[int, Query(ge=0, le=999, description="Of a modal run, counted from 0.")]
Camera = Annotated[Preset, Query(description="Where to look from.")]
PoseText = Annotated[
    str,
    Query(
        max_length=200,
        description="Where the camera was moved to, as the page's address has it: x, y, z of the "
        "eye, x, y, z of what it looks at [m], and the field of view if not the preset's [rad].",
        examples=["-30,-48,22.5,29.2,0,1.3"],
    ),
]
Colours = Annotated[Colouring, Query(description="What the surface's colours say.")]
PageTheme = Annotated[Theme, Query(description="Light or dark.")]


async def draw_here(drawing: Still) -> bytes:
    """Draws in a thread of this process."""
    return await run_in_threadpool(draw_still, drawing)


def add_exports(
    routes: APIRouter,
    open_reader: Callable[[str], FrameSource],
    draw: DrawStill,
    limits: ReplayLimits | None = None,
) -> None:
    """Adds the routes of stills and replays.

    Args:
        routes: Where to.
        open_reader: Opens the stored result of a run by its id.
        draw: Draws a still.
        limits: How large a replay may become.
    """
    _add_still(routes, open_reader, draw)
    _add_replay(routes, open_reader, limits or ReplayLimits())


def _add_still(
    routes: APIRouter, open_reader: Callable[[str], FrameSource], draw: DrawStill
) -> None:
    @routes.get(
        "/api/v1/runs/{run_id}/viewer/still.png",
        response_class=Response,
        responses={200: {"content": {"image/png": {}}}},
    )
    async def read_still_picture(
        run_id: str,
        time: Time = None,
        mode: Mode = 0,
        camera: Camera = "overview",
        pose: PoseText = "",
        colour: Colours = "none",
        scale: Scale = None,
        theme: PageTheme = "light",
        width: Annotated[int, Query(ge=200, le=2400, description="[pixel]")] = 1200,
        height: Annotated[int, Query(ge=150, le=1600, description="[pixel]")] = 675,
    ) -> Response:
        """One moment in 3D, drawn by the server: needs no WebGL."""
        options = StillOptions(
            time=time,
            mode=mode,
            camera=camera,
            pose=_pose(pose),
            colour=colour,
            scale=scale,
            theme=theme,
            width=width,
            height=height,
        )

        def read() -> Still:
            source = open_reader(run_id)
            _require_possible(source, colour, mode)
            return read_still(source, options)

        content = await draw(await run_in_threadpool(read))
        return Response(content, media_type="image/png")


def _add_replay(
    routes: APIRouter, open_reader: Callable[[str], FrameSource], limits: ReplayLimits
) -> None:
    one_at_once, places = threading.Lock(), threading.BoundedSemaphore(1 + _WAITING)

    @routes.get(
        "/api/v1/runs/{run_id}/viewer/replay.html",
        response_class=Response,
        responses={200: {"content": {"text/html": {}}}},
    )
    def read_replay(
        run_id: str,
        begin: From = None,
        end: To = None,
        mode: Mode = 0,
        camera: Camera = "overview",
        pose: PoseText = "",
        colour: Colours = "none",
        scale: Scale = None,
        theme: PageTheme = "light",
    ) -> Response:
        """A stretch of the run as one page that opens from disk, without a network."""
        source = open_reader(run_id)
        _require_possible(source, colour, mode)
        options = ReplayOptions(
            start=begin,
            stop=end,
            mode=mode,
            camera=camera,
            pose=_pose(pose),
            colour=colour,
            scale=scale,
            theme=theme,
        )
        with _turn(places, one_at_once):
            made = replay(source, options, limits)
        return _attachment(made, run_id)


@contextmanager
def _turn(places: threading.BoundedSemaphore, one_at_once: threading.Lock) -> Generator[None]:
    """Lets one replay be made and a few wait.

    Raises:
        Problem: 503: too many wait already, or the one before takes too long.
    """
    detail = "Other replays are being made. Try again in a moment."
    busy = Problem(503, "Replays are busy", detail, headers={"Retry-After": "5"})
    if not places.acquire(blocking=False):
        raise busy
    try:
        if not one_at_once.acquire(timeout=_PATIENCE):
            raise busy
        try:
            yield
        finally:
            one_at_once.release()
    finally:
        places.release()


def _attachment(made: Replay, run_id: str) -> Response:
    return Response(
        made.page,
        media_type="text/html; charset=utf-8",
        headers={"Content-Disposition": f'attachment; filename="replay-{run_id}.html"'},
    )


def _require_possible(source: FrameSource, colour: Colouring, mode: int) -> None:
    """Refuses what the run cannot show.

    Raises:
        Problem: 422 that names the parameter.
    """
    known = PictureMaker(source).available_colourings
    if colour not in known:
        raise _unusable("colour", colour, "this run has no such values", ", ".join(known))
    modes = Timeline(source).modes
    if mode and mode >= modes:
        reason = f"this run has {modes or 'no'} modes"
        raise _unusable("mode", str(mode), reason, f"0 to {max(modes - 1, 0)}")


def _pose(text: str) -> Pose | None:
    """A pose as an address has it; none where it says nothing.

    Raises:
        Problem: 422 that names the parameter.
    """
    if not text:
        return None
    try:
        pose = PoseChange.read(text).pose()
    except ValueError:
        pose = None
    if pose is None or not pose.looks:
        reason = "is no place of the eye and another that it looks at"
        remedy = "Give six numbers between commas, in metres; a seventh is the field of view."
        raise _refused("pose", shortened(text), reason, remedy)
    return pose


def _unusable(name: str, value: str, reason: str, choices: str) -> Problem:
    return _refused(name, value, reason, f"Choose from {choices}.")


def _refused(name: str, value: str, reason: str, remedy: str) -> Problem:
    finding = Finding(pointer=name, value=value, reason=reason, remedy=remedy)
    return Problem(422, "Unusable value", reason, errors=[finding])
