"""From POST to done, through the queue, a process, the store and back."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

from server.settings import Limits
from tests.server import odd_batches
from tests.server.server_case import (
    Client,
    beam_study,
    ended,
    serving,
    settings_for,
    short_study,
    submit,
    until,
)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Client, dict[str, Any]]]:
    """A server with one finished run of the sprung mass."""
    with serving(settings_for(tmp_path_factory.mktemp("server")), makes_tables=True) as client:
        job = ended(client, submit(client, beam_study())["id"])
        assert job["state"] == "done", job
        yield client, job


@pytest.mark.slow
def test_a_run_reaches_its_result(finished: tuple[Client, dict[str, Any]]) -> None:
    client, job = finished
    assert job["progress"]["fraction"] == 1.0
    assert job["progress"]["step"] == job["progress"]["steps"] == 3600
    assert job["created"] <= job["started"] <= job["ended"]
    [item] = job["runs"]
    run = client.get(f"/api/v1/runs/{item['id']}").json()
    assert run["state"] == "done"
    assert run["attempt"] == 1
    assert run["job"] == job["id"]
    assert run["summary"]["timings"]["total"] > 0
    assert run["summary"]["versions"]["numpy"]
    assert run["summary"]["unjudged"].startswith("Not judged")


def test_its_histories_come_as_csv(finished: tuple[Client, dict[str, Any]]) -> None:
    client, job = finished
    run = f"/api/v1/runs/{job['runs'][0]['id']}"
    channels = client.get(f"{run}/channels").json()
    assert channels["committed"] == channels["samples"] == 3601
    names = [channel["name"] for channel in channels["items"]]
    assert "mid-span 1/displacement" in names
    answer = client.get(
        f"{run}/channels/mid-span 1%2Fdisplacement.csv",
        params={"from": 0.1, "to": 0.2, "channels": ["wheel 01/contact force"]},
    )
    assert answer.headers["content-type"].startswith("text/csv")
    assert answer.headers["content-disposition"].startswith("attachment")
    header, *rows = answer.text.splitlines()
    assert header == "time [s],mid-span 1/displacement [m],wheel 01/contact force [N]"
    table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    assert len(table) == 401
    np.testing.assert_allclose(table[[0, -1], 0], [0.1, 0.2], rtol=1e-12)
    assert table[:, 1].min() < 0 < table[:, 2].min()
    few = client.get(f"{run}/channels/mid-span 1/displacement.csv", params={"points": 100})
    assert 50 <= len(few.text.splitlines()) <= 101


def test_its_shapes_come_as_bytes(finished: tuple[Client, dict[str, Any]]) -> None:
    client, job = finished
    run = f"/api/v1/runs/{job['runs'][0]['id']}"
    frames = client.get(f"{run}/frames").json()
    assert len(frames["items"]) == frames["frames"]
    assert frames["items"][3]["time"] == pytest.approx(0.015)
    raw = client.get(f"{run}/frames", params={"index": 90})
    values = np.frombuffer(raw.content, "<f4")
    assert values.size == 3 * (frames["vertices"] + frames["bodies"])
    plain = client.get(f"{run}/frames", params={"index": 90, "format": "json"}).json()
    np.testing.assert_allclose(np.ravel(plain["displacement"]), values[: 3 * frames["vertices"]])
    assert len(plain["velocity"]) == len(plain["acceleration"]) == frames["vertices"]
    assert client.get(f"{run}/frames", params={"index": 10**6}).status_code == 404


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file_format", "kind", "begins"),
    [
        ("json", "application/json", b"{"),
        ("png", "image/png", b"\x89PNG"),
        ("svg", "image/svg+xml", b"<?xml"),
        ("pdf", "application/pdf", b"%PDF"),
    ],
)
def test_figures_come_in_every_format(
    finished: tuple[Client, dict[str, Any]], file_format: str, kind: str, begins: bytes
) -> None:
    client, job = finished
    run = f"/api/v1/runs/{job['runs'][0]['id']}"
    answer = client.get(f"{run}/plots/displacement.{file_format}", params={"points": 200})
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == kind
    assert answer.content.startswith(begins)


@pytest.mark.slow
def test_drawing_has_a_short_queue(tmp_path: Path) -> None:
    limits = Limits(pending_figures=0)
    with serving(settings_for(tmp_path, limits=limits)) as client:
        job = ended(client, submit(client, short_study())["id"])
        answer = client.get(f"/api/v1/runs/{job['runs'][0]['id']}/plots/displacement.png")
    assert answer.status_code == 503
    assert int(answer.headers["retry-after"]) > 0
    assert answer.headers["content-type"] == "application/problem+json"


@pytest.mark.slow
def test_modes_are_a_kind_of_job(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        job = ended(client, submit(client, short_study(), kind="modes")["id"])
        assert job["state"] == "done", job
        assert job["kind"] == "modes"
        assert job["progress"]["fraction"] == 1.0
        run = client.get(f"/api/v1/runs/{job['runs'][0]['id']}").json()
        assert run["summary"]["modes"][0]["frequency"] > 0
        # One shape a mode, and no histories beside them: the beam has no wheels on it.
        shapes = client.json(f"runs/{run['id']}/frames")
        assert shapes["frames"] == len(shapes["items"]) == len(run["summary"]["modes"])
        assert client.json(f"runs/{run['id']}/channels")["items"] == []


@pytest.mark.slow
def test_a_sweep_is_one_job_of_many_runs(tmp_path: Path) -> None:
    study = short_study(sweep={"speeds": [20.0, 25.0, 30.0]})
    with serving(settings_for(tmp_path, concurrent_batches=2)) as client:
        job = ended(client, submit(client, study)["id"])
        assert job["state"] == "done"
        assert [run["parameters"]["speed"] for run in job["runs"]] == [20.0, 25.0, 30.0]
        assert job["progress"]["step"] == job["progress"]["steps"]


def test_a_jobs_verdict_is_the_worst_of_its_runs(tmp_path: Path) -> None:
    study = short_study(sweep={"speeds": [20.0, 25.0, 30.0]})
    with serving(settings_for(tmp_path), compute=odd_batches.finish) as client:
        job = ended(client, submit(client, study)["id"])
        verdicts = client.get(f"/api/v1/jobs/{job['id']}/verdicts").json()
        one = client.get(f"/api/v1/runs/{job['runs'][0]['id']}/verdicts").json()
    assert verdicts["judged"] == verdicts["runs"] == 3
    assert [item["value"] for item in verdicts["items"]] == [102.0 / 50.0]
    assert verdicts["items"][0]["run"] == job["runs"][2]["id"]
    assert one["items"][0]["value"] == 2.0


@pytest.mark.parametrize(
    ("compute", "state", "words"),
    [
        (odd_batches.die, "failed", "SIGSEGV"),
        (odd_batches.fail, "failed", "wheel 07 right"),
        (odd_batches.break_down, "failed", "unexpected error"),
    ],
)
def test_a_run_that_fails_says_why_and_the_server_goes_on(
    tmp_path: Path, compute: Any, state: str, words: str
) -> None:
    with serving(settings_for(tmp_path), compute=compute) as client:
        job = ended(client, submit(client, short_study())["id"])
        assert job["state"] == state
        assert words in job["error"]["detail"]
        assert client.get("/api/v1/health").status_code == 200
        assert ended(client, submit(client, short_study())["id"])["state"] == state


@pytest.mark.slow
def test_time_and_memory_have_limits(tmp_path: Path) -> None:
    limits = Limits(batch_seconds=0.3)
    with serving(settings_for(tmp_path / "a", limits=limits), compute=odd_batches.hang) as client:
        job = ended(client, submit(client, short_study())["id"])
        assert job["state"] == "timed_out"
        assert "0.3 s" in job["error"]["detail"]
    limits = Limits(batch_bytes=250_000_000)
    with serving(settings_for(tmp_path / "b", limits=limits), compute=odd_batches.eat) as client:
        job = ended(client, submit(client, short_study())["id"])
        assert job["state"] == "out_of_memory"
        assert "250 MB" in job["error"]["detail"]


@pytest.mark.parametrize("compute", [odd_batches.hang, odd_batches.hang_stubbornly])
def test_cancelling_ends_the_process(tmp_path: Path, compute: Any) -> None:
    with serving(settings_for(tmp_path), compute=compute) as client:
        computing, waiting = (submit(client, short_study())["id"] for _ in range(2))
        until(
            lambda: client.get(f"/api/v1/jobs/{computing}").json(),
            lambda job: job["progress"] is not None and job["progress"]["step"] == 1,
        )
        assert client.get(f"/api/v1/jobs/{waiting}").json()["position"] == 0
        processes = client.app.state.coordinator.process_ids
        assert client.post(f"/api/v1/jobs/{waiting}/cancel").status_code == 202
        assert client.post(f"/api/v1/jobs/{computing}/cancel").status_code == 202
        assert ended(client, waiting)["state"] == "cancelled"
        assert ended(client, computing)["state"] == "cancelled"
        # Recorded at once; the process has its grace time to follow.
        until(lambda: any(psutil.pid_exists(pid) for pid in processes), lambda alive: not alive)
        # Cancelling what has ended changes nothing.
        assert client.post(f"/api/v1/jobs/{computing}/cancel").json()["state"] == "cancelled"


@pytest.mark.slow
def test_a_stopped_server_leaves_its_run_in_the_queue(tmp_path: Path) -> None:
    settings = settings_for(tmp_path)
    with serving(settings, compute=odd_batches.hang) as client:
        job = submit(client, short_study())["id"]
        until(lambda: client.get(f"/api/v1/jobs/{job}").json(), lambda j: j["state"] == "running")
        processes = client.app.state.coordinator.process_ids
    assert not any(psutil.pid_exists(pid) for pid in processes)
    with serving(settings) as client:
        found = ended(client, job)
        assert found["state"] == "done"
        assert client.get(f"/api/v1/runs/{found['runs'][0]['id']}").json()["attempt"] == 2
        folder = settings.data / "runs" / found["runs"][0]["id"]
        assert [path.name for path in folder.iterdir()] == ["002"]


def test_two_jobs_compute_side_by_side(tmp_path: Path) -> None:
    settings = settings_for(tmp_path, concurrent_batches=2)
    with serving(settings, compute=odd_batches.hang) as client:
        for _ in range(3):
            submit(client, short_study())
        states = until(
            lambda: [job["state"] for job in client.get("/api/v1/jobs").json()["items"]],
            lambda states: states.count("running") == 2,
        )
        assert states == ["queued", "running", "running"]


def test_the_list_is_paged(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path), compute=odd_batches.hang) as client:
        made = [submit(client, short_study(name=f"job {i}"))["id"] for i in range(5)]
        first = client.get("/api/v1/jobs", params={"limit": 2}).json()
        # A job that comes meanwhile does not shift the pages.
        submit(client, short_study())
        second = client.get("/api/v1/jobs", params={"limit": 2, "cursor": first["next"]}).json()
        third = client.get("/api/v1/jobs", params={"limit": 2, "cursor": second["next"]}).json()
        seen = [job["id"] for page in (first, second, third) for job in page["items"]]
        assert seen == made[::-1]
        assert third["next"] is None
        waiting = client.get("/api/v1/jobs", params={"state": "queued"}).json()["items"]
        assert {job["state"] for job in waiting} == {"queued"}
        assert client.get("/api/v1/jobs", params={"cursor": "x"}).status_code == 422


def test_the_queue_has_an_end(tmp_path: Path) -> None:
    limits = Limits(queued_jobs=2)
    with serving(settings_for(tmp_path, limits=limits), compute=odd_batches.hang) as client:
        answers = [client.post("/api/v1/jobs", json={"study": short_study()}) for _ in range(5)]
        refused = answers[-1]
        assert refused.status_code == 503
        assert refused.headers["retry-after"]
        assert refused.headers["content-type"] == "application/problem+json"


def test_children_compute_on_one_thread(tmp_path: Path) -> None:
    before = {name: os.environ.get(name) for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS")}
    with serving(settings_for(tmp_path), compute=odd_batches.hang) as client:
        submit(client, short_study())
        coordinator = client.app.state.coordinator
        [pid] = until(lambda: coordinator.process_ids, bool)
        # A forked child's own environment is its forkserver's.
        environment = psutil.Process(pid).parent().environ()
        assert environment["MKL_NUM_THREADS"] == environment["OMP_NUM_THREADS"] == "1"
    assert {name: os.environ.get(name) for name in before} == before
