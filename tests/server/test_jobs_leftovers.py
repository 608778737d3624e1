"""What attempts and jobs leave: taken up where it is sound, removed where nobody needs it."""

from __future__ import annotations

from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from server.jobs.attempts import order_for
from server.jobs.computing import compute_order
from server.jobs.engines import open_engine
from server.jobs.gather import gather_job
from server.jobs.ledger import Ledger
from server.jobs.orders import Commands, Order
from server.jobs.process import StoppedError
from server.jobs.requests import Requested
from server.jobs.resuming import Resumable
from server.jobs.submission import stored_study
from server.settings import Settings
from server.store import (
    BatchRecord,
    Database,
    ModelStore,
    StoreError,
    attempt_place,
    job_place,
    model_place,
    open_place,
    read_document,
    write_summary,
)
from server.store.local_place import LocalPlace
from solver import studies
from tests.server.database_case import LIMIT, add, end, start
from tests.server.server_case import short_study


def _order(settings: Settings, batch: BatchRecord, database: Database) -> Order:
    return order_for(batch, settings, compute_order, database.runs_of([batch.job])[batch.job])


def _resumed_step(settings: Settings, order: Order, attempt: int, stop_after: int) -> int:
    """The step at which an attempt begins; it is stopped some steps later."""
    study = stored_study(order.study)
    simulation = studies.prepare(study, 0)
    commands = Commands()
    store = open_place(settings.store_url)
    again = replace(order, attempt=attempt)
    keeper = Resumable(store, again, order.runs[0], lambda _: None, commands)
    writer = keeper.begin(simulation)
    first = writer.expected_step
    with suppress(StoppedError):
        for sample in simulation.samples():
            if sample.step >= first:
                writer.append(sample)
                commands.stop = sample.step >= first + stop_after
                keeper.after_step(simulation)
    assert commands.stop
    writer.abort()
    return first


def test_a_checkpoint_of_another_source_is_ignored(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The version alone does not tell: a change of the solver need not change its number."""
    settings = Settings(data=tmp_path)
    with closing(Database(tmp_path / "trainbridge.sqlite")) as database:
        add(database, study=short_study())
        order = _order(settings, start(database, database.queued_batches(1)[0]), database)
    assert _resumed_step(settings, order, 1, 10) == 0
    assert _resumed_step(settings, order, 2, 5) == 11
    with monkeypatch.context() as patch:
        patch.setattr(studies, "source_digest", lambda: "0" * 64)
        assert _resumed_step(settings, order, 3, 2) == 0
    assert _resumed_step(settings, order, 4, 2) == 17


def test_a_run_that_was_cancelled_as_it_ended_is_not_judged(tmp_path: Path) -> None:
    settings = Settings(data=tmp_path)
    store = open_place(tmp_path)
    study = short_study(sweep={"speeds": [30.0, 40.0]})
    with closing(Database(tmp_path / "trainbridge.sqlite")) as database:
        job = add(database, 2, study=study, wants_gather=True)
        done, cancelled = (start(database, batch) for batch in database.queued_batches(LIMIT))
        end(database, done)
        end(database, cancelled, "cancelled")
        for value, batch in enumerate((done, cancelled)):
            place = attempt_place(store, batch.runs[0].id, 1)
            verdict = {"rule": "deck", "value": value, "limit": 5.0, "exceeds": False}
            write_summary(place, {"verdicts": [verdict], "peaks": {}})
        [batch] = database.queued_batches(LIMIT)
        assert batch.purpose == "gather"
        order = _order(settings, start(database, batch), database)
    gather_job(store, order)
    document = read_document(job_place(store, job.id), "summary.json")
    assert document is not None
    assert [run["state"] for run in document["runs"]] == ["done", "cancelled"]
    assert [run["done"] for run in document["runs"]] == [True, False]
    assert [verdict["value"] for verdict in document["verdicts"]] == [0]
    assert document["judged"] == 1


def test_the_model_goes_with_the_last_job_that_needs_it(tmp_path: Path) -> None:
    settings = Settings(data=tmp_path)
    store = open_place(tmp_path)
    with closing(Database(tmp_path / "trainbridge.sqlite")) as database:
        jobs = [add(database, model=model * 32).id for model in "aab"]
        for model in "ab":
            models = ModelStore(model_place(store, model * 32))
            models.save("factor", {"values": np.arange(3)})
            models.finish()
        ledger = Ledger(database, store, 3)
        requested = Requested(database, store, ledger, open_engine(settings, ""), {})
        left: list[list[str]] = []
        for job in jobs[:2]:
            database.request_delete(job)
            requested.obey()
            requested.obey()
            assert database.known_jobs() == set(jobs[jobs.index(job) + 1 :])
            left.append(store.child("models").names())
    assert left == [["a" * 32, "b" * 32], ["b" * 32]]


def test_a_model_that_cannot_be_read_is_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    models = ModelStore(LocalPlace(tmp_path))
    models.save("factor", {"values": np.arange(3)})

    def refuse(*_: Any) -> Any:
        raise StoreError("the object store does not answer")

    monkeypatch.setattr(LocalPlace, "read", refuse)
    monkeypatch.setattr(LocalPlace, "write", refuse)
    assert models.load("factor") is None
    assert "made anew: the object store does not answer" in caplog.text
    with pytest.raises(StoreError):
        models.save("factor", {"values": np.arange(3)})
