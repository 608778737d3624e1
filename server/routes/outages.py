"""Answers while the database or the store is away: 503, and the server goes on."""

from __future__ import annotations

import logging

from fastapi import FastAPI, Request
from sqlalchemy.exc import InterfaceError, InternalError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from starlette.responses import Response

from server.errors import Problem
from server.store import NotStoredError, StoreError, StoreFullError

__all__ = ["DATABASE_AWAY", "install_outages"]

DATABASE_AWAY = (OperationalError, InterfaceError, InternalError, PoolTimeoutError)
"""What a database that is locked, full, read-only or gone raises. That it has ended a transaction
that was silent for too long, as on a machine that slept, PostgreSQL calls internal."""

_log = logging.getLogger("trainbridge.errors")
_LATER = {"Retry-After": "5"}


def install_outages(app: FastAPI) -> None:
    """Maps outages to answers that say what to do."""

    async def on_database(request: Request, error: Exception) -> Response:
        _log.error("%s %s: the database is away: %s", request.method, request.url.path, error)
        return Problem(
            503,
            "The database does not answer",
            "It is locked, full, read-only or out of reach. Try again in a moment; the server's "
            "log says more.",
            headers=_LATER,
        ).response()

    for kind in DATABASE_AWAY:
        app.add_exception_handler(kind, on_database)

    @app.exception_handler(NotStoredError)
    async def on_missing(request: Request, error: NotStoredError) -> Response:
        detail = f"{error} It was removed or replaced while it was read. Read it again."
        return Problem(409, "Not there any more", detail).response()

    @app.exception_handler(StoreError)
    async def on_store(request: Request, error: StoreError) -> Response:
        _log.error("%s %s: the store is away: %s", request.method, request.url.path, error)
        if isinstance(error, StoreFullError):
            detail = "There is no room left where results are stored. Delete jobs, or make room."
            return Problem(507, "No room left", detail).response()
        return Problem(
            503,
            "The store does not answer",
            "Results cannot be read or written where they are stored. Try again in a moment; the "
            "server's log says more.",
            headers=_LATER,
        ).response()
