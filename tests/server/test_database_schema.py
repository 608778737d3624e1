"""Tables become those of this program, and no row is lost on the way."""

from __future__ import annotations

import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import text

from server.store import Database, SchemaVersionError, migrate
from server.store.models import Table
from server.store.schema import (
    MIGRATIONS,
    REVISIONS,
    _shown,  # pyright: ignore[reportPrivateUsage]
)
from server.store.sessions import database_url as parsed
from server.store.sessions import open_engine
from tests.server.database_case import add, compute

RUN_STATES = ("done", "failed", "queued", "running", "timed_out")


def write_first_version(url: str) -> None:
    """A database as it was before migrations: its tables, rows in each, no Alembic."""
    engine = open_engine(parsed(url))
    with engine.begin() as connection:
        config = Config(attributes={"connection": connection})
        config.set_main_option("script_location", str(MIGRATIONS))
        command.upgrade(config, "0001")
        connection.execute(text("DROP TABLE alembic_version"))
        connection.execute(
            text(
                "INSERT INTO jobs (id, kind, name, study, state, cancel_requested, steps, created) "
                "VALUES ('job', 'crossing', 'old', '{\"a\": 1}', 'running', :no, 5, 3.5)"
            ),
            {"no": False},
        )
        for index, state in enumerate(RUN_STATES):
            values = {"id": f"run{index}", "batch": f"batch{index}", "index": index, "state": state}
            connection.execute(
                text(
                    "INSERT INTO batches (id, job, state, attempt) "
                    "VALUES (:batch, 'job', :state, 2)"
                ),
                values,
            )
            connection.execute(
                text(
                    'INSERT INTO runs (id, job, batch, "index", parameters, state, attempt, '
                    "progress, verdicts) VALUES "
                    "(:id, 'job', :batch, :index, '{\"speed\": 50.0}', :state, 2, '{}', 'null')"
                ),
                values,
            )
        connection.execute(
            text(
                "INSERT INTO events (job, run, kind, data, time) "
                "VALUES ('job', 'run0', 'state', '{\"state\": \"done\"}', 4.0)"
            )
        )
    engine.dispose()


def test_an_older_database_is_refused_and_the_command_named(database_url: str) -> None:
    write_first_version(database_url)
    with pytest.raises(SchemaVersionError, match="Stop the server and run `trainbridge migrate`"):
        Database(database_url)


def test_a_migration_keeps_every_row(database_url: str) -> None:
    write_first_version(database_url)
    assert migrate(database_url) == ("0001", "0004")
    assert migrate(database_url) == ("0004", "0004")
    database = Database(database_url)
    job = database.job("job")
    assert job is not None
    assert (job.name, job.study, job.steps, job.created) == ("old", {"a": 1}, 5, 3.5)
    assert (job.priority, job.disk_bytes, job.wants_gather, job.source) == (0, 0, False, None)
    runs = database.runs("job")
    assert tuple(run.state for run in runs) == RUN_STATES
    assert {(run.attempt, run.parameters["speed"], run.verdicts) for run in runs} == {
        (2, 50.0, None)
    }
    # A batch says that it has ended, its runs say how.
    states = [batch.state for batch in database.batches_of("job")]
    assert states == ["done", "done", "queued", "running", "done"]
    (event,) = database.events_after(0)
    assert (event.id, event.data, event.time) == (1, {"state": "done"}, 4.0)
    # And it works.
    add(database)
    assert compute(database) == 2
    assert database.last_event() > 1
    database.close()


def test_a_copy_is_made_first_and_replaces_nothing(tmp_path: Path) -> None:
    file = tmp_path / "trainbridge.sqlite"
    write_first_version(str(file))
    named = tmp_path / "trainbridge-0001-1970-01-01T000140Z.sqlite"
    named.write_text("mine")
    migrate(file, clock=lambda: 100.0)
    assert named.read_text() == "mine"
    copy = tmp_path / "trainbridge-0001-1970-01-01T000140Z-2.sqlite"
    with closing(sqlite3.connect(copy)) as connection:
        assert connection.execute("SELECT count(*) FROM runs").fetchone() == (5,)
        assert connection.execute("SELECT version FROM schema_version").fetchone() == (1,)
    assert {path.suffix for path in tmp_path.iterdir()} == {".sqlite"}


def test_a_migration_that_fails_changes_nothing(
    database_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_first_version(database_url)

    def fail(_connection: Any) -> None:
        raise OSError("the disk is full")

    with monkeypatch.context() as patch:
        patch.setattr("server.store.schema._require_references", fail)
        with pytest.raises(OSError, match="full"):
            migrate(database_url)
    assert migrate(database_url) == ("0001", "0004")


def test_rows_that_refer_to_nothing_stop_a_migration(tmp_path: Path) -> None:
    file = tmp_path / "trainbridge.sqlite"
    write_first_version(str(file))
    with closing(sqlite3.connect(file)) as connection, connection:
        connection.execute("UPDATE runs SET batch = 'nothing' WHERE id = 'run0'")
    with pytest.raises(SchemaVersionError, match="runs refer to rows of batches"):
        migrate(file)
    with pytest.raises(SchemaVersionError, match="schema 0001"):
        Database(file)


def test_a_newer_database_is_refused(database_url: str) -> None:
    Database(database_url).close()
    engine = open_engine(parsed(database_url))
    with engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '0099'"))
    engine.dispose()
    for opened in (Database, migrate):
        with pytest.raises(SchemaVersionError, match=r"0099.*Upgrade trainbridge.*--data"):
            opened(database_url)


def test_what_is_no_database_of_ours_is_refused(database_url: str, tmp_path: Path) -> None:
    engine = open_engine(parsed(database_url))
    with engine.begin() as connection:
        connection.execute(text("CREATE TABLE jobs (title VARCHAR(10))"))
    engine.dispose()
    with pytest.raises(SchemaVersionError, match="another program"):
        Database(database_url)
    with pytest.raises(SchemaVersionError, match="no database"):
        migrate(tmp_path / "nothing.sqlite")
    assert not (tmp_path / "nothing.sqlite").exists()


@pytest.mark.parametrize("way", ["created", "migrated"])
def test_migrations_make_the_tables_that_the_program_reads(database_url: str, way: str) -> None:
    if way == "created":
        Database(database_url).close()
    else:
        write_first_version(database_url)
        migrate(database_url)
    engine = open_engine(parsed(database_url))
    with engine.connect() as connection:
        options = {"compare_type": True, "render_as_batch": True}
        context = MigrationContext.configure(connection, opts=options)
        assert compare_metadata(context, Table.metadata) == []
    engine.dispose()


def test_revisions_are_those_in_the_package() -> None:
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    scripts = ScriptDirectory.from_config(config).walk_revisions()
    assert [script.revision for script in scripts] == list(REVISIONS)[::-1]


def test_a_database_of_today_is_opened_without_alembic(tmp_path: Path) -> None:
    """Alembic and Mako cost an idle server memory and a command line time."""
    Database(tmp_path / "trainbridge.sqlite").close()
    program = (
        "import sys; from server.store import Database; Database(sys.argv[1]).close();"
        "print(sorted({'alembic', 'mako', 'psycopg'} & set(sys.modules)))"
    )
    answer = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path / "trainbridge.sqlite")],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        check=True,
    )
    assert answer.stdout.strip() == "[]"


def test_a_refusal_tells_no_secret_of_the_databases_address() -> None:
    url = "postgresql://me:one@host/name?sslpassword=two&application_name=mine"
    shown = _shown(parsed(url))
    assert "one" not in shown
    assert "two" not in shown
    assert "host/name" in shown
    assert "mine" in shown
