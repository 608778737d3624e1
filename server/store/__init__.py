"""Everything that is written: metadata in a database, results in arrays."""

from server.store.advisory import AdvisoryLock, LockHeldError
from server.store.checkpoint import Checkpoint, earlier_checkpoints, read_checkpoint
from server.store.cleaning import Orphan, free_bytes, orphans, remove_orphans, used_bytes
from server.store.database import (
    Database,
    DatabaseUrlError,
    KeyReusedError,
    QueueFullError,
    SchemaVersionError,
    migrate,
)
from server.store.documents import plain, read_document, write_document
from server.store.failures import CheckpointError, PlaceError, StoreError, StoreFullError
from server.store.holding import Holding
from server.store.layout import attempt_place, job_place, model_place, run_place
from server.store.library import LibraryFullError, LibraryRecord, NewEntry
from server.store.model_store import ModelStore
from server.store.ownership import OWNER, claim_store
from server.store.place import Place, check_place, claim, open_place
from server.store.plan import StoredPlan
from server.store.reader import NotStoredError, RunReader
from server.store.records import (
    BatchRecord,
    Decide,
    EventRecord,
    JobDecision,
    JobFilter,
    JobRecord,
    JobView,
    NewEvent,
    NewJob,
    Requests,
    RunRecord,
)
from server.store.writer import RunWriter, write_summary
from solver.results import SlabPeaks

__all__ = [
    "OWNER",
    "AdvisoryLock",
    "BatchRecord",
    "Checkpoint",
    "CheckpointError",
    "Database",
    "DatabaseUrlError",
    "Decide",
    "EventRecord",
    "Holding",
    "JobDecision",
    "JobFilter",
    "JobRecord",
    "JobView",
    "KeyReusedError",
    "LibraryFullError",
    "LibraryRecord",
    "LockHeldError",
    "ModelStore",
    "NewEntry",
    "NewEvent",
    "NewJob",
    "NotStoredError",
    "Orphan",
    "Place",
    "PlaceError",
    "QueueFullError",
    "Requests",
    "RunReader",
    "RunRecord",
    "RunWriter",
    "SchemaVersionError",
    "SlabPeaks",
    "StoreError",
    "StoreFullError",
    "StoredPlan",
    "attempt_place",
    "check_place",
    "claim",
    "claim_store",
    "earlier_checkpoints",
    "free_bytes",
    "job_place",
    "migrate",
    "model_place",
    "open_place",
    "orphans",
    "plain",
    "read_checkpoint",
    "read_document",
    "remove_orphans",
    "run_place",
    "used_bytes",
    "write_document",
    "write_summary",
]
