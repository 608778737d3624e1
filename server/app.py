"""The application: routes, errors, access rules and the queue behind them."""

from __future__ import annotations

import signal
import socket
from collections.abc import AsyncGenerator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path
from types import FrameType

import uvicorn
from fastapi import FastAPI
from sqlalchemy.exc import SQLAlchemyError
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware

from server import viewer
from server.errors import install_errors
from server.jobs.coordinator import Coordinator
from server.jobs.lock import FolderInUseError, FolderLock
from server.jobs.process import Compute
from server.jobs.submission import stored_study
from server.jobs.worker import run_task
from server.routes import events, jobs, login, meta, pages, plots, runs, studies, templates
from server.routes.body import BodyGuard
from server.routes.drawing import DrawingProcess
from server.routes.openapi import describe_studies
from server.routes.schemas import ProblemDocument
from server.routes.service import Changes, Service
from server.security import Access, Guard
from server.settings import Settings
from server.store import Database, RunReader, SchemaVersionError

__all__ = ["StartError", "create_app", "serve_until_stopped"]

DATABASE = "trainbridge.sqlite"
"""Name of the database in the data folder."""
_GRACE_SECONDS = 3
"""Time for open requests when the server stops. [s]"""
_BACKLOG = 2048
"""Connections that wait for the server to start, as uvicorn takes them later."""
_LARGEST_MESSAGE = 64 * 1024 * 1024
"""A viewer's frames come as one message each. [B]"""

_PROBLEM = {
    "model": ProblemDocument,
    "description": "What went wrong, where, and what to do (RFC 9457).",
}


def create_app(settings: Settings, *, compute: Compute = run_task) -> FastAPI:
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
        version=meta.package_version(),
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
    for module in (meta, templates, studies, jobs, events, runs, plots, login, pages):
        app.include_router(module.router)

    def open_reader(run: str) -> RunReader:
        service: Service = app.state.service
        return service.open_reader(run)

    app.include_router(viewer.router(open_reader))
    app.mount("/static", pages.static_files(), name="static")
    describe_studies(app)
    return app


def _lifespan(
    settings: Settings, compute: Compute
) -> Callable[[FastAPI], AbstractAsyncContextManager[None]]:
    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncGenerator[None]:
        with FolderLock(settings.data):
            service = _open_service(app, settings, compute)
            app.state.service = service
            service.changes.bind()
            await run_in_threadpool(service.coordinator.start)
            try:
                yield
            finally:
                service.changes.end()
                service.drawing.close()
                await run_in_threadpool(service.coordinator.stop)
                service.database.close()

    return lifespan


def _open_service(app: FastAPI, settings: Settings, compute: Compute) -> Service:
    changes: Changes = app.state.changes
    database = Database(settings.data / DATABASE)
    return Service(
        settings=settings,
        database=database,
        coordinator=Coordinator(
            database,
            settings,
            read_study=stored_study,
            compute=compute,
            on_change=changes.notify,
        ),
        drawing=DrawingProcess(
            pending=settings.limits.pending_figures, seconds=settings.figure_seconds
        ),
        changes=changes,
    )


class StartError(Exception):
    """Why the server cannot start; the text says what to do."""


class _Server(uvicorn.Server):
    """Ends event streams as soon as it is asked to stop: uvicorn waits for them otherwise."""

    def __init__(self, config: uvicorn.Config, changes: Changes) -> None:
        super().__init__(config)
        self._changes = changes

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        self._changes.end()
        super().handle_exit(sig, frame)


def serve_until_stopped(settings: Settings) -> None:
    """Serves one data folder until SIGTERM or Ctrl-C.

    Raises:
        StartError: The folder or the port is in use, or the folder is of another version.
    """
    _require_usable(settings.data)
    listener = _listen(settings.host, settings.port)
    app = create_app(settings)
    config = uvicorn.Config(
        app,
        log_level="warning",
        server_header=False,
        timeout_graceful_shutdown=_GRACE_SECONDS,
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


def _require_usable(data: Path) -> None:
    """Finds out before the server starts what would stop it."""
    try:
        with FolderLock(data):
            Database(data / DATABASE).close()
    except (FolderInUseError, SchemaVersionError) as error:
        raise StartError(str(error)) from error
    except SQLAlchemyError as error:
        raise StartError(f"The database in {data} cannot be used: {error}.") from error


def _listen(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM)
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
