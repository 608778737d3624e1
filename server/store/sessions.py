"""Connections and transactions: the same promises on SQLite and PostgreSQL.

SQLite with a write-ahead log and ``synchronous=FULL``: what was answered with 202 survives a power
cut. On both, one transaction writes at a time, and it holds the right to write from its first
statement on: what it reads stays true until it commits. SQLite gives that by ``BEGIN IMMEDIATE``,
PostgreSQL by an advisory lock of the transaction. Writers are few (a coordinator and some web
processes) and short, so that waiting costs less than finding out which rows two of them share; and
numbers of events are committed in their order, so that a reader who remembers the last one that it
saw misses none. A transaction that only reads sees one moment, whatever is written meanwhile:
SQLite gives that anyway, PostgreSQL where it is asked for. Nobody waits for ever: after
``busy_seconds`` SQLAlchemy's ``OperationalError``.
"""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sqlalchemy import URL, Connection, Engine, create_engine, event, func, make_url, select
from sqlalchemy.exc import ArgumentError
from sqlalchemy.orm import Session

__all__ = ["BUSY_SECONDS", "DatabaseUrlError", "Sessions", "database_url", "open_engine"]

BUSY_SECONDS = 10.0
"""Longest wait for the right to write. [s]"""
WRITER_LOCK = 0x7472_6169_6E01
"""Number of PostgreSQL's advisory lock for the right to write ("train", 1)."""
_CONNECT_SECONDS = 5
"""Longest wait for PostgreSQL to answer a new connection. [s]"""
_LOOK_SECONDS = 0.005
"""Time between two looks at a file that another one changes. [s]"""
_IDLE_SECONDS = 30
"""After this a transaction whose client went silent is ended, and its locks with it. [s]"""
_ONE_MOMENT: dict[str, Any] = {"isolation_level": "REPEATABLE READ", "postgresql_readonly": True}
"""Of a transaction that reads: PostgreSQL's own choice looks anew for each statement."""
_MOST = 40
"""Connections beyond the five that are kept: as many as a server has threads that may wait."""


class DatabaseUrlError(ValueError):
    """An address that is none of a database that can be used; the text says what to do."""


class Sessions:
    """Gives transactions on one database; what reads and writes tables builds on it."""

    def __init__(self, engine: Engine, clock: Callable[[], float] = time.time) -> None:
        """Takes an engine of ``open_engine``."""
        self._engine = engine
        postgresql = engine.dialect.name == "postgresql"
        self._reading = engine.execution_options(**_ONE_MOMENT) if postgresql else engine
        self._clock = clock

    @property
    def engine(self) -> Engine:
        """For locks and migrations."""
        return self._engine

    def close(self) -> None:
        """Closes every connection."""
        self._engine.dispose()

    @contextmanager
    def _write(self) -> Generator[Session]:
        """One transaction that may write: all of it or nothing is stored."""
        connection = self._engine.connect().execution_options(immediate=True)
        with connection, Session(connection, expire_on_commit=False) as session, session.begin():
            # By the session: it commits only a transaction that it began itself.
            take_right_to_write(session.connection())
            yield session

    @contextmanager
    def _read(self) -> Generator[Session]:
        """One transaction that only reads: all its statements see the same moment."""
        with Session(self._reading, expire_on_commit=False) as session:
            yield session


def take_right_to_write(connection: Connection) -> None:
    """Waits until no other transaction writes; SQLite's own ``BEGIN`` has done so."""
    if connection.dialect.name == "postgresql":
        connection.execute(select(func.pg_advisory_xact_lock(WRITER_LOCK)))


def database_url(url: str | Path) -> URL:
    """A path of an SQLite file, or the URL of an SQLite or PostgreSQL database.

    Raises:
        DatabaseUrlError: It is neither.
    """
    if isinstance(url, Path) or "://" not in url:
        return URL.create("sqlite", database=str(url))
    try:
        parsed = make_url(url)
    except (ArgumentError, ValueError):
        # The text may hold a password: it is not repeated.
        raise DatabaseUrlError(f"The database's URL cannot be read. {_FORMS}") from None
    match parsed.drivername:
        case "sqlite" if parsed.database and parsed.database != ":memory:":
            return parsed
        case "postgresql" | "postgres" | "postgresql+psycopg":
            return parsed.set(drivername="postgresql+psycopg")
        case name:
            raise DatabaseUrlError(f"A database {name!r} cannot be used. {_FORMS}")


