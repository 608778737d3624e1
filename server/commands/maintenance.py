"""Commands for who runs a server: its settings, its database, its disk."""

from __future__ import annotations

import json
from contextlib import closing
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from server.commands.console import fail, settings_of, wide_console
from server.commands.serving import Config, Data, DatabaseUrl, Store
from server.settings import DATABASE_NAME, Settings
from server.settings.addresses import without_secrets

if TYPE_CHECKING:
    from server.store import Database, Place

__all__ = ["clean", "config", "migrate"]


def config(
    as_json: Annotated[bool, typer.Option("--json", help="Print as JSON.")] = False,
    file: Config = None,
) -> None:
    """Print every setting: its value, where it comes from, what it means."""
    shown = settings_of(config=file).shown()
    if as_json:
        typer.echo(json.dumps([asdict(item) for item in shown], indent=2, ensure_ascii=False))
        return
    from rich.table import Table

    table = Table("setting", "value", "from", "meaning", box=None, pad_edge=False)
    for item in shown:
        table.add_row(item.name, item.value, item.source, item.meaning)
    wide_console().print(table)
    typer.echo(
        "\nStrongest first: command line, variable TRAINBRIDGE_<NAME> (dots become _), file "
        "(--config, TRAINBRIDGE_CONFIG or trainbridge.toml), default."
    )


def migrate(data: Data = None, database: DatabaseUrl = None, config: Config = None) -> None:
    """Bring the database of an older version to this one; a copy of an SQLite file is kept."""
    settings = settings_of(config=config, data=data, database=database).settings
    from sqlalchemy.exc import SQLAlchemyError

    from server.jobs.lock import FolderInUseError, FolderLock
    from server.store import SchemaVersionError
    from server.store import migrate as migrate_database

    try:
        if settings.data.is_dir():
            # Whoever works with the old tables would fail in the middle of its work.
            with FolderLock(settings.data):
                before, after = migrate_database(settings.database_url)
        else:
            before, after = migrate_database(settings.database_url)
    except (SchemaVersionError, FolderInUseError) as error:
        fail(str(error))
    except (SQLAlchemyError, OSError) as error:
        fail(f"The database was left as it was: {error}.")
    if before == after:
        typer.echo(f"The database has schema {after} already.")
    else:
        typer.echo(f"The database had schema {before} and has schema {after} now.")


def clean(
    yes: Annotated[
        bool, typer.Option("--yes", help="Remove what is listed; without it nothing is removed.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Only list, whatever else is said.")
    ] = False,
    data: Data = None,
    database: DatabaseUrl = None,
    store: Store = None,
    config: Config = None,
) -> None:
    """List, or with --yes remove, what no job refers to; safe while a server runs."""
    settings = settings_of(config=config, data=data, database=database, store=store).settings
    from sqlalchemy.exc import SQLAlchemyError

    from server.store import SchemaVersionError, StoreError

    try:
        _clean(settings, remove=yes and not dry_run)
    except (SchemaVersionError, StoreError) as error:
        fail(str(error))
    except SQLAlchemyError as error:
        fail(f"The database cannot be used: {error}.")


def _clean(settings: Settings, *, remove: bool) -> None:
    """Removes names that the database does not know, and what finished runs have outlived.

    A job is in the database before it has any file. So the files are listed first and the database
    is asked again afterwards: a name that it does not know then belongs to no job, of now or to
    come, and no lock is needed.
    """
    from server.store import Database, Orphan, open_place, orphans, remove_orphans

    if not settings.database and not (settings.data / DATABASE_NAME).is_file():
        fail(f"There is no database in {settings.data}. Name the data folder with --data.")
    place = open_place(settings.store_url)
    with closing(Database(settings.database_url)) as database:
        before = _known(database)
        found = orphans(place, runs=before.runs, jobs=before.jobs, models=before.models)
        if remove and found:
            _require_ours(settings, place, database, empty=not before.jobs)
        known = _known(database)
    for item in found:
        typer.echo(f"{item.kind:8} {item.name}  {item.bytes:,} B")
    size = sum(item.bytes for item in found)
    if not remove:
        hint = " Run it again with --yes to remove them." if found else ""
        typer.echo(f"Would remove {len(found)} items, {size:,} B.{hint}")
        return
    removed: list[Orphan] = []
    size = remove_orphans(
        found, runs=known.runs, jobs=known.jobs, models=known.models, report=removed.append
    )
    typer.echo(f"Removed {len(removed)} items, {size:,} B.")


def _require_ours(settings: Settings, store: Place, database: Database, *, empty: bool) -> None:
    """Ends the command where the files may be those of another database."""
    from server.store import OWNER, PlaceError, claim_store

    if empty and not store.exists(OWNER):
        fail(
            f"The database {without_secrets(settings.database_url)} holds no job at all: it may "
            f"not be the one of the store {without_secrets(settings.store_url)}. Nothing was "
            "removed. If it is, remove the folders runs, jobs and models there by hand."
        )
    try:
        claim_store(store, database)
    except PlaceError as error:
        fail(f"{error} Nothing was removed.")


@dataclass(frozen=True, kw_only=True)
class _Known:
    """Names that the database holds."""

    runs: set[str]
    jobs: set[str]
    models: set[str]


def _known(database: Database) -> _Known:
    return _Known(
        runs=database.known_runs(), jobs=database.known_jobs(), models=database.known_models()
    )
