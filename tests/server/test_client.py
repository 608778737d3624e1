"""The Python client: against a real server, and against one that breaks off."""

from __future__ import annotations

import json
import re
import time
import weakref
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from server.client import (
    ClientError,
    ProblemError,
    ServerAwayError,
    TrainbridgeClient,
    WatchEvent,
)
from server.client import client as client_module
from server.client import watching as client_watching
from server.routes.schemas import Job
from server.store import RunReader, attempt_place
from solver import studies
from tests.server import odd_batches
from tests.server.server_case import Client, serving, settings_for, short_study, until

ROOT = Path(__file__).parents[2]
TOKEN = "correct horse battery staple"
LONG = 180.0
"""Time for what takes a moment on a quiet machine. [s]"""


def client_of(server: Client, **parts: Any) -> TrainbridgeClient:
    return TrainbridgeClient(f"http://127.0.0.1:{server.port}", **parts)


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TrainbridgeClient]:
    """Of a server whose runs are done at once."""
    settings = settings_for(tmp_path_factory.mktemp("quick"), token=TOKEN)
    with (
        serving(settings, compute=odd_batches.finish) as server,
        client_of(server, token=TOKEN) as client,
    ):
        yield client


@pytest.mark.slow
def test_a_job_from_its_study_to_its_histories(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path)) as server, client_of(server) as client:
        job = client.submit(short_study(sweep={"speeds": [20.0, 30.0]}), priority=3)
        assert (job.state, job.priority) == ("queued", 3)
        events = list(client.watch(job.id))
        assert events[-1].is_end
        assert [event.is_end for event in events].count(True) == 1
        progress = [event.progress for event in events if event.progress is not None]
        first, second = (run.id for run in job.runs)
        assert {item["run"] for item in progress} >= {first, second}
        assert [event.number for event in events] == sorted(event.number for event in events)
        run = client.run(first)
        assert run.state == "done"
        assert run.attempt == 1
        assert [item["run"] for item in client.summary(job.id)["runs"]] == [first, second]
        assert client.verdicts(job.id).judged == 2
        assert f"run 1 ({second})  running" in client.log(job.id)
        channel = client.channels(first).items[0]
        history = client.channel(first, channel.name)
        reader = RunReader(attempt_place(server.app.state.service.store, first, 1))
        assert np.array_equal(history[:, 0], reader.times())
        assert np.array_equal(history[:, 1], reader.channel(channel.name))
        window = client.channel(first, channel.name, begin=0.1, end=0.2)
        assert (window[0, 0], window[-1, 0]) == pytest.approx((0.1, 0.2), abs=2e-3)


@pytest.mark.slow
def test_jobs_are_listed_over_pages(quick: TrainbridgeClient) -> None:
    made = [quick.submit(short_study(name=f"listed {index}")).id for index in range(5)]
    assert [job.id for job in quick.jobs(name="listed", page=2)] == made[::-1]
    for job in made:
        assert quick.wait(job, seconds=LONG).state == "done"
    assert {job.id for job in quick.jobs(states=["done"])} >= set(made)
    assert list(quick.jobs(states=["failed"], name="listed")) == []


@pytest.mark.slow
def test_everything_that_can_be_asked_of_a_job(tmp_path: Path) -> None:
    settings = settings_for(tmp_path)
    with serving(settings, compute=odd_batches.hang) as server, client_of(server) as client:
        job = client.submit(short_study(), key="one")
        assert client.submit(short_study(), key="one").id == job.id
        waits = client.clone(job.id)
        assert waits.source == job.id
        assert client.set_priority(waits.id, 9).priority == 9
        with pytest.raises(TimeoutError):
            client.wait(waits.id, seconds=0.5)
        client.cancel_run(job.runs[0].id)
        assert client.wait(job.id, seconds=LONG).state == "cancelled"
        client.delete(job.id)
        with pytest.raises(ProblemError) as raised:
            client.job(job.id)
        assert raised.value.status == 404
        client.cancel(waits.id)
        assert client.wait(waits.id, seconds=LONG).state == "cancelled"
        attempts = client.job(waits.id).runs[0].attempt
        assert client.retry(waits.id).state in ("queued", "running")
        until(lambda: client.job(waits.id).runs[0].attempt, lambda found: found == attempts + 1)


