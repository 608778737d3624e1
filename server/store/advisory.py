"""One coordinator for a PostgreSQL database: a lock that dies with the connection of its holder."""

from __future__ import annotations

from contextlib import suppress

from sqlalchemy import Connection, func, select, text
from sqlalchemy.exc import SQLAlchemyError

from server.store.holding import Holding
from server.store.sessions import DatabaseUrlError, Sessions

__all__ = ["AdvisoryLock", "LockHeldError"]

COORDINATOR_LOCK = 0x7472_6169_6E02
"""Number of the lock ("train", 2)."""

# A holder whose machine vanished is found out by its silence, within about 11 s.
_SILENCE = (
    "SET tcp_keepalives_idle = 5",
    "SET tcp_keepalives_interval = 2",
    "SET tcp_keepalives_count = 3",
)
# A lock of one number is kept as two halves of 32 bits.
_HOLDERS = text(
    "SELECT a.pid, host(a.client_addr), a.pid = pg_backend_pid() "
    "FROM pg_locks l JOIN pg_stat_activity a ON a.pid = l.pid "
    "WHERE l.locktype = 'advisory' AND l.granted AND l.objsubid = 1 "
    "AND l.database = (SELECT oid FROM pg_database WHERE datname = current_database()) "
    "AND l.classid::bigint = :high AND l.objid::bigint = :low"
).bindparams(high=COORDINATOR_LOCK >> 32, low=COORDINATOR_LOCK & 0xFFFF_FFFF)


class LockHeldError(Exception):
    """Another coordinator works on the database; the text says where."""


class AdvisoryLock(Holding):
    """Held by one connection until it is released, or until the connection or its process ends."""

    def __init__(self, database: Sessions) -> None:
        """Takes the lock of a PostgreSQL database.

        Raises:
            DatabaseUrlError: The database is none of PostgreSQL: lock its folder instead.
            LockHeldError: Another connection holds it.
            sqlalchemy.exc.OperationalError: The database does not answer.
        """
        if database.engine.dialect.name != "postgresql":
            raise DatabaseUrlError("Only PostgreSQL has this lock: lock the data folder instead.")
        connection = database.engine.connect().execution_options(isolation_level="AUTOCOMMIT")
        try:
            for setting in _SILENCE:
                connection.exec_driver_sql(setting)
            taken = connection.scalar(select(func.pg_try_advisory_lock(COORDINATOR_LOCK)))
            if not taken:
                raise LockHeldError(_refusal(connection))
        except BaseException:
            _end(connection)
            raise
        self._connection: Connection | None = connection

    def held(self) -> bool:
        """Asks the server; False once the connection was lost, and then for ever."""
        if self._connection is None:
            return False
        try:
            return any(own for _, _, own in self._connection.execute(_HOLDERS))
        except SQLAlchemyError:
            _end(self._connection)
            self._connection = None
            return False

    def release(self) -> None:
        """Gives the lock free by ending its connection; again is fine."""
        connection, self._connection = self._connection, None
        if connection is not None:
            with suppress(SQLAlchemyError):
                # A server notices the end of a connection a little later: the next may not wait.
                connection.execute(select(func.pg_advisory_unlock(COORDINATOR_LOCK)))
            _end(connection)


def _end(connection: Connection) -> None:
    """Ends it for good: in the pool, somebody else would go on with its session."""
    connection.invalidate()
    connection.close()


def _refusal(connection: Connection) -> str:
    holder = connection.execute(_HOLDERS).first()
    where = "" if holder is None else f" (from {holder[1] or 'this machine'})"
    return f"Another coordinator{where} works on this database. Stop it, or give another database."
