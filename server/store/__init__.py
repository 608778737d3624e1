"""Everything that is written: metadata in a database, results in arrays."""

from server.store.database import Database, QueueFullError, SchemaVersionError
from server.store.documents import plain
from server.store.layout import attempt_folder
from server.store.plan import StoredPlan
from server.store.reader import NotStoredError, RunReader
from server.store.records import BatchRecord, EventRecord, JobRecord, NewEvent, RunRecord
from server.store.writer import RunWriter, write_summary

__all__ = [
    "BatchRecord",
    "Database",
    "EventRecord",
    "JobRecord",
    "NewEvent",
    "NotStoredError",
    "QueueFullError",
    "RunReader",
    "RunRecord",
    "RunWriter",
    "SchemaVersionError",
    "StoredPlan",
    "attempt_folder",
    "plain",
    "write_summary",
]
