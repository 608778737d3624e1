"""Schedulers and workers as processes: how they end, what they refuse, what they outlive."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from server.jobs import dask_slots
from server.jobs.dask_nodes import run_scheduler, run_worker
from server.jobs.engine import EngineError
from tests.server import dask_batches
from tests.server.dask_case import (
    ROOT,
    Node,
    certificates,
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
)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.usefixtures("swept", "swept_module"),
    pytest.mark.filterwarnings("ignore:unclosed <socket:ResourceWarning"),
]


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return listener.getsockname()[1]


def test_own_cluster_stops(tmp_path: Path) -> None:
    """Its batches are asked to store checkpoints, and are told as stopped, not as lost."""
    engine = engine_of(settings_for(tmp_path, "dask"))
    engine.start()
    engine.run(order_for(tmp_path, dask_batches.resume))
    process = process_of(hear(engine, told("checkpoint")))
    engine.stop()
    assert gone(process)
    assert events(engine.reports(0.0)) == {"batch-1": "stop"}


def test_worker_that_is_asked_to_end(tmp_path: Path) -> None:
    with external_scheduler(tmp_path, workers=1) as (settings, nodes):
        engine = engine_of(settings)
        engine.start()
        engine.run(order_for(tmp_path, dask_batches.resume))
        process = process_of(hear(engine, told("checkpoint")))
        nodes[1].process.send_signal(signal.SIGTERM)
        assert events(hear(engine, ended(1))) == {"batch-1": "stop"}
        errors = nodes[1].wait()
        assert (nodes[1].process.returncode, errors) == (0, "")
        assert gone(process)
        until(lambda: engine.free_slots() == 0)
        engine.stop()


def test_scheduler_that_is_killed(tmp_path: Path) -> None:
    """Every call says so at once; batches stop; workers wait for it to come back."""
    with external_scheduler(tmp_path, workers=1) as (settings, nodes):
        engine = engine_of(settings)
        engine.start()
        order = order_for(tmp_path, dask_batches.resume)
        engine.run(order)
        process = process_of(hear(engine, told("checkpoint")))
        nodes[0].end()
        # Not by an answer that stays away: the connection is known to be lost.
        with pytest.raises(EngineError, match="went away"):
            hear(engine, ended(1))
        for call in (engine.free_slots, lambda: engine.run(order), lambda: engine.reattach([])):
            with pytest.raises(EngineError):
                call()
        until(lambda: gone(process))
        port = int(settings.engine.rpartition(":")[2])
        nodes[0] = Node(run_scheduler, settings, host="127.0.0.1", port=port)
        nodes[0].ready()
        nodes[1].ready()
        engine.start()
        assert engine.reattach([order]) == set()
        engine.run(order_for(tmp_path, dask_batches.resume, attempt=2))
        assert events(hear(engine, ended(1))) == {"batch-2": "finish"}
        engine.stop()
        nodes[0].process.send_signal(signal.SIGTERM)
        assert nodes[0].wait() == ""
        assert nodes[0].process.returncode == 0


def test_scheduler_that_stays_away(tmp_path: Path) -> None:
    """Engine and worker give up in time, and say what to do."""
    url = f"tcp://127.0.0.1:{_free_port()}"
    settings = settings_for(tmp_path, url, engine_seconds=0.5)
    worker = Node(run_worker, settings, scheduler=url, slots=1)
    with pytest.raises(EngineError, match=r"does not answer .* after 0\.5 s.* Start it"):
        engine_of(settings).start()
    errors = worker.wait()
    assert worker.process.returncode == 1
    assert f"The scheduler {url} stays away" in errors
    assert "never" not in errors  # No coroutine that was never awaited, no task never retrieved.


def test_unsafe_and_incomplete_settings_are_refused(tmp_path: Path) -> None:
    def start(engine: str, **changes: object) -> None:
        engine_of(settings_for(tmp_path, engine, **changes)).start()

    with pytest.raises(EngineError, match=r"any code on every worker.*allow_insecure_scheduler"):
        start("tcp://192.0.2.1:8786")
    with pytest.raises(EngineError, match="needs the setting tls_ca_file"):
        start("tls://192.0.2.1:8786")
    files = certificates(tmp_path) | {"tls_key_file": tmp_path / "missing.pem"}
    with pytest.raises(EngineError, match=r"missing\.pem of the setting tls_key_file is not there"):
        start("tls://192.0.2.1:8786", **files)
    settings = settings_for(tmp_path, "local")
    with pytest.raises(EngineError, match="allow_insecure_scheduler"):
        run_scheduler(settings, host="0.0.0.0", port=0)
    with pytest.raises(EngineError, match="allow_insecure_scheduler"):
        run_worker(settings, scheduler="tcp://192.0.2.1:8786", slots=1)


def test_certificates_of_others_are_refused(tmp_path: Path) -> None:
    """Another authority's certificate opens nothing, and neither does no certificate."""
    files = certificates(tmp_path)
    scheduler = Node(
        run_scheduler, settings_for(tmp_path, "local", **files), host="127.0.0.1", port=0
    )
    try:
        address = scheduler.ready()
        (tmp_path / "other").mkdir()
        other = certificates(tmp_path / "other")
        for settings in (
            settings_for(tmp_path, address, engine_seconds=1.0, **other),
            settings_for(tmp_path, address.replace("tls", "tcp"), engine_seconds=1.0),
        ):
            with pytest.raises(EngineError, match="does not answer"):
                engine_of(settings).start()
    finally:
        scheduler.end()


def test_workers_of_another_version_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dask_slots, "installed_version", lambda: "9.9.9")
    with external_scheduler(tmp_path, workers=1) as (settings, _):
        engine = engine_of(settings)
        with pytest.raises(EngineError, match=r"this machine 9\.9\.9\. Install the same version"):
            engine.start()
        engine.stop()


def test_worker_that_is_frozen_keeps_nobody_waiting(tmp_path: Path) -> None:
    with external_scheduler(tmp_path, workers=2) as (settings, nodes):
        nodes[1].process.send_signal(signal.SIGSTOP)
        # The one that is awake has a third of this for its answer.
        engine = engine_of(replace(settings, engine_seconds=15.0))
        engine.start()
        assert engine.free_slots() == 1
        engine.run(order_for(tmp_path, dask_batches.finish))
        assert events(hear(engine, ended(1))) == {"batch-1": "finish"}
        engine.stop()


def test_worker_that_may_not_start_processes_is_refused(tmp_path: Path) -> None:
    """A plain ``dask worker``; the engine goes on with the others."""
    with external_scheduler(tmp_path, workers=0) as (settings, _):
        command = [sys.executable, "-m", "distributed.cli.dask_worker", settings.engine]
        for name in ("ca-file", "cert", "key"):
            command += [f"--tls-{name}", str(tmp_path / f"{name.removesuffix('-file')}.pem")]
        command += ["--nthreads=1", "--nworkers=1", "--no-dashboard", "--host=127.0.0.1"]
        plain = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE)
        engine = engine_of(settings)
        try:
            engine.start()
            assert engine.free_slots() == 0
            with pytest.raises(EngineError, match="may not start processes"):
                until(engine.start)
        finally:
            engine.stop()
            plain.terminate()
            plain.communicate(timeout=180)


def test_the_server_is_imported_without_dask() -> None:
    """Dask takes 60 MB and a quarter of a second, which only its engine may cost."""
    code = "import sys, server.app, server.cli; sys.exit('distributed' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False).returncode == 0
