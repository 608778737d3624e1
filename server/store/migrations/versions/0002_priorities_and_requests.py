"""Priorities, requests of people, checkpoints, what prepares and gathers.

Every row is kept. A batch that had ended as one of its runs did is ``done`` now: how each run
ended is said by the run.
"""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None

_COUNT = sa.BigInteger().with_variant(sa.Integer, "sqlite")


def _flag(name: str) -> sa.Column[bool]:
    return sa.Column(name, sa.Boolean, nullable=False, server_default=sa.false())


def _number(name: str, default: int, kind: sa.types.TypeEngine[int]) -> sa.Column[int]:
    return sa.Column(name, kind, nullable=False, server_default=str(default))


def upgrade() -> None:
    """Changes the tables; there is no way back but the copy of the database."""
    _change_jobs()
    _change_batches()
    with op.batch_alter_table("runs") as runs:
        runs.add_column(_flag("cancel_requested"))
        runs.add_column(_flag("retry_requested"))
        runs.create_index("ix_runs_cancel_requested", ["cancel_requested"])
        runs.create_index("ix_runs_retry_requested", ["retry_requested"])
    op.create_index("events_of_a_kind", "events", ["kind", "time"])
    if op.get_context().dialect.name == "postgresql":
        op.alter_column("events", "id", type_=sa.BigInteger, existing_type=sa.Integer)
        op.execute("ALTER SEQUENCE events_id_seq AS bigint")
    op.execute("UPDATE batches SET state = 'done' WHERE state NOT IN ('queued', 'running')")
    # Versions from before migrations refuse any number but theirs.
    op.execute("UPDATE schema_version SET version = 2")


def _change_jobs() -> None:
    with op.batch_alter_table("jobs") as jobs:
        jobs.alter_column("steps", type_=_COUNT, existing_type=sa.Integer, existing_nullable=False)
        jobs.add_column(_number("priority", 0, sa.Integer()))
        jobs.add_column(sa.Column("source", sa.String(32)))
        jobs.add_column(_number("disk_bytes", 0, _COUNT))
        jobs.add_column(_flag("wants_gather"))
        jobs.add_column(sa.Column("model", sa.String(64)))
        jobs.add_column(_number("generation", 0, sa.Integer()))
        jobs.add_column(_flag("retry_requested"))
        jobs.add_column(_flag("delete_requested"))
        jobs.add_column(sa.Column("key", sa.String(200)))
        jobs.add_column(sa.Column("body_digest", sa.String(64)))
        jobs.create_unique_constraint("jobs_key", ["key"])
        jobs.create_index("jobs_in_order", ["state", "priority", "sequence"])
        jobs.create_index("ix_jobs_created", ["created"])
        jobs.create_index("ix_jobs_source", ["source"])
        jobs.create_index("ix_jobs_retry_requested", ["retry_requested"])
        jobs.create_index("ix_jobs_delete_requested", ["delete_requested"])


def _change_batches() -> None:
    with op.batch_alter_table("batches") as batches:
        batches.add_column(
            sa.Column("purpose", sa.String(16), nullable=False, server_default="runs")
        )
        batches.add_column(sa.Column("generation", sa.Integer))
        batches.add_column(_number("deaths", 0, sa.Integer()))
        batches.add_column(_number("checkpoint_step", -1, _COUNT))
        batches.add_column(sa.Column("model", sa.String(64)))
        batches.add_column(sa.Column("waits_for", sa.String(32)))
        batches.create_unique_constraint("one_a_generation", ["job", "purpose", "generation"])
