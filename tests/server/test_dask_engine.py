"""The Dask engine: six cases each on its own cluster and on an external tls:// scheduler.

The tests of one cluster share it: each leaves as many workers as it found.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import psutil
import pytest

from server.jobs import dask_engine
from server.jobs.dask_engine import DaskEngine
from server.jobs.dask_nodes import run_worker
from server.settings import Settings
from tests.server import dask_batches
from tests.server.dask_case import (
    Node,
    coordinate,
    ended,
    engine_of,
    events,
    external_scheduler,
    gone,
    hear,
    order_for,
    process_of,
    settings_for,
    told,
    until,
    worker_of,
)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.usefixtures("swept", "swept_module"),
    pytest.mark.filterwarnings("ignore:unclosed <socket:ResourceWarning"),
]


@dataclass
class Cluster:
    """A cluster of two slots, and an engine that uses it."""

    settings: Settings
    engine: DaskEngine
    nodes: list[Node]

    @property
    def external(self) -> bool:
        """Whether it outlives its coordinator."""
        return bool(self.nodes)

    def mend(self) -> None:
        """Waits for the two slots, a worker that was killed replaced."""
        if self.external:
            scheduler = self.nodes[0].address
            running = [node for node in self.nodes[1:] if node.process.poll() is None]
            for node in set(self.nodes[1:]) - set(running):
                node.end()
            while len(running) < 2:
                running.append(Node(run_worker, self.settings, scheduler=scheduler, slots=1))
            self.nodes[1:] = running
        until(lambda: self.engine.free_slots() == 2)


@pytest.fixture(scope="module", params=["dask", "tls"])
def cluster(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Cluster]:
    folder = tmp_path_factory.mktemp(request.param)
    if request.param == "tls":
        with external_scheduler(folder) as (settings, nodes):
            engine = engine_of(settings)
            engine.start()
            yield Cluster(settings, engine, nodes)
            engine.stop()
        return
    settings = settings_for(folder, "dask")
    engine = engine_of(settings)
    engine.start()
    yield Cluster(settings, engine, [])
    engine.stop()


# A cluster of its own ends with its coordinator: these cases need one that stays.
_EXTERNAL = pytest.mark.parametrize("cluster", ["tls"], indirect=True)


def test_submit(cluster: Cluster, tmp_path: Path) -> None:
    engine = cluster.engine
    cluster.mend()
    orders = [order_for(tmp_path, dask_batches.finish, f"submit{n}") for n in range(2)]
    for order in orders:
        engine.run(order)
    assert engine.free_slots() == 0
    heard = hear(engine, ended(2))
    assert events(heard) == {order.key: "finish" for order in orders}, heard
    for order in orders:
        kinds = [report.kind for report in heard if report.key == order.key]
        assert kinds == ["started", "progress", "finished", "progress", "finished", "ended"]
    finished = [(report.run, report.data) for report in heard if report.kind == "finished"]
    assert ("submit0b", {"verdicts": [1]}) in finished
    assert engine.free_slots() == 2


def test_no_order_waits_inside(cluster: Cluster, tmp_path: Path) -> None:
    """An order beyond the slots comes back to be queued in SQL."""
    engine = cluster.engine
    cluster.mend()
    for number in range(3):
        engine.run(order_for(tmp_path, dask_batches.finish_first_then_wait, f"full{number}"))
    assert events(hear(engine, ended(1))) == {"full2-1": "lose"}
    (tmp_path / "go").touch()
    assert events(hear(engine, ended(2))) == {"full0-1": "finish", "full1-1": "finish"}


def test_cancel(cluster: Cluster, tmp_path: Path) -> None:
    """One run leaves its batch, the other goes on; then a whole attempt ends early."""
    engine = cluster.engine
    cluster.mend()
    one = order_for(tmp_path, dask_batches.wait_for_cancel, "cancel")
    whole = order_for(tmp_path, dask_batches.resume, "whole")
    engine.run(one)
    engine.run(whole)
    engine.cancel(one.key, ["cancela"])
    heard = hear(engine, lambda heard: ended(1)(heard) and told("checkpoint")(heard))
    assert [(r.kind, r.run) for r in heard if r.run] == [
        ("cancelled", "cancela"),
        ("finished", "cancelb"),
    ]
    engine.cancel(whole.key)
    # That it comes at once is a row of the benchmarks; here, that it does not wait for the order,
    # which takes ten minutes.
    assert events(hear(engine, ended(1))) == {whole.key: "cancel"}
    engine.cancel("unknown-1")


def test_cancel_at_once(cluster: Cluster, tmp_path: Path) -> None:
    """A cancellation that overtakes its order is not lost."""
    engine = cluster.engine
    cluster.mend()
    engine.run(order_for(tmp_path, dask_batches.wait_for_cancel, "early"))
    engine.cancel("early-1")
    assert events(hear(engine, ended(1))) == {"early-1": "cancel"}


def test_kill_worker(cluster: Cluster, tmp_path: Path) -> None:
    """What its worker computed is lost at once, its process ends too, the other order goes on."""
    engine = cluster.engine
    cluster.mend()
    engine.run(order_for(tmp_path, dask_batches.resume, "lost"))
    process = process_of(hear(engine, told("checkpoint")))
    engine.run(order_for(tmp_path, dask_batches.finish_first_then_wait, "kept"))
    hear(engine, told("finished"))
    worker_of(process).kill()
    # Before the scheduler itself would give a silent worker up, which takes it five minutes.
    assert events(hear(engine, ended(1))) == {"lost-1": "lose"}
    until(lambda: gone(process))
    (tmp_path / "go").touch()
    assert events(hear(engine, ended(1))) == {"kept-1": "finish"}


def test_resume(cluster: Cluster, tmp_path: Path) -> None:
    """After a loss another attempt of the same batch computes, from what the first one left."""
    engine = cluster.engine
    cluster.mend()
    first = order_for(tmp_path, dask_batches.resume)
    engine.run(first)
    process = process_of(hear(engine, told("checkpoint")))
    worker_of(process).kill()
    assert events(hear(engine, ended(1))) == {first.key: "lose"}
    second = replace(first, attempt=2)
    until(lambda: engine.free_slots() > 0)
    engine.run(second)
    assert events(hear(engine, ended(1))) == {second.key: "finish"}


def test_gather(cluster: Cluster, tmp_path: Path) -> None:
    engine = cluster.engine
    cluster.mend()
    order = order_for(tmp_path, dask_batches.gather, "gather", purpose="gather")
    engine.run(order)
    assert events(hear(engine, ended(1))) == {order.key: "finish"}
    assert (tmp_path / "summary").read_text() == "gathera gatherb"


def test_restart(cluster: Cluster, tmp_path: Path) -> None:
    """After kill -9 of the coordinator an external cluster goes on, and its own one ends."""
    going = order_for(tmp_path, dask_batches.finish_first_then_wait, "going")
    never = order_for(tmp_path, dask_batches.finish, "never")
    cluster.mend()
    mine = replace(cluster.settings, data=tmp_path / "data")
    coordinator = Node(coordinate, mine, orders=[going])
    try:
        process = int(coordinator.ready())
        worker = worker_of(process).pid
    finally:
        coordinator.end()
    if not cluster.external:
        until(lambda: gone(process) and gone(worker))
        assert cluster.engine.reattach([going, never]) == set()
        return
    engine = engine_of(mine)
    engine.start()
    assert engine.reattach([going, never]) == {going.key}
    (tmp_path / "go").touch()
    heard = hear(engine, ended(1))
    assert [(r.kind, r.run) for r in heard] == [
        ("started", ""),
        ("finished", "goinga"),
        ("finished", "goingb"),
        ("ended", ""),
    ]
    engine.stop()


@_EXTERNAL
def test_what_ended_meanwhile_is_reported(cluster: Cluster, tmp_path: Path) -> None:
    """A coordinator that detaches, or is killed before it stored an end, hears it again."""
    cluster.mend()
    mine = replace(cluster.settings, data=tmp_path / "data")
    order = order_for(tmp_path, dask_batches.finish_first_then_wait, "meanwhile")
    first = engine_of(mine)
    first.start()
    first.run(order)
    hear(first, told("finished"))
    first.stop()
    (tmp_path / "go").touch()
    second, third = engine_of(mine), engine_of(mine)
    for engine in (second, third):
        # The third hears it although the second has: that one never came back to say so.
        engine.start()
        assert engine.reattach([order]) == {order.key}
        kinds = [report.kind for report in hear(engine, ended(1))]
        assert kinds == ["started", "finished", "finished", "ended"]
    third.reports(0.0)
    assert third.reattach([order]) == set()
    third.stop()
    second.stop()


@_EXTERNAL
def test_task_that_nobody_asks_for_ends(cluster: Cluster, tmp_path: Path) -> None:
    """What a coordinator does not find in its database does not compute for ever."""
    cluster.mend()
    mine = replace(cluster.settings, data=tmp_path / "data")
    first = engine_of(mine)
    first.start()
    first.run(order_for(tmp_path, dask_batches.resume, "orphan"))
    process = process_of(hear(first, told("started")))
    first.stop()
    second = engine_of(mine)
    second.start()
    assert second.reattach([]) == set()
    second.reports(0.0)
    until(lambda: gone(process))
    second.stop()


def test_what_cannot_travel_fails_in_words(
    cluster: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    engine = cluster.engine
    cluster.mend()
    finish = dask_batches.finish
    engine.run(order_for(tmp_path, lambda *_: None, "lambda"))
    engine.run(order_for(tmp_path, finish, "unreadable", study={"x": dask_batches.Unreadable()}))
    heard = hear(engine, ended(2))
    monkeypatch.setattr(dask_engine, "installed_version", lambda: "0.0.7")
    engine.run(order_for(tmp_path, finish, "older"))
    heard += hear(engine, ended(1))
    assert set(events(heard).values()) == {"fail"}
    errors = {item.key: item.data["error"] for item in heard if item.kind == "ended"}
    assert "cannot be sent" in errors["lambda-1"]
    assert "not a number" in errors["unreadable-1"]
    assert "its coordinator 0.0.7" in errors["older-1"]


def test_batch_that_dies(cluster: Cluster, tmp_path: Path) -> None:
    """The death of the batch's own process is told apart from that of its worker."""
    engine = cluster.engine
    cluster.mend()
    engine.run(order_for(tmp_path, dask_batches.resume, "dying"))
    process = process_of(hear(engine, told("checkpoint")))
    psutil.Process(process).send_signal(signal.SIGKILL)
    assert events(hear(engine, ended(1))) == {"dying-1": "die"}
