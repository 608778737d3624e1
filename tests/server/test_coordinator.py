"""The coordinator against an engine that does as it is told, one turn at a time."""

from __future__ import annotations

import threading
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy.exc import OperationalError

from server.jobs import supervision
from server.jobs.coordinator import Coordinator
from server.jobs.engine import EngineError
from server.jobs.orders import Order, Report
from server.jobs.states import Event
from server.store import Database, Place, StoreError, open_place
from tests.server.database_case import add
from tests.server.server_case import settings_for, until


class ScriptedEngine:
    """Holds what it was asked, and tells what the test wants told."""

    def __init__(self) -> None:
        self.orders: dict[str, Order] = {}
        self.cancelled: list[tuple[str, tuple[str, ...]]] = []
        self.told: list[Report] = []
        self.slots = 2
        self.remembers: set[str] = set()
        self.refuses: Exception | None = None
        self.starts = 0
        self._woken = threading.Event()
        self._telling = threading.Lock()

    def start(self) -> None:
        self.starts += 1
        if isinstance(self.refuses, EngineError):
            raise self.refuses

    def free_slots(self) -> int:
        return self.slots - len(self.orders)

    def run(self, order: Order) -> None:
        if self.refuses is not None:
            refused, self.refuses = self.refuses, None
            raise refused
        self.orders[order.key] = order

    def cancel(self, key: str, runs: Collection[str] = ()) -> None:
        self.cancelled.append((key, tuple(runs)))

    def reattach(self, orders: Sequence[Order]) -> set[str]:
        found = {order.key: order for order in orders if order.key in self.remembers}
        self.orders |= found
        return set(found)

    def reports(self, seconds: float) -> list[Report]:
        if not self.told:
            self._woken.wait(seconds)
        self._woken.clear()
        with self._telling:
            told, self.told = self.told, []
        for report in told:
            if report.kind == "ended":
                self.orders.pop(report.key, None)
        return told

    def wake(self) -> None:
        self._woken.set()

    def stop(self) -> None:
        return

    # What tests say.

    def tell(self, key: str, kind: str, run: str = "", **data: Any) -> None:
        with self._telling:
            self.told.append(Report(key=key, kind=kind, run=run, data=data))
        self.wake()

    def end(self, key: str, event: Event, error: str = "") -> None:
        self.tell(key, "ended", event=str(event), error=error)


class Held:
    def ensure(self) -> None:
        return


class Queue:
    """A coordinator with its parts."""

    def __init__(self, folder: Path) -> None:
        self.database = Database(folder / "queue.sqlite")
        self.engine = ScriptedEngine()
        self.store: Place = open_place(folder / "store")
        settings = settings_for(folder, queue_poll_seconds=0.02, attempts_limit=3)
        self.coordinator = Coordinator(
            self.database, self.store, settings, self.engine, Held(), compute=print
        )  # type: ignore[arg-type]

    def start(self) -> None:
        self.coordinator.start()

    def begun(self) -> Order:
        """The one order that computes."""
        return until(self.order, bool)

    def order(self) -> Order | None:
        """The first order that computes now; the coordinator's thread adds and removes some."""
        return next(iter(list(self.engine.orders.values())), None)

    def state(self, job: str) -> str:
        found = self.database.job(job)
        return "gone" if found is None else found.state


@pytest.fixture
def queue(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Queue]:
    monkeypatch.setattr("server.jobs.coordinator._RETRY_SECONDS", 0.02)
    made = Queue(tmp_path)
    yield made
    made.coordinator.stop()
    made.database.close()


def test_a_run_ends_as_its_process_says(queue: Queue) -> None:
    job = add(queue.database)
    queue.start()
    order = queue.begun()
    assert (order.attempt, queue.state(job.id)) == (1, "running")
    queue.engine.tell(order.key, "finished", order.runs[0].id, verdicts=[{"rule": "deck"}])
    queue.engine.end(order.key, Event.FINISH)
    until(lambda: queue.state(job.id), lambda state: state == "done")
    assert queue.database.runs(job.id)[0].verdicts == [{"rule": "deck"}]


