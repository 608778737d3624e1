"""The viewer over HTTP: open a session, say what it shows, close it; its page and websocket."""

from __future__ import annotations

from collections.abc import AsyncGenerator, Callable
from contextlib import asynccontextmanager
from typing import Annotated, Any

from fastapi import APIRouter, Response, WebSocket
from pydantic import BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from server.errors import Finding, Problem, gone_missing, pointer, shortened
from server.viewer.camera import Preset
from server.viewer.palette import Theme
from server.viewer.playback import PlaybackState
from server.viewer.proxy import page, pass_on
from server.viewer.session import Session, Sessions, TooManySessionsError, ViewerLimits
from server.viewer.source import FrameSource

__all__ = ["OpenedView", "ViewChange", "ViewRequest", "ViewState", "router"]

_STRICT = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class ViewRequest(BaseModel):
    """How a new view looks."""

    model_config = _STRICT

    theme: Annotated[Theme, Field(description="Of the page around the view.")] = "light"


class OpenedView(BaseModel):
    """A new viewing session."""

    session: Annotated[str, Field(description="128 random bits.")]
    url: Annotated[str, Field(description="Page to show in a frame, under this origin.")]


class ViewChange(BaseModel):
    """What should be shown. Fields that are left out stay as they are."""

    model_config = _STRICT

    time: Annotated[float, Field(ge=0.0, le=1e6, description="Time in the run. [s]")] = 0.0
    playing: Annotated[bool, Field(description="Whether the time runs.")] = False
    rate: Annotated[
        float, Field(ge=1e-3, le=10.0, description="Simulated over real seconds.", examples=[0.1])
    ] = 0.1
    scale: Annotated[
        float, Field(ge=0.0, le=1e5, description="Deformation scale.", examples=[500.0])
    ] = 1.0
    layers: Annotated[
        list[Annotated[str, Field(max_length=40)]],
        Field(max_length=32, description="Names of what is visible, from `available_layers`."),
    ] = []
    camera: Annotated[
        Preset, Field(description="Where to look from; `free` leaves the camera alone.")
    ] = "overview"
    theme: Annotated[Theme, Field(description="Of the page around the view.")] = "light"


class ViewState(BaseModel):
    """What is shown now, and what could be."""

    session: str
    run: str
    time: Annotated[float, Field(description="Time in the run. [s]")]
    playing: bool
    rate: float
    scale: float
    layers: list[str]
    camera: Preset
    theme: Theme
    available_layers: list[str]
    last_time: Annotated[float, Field(description="Time of the last stored frame. [s]")]
    frame_interval: Annotated[float, Field(description="Time between stored frames. [s]")]
    done: Annotated[bool, Field(description="Whether no more frames will come.")]
    clients: Annotated[int, Field(description="Browsers that watch.")]


def router(
    open_reader: Callable[[str], FrameSource], limits: ViewerLimits | None = None
) -> APIRouter:
    """Routes of the viewer; its sessions end with the application's lifespan.

    Args:
        open_reader: Opens the stored result of a run by its id; raises the server's own error
            where there is none or where it has not come to its first step.
        limits: How much the viewer may take.
    """
    sessions = Sessions(limits or ViewerLimits())

    @asynccontextmanager
    async def lifespan(_: Any) -> AsyncGenerator[None]:
        yield
        await run_in_threadpool(sessions.close_all)

    routes = APIRouter(lifespan=lifespan, tags=["viewer"])
    _add_resource(routes, sessions, open_reader)
    _add_page(routes, sessions)
    return routes


def _add_resource(
    routes: APIRouter, sessions: Sessions, open_reader: Callable[[str], FrameSource]
) -> None:
    @routes.post("/api/v1/runs/{run_id}/viewer", status_code=201)
    def open_view(
        run_id: str, response: Response, request: ViewRequest | None = None
    ) -> OpenedView:
        """Opens a viewing session on a run, running or finished."""
        theme = request.theme if request else "light"
        try:
            session = sessions.open(run_id, open_reader(run_id), theme)
        except TooManySessionsError as error:
            raise _too_many(str(error)) from error
        response.headers["Location"] = f"/api/v1/viewer/{session.id}"
        return OpenedView(session=session.id, url=f"/viewer/{session.id}/")

    @routes.get("/api/v1/viewer/{session_id}")
    def read_view(session_id: str) -> ViewState:
        """What a session shows now."""
        session = _found(sessions, session_id)
        return _state(session, session.player.state)

    @routes.put("/api/v1/viewer/{session_id}")
    def change_view(session_id: str, change: ViewChange) -> ViewState:
        """Says what a session shows; fields that are left out stay as they are."""
        session = _found(sessions, session_id)
        changes = change.model_dump(include=change.model_fields_set)
        if "layers" in changes:
            changes["layers"] = _known_layers(session, change.layers)
        return _state(session, session.change(**changes))

    @routes.delete("/api/v1/viewer/{session_id}", status_code=204)
    def close_view(session_id: str) -> None:
        """Ends a session."""
        _found(sessions, session_id)
        sessions.close(session_id)


def _add_page(routes: APIRouter, sessions: Sessions) -> None:
    @routes.get("/viewer/{session_id}/", include_in_schema=False)
    def view_page(session_id: str) -> Response:
        _found(sessions, session_id)
        return page()

    @routes.websocket("/viewer/{session_id}")
    async def view_socket(websocket: WebSocket, session_id: str) -> None:
        await pass_on(websocket, sessions, session_id)


def _found(sessions: Sessions, session_id: str) -> Session:
    session = sessions.get(session_id)
    if session is None:
        raise gone_missing("view", session_id)
    return session


def _known_layers(session: Session, layers: list[str]) -> frozenset[str]:
    for index, name in enumerate(layers):
        if name not in session.player.layers:
            finding = Finding(
                pointer=pointer(("layers", index)),
                value=shortened(name),
                reason="this run has no such layer",
                remedy=f"Choose from {', '.join(session.player.layers)}.",
            )
            raise Problem(422, "Unusable values", finding.reason, errors=[finding])
    return frozenset(layers)


def _too_many(detail: str) -> Problem:
    return Problem(
        429,
        "Too many 3D views",
        f"{detail} and all are watched. Close one of them, then try again.",
        headers={"Retry-After": "10"},
    )


def _state(session: Session, state: PlaybackState) -> ViewState:
    player = session.player
    return ViewState(
        session=session.id,
        run=session.run,
        time=state.time,
        playing=state.playing,
        rate=state.rate,
        scale=state.scale,
        layers=[name for name in player.layers if name in state.layers],
        camera=state.camera,
        theme=state.theme,
        available_layers=list(player.layers),
        last_time=player.last,
        frame_interval=player.interval,
        done=player.done,
        clients=session.clients,
    )
