"""What the home page says of the machine: its size, its engine, its queue."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import psutil
import pytest

from server.routes.machine import read_machine, usable_cores
from server.version import package_version
from tests.server import odd_batches
from tests.server.server_case import (
    Client,
    ended,
    serving,
    settings_for,
    short_study,
    submit,
    until,
)


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """One run at a time, which never ends by itself."""
    settings = settings_for(tmp_path_factory.mktemp("server"))
    with serving(settings, compute=odd_batches.hang) as client:
        yield client


def test_the_machine_is_told_as_it_is(client: Client) -> None:
    machine: dict[str, Any] = client.json("machine")
    assert machine["cores"] == usable_cores() >= 1
    assert machine["memory_bytes"] == psutil.virtual_memory().total
    assert 0 < machine["memory_available_bytes"] <= machine["memory_bytes"]
    folder: Path = client.app.state.service.store.local
    # Others write to the same disk meanwhile.
    assert machine["disk_free_bytes"] == pytest.approx(shutil.disk_usage(folder).free, rel=0.1)
    assert (machine["engine"], machine["workers"]) == ("local", 1)
    assert machine["version"] == package_version()
    assert machine["trouble"] == ""


def test_jobs_that_compute_and_wait_are_counted(client: Client) -> None:
    jobs = [submit(client, short_study())["id"] for _ in range(3)]

    def counted() -> tuple[int, int]:
        machine = client.json("machine")
        return machine["running"], machine["queued"]

    until(counted, lambda seen: seen == (1, 2))
    for job in jobs:
        client.post(f"/api/v1/jobs/{job}/cancel")
    for job in jobs:
        ended(client, job)
    assert counted() == (0, 0)


@pytest.mark.parametrize(
    ("changes", "engine", "workers"),
    [
        ({"engine": "slurm", "slurm_jobs": 3, "slurm_cores": 8}, "slurm", 24),
        ({"engine": "tls://scheduler.example.org:8786"}, "tls", None),
        ({"engine": "dask", "concurrent_batches": 5}, "dask", 5),
    ],
)
def test_other_engines_are_named_without_their_address(
    client: Client, changes: dict[str, Any], engine: str, workers: int | None
) -> None:
    service = client.app.state.service
    machine = read_machine(replace(service, settings=replace(service.settings, **changes)))
    assert (machine.engine, machine.workers) == (engine, workers)


def test_a_queue_in_trouble_says_so(client: Client) -> None:
    service = client.app.state.service
    troubled = replace(service, queue_trouble=lambda: "The scheduler does not answer.")
    assert read_machine(troubled).trouble == "The scheduler does not answer."
    assert "Restart" in read_machine(replace(service, queue_alive=lambda: False)).trouble
