"""Event streams: what a tab hears, from where it left off, and that streams end."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

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


def events(client: Client, path: str, **headers: str) -> Iterator[tuple[int, str, Any]]:
    """(id, kind, data) as they come; comments as (0, "comment", text)."""
    with client.stream("GET", f"/api/v1/{path}", headers=headers) as answer:
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith("text/event-stream")
        number, kind = 0, ""
        for line in answer.iter_lines():
            name, _, value = line.partition(": ")
            if name == "id":
                number = int(value)
            elif name == "event":
                kind = value
            elif name == "data":
                yield number, kind, json.loads(value)
            elif line.startswith(":"):
                yield 0, "comment", value


def until_done(stream: Iterator[tuple[int, str, Any]]) -> list[tuple[int, str, Any]]:
    """All events up to the job's end."""
    heard: list[tuple[int, str, Any]] = []
    for item in stream:
        heard.append(item)
        if item[1] == "job" and item[2]["state"] == "done":
            return heard
    raise AssertionError(f"the stream ended after {len(heard)} events")


def test_a_run_is_heard_from_its_beginning_to_its_end(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        job = submit(client, beam_study())["id"]
        heard = until_done(events(client, f"jobs/{job}/events"))
        snapshot = client.json(f"jobs/{job}")
    numbers = [number for number, kind, _ in heard if kind != "comment"]
    assert numbers == sorted(numbers)
    jobs = [data for _, kind, data in heard if kind == "job"]
    assert jobs[0]["id"] == job
    assert jobs[-1] == snapshot
    progress = [data for _, kind, data in heard if kind == "progress"]
    fractions = [data["fraction"] for data in progress]
    assert fractions == sorted(fractions)
    assert len(set(fractions)) >= 10
    assert fractions[-1] == 1.0
    assert all(data["fraction"] * data["steps"] == pytest.approx(data["step"]) for data in progress)
    assert "computing" in {data["stage"] for data in progress}


def test_live_curves_grow_as_the_run_does(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        job = submit(client, beam_study())["id"]
        heard = until_done(events(client, f"jobs/{job}/events"))
    points = [data["points"] for _, kind, data in heard if kind == "progress" and "points" in data]
    times = [time for part in points for time in part["time"]]
    assert times == sorted(times)
    assert times[0] == 0.0
    assert times[-1] == pytest.approx(0.9, abs=2e-3)
    assert 500 <= len(times) <= 1500
    names = {name for part in points for name in part["channels"]}
    assert "mid-span 1/displacement" in names
    assert all(len(v) == len(p["time"]) for p in points for v in p["channels"].values())


def test_a_stream_that_reconnects_misses_nothing(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        job = submit(client, short_study())["id"]
        ended(client, job)
        # The job's end is told at once, then all that was, then the job again.
        told = events(client, f"jobs/{job}/events")
        next(told)
        progress = [number for number, kind, _ in until_done(told) if kind == "progress"]
        middle = progress[len(progress) // 2]
        headers = {"Last-Event-ID": str(middle)}
        rest = until_done_progress(client, f"events?job={job}", progress[-1], headers)
        assert rest == [number for number in progress if number > middle]


def until_done_progress(client: Client, path: str, last: int, headers: dict[str, str]) -> list[int]:
    """Numbers of the progress events up to ``last``."""
    heard: list[int] = []
    for number, kind, _ in events(client, path, **headers):
        if kind == "progress":
            heard.append(number)
            if number == last:
                break
    return heard


def test_one_stream_follows_many_jobs(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path), compute=odd_batches.finish) as client:
        made = [submit(client, short_study())["id"] for _ in range(3)]
        done: set[str] = set()
        query = "&".join(f"job={job}" for job in made[:2])
        for _, kind, data in events(client, f"events?{query}"):
            if kind == "job":
                assert data["id"] in made[:2]
                done |= {data["id"]} if data["state"] == "done" else set()
            if len(done) == 2:
                break
        # Without names: every job, the new ones too.
        heard: set[str] = set()
        late: list[str] = []
        for _, kind, data in events(client, "events"):
            if kind == "job" and data["state"] == "done":
                heard.add(data["id"])
            if heard >= set(made) and not late:
                late.append(submit(client, short_study())["id"])
            if late and late[0] in heard:
                break


def test_a_quiet_stream_has_a_heartbeat(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        kinds = []
        for _, kind, _ in events(client, "events"):
            kinds.append(kind)
            if len(kinds) == 3:
                break
    assert kinds == ["comment"] * 3


def test_snapshots_are_rationed(tmp_path: Path) -> None:
    # Eight tabs must not freeze: at most about four snapshots a second each.
    with serving(settings_for(tmp_path)) as client:
        job = submit(client, beam_study())["id"]
        begin = time.monotonic()
        heard = until_done(events(client, f"events?job={job}"))
        seconds = time.monotonic() - begin
    assert len([kind for _, kind, _ in heard if kind == "job"]) <= 4 * seconds + 3


def test_streams_have_an_end(tmp_path: Path) -> None:
    limits = Limits(event_streams=1)
    with serving(settings_for(tmp_path, limits=limits)) as client:
        first = events(client, "events")
        next(first)
        answer = client.get("/api/v1/events")
        assert answer.status_code == 503
        assert answer.headers["retry-after"]
        first.close()  # type: ignore[attr-defined]
        # The place is free again once the server notices.
        until(lambda: client.app.state.changes.listeners, lambda count: count == 0)


def test_streams_end_with_the_server(tmp_path: Path) -> None:
    ends: list[float] = []
    opened = threading.Event()

    def listen(port: int, app: Any) -> None:
        with Client(port, app) as client:
            for _ in events(client, "events"):
                opened.set()
        ends.append(time.monotonic())

    with serving(settings_for(tmp_path)) as client:
        threads = [
            threading.Thread(target=listen, args=(client.port, client.app)) for _ in range(3)
        ]
        for thread in threads:
            thread.start()
        assert opened.wait(10)
        begin = time.monotonic()
    for thread in threads:
        thread.join(10)
    assert len(ends) == 3
    assert max(ends) - begin < 3.0
