"""Event streams: what a tab hears, from where it left off, and that streams end."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy.exc import OperationalError

from server.routes import changes as changes_module
from server.routes.changes import Changes
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


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
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
    ends: list[int] = []
    opened = threading.Event()

    def listen(port: int, app: Any) -> None:
        with Client(port, app) as client:
            for _ in events(client, "events"):
                opened.set()
        ends.append(port)

    with serving(settings_for(tmp_path)) as client:
        threads = [
            threading.Thread(target=listen, args=(client.port, client.app)) for _ in range(3)
        ]
        for thread in threads:
            thread.start()
        assert opened.wait(60)
    for thread in threads:
        thread.join(60)
    assert len(ends) == 3


@pytest.mark.slow
def test_another_process_tells_as_much(tmp_path: Path) -> None:
    # Two servers on one folder, as two processes: the second has no coordinator to wake it.
    settings = settings_for(tmp_path, event_poll_seconds=0.01)
    with (
        serving(settings) as first,
        serving(replace(settings, coordinator=False)) as second,
    ):
        job = submit(second, short_study())["id"]
        heard = until_done(events(second, f"jobs/{job}/events"))
        expected = [
            event.id
            for event in first.app.state.service.database.events_after(0, jobs=[job])
            if event.kind == "progress"
        ]
    assert [number for number, kind, _ in heard if kind == "progress"] == expected
    assert len(expected) >= 10


@pytest.mark.slow
def test_a_stream_says_when_all_that_was_missed_is_told(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as client:
        job = submit(client, short_study())["id"]
        ended(client, job)
        told = []
        for number, kind, data in events(client, f"jobs/{job}/events"):
            told.append((number, kind))
            if kind == "comment":
                assert data == "nothing more waits"
                break
        database = client.app.state.service.database
        progress = [e.id for e in database.events_after(0, jobs=[job]) if e.kind == "progress"]
    assert [number for number, kind in told if kind == "progress"] == progress


@pytest.mark.slow
@pytest.mark.parametrize("where", ["events", "jobs/{job}/events"])
def test_a_number_from_before_the_database_was_replaced(tmp_path: Path, where: str) -> None:
    with serving(settings_for(tmp_path), compute=odd_batches.hang) as client:
        job = submit(client, short_study())["id"]
        until(lambda: client.json(f"jobs/{job}")["state"], lambda state: state == "running")
        stream = events(client, where.format(job=job), **{"Last-Event-ID": "1000000"})
        first = next(stream)
        assert 0 < first[0] < 1_000_000
        client.patch(f"/api/v1/jobs/{job}", json={"priority": 1})
        client.post(f"/api/v1/jobs/{job}/cancel")
        # With a number that is yet to come, the end would never be told.
        said = (data["state"] for _, kind, data in stream if kind == "job")
        assert "cancelled" in said


@pytest.mark.slow
def test_a_stream_ends_with_the_last_of_its_jobs(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path), compute=odd_batches.hang) as client:
        job = submit(client, short_study())["id"]
        stream = events(client, f"events?job={job}")
        next(stream)
        assert client.delete(f"/api/v1/jobs/{job}").status_code == 202
        assert all(kind != "job" or data["id"] == job for _, kind, data in stream)


def test_nobody_looks_for_events_while_nobody_listens() -> None:
    looks: list[int] = []

    def last_event() -> int:
        looks.append(len(looks))
        return len(looks) // 3

    async def listen() -> list[int]:
        changes = Changes()
        changes.bind()
        changes.follow(last_event, 0.001)
        await asyncio.sleep(0.01)
        counts = [len(looks)]
        async with changes.listen() as changed, changes.listen():
            for _ in range(3):
                changed.clear()
                await asyncio.wait_for(changed.wait(), 60.0)
        counts.append(len(looks))
        await asyncio.sleep(0.02)
        # A look that had begun may still have ended.
        counts.append(len(looks) - counts[-1])
        return counts

    before, while_listening, after = asyncio.run(listen())
    assert before == 0
    # One task for both: three changes take at most nine looks, and one that was under way.
    assert 5 <= while_listening <= 10
    assert after <= 1


def test_events_come_again_with_the_database(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(changes_module, "_RETRY_SECONDS", 0.001)
    answers = iter([1, OSError("gone"), OSError("gone"), 2])

    def last_event() -> int:
        answer = next(answers, 2)
        if isinstance(answer, Exception):
            raise answer
        return answer

    async def listen() -> None:
        changes = Changes()
        changes.bind()
        changes.follow(last_event, 0.001)
        async with changes.listen() as changed:
            for _ in range(2):
                changed.clear()
                await asyncio.wait_for(changed.wait(), 60.0)

    asyncio.run(listen())
    # Said once, however often it was asked.
    assert len([item for item in caplog.records if item.levelname == "ERROR"]) == 1


def test_a_database_that_is_away_is_an_answer(tmp_path: Path) -> None:
    def away(*_: Any, **__: Any) -> Any:
        raise OperationalError("SELECT 1", {}, Exception("database is locked"))

    with serving(settings_for(tmp_path), compute=odd_batches.finish) as client:
        service = client.app.state.service
        stream = events(client, "events")
        next(stream)
        with pytest.MonkeyPatch.context() as patch:
            for name in ("jobs", "add_job", "events_after"):
                patch.setattr(service.database, name, away)
            for answer in (
                client.get("/api/v1/jobs"),
                client.post("/api/v1/jobs", json={"study": short_study()}),
            ):
                assert answer.status_code == 503
                assert answer.headers["content-type"] == "application/problem+json"
                assert answer.headers["retry-after"]
                assert "SELECT" not in answer.text
            # A stream ends; whoever listened comes again.
            service.changes.notify()
            list(stream)
        # And it goes on as if nothing had been.
        ended(client, submit(client, short_study())["id"])
