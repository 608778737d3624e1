"""Databases for the server's tests: SQLite always, PostgreSQL where it is installed."""

from __future__ import annotations

import gc
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from server.store import Database
from tests.server.database_case import lay_database
from tests.server.postgresql_server import (
    MISSING,
    PostgresqlServer,
    find_programs,
    running_server,
)


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgresqlServer]:
    """A private PostgreSQL server; the test is skipped, and says why, where there is none."""
    programs = find_programs()
    if programs is None:
        pytest.skip(MISSING)
    with running_server(programs) as server:
        yield server


@pytest.fixture
def postgresql_url(postgresql: PostgresqlServer) -> Iterator[str]:
    """URL of an empty PostgreSQL database of this test alone."""
    url = postgresql.new_database()
    yield url
    postgresql.drop(url)


@pytest.fixture(params=["sqlite", "postgresql"])
def database_url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """An empty database of each kind: the path of an SQLite file, or a PostgreSQL URL."""
    if request.param == "sqlite":
        return str(tmp_path / "trainbridge.sqlite")
    url: str = request.getfixturevalue("postgresql_url")
    return url


@pytest.fixture(scope="session")
def _postgresql_template(postgresql: PostgresqlServer) -> Iterator[str]:
    """URL of a migrated PostgreSQL database that is only copied."""
    url = postgresql.new_database()
    Database(url).close()
    yield url
    postgresql.drop(url)


@pytest.fixture(params=["sqlite", "postgresql"])
def migrated_url(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """A database of each kind with today's tables and nothing in them."""
    if request.param == "sqlite":
        file = tmp_path / "trainbridge.sqlite"
        lay_database(file)
        yield str(file)
        return
    server: PostgresqlServer = request.getfixturevalue("postgresql")
    url = server.new_database(copy_of=request.getfixturevalue("_postgresql_template"))
    yield url
    server.drop(url)


@pytest.fixture
def open_database() -> Iterator[Callable[..., Database]]:
    """Opens databases that are closed in the end, before the server of theirs drops them."""
    with ExitStack() as stack:

        def open_it(*arguments: Any, **options: Any) -> Database:
            database = Database(*arguments, **options)
            stack.callback(database.close)
            return database

        yield open_it


@pytest.fixture
def swept() -> Iterator[None]:
    """Collects at once what the test leaves of Dask, whose client forgets to close the socket with
    which it was just reaching for a scheduler that is gone. Later it would be another test's."""
    yield
    _sweep()


@pytest.fixture(scope="module")
def swept_module() -> Iterator[None]:
    """The same after the fixtures of a module."""
    yield
    _sweep()


def _sweep() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        gc.collect()
