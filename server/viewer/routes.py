"""The viewer over HTTP: open a session, say what it shows, close it; its page and websocket."""

from __future__ import annotations

from collections.abc import AsyncGenerator, Callable
from contextlib import asynccontextmanager
from typing import Any

from fastapi import APIRouter, Response, WebSocket
from starlette.concurrency import run_in_threadpool

from server.errors import Finding, Problem, gone_missing, pointer, shortened
from server.viewer.exports import DrawStill, add_exports, draw_here
from server.viewer.playback import Choices
from server.viewer.proxy import page, pass_on
from server.viewer.session import Session, Sessions, TooManySessionsError, ViewerLimits
from server.viewer.source import FrameSource
from server.viewer.states import OpenedView, ViewChange, ViewRequest, ViewState

__all__ = ["router"]


def router(
    open_reader: Callable[[str], FrameSource],
    limits: ViewerLimits | None = None,
    draw: DrawStill = draw_here,
) -> APIRouter:
    """Routes of the viewer; its sessions end with the application's lifespan.

    Args:
        open_reader: Opens the stored result of a run by its id; raises the server's own error
            where there is none or where it has not come to its first step.
        limits: How much the viewer may take.
        draw: Draws a still, off the event loop and best in another process.
    """
    sessions = Sessions(limits or ViewerLimits(), open_reader)

    @asynccontextmanager
    async def lifespan(_: Any) -> AsyncGenerator[None]:
        yield
        await run_in_threadpool(sessions.close_all)

    routes = APIRouter(lifespan=lifespan, tags=["viewer"])
    _add_resource(routes, sessions, open_reader)
    add_exports(routes, open_reader, draw)
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
        return ViewState.of(_found(sessions, session_id))

    @routes.put("/api/v1/viewer/{session_id}")
    def change_view(session_id: str, change: ViewChange) -> ViewState:
        """Says what a session shows; fields that are left out stay as they are."""
        session = _found(sessions, session_id)
        _change(sessions, session, change, open_reader)
        return ViewState.of(session)

    @routes.delete("/api/v1/viewer/{session_id}", status_code=204)
    def close_view(session_id: str) -> None:
        """Ends a session."""
        _found(sessions, session_id)
        sessions.close(session_id)


def _change(
    sessions: Sessions,
    session: Session,
    change: ViewChange,
    open_reader: Callable[[str], FrameSource],
) -> None:
    """Shows what was asked for, or nothing of it.

    Raises:
        Problem: 422 that points at the field: the run cannot show it.
    """
    changes = change.model_dump(include=change.model_fields_set)
    run = changes.pop("run", session.run)
    source = None if run == session.run else _opened(open_reader, run)
    _require_possible(change, session.player.choices if source is None else Choices.of(source))
    if "layers" in changes:
        changes["layers"] = frozenset(change.layers)
    if "pose" in changes:
        changes["pose"] = None if change.pose is None else change.pose.pose()
    if source is not None:
        session.switch(run, source)
    if "place" in changes:
        session.mark(changes.pop("place"))
    if changes:
        sessions.change(session, **changes)


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


def _opened(open_reader: Callable[[str], FrameSource], run: str) -> FrameSource:
    """Another run's frames.

    Raises:
        Problem: 422 that points at the field: there is none, or it has no histories yet.
    """
    try:
        return open_reader(run)
    except Problem as problem:
        raise _unusable("run", run, problem.detail, "Choose a run that has begun.") from problem


def _require_possible(change: ViewChange, choices: Choices) -> None:
    """Refuses what the run cannot show.

    Raises:
        Problem: 422 that points at the field.
    """
    for index, name in enumerate(change.layers):
        if name not in choices.layers:
            remedy = f"Choose from {', '.join(choices.layers)}."
            raise _unusable(f"layers/{index}", name, "this run has no such layer", remedy)
    if change.pose is not None and not change.pose.pose().looks:
        reason, remedy = "is where the eye is", "Give another point than `position`."
        raise _unusable("pose/look_at", str(change.pose.look_at), reason, remedy)
    if change.colour not in choices.colours:
        reason, remedy = "this run has no such values", f"Choose from {', '.join(choices.colours)}."
        raise _unusable("colour", change.colour, reason, remedy)
    if change.mode and change.mode >= choices.modes:
        reason = f"this run has {choices.modes or 'no'} modes"
        remedy = f"Choose from 0 to {choices.modes - 1}." if choices.modes else "Leave it out."
        raise _unusable("mode", change.mode, reason, remedy)


def _unusable(field: str, value: object, reason: str, remedy: str) -> Problem:
    finding = Finding(
        pointer=pointer(field.split("/")), value=shortened(value), reason=reason, remedy=remedy
    )
    return Problem(422, "Unusable values", reason, errors=[finding])


def _too_many(detail: str) -> Problem:
    return Problem(
        429,
        "Too many 3D views",
        f"{detail} and all are watched. Close one of them, then try again.",
        headers={"Retry-After": "10"},
    )