def test_who_watches_hears_that_the_job_was_deleted(tmp_path: Path) -> None:
    settings = settings_for(tmp_path)
    with serving(settings, compute=odd_batches.hang) as server, client_of(server) as client:
        job = client.submit(short_study()).id
        heard = client.watch(job)
        next(heard)
        client.delete(job)
        with pytest.raises(ProblemError) as raised:
            list(heard)
        assert raised.value.status == 404


def test_refusals_tell_each_finding(quick: TrainbridgeClient) -> None:
    study = studies.to_json(studies.template("sprung-mass-beam").study)
    study["mesh_level"] = "ultra"
    with pytest.raises(ProblemError) as raised:
        quick.submit(study)
    assert raised.value.status == 422
    [finding] = raised.value.findings
    assert finding.pointer == "/study/mesh_level"
    assert finding.remedy
    with (
        TrainbridgeClient(quick.url, "wrong") as stranger,
        pytest.raises(ProblemError, match="Token needed"),
    ):
        stranger.health()
    with pytest.raises(ProblemError) as raised:
        quick.job("../../secret?x=1#y")
    assert raised.value.status == 404


@pytest.mark.parametrize("url", ["", "127.0.0.1:8000", "ftp://host", "http://", "http://[::1"])
def test_an_address_that_is_none_is_said(url: str) -> None:
    with pytest.raises(ClientError, match="is not a server's address"):
        TrainbridgeClient(url)


def test_nobody_answers() -> None:
    with (
        TrainbridgeClient("http://127.0.0.1:1", patience=0.0) as client,
        pytest.raises(ServerAwayError, match="trainbridge serve"),
    ):
        client.health()
    with (
        TrainbridgeClient("http://127.0.0.1:1", patience=60.0) as client,
        pytest.raises(ServerAwayError),
    ):
        list(client.watch("a"))


def test_what_is_no_problem_document_is_told_too() -> None:
    def proxy(request: httpx.Request) -> httpx.Response:
        return httpx.Response(502, html="<h1>Bad gateway</h1>")

    with (
        TrainbridgeClient(transport=httpx.MockTransport(proxy)) as client,
        pytest.raises(ProblemError, match=r"502.*Bad gateway"),
    ):
        client.health()


class Breaking(httpx.SyncByteStream):
    """A stream that breaks off after what it says."""

    def __init__(self, *parts: str, breaks: bool = True) -> None:
        self.parts = parts
        self.breaks = breaks

    def __iter__(self) -> Iterator[bytes]:
        yield from (part.encode() for part in self.parts)
        if self.breaks:
            raise httpx.ReadError("the connection is gone")


def told(number: int, kind: str, data: Any) -> str:
    return f"id: {number}\nevent: {kind}\ndata: {json.dumps(data)}\n\n"


def job(state: str) -> dict[str, Any]:
    values = dict.fromkeys(
        ("progress", "started", "ended", "error", "position", "estimated_start", "source")
    )
    fixed = {"id": "a", "kind": "crossing", "name": "a", "created": "", "priority": 0, "runs": []}
    return {**values, **fixed, "state": state}


def test_watching_goes_on_where_it_broke_off(monkeypatch: pytest.MonkeyPatch) -> None:
    pauses: list[float] = []
    monkeypatch.setattr(client_watching.time, "sleep", pauses.append)
    step = {"run": "r", "step": 1}
    answers = iter(
        [
            Breaking(told(0, "job", job("running")), told(7, "progress", step)),
            httpx.Response(503, json={}),
            # What a proxy says while the server behind it restarts.
            httpx.Response(502, text="<html>"),
            httpx.Response(504, text="<html>"),
            httpx.ConnectError("refused"),
            Breaking(": nothing more waits\n\n", told(8, "progress", step), "id: 9\nevent: jo"),
            # It has ended meanwhile: the end comes first, then what was missed, then all is told.
            Breaking(
                told(8, "job", job("done")),
                told(9, "progress", step),
                ": nothing more waits\n\n",
                breaks=False,
            ),
        ]
    )
    begins: list[str | None] = []

    def server(request: httpx.Request) -> httpx.Response:
        begins.append(request.headers.get("last-event-id"))
        answer = next(answers)
        if isinstance(answer, Exception):
            raise answer
        return answer if isinstance(answer, httpx.Response) else httpx.Response(200, stream=answer)

    with TrainbridgeClient(transport=httpx.MockTransport(server)) as client:
        events = list(client.watch("a"))
    assert begins == [None, "7", "7", "7", "7", "7", "8"]
    assert [event.number for event in events] == [0, 7, 8, 9, 8]
    assert events[-1].is_end
    assert [event.kind for event in events] == ["job", "progress", "progress", "progress", "job"]
    # Longer and longer, and from the beginning again once something was heard.
    assert pauses == [0.1, 0.2, 0.4, 0.8, 1.6, 0.1]


