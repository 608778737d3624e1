"""Jobs, batches, runs and events in a SQL database: the truth of the queue.

Each method is one transaction. Only the coordinator changes states; routes add jobs, read, and note
what people ask for. What each group of methods does stands in the modules of the base classes.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from server.store.library import Library
from server.store.queue import Queue
from server.store.requests import RequestFlags
from server.store.schema import SchemaVersionError, migrate, require_schema
from server.store.sessions import BUSY_SECONDS, DatabaseUrlError, database_url, open_engine
from server.store.submissions import KeyReusedError, QueueFullError, Submissions
from server.store.upkeep import Upkeep

__all__ = [
    "Database",
    "DatabaseUrlError",
    "KeyReusedError",
    "QueueFullError",
    "SchemaVersionError",
    "migrate",
]


class Database(Submissions, RequestFlags, Queue, Upkeep, Library):
    """The metadata of one installation, in an SQLite file or on a PostgreSQL server.

    Methods raise SQLAlchemy's ``OperationalError`` where the database is locked for too long, gone
    or full: nothing of the method has happened then, and the next call connects anew.
    """

    def __init__(
        self,
        url: str | Path,
        *,
        clock: Callable[[], float] = time.time,
        busy_seconds: float = BUSY_SECONDS,
    ) -> None:
        """Opens the database, or makes its tables where it is new.

        Args:
            url: Path of an SQLite file, or ``sqlite:///...`` or ``postgresql://...``.
            clock: Seconds since 1970, UTC.
            busy_seconds: Longest wait for other writers. [s]

        Raises:
            DatabaseUrlError: The URL is none of these.
            SchemaVersionError: The database belongs to another version of this program.
            sqlalchemy.exc.OperationalError: It cannot be reached.
        """
        super().__init__(open_engine(database_url(url), busy_seconds=busy_seconds), clock)
        try:
            require_schema(self.engine)
        except BaseException:
            self.close()
            raise
