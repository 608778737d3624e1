"""The application: routes, errors, access rules and the queue behind them."""

from __future__ import annotations

import signal
import socket
from collections.abc import AsyncGenerator, Callable
from contextlib import AbstractAsyncContextManager, ExitStack, asynccontextmanager
from types import FrameType

import uvicorn
from fastapi import APIRouter, FastAPI
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware

from server import viewer
from server.coordinate import (
    CoordinatorProcess,
    StartError,
    new_coordinator,
    open_database,
    require_usable,
)
from server.errors import install_errors
from server.jobs.computing import compute_order
from server.jobs.coordinator import Coordinator
from server.jobs.lock import queue_lock
from server.jobs.orders import Compute
from server.jobs.states import ENDED, State
from server.routes import (
    compare,
    compare_plots,
    events,
    job_plots,
    jobs,
    library,
    login,
    machine,
    meta,
    pages,
    plots,
    reports,
    requests,
    runs,
    studies,
    templates,
)
from server.routes.body import BodyGuard
from server.routes.changes import Changes
from server.routes.drawing import DrawingProcess
from server.routes.openapi import describe_studies
from server.routes.outages import install_outages
from server.routes.schemas import ProblemDocument
from server.routes.service import Service
from server.security import Access, Guard
from server.settings import Settings
from server.store import Database, Place, RunReader, open_place
from server.version import package_version

__all__ = ["StartError", "create_app", "serve_until_stopped"]

_GRACE_SECONDS = 3
"""Time for open requests when the server stops. [s]"""
_KEEP_ALIVE_SECONDS = 75
"""Longer than clients and proxies keep an idle connection (httpx 5 s, nginx 60 s): who closes first
must be they, or a request meets a connection that is just being closed. [s]"""
_BACKLOG = 2048
"""Connections that wait for the server to start, as uvicorn takes them later."""
_LARGEST_MESSAGE = 64 * 1024 * 1024
"""A viewer's frames come as one message each. [B]"""

_ROUTES = (
    meta,
    machine,
    templates,
    studies,
    jobs,
    requests,
    events,
    runs,
    plots,
    job_plots,
    compare,
    compare_plots,
    reports,
    library,
    login,
    pages,
)

_PROBLEM = {
    "model": ProblemDocument,
    "description": "What went wrong, where, and what to do (RFC 9457).",
}


def create_app(settings: Settings, *, compute: Compute = compute_order) -> FastAPI:
    """The application of one data folder.

    Args:
        settings: Where, what is accepted, who may come.
        compute: What a batch's process does.

    Returns:
        The application; its queue begins with its lifespan and holds the data folder's lock.
    """
    access = Access(allowed_hosts=settings.allowed_hosts, token=settings.token)
    app = FastAPI(
        title="Trainbridge",
        version=package_version(),
        description=(
            "Dynamic interaction of train, track and bridge. All values are SI; the unit that "
            "people read stands beside each field as ``unit``."
        ),
        openapi_url=meta.OPENAPI_URL,
        docs_url=None,
        redoc_url=None,
        lifespan=_lifespan(settings, compute),
        middleware=[
            Middleware(Guard, access=access),
            Middleware(BodyGuard, limit=settings.limits.body_bytes),
        ],
        responses={"4XX": _PROBLEM},
    )
    app.state.access = access
    app.state.changes = Changes()
    install_errors(app)
    install_outages(app)
    for module in _ROUTES:
        app.include_router(module.router)
    app.include_router(_viewer_routes(app))
    app.mount("/static", pages.static_files(), name="static")
    describe_studies(app)
    return app


def _viewer_routes(app: FastAPI) -> APIRouter:
    """The 3D view of what this application's store holds, drawn by its own process."""

    def open_reader(run: str) -> RunReader | viewer.StoppedRun:
        service: Service = app.state.service
        record = service.run(run)
        reader = service.reader(record)
        stopped = State(record.state) in ENDED and not reader.done
        return viewer.StoppedRun(reader.place) if stopped else reader

    async def draw(still: viewer.Still) -> bytes:
        service: Service = app.state.service
        return await service.drawing.work(viewer.draw_still, still)

    return viewer.router(open_reader, draw=draw)