@pytest.mark.slow
def test_only_deaths_with_no_checkpoint_between_end_a_run(queue: Queue) -> None:
    job = add(queue.database)
    queue.start()
    ends = [Event.DIE, Event.LOSE, Event.DIE, "checkpoint", Event.DIE, Event.STOP, Event.DIE]
    for attempt, event in enumerate(ends, start=1):
        order = until(
            queue.order,
            lambda found, attempt=attempt: found is not None and found.attempt == attempt,
        )
        if event == "checkpoint":
            queue.engine.tell(order.key, "checkpoint", order.runs[0].id, step=7)
        queue.engine.end(order.key, Event.DIE if event == "checkpoint" else event, "it died")
    until(lambda: queue.state(job.id), lambda state: state == "failed")
    error = queue.database.runs(job.id)[0].error
    assert error is not None
    assert "3 times in a row with no new checkpoint" in error


def test_what_cannot_be_deleted_holds_up_nobody_else(
    queue: Queue, monkeypatch: pytest.MonkeyPatch
) -> None:
    stuck = add(queue.database)
    queue.database.request_cancel(stuck.id)
    remove = type(queue.store).remove

    def refuse(place: Place, name: str | None = None) -> None:
        if "runs" in place.url:
            raise StoreError("the folder belongs to someone else")
        remove(place, name)  # type: ignore[arg-type]

    monkeypatch.setattr(type(queue.store), "remove", refuse)
    queue.start()
    until(lambda: queue.state(stuck.id), lambda state: state == "cancelled")
    queue.database.request_delete(stuck.id)
    other = add(queue.database)
    order = queue.begun()
    queue.engine.tell(order.key, "finished", order.runs[0].id, verdicts=[])
    queue.engine.end(order.key, Event.FINISH)
    until(lambda: queue.state(other.id), lambda state: state == "done")
    assert queue.database.requests().delete_jobs == (stuck.id,)


