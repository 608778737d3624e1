"""A store is of one database, and nobody else removes anything there."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from typer.testing import CliRunner

from server.cli import app
from server.commands import maintenance
from server.store import Database, PlaceError, attempt_place, claim_store, open_place
from tests.server.database_case import add


def test_a_store_is_of_the_first_database_that_takes_it(
    tmp_path: Path, database_url: str, open_database: Callable[..., Database]
) -> None:
    store = open_place(tmp_path / "store")
    ours, other = open_database(database_url), open_database(tmp_path / "other.sqlite")
    claim_store(store, ours)
    claim_store(store, open_database(database_url))
    with pytest.raises(PlaceError, match=r"another database.*--store.*remove the document OWNER"):
        claim_store(store, other)
    store.remove("OWNER")
    claim_store(store, other)


def _run_beside(data: Path) -> Path:
    """A database with a job, beside a run that it does not know."""
    data.mkdir(parents=True)
    with closing(Database(data / "trainbridge.sqlite")) as database:
        add(database)
    run = attempt_place(open_place(data), "0123456789abcdef", 1)
    run.write("plan.json", b"{}")
    return data / "runs" / "0123456789abcdef"


def test_runs_of_another_database_are_not_cleaned_away(tmp_path: Path) -> None:
    run = _run_beside(tmp_path / "data")
    with closing(Database(tmp_path / "theirs.sqlite")) as theirs:
        claim_store(open_place(tmp_path / "data"), theirs)
    words = ["clean", "--data", str(tmp_path / "data"), "--yes"]
    refused = CliRunner().invoke(app, words)
    assert refused.exit_code == 1
    assert "belongs to another database" in refused.output
    assert "Nothing was removed" in refused.output
    assert run.exists()
    (tmp_path / "data" / "OWNER").unlink()
    removed = CliRunner().invoke(app, words)
    assert "Removed 1 items" in removed.output
    assert not run.exists()
    with (
        closing(Database(tmp_path / "theirs.sqlite")) as theirs,
        pytest.raises(PlaceError),
    ):
        claim_store(open_place(tmp_path / "data"), theirs)


def test_clean_counts_what_it_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = _run_beside(tmp_path / "data")
    look = maintenance._known  # pyright: ignore[reportPrivateUsage]
    looks: list[None] = []

    def known(database: Database) -> object:
        found = look(database)
        looks.append(None)
        if len(looks) > 1:  # Submitted after the files were listed.
            found.runs.add(run.name)
        return found

    monkeypatch.setattr(maintenance, "_known", known)
    words = ["clean", "--data", str(tmp_path / "data"), "--yes"]
    assert "Removed 0 items, 0 B" in CliRunner().invoke(app, words).output
    assert run.exists()