def _lifespan(
    settings: Settings, compute: Compute
) -> Callable[[FastAPI], AbstractAsyncContextManager[None]]:
    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncGenerator[None]:
        with ExitStack() as held:
            service = await run_in_threadpool(_open_service, app, settings, compute, held)
            app.state.service = service
            service.changes.bind()
            try:
                yield
            finally:
                service.changes.end()
                await run_in_threadpool(held.close)

    return lifespan


def _open_service(app: FastAPI, settings: Settings, compute: Compute, held: ExitStack) -> Service:
    """Opens everything that routes work with, and starts the coordinator that the settings ask for.

    Args:
        app: Knows the changes that wake event streams.
        settings: The settings.
        compute: What a batch's process does.
        held: Takes what has to be closed, in the opposite order, when the server stops.
    """
    changes: Changes = app.state.changes
    database = open_database(settings)
    held.callback(database.close)
    store = open_place(settings.store_url)
    coordinator = _start_coordinator(app, settings, compute, database, store, held)
    drawing = DrawingProcess(
        pending=settings.limits.pending_figures, seconds=settings.figure_seconds
    )
    held.callback(drawing.close)
    return Service(
        settings=settings,
        database=database,
        store=store,
        drawing=drawing,
        wake=_nobody if coordinator is None else coordinator.wake,
        queue_alive=None if coordinator is None else lambda: coordinator.alive,
        queue_trouble=lambda: "" if coordinator is None else coordinator.trouble,
        changes=changes,
    )


def _start_coordinator(
    app: FastAPI,
    settings: Settings,
    compute: Compute,
    database: Database,
    store: Place,
    held: ExitStack,
) -> Coordinator | CoordinatorProcess | None:
    """A thread for the local engine, a process for the others, None where it is elsewhere."""
    changes: Changes = app.state.changes
    if settings.coordinator and settings.engine == "local":
        lock = held.enter_context(queue_lock(settings, database))
        coordinator = new_coordinator(
            settings, database, store, lock, compute=compute, on_change=changes.notify
        )
    else:
        changes.follow(database.last_event, settings.event_poll_seconds)
        if not settings.coordinator:
            return None
        coordinator = CoordinatorProcess(settings, compute)
    app.state.coordinator = coordinator
    coordinator.start()
    held.callback(coordinator.stop)
    return coordinator


def _nobody() -> None:
    """A coordinator elsewhere looks by itself."""


class _Server(uvicorn.Server):
    """Ends event streams as soon as it is asked to stop: uvicorn waits for them otherwise."""

    def __init__(self, config: uvicorn.Config, changes: Changes) -> None:
        super().__init__(config)
        self._changes = changes

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        self._changes.end()
        super().handle_exit(sig, frame)


def serve_until_stopped(settings: Settings) -> None:
    """Serves until SIGTERM or Ctrl-C.

    Raises:
        StartError: Database, store, queue or port cannot be used.
    """
    require_usable(settings, lock=settings.coordinator)
    listener = _listen(settings.host, settings.port)
    app = create_app(settings)
    config = uvicorn.Config(
        app,
        log_level="warning",
        server_header=False,
        timeout_graceful_shutdown=_GRACE_SECONDS,
        timeout_keep_alive=_KEEP_ALIVE_SECONDS,
        ws_per_message_deflate=False,
        ws_max_size=_LARGEST_MESSAGE,
    )
    host, port = listener.getsockname()[:2]
    shown = f"[{host}]" if ":" in host else host
    print(f"Trainbridge serves http://{shown}:{port}  (data in {settings.data})", flush=True)
    for number in (signal.SIGINT, signal.SIGTERM):
        # uvicorn raises the signal again when it has stopped: being asked to stop is no failure.
        signal.signal(number, lambda *_: None)
    _Server(config, app.state.changes).run(sockets=[listener])


def _listen(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # With the protocol named asyncio sends small answers at once, 40 ms earlier.
    listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((host, port))
        # Before the address is printed: who reads it and connects at once is not refused.
        listener.listen(_BACKLOG)
    except OSError as error:
        listener.close()
        raise StartError(
            f"Port {port} of {host} cannot be used: {error.strerror}. Another server may run "
            "there; choose another port with --port."
        ) from error
    listener.set_inheritable(True)
    return listener