def test_a_job_of_many_runs_is_deleted_bit_by_bit(
    queue: Queue, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("server.jobs.requests._REMOVED_AT_ONCE", 2)
    job = add(queue.database, runs=5)
    runs = [run.id for run in queue.database.runs(job.id)]
    for run in runs:
        queue.store.child("runs", run, "001").write("plan.json", b"{}")
    queue.database.request_cancel(job.id)
    queue.start()
    until(lambda: queue.state(job.id), lambda state: state == "cancelled")
    queue.database.request_delete(job.id)
    until(lambda: queue.database.known_jobs(), lambda jobs: not jobs)
    assert queue.store.child("runs").names() == []


def test_an_order_that_cannot_begin_goes_back_into_the_queue(queue: Queue) -> None:
    job = add(queue.database)
    queue.engine.refuses = OSError("too many open files")
    queue.start()
    order = queue.begun()
    # The machine's trouble is not the run's: it counts for nothing.
    assert order.attempt == 2
    assert queue.database.running_batches()[0].deaths == 0
    assert queue.state(job.id) == "running"


def test_a_store_that_does_not_answer_holds_up_no_end(
    queue: Queue, monkeypatch: pytest.MonkeyPatch
) -> None:
    add(queue.database)
    queue.start()
    order = queue.begun()

    def refuse(place: Place, name: str) -> bool:
        raise StoreError("the store does not answer")

    monkeypatch.setattr(type(queue.store), "exists", refuse)
    queue.engine.end(order.key, Event.LOSE)
    until(
        lambda: [item.attempt for item in list(queue.engine.orders.values())],
        lambda attempts: attempts == [2],
    )


def test_a_cancel_survives_a_write_that_failed(
    queue: Queue, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = add(queue.database)
    queue.start()
    order = queue.begun()
    write, failures = queue.database.change_batch, [1, 1]

    def fail_first(*arguments: Any, **options: Any) -> bool:
        if failures:
            failures.pop()
            raise OperationalError("UPDATE", {}, Exception("database is locked"))
        return write(*arguments, **options)

    monkeypatch.setattr(queue.database, "change_batch", fail_first)
    queue.database.request_cancel(job.id)
    until(lambda: queue.state(job.id), lambda state: state == "cancelled")
    # It is written first, then the engine is told.
    assert until(lambda: queue.engine.cancelled, bool) == [(order.key, ())]


def test_a_run_that_was_cancelled_before_its_coordinator_died_ends_quietly(
    queue: Queue,
) -> None:
    job, other = add(queue.database), add(queue.database)
    (batch, _) = queue.database.queued_batches(2)
    started = queue.database.start_batch(batch)
    assert started is not None
    run = started.runs[0].id
    queue.coordinator._ledger._change(started, {}, {run: {"state": "cancelled"}})  # pyright: ignore[reportPrivateUsage]
    queue.engine.remembers = {f"{started.id}-1"}
    queue.start()
    # The engine, which never heard of it, is told; what it tells then changes nothing.
    until(lambda: queue.engine.cancelled, lambda asked: asked == [(f"{started.id}-1", ())])
    queue.engine.tell(f"{started.id}-1", "finished", run, verdicts=[])
    queue.engine.end(f"{started.id}-1", Event.FINISH)
    until(lambda: queue.database.batch(started.id).state, lambda state: state == "done")
    assert queue.state(job.id) == "cancelled"
    assert queue.state(other.id) == "running"


def test_what_waits_is_cancelled_while_the_engine_is_away(queue: Queue) -> None:
    job = add(queue.database)
    queue.engine.refuses = EngineError("the scheduler does not answer")
    queue.start()
    until(lambda: queue.coordinator.trouble, lambda text: "does not answer" in text)
    queue.database.request_cancel(job.id)
    until(lambda: queue.state(job.id), lambda state: state == "cancelled")
    assert queue.engine.starts > 1


def test_reports_do_not_pile_up_while_the_database_is_away(
    queue: Queue, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("server.jobs.coordinator._MOST_PROGRESS", 10)
    job = add(queue.database)
    queue.start()
    order = queue.begun()
    run = order.runs[0].id
    away = threading.Event()
    away.set()
    for name in ("record", "requests", "running_batches", "queued_batches"):
        method = getattr(queue.database, name)

        def answer(*arguments: Any, method: Any = method, **options: Any) -> Any:
            if away.is_set():
                raise OperationalError("SELECT", {}, Exception("server closed the connection"))
            return method(*arguments, **options)

        monkeypatch.setattr(queue.database, name, answer)
    for step in range(50):
        progress = {"step": step, "stage": "computing", "fraction": 0.0}
        queue.engine.tell(order.key, "progress", run, **progress)
    queue.engine.tell(order.key, "log", run, text="the last word")
    until(lambda: queue.engine.told, lambda told: not told)
    until(
        lambda: len(queue.coordinator._events),  # pyright: ignore[reportPrivateUsage]
        lambda count: 0 < count < 20,
    )
    away.clear()
    until(
        lambda: [event.data.get("text") for event in queue.database.log_of(job.id)],
        lambda texts: "the last word" in texts,
    )
    told = [e for e in queue.database.events_after(0) if e.kind == "progress"]
    assert [event.data["step"] for event in told][-1] == 49
    assert len(told) <= 10


def test_trouble_of_the_supervisor_is_not_the_runs_failure(
    queue: Queue, monkeypatch: pytest.MonkeyPatch
) -> None:
    add(queue.database)
    queue.start()
    order = queue.begun()

    def refuse(_: Order) -> None:
        raise OSError("cannot allocate memory")

    monkeypatch.setattr(supervision, "BatchProcess", refuse)
    posted: list[Report] = []
    supervision.supervise(order, posted.append, supervision.Control())
    assert [report.kind for report in posted] == ["ended"]
    assert posted[0].data["event"] == Event.DIE