_FORMS = (
    "Give the path of an SQLite file, sqlite:////absolute/path.sqlite, or "
    "postgresql://user:password@host/name."
)


def open_engine(
    url: URL, *, busy_seconds: float = BUSY_SECONDS, foreign_keys: bool = True
) -> Engine:
    """An engine whose connections keep this module's promises.

    Args:
        url: Of ``database_url``.
        busy_seconds: Longest wait for the right to write. [s]
        foreign_keys: Whether SQLite checks them: not while tables are rebuilt.

    Raises:
        DatabaseUrlError: The driver of PostgreSQL is not installed.
    """
    if url.get_backend_name() == "sqlite":
        return _open_sqlite(url, busy_seconds, foreign_keys)
    return _open_postgresql(url, busy_seconds)


def _open_sqlite(url: URL, busy_seconds: float, foreign_keys: bool) -> Engine:
    engine = create_engine(url, connect_args={"timeout": busy_seconds}, max_overflow=_MOST)

    @event.listens_for(engine, "connect")
    def prepare(connection: Any, _record: Any) -> None:
        # The driver's own transactions begin late and cannot be made to write at once: we begin.
        connection.isolation_level = None
        cursor = connection.cursor()
        _use_write_ahead_log(cursor, busy_seconds)
        checked = "ON" if foreign_keys else "OFF"
        for pragma in ("synchronous=FULL", f"foreign_keys={checked}"):
            cursor.execute(f"PRAGMA {pragma}")
        cursor.close()

    @event.listens_for(engine, "begin")
    def begin(connection: Any) -> None:
        # A writer that began as a reader could find the database changed under it.
        immediate = connection.get_execution_options().get("immediate", False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if immediate else "BEGIN")

    return engine


def _use_write_ahead_log(cursor: Any, busy_seconds: float) -> None:
    """Of several that open a new file together SQLite lets one change it, and turns the others away
    without the wait that it grants otherwise: they look again."""
    limit = time.monotonic() + busy_seconds
    while True:
        try:
            cursor.execute("PRAGMA journal_mode=WAL")
            return
        except sqlite3.OperationalError as error:
            if "locked" not in str(error) or time.monotonic() >= limit:
                raise
            time.sleep(_LOOK_SECONDS)


def _open_postgresql(url: URL, busy_seconds: float) -> Engine:
    given = {"connect_timeout": _CONNECT_SECONDS, "application_name": "trainbridge", **url.query}
    # A server that vanished without a word is noticed by its silence, not after hours.
    silence = {"keepalives_idle": 5, "keepalives_interval": 2, "keepalives_count": 3}
    silence |= {"tcp_user_timeout": 10_000}
    try:
        engine = create_engine(
            url, pool_pre_ping=True, connect_args={**silence, **given}, max_overflow=_MOST
        )
    except ImportError:
        raise DatabaseUrlError(
            'PostgreSQL needs its driver: pip install "psycopg[binary]", or leave the database\'s '
            "URL away to use SQLite."
        ) from None

    @event.listens_for(engine, "connect")
    def prepare(connection: Any, _record: Any) -> None:
        # Outside of a transaction: a setting inside of one would be rolled back with it.
        connection.autocommit = True
        for setting, value in (
            # As SQLite's ``synchronous=FULL``: an answer comes after the disk has it.
            ("synchronous_commit", "on"),
            ("lock_timeout", round(1000 * busy_seconds)),
            ("idle_in_transaction_session_timeout", 1000 * _IDLE_SECONDS),
        ):
            connection.execute(f"SET {setting} = {value}")
        connection.autocommit = False

    return engine
