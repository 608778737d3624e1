"""Which tables a database has, and how they become those of this program.

Alembic's migrations lie inside of the package. Alembic itself is imported only where tables are
made or changed: a server on a database of today does without it.
"""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from sqlalchemy import URL, Connection, Engine, inspect, text

from server.settings.addresses import without_secrets
from server.store.sessions import database_url, open_engine, take_right_to_write

__all__ = ["MIGRATIONS", "REVISIONS", "SchemaVersionError", "migrate", "require_schema"]

MIGRATIONS = Path(__file__).parent / "migrations"
REVISIONS = ("0001", "0002", "0003", "0004")
"""Every revision, oldest first; the last is what this program reads."""


class SchemaVersionError(Exception):
    """The database was written by another version; the text says what to do."""


def require_schema(engine: Engine) -> None:
    """Makes the tables of a new database, and refuses those of another version.

    Raises:
        SchemaVersionError: The tables are older or newer.
    """
    with engine.connect() as connection:
        found = _revision(connection)
    if found is None:
        with engine.connect().execution_options(immediate=True) as connection, connection.begin():
            take_right_to_write(connection)
            # Another process may have made them while this one waited.
            found = _revision(connection) or _upgrade(connection)
    _refuse_newer(engine.url, found)
    if found != REVISIONS[-1]:
        raise SchemaVersionError(
            f"The database {_shown(engine.url)} has schema {found}, older than schema "
            f"{REVISIONS[-1]} of this version of trainbridge. Stop the server and run "
            "`trainbridge migrate`: it keeps every job, and copies an SQLite file first."
        )


def migrate(url: str | Path, *, clock: Callable[[], float] = time.time) -> tuple[str, str]:
    """Brings a database to the newest schema, all or nothing; an SQLite file is copied first.

    The copy lies beside the file, with the revision and the date in its name; it replaces nothing.

    Args:
        url: Path of an SQLite file, or URL.
        clock: For the date. [s]

    Returns:
        The revision before and after.

    Raises:
        SchemaVersionError: There is no database, or a newer one.
        OSError: The copy cannot be written.
    """
    parsed = database_url(url)
    file = _file(parsed)
    if file is not None and not file.exists():
        raise SchemaVersionError(f"There is no database {file}: nothing to migrate.")
    # SQLite tables are rebuilt under other names: what refers to them must not be looked at.
    engine = open_engine(parsed, foreign_keys=False)
    try:
        with engine.connect().execution_options(immediate=True) as connection, connection.begin():
            take_right_to_write(connection)
            found = _revision(connection)
            if found is None:
                raise SchemaVersionError(
                    f"The database {_shown(parsed)} has no tables: nothing to migrate."
                )
            _refuse_newer(parsed, found)
            if found != REVISIONS[-1]:
                if file is not None:
                    _copy(file, found, clock())
                _upgrade(connection)
                _require_references(connection)
            return found, REVISIONS[-1]
    finally:
        engine.dispose()


def _revision(connection: Connection) -> str | None:
    """The revision of a database's tables; None where it has none."""
    tables = set(inspect(connection).get_table_names())
    if "alembic_version" in tables:
        found = connection.scalar(text("SELECT version_num FROM alembic_version"))
        if found is not None:
            return str(found)
    if "schema_version" in tables:
        # From before migrations: 1 is the first revision, and there was no other.
        version = connection.scalar(text("SELECT version FROM schema_version"))
        return REVISIONS[0] if version in (None, 1) else str(version)
    if "jobs" in tables:
        raise SchemaVersionError(
            f"The database {_shown(connection.engine.url)} holds tables of another program. Give "
            "another --data folder or another database."
        )
    return None


def _refuse_newer(url: URL, found: str) -> None:
    if found not in REVISIONS:
        raise SchemaVersionError(
            f"The database {_shown(url)} has schema {found}, which this version of trainbridge "
            f"does not know: it reads schema {REVISIONS[-1]}. Upgrade trainbridge, or give another "
            "--data folder."
        )


def _upgrade(connection: Connection) -> str:
    """Runs the migrations that are missing, inside the connection's transaction."""
    from alembic import command
    from alembic.config import Config

    config = Config(attributes={"connection": connection})
    # A percent sign in the path is no variable.
    config.set_main_option("script_location", str(MIGRATIONS).replace("%", "%%"))
    tables = set(inspect(connection).get_table_names())
    if "schema_version" in tables and "alembic_version" not in tables:
        command.stamp(config, REVISIONS[0])
    command.upgrade(config, "head")
    return REVISIONS[-1]


def _require_references(connection: Connection) -> None:
    if connection.dialect.name == "sqlite":
        broken = connection.exec_driver_sql("PRAGMA foreign_key_check").first()
        if broken is not None:
            raise SchemaVersionError(
                f"Rows of table {broken[0]} refer to rows of {broken[2]} that are missing. The "
                "database was left as it was: restore a copy of it."
            )


def _copy(file: Path, revision: str, now: float) -> None:
    """A whole copy of a database that may be open, under a name that is free."""
    date = time.strftime("%Y-%m-%dT%H%M%SZ", time.gmtime(now))
    for number in range(1, 1000):
        suffix = "" if number == 1 else f"-{number}"
        target = file.with_name(f"{file.stem}-{revision}-{date}{suffix}{file.suffix}")
        try:
            target.touch(0o600, exist_ok=False)
        except FileExistsError:
            continue
        break
    else:
        raise FileExistsError(f"There are a thousand copies of {file} already.")
    try:
        with closing(sqlite3.connect(file)) as source, closing(sqlite3.connect(target)) as copy:
            source.backup(copy)
    except BaseException:
        target.unlink()
        raise


def _file(url: URL) -> Path | None:
    is_file = url.get_backend_name() == "sqlite" and url.database
    return Path(url.database) if is_file and url.database else None


def _shown(url: URL) -> str:
    """A database's address without its secrets."""
    file = _file(url)
    return str(file) if file else without_secrets(url.render_as_string(hide_password=False))