def test_waiting_keeps_no_events(monkeypatch: pytest.MonkeyPatch) -> None:
    alive: list[weakref.ref[WatchEvent]] = []

    def told_one_by_one(*_: Any, **__: Any) -> Iterator[WatchEvent]:
        for number in range(100):
            last = number == 99
            said = Job.model_validate(job("done")) if last else None
            event = WatchEvent(number=number, kind="job" if last else "progress", job=said)
            alive.append(weakref.ref(event))
            yield event
            del event
            # The one that was just told, at most.
            assert sum(item() is not None for item in alive) <= 1

    monkeypatch.setattr(client_module, "watch", told_one_by_one)
    assert TrainbridgeClient().wait("a").state == "done"


def test_a_proxy_is_not_asked_for_this_machine(
    quick: TrainbridgeClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("HTTP_PROXY", "http_proxy", "ALL_PROXY"):
        monkeypatch.setenv(name, "http://127.0.0.1:9")
    monkeypatch.delenv("NO_PROXY", raising=False)
    monkeypatch.delenv("no_proxy", raising=False)
    with TrainbridgeClient(quick.url, TOKEN) as client:
        assert client.health().status == "ok"
    elsewhere = TrainbridgeClient("http://trainbridge.invalid")
    with elsewhere, pytest.raises(ServerAwayError, match="refused"):
        elsewhere.health()


def test_a_time_without_a_zone_is_the_local_one(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[httpx.URL] = []

    def server(request: httpx.Request) -> httpx.Response:
        asked.append(request.url)
        return httpx.Response(200, json={"items": [], "next": None})

    monkeypatch.setenv("TZ", "KST-9")
    time.tzset()
    try:
        with TrainbridgeClient(transport=httpx.MockTransport(server)) as client:
            list(
                client.jobs(
                    created_from=datetime(2026, 1, 2, 3),
                    created_to=datetime(2026, 1, 3, tzinfo=UTC),
                )
            )
    finally:
        monkeypatch.undo()
        time.tzset()
    sent = [datetime.fromisoformat(asked[0].params[f"created_{end}"]) for end in ("from", "to")]
    assert sent == [datetime(2026, 1, 1, 18, tzinfo=UTC), datetime(2026, 1, 3, tzinfo=UTC)]


def test_the_example_of_the_readme_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.search(r"<!-- client example -->\s*```python\n(.+?)\n```", text, re.S)
    assert found
    with serving(settings_for(tmp_path), compute=odd_batches.finish) as server:
        address = f"http://127.0.0.1:{server.port}"
        exec(found.group(1).replace("http://127.0.0.1:8000", address), {})
    printed = capsys.readouterr().out.splitlines()
    assert "job" in {line.split()[-1] for line in printed}
    assert printed[-1] == "done"


def test_the_pause_between_attempts_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    pauses: list[float] = []

    def sleep(seconds: float) -> None:
        pauses.append(seconds)
        now[0] += seconds

    monkeypatch.setattr(client_watching.time, "sleep", sleep)
    monkeypatch.setattr(client_watching.time, "monotonic", lambda: now[0])

    answers = iter([httpx.Response(200, stream=Breaking(told(0, "job", job("running"))))])

    def away(request: httpx.Request) -> httpx.Response:
        answer = next(answers, None)
        if answer is None:
            raise httpx.ConnectError("refused")
        return answer

    transport = httpx.MockTransport(away)
    with (
        TrainbridgeClient(transport=transport, patience=60.0) as client,
        pytest.raises(ServerAwayError),
    ):
        list(client.watch("a"))
    assert max(pauses) == 5.0
    assert 60.0 < sum(pauses) <= 65.0
