"""Bad input on every route that takes a body: 4xx, problem+json, pointer and remedy, never 500."""

from __future__ import annotations

import json
import sqlite3
import tracemalloc
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from server.app import create_app
from server.errors import Problem
from server.jobs.strict_json import read_json
from server.jobs.submission import Capacity, admit, read_submission
from server.settings import DATABASE_NAME, Limits
from solver import studies
from tests.server import odd_batches
from tests.server.command_line import refused_here, trainbridge
from tests.server.server_case import Client, beam_study, ended, every_route, serving, settings_for

MIB = 1024 * 1024
BODY_METHODS = {"POST", "PUT", "PATCH"}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    settings = settings_for(tmp_path_factory.mktemp("server"), token="a token for the login route")
    with serving(settings, compute=odd_batches.finish) as client:
        client.headers["Authorization"] = f"Bearer {settings.token}"
        yield client


def body_routes(app: FastAPI) -> list[tuple[str, str]]:
    """Every route that may carry a body, with values for its parameters."""
    routes = [
        (method, route.path.replace("{", "").replace("}", ""))
        for route in every_route(app.routes)
        for method in sorted(getattr(route, "methods", None) or ())
        if method in BODY_METHODS
    ]
    return sorted(routes)


ROUTES = body_routes(create_app(settings_for(Path("unused"))))


def test_the_walk_finds_the_routes() -> None:
    paths = {path for _, path in ROUTES}
    assert {"/api/v1/jobs", "/api/v1/studies/validate", "/login"} <= paths
    assert any("viewer" in path for path in paths)


def with_study(text: str) -> bytes:
    """A submission that would be right but for a text in its study."""
    study = json.dumps(beam_study())[1:-1]
    return f'{{"study": {{{study}, {text}}}}}'.encode()


@dataclass(frozen=True)
class Bad:
    """A body that no route may take."""

    body: bytes
    status: int
    pointer: str = ""
    kind: str = "application/json"


MALFORMED = {
    "not JSON": Bad(b"{'name': 1}", 400),
    "cut off": Bad(b'{"study": ', 400),
    "invalid UTF-8": Bad(b'{"name": "\xff\xfe"}', 400),
    "lone surrogate": Bad(rb'{"study": {"name": "\ud800"}}', 400, "/study/name"),
    "lone surrogate in a key": Bad(rb'{"study": {"\udfff": 1}}', 400, r"/study/\udfff"),
    "NaN": Bad(b'{"study": {"line_speed": NaN}}', 400, "/study/line_speed"),
    "Infinity": Bad(b'{"study": {"line_speed": -Infinity}}', 400, "/study/line_speed"),
    "1e999": Bad(b'{"study": {"sweep": {"speeds": [1, 1e999]}}}', 400, "/study/sweep/speeds/1"),
    "an endless integer": Bad(b'{"a": ' + b"9" * 5000 + b"}", 400, "/a"),
    "a key twice": Bad(b'{"kind": "modes", "kind": "crossing"}', 400, "/kind"),
    "200,000 brackets": Bad(b"[" * 200_000, 400),
    "200,000 closed brackets": Bad(b"[" * 200_000 + b"]" * 200_000, 400),
    "brackets of objects": Bad(b'{"a":' * 200_000 + b"1" + b"}" * 200_000, 400),
    "an endless text": Bad(b'"' + rb"\"" * 200_000, 400),
    "too large": Bad(b'{"name": "' + b"a" * (4 * MIB) + b'"}', 413),
    "form data": Bad(b"name=1", 415, kind="application/x-www-form-urlencoded"),
    "plain text": Bad(b"{}", 415, kind="text/plain"),
}


@pytest.mark.parametrize(("method", "path"), ROUTES)
@pytest.mark.parametrize("name", MALFORMED)
def test_malformed_bodies_are_refused_everywhere(
    client: Client, method: str, path: str, name: str
) -> None:
    bad = MALFORMED[name]
    answer = client.request(method, path, content=bad.body, headers={"Content-Type": bad.kind})
    document = problem(answer)
    assert answer.status_code == bad.status, answer.text
    if bad.status == 400:
        assert document["errors"][0]["pointer"] == bad.pointer
        assert all(item["remedy"] for item in document["errors"])


@pytest.mark.parametrize(("method", "path"), ROUTES)
def test_a_body_that_streams_is_counted(client: Client, method: str, path: str) -> None:
    # No Content-Length: the limit must hold while the bytes come.
    def chunks() -> Iterator[bytes]:
        yield b'{"a": "'
        for _ in range(100):
            yield b"x" * (MIB // 4)

    headers = {"Content-Type": "application/json"}
    answer = client.request(method, path, content=chunks(), headers=headers)
    assert answer.status_code == 413
    problem(answer)


@pytest.mark.parametrize("path", ["/api/v1/jobs", "/api/v1/studies/validate"])
@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"sweep": {"speeds": [0]}}, "/study/sweep/speeds/0"),
        ({"sweep": {"speeds": [-120.0]}}, "/study/sweep/speeds/0"),
        ({"sweep": {"speeds": [True]}}, "/study/sweep/speeds/0"),
        ({"sweep": {"speeds": ["120"]}}, "/study/sweep/speeds/0"),
        ({"sweep": {"speeds": []}}, "/study/sweep/speeds"),
        ({"sweep": {"speeds": [1.0] * 501}}, "/study/sweep/speeds"),
        ({"sweep": {"speeds": [1] * 1_000_000}}, "/study/sweep/speeds"),
        ({"integration": {"time_step": "1e-3"}}, "/study/integration/time_step"),
        ({"mesh_level": "ultra"}, "/study/mesh_level"),
        ({"wheels": 4}, "/study/wheels"),
        ({"name": ""}, "/study/name"),
        ({"name": "n" * 1000}, "/study/name"),
        ({"train": {"type": "maglev"}}, "/study/train/type"),
        ({"train": {"type": "sprung_masses", "mass": -1}}, "/study/train/mass"),
        ({"train": {"type": "sprung_masses", "wings": 2}}, "/study/train/wings"),
        ({"train": 5}, "/study/train"),
        ({"train": None}, "/study/train"),
        ({"schema_version": 99}, "/study/schema_version"),
    ],
)
def test_unusable_values_are_pointed_at(
    client: Client, path: str, change: dict[str, Any], pointer: str
) -> None:
    answer = client.post(path, json={"study": beam_study(**change)})
    assert answer.status_code == 422, answer.text
    document = problem(answer)
    assert [item["pointer"] for item in document["errors"]] == [pointer]


@pytest.mark.parametrize("path", ["/api/v1/jobs", "/api/v1/studies/validate"])
@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ([], ""),
        ("study", ""),
        ({}, "/study"),
        ({"study": 5}, "/study"),
        ({"study": []}, "/study"),
        ({"study": {}, "kind": "magic"}, "/kind"),
        ({"study": {}, "urgency": 1}, "/urgency"),
        ({"study": {}, "priority": "high"}, "/priority"),
        ({"study": {}, "priority": True}, "/priority"),
        ({"study": {}, "priority": 1.0}, "/priority"),
        ({"study": {}, "priority": -101}, "/priority"),
    ],
)
def test_unusable_submissions_are_pointed_at(
    client: Client, path: str, body: Any, pointer: str
) -> None:
    answer = client.post(path, json=body)
    assert answer.status_code == 422, answer.text
    assert pointer in [item["pointer"] for item in problem(answer)["errors"]]


def test_a_missing_body_is_refused(client: Client) -> None:
    for method, path in [
        ("POST", "/api/v1/jobs"),
        ("POST", "/api/v1/studies/validate"),
        ("POST", "/login"),
        ("PATCH", "/api/v1/jobs/none"),
    ]:
        answer = client.request(method, path)
        assert answer.status_code == 400
        assert "JSON body" in problem(answer)["detail"]


def test_what_the_solver_refuses_is_pointed_at(client: Client) -> None:
    study = studies.to_json(studies.template("khst-alverca").study)
    study["approach"]["length"] = 10.0
    study["integration"]["time_step"] = 0.05
    answer = client.post("/api/v1/jobs", json={"study": study})
    assert answer.status_code == 422
    pointers = {item["pointer"] for item in problem(answer)["errors"]}
    assert pointers == {"/study/approach/length", "/study/integration/time_step"}
    # The same findings without submitting.
    report = client.post("/api/v1/studies/validate", json={"study": study}).json()
    assert {item["pointer"] for item in report["errors"]} == pointers
    assert report["estimate"] is None


def enormous_study() -> dict[str, Any]:
    """A petabyte of results: the slowest train, the finest step, a shape at each of them."""
    study = studies.to_json(studies.template("khst-alverca").study)
    study["sweep"]["speeds"] = [0.001] * 4
    study["integration"]["time_step"] = 1e-5
    study["outputs"]["frame_interval"] = 1e-4
    study["mesh_level"] = "fine"
    return study


def test_a_petabyte_is_refused_at_once(client: Client, tmp_path: Path) -> None:
    submission = read_submission(read_json(json.dumps({"study": enormous_study()}).encode()))
    limits = Limits()
    with pytest.raises(Problem, match="limit"):
        admit(submission, limits, Capacity.now(limits, tmp_path))
    # By closed formulas: one history of one run would be 400 GB.
    tracemalloc.start()
    try:
        with pytest.raises(Problem, match="limit"):
            admit(submission, limits, Capacity.now(limits, tmp_path))
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 10e6
    answer = client.post("/api/v1/jobs", json={"study": enormous_study()})
    assert answer.status_code == 422
    pointers = {item["pointer"] for item in problem(answer)["errors"]}
    assert {"/study/integration/time_step", "/study/outputs/frame_interval"} <= pointers


def test_each_limit_is_a_setting(tmp_path: Path) -> None:
    study = {"study": beam_study(sweep={"speeds": [20.0, 25.0]})}
    submission = read_submission(read_json(json.dumps(study).encode()))
    for limits, words in (
        (Limits(runs_per_job=1), "2 runs; the limit is 1"),
        (Limits(steps_per_job=100), "time steps; the limit is 100"),
        (Limits(memory_fraction=1e-6), "GB of memory"),
        (Limits(disk_fraction=1e-9), "GB of disk"),
    ):
        with pytest.raises(Problem, match=words):
            admit(submission, limits, Capacity.now(limits, tmp_path))
    # A folder that comes with the first result counts as the disk that it will be on.
    admit(submission, Limits(), Capacity.now(Limits(), tmp_path / "not" / "yet"))
    # What computes and stores elsewhere is not held to this machine's memory and disk.
    elsewhere = Limits(memory_fraction=1e-6, disk_fraction=1e-9)
    admit(submission, elsewhere, Capacity.now(elsewhere, None, computes_here=False))


@pytest.mark.parametrize(
    "path",
    [
        "jobs/none",
        "jobs/none/events",
        "jobs/none/verdicts",
        "jobs/none/summary",
        "jobs/none/log",
        "jobs/%F0%9F%9A%84/study",
        "jobs/none%00/log",
        "events?job=none",
        "runs/none",
        "runs/none/verdicts",
        "runs/none/channels",
        "runs/none/channels/a/b.csv",
        "runs/none/frames",
        "runs/none/plots/displacement.json",
        "templates/none",
        "nothing",
        "jobs/%00",
        "jobs/..%2f..",
        "runs/%F0%9F%9A%84",
    ],
)
def test_what_does_not_exist_is_a_problem(client: Client, path: str) -> None:
    answer = client.get(f"/api/v1/{path}")
    assert answer.status_code == 404
    problem(answer)


@pytest.mark.parametrize(
    "query",
    ["limit=0", "limit=1000", "limit=x", "cursor=-1", "cursor=" + "9" * 400, "state=asleep"],
)
def test_unusable_queries_are_pointed_at(client: Client, query: str) -> None:
    answer = client.get(f"/api/v1/jobs?{query}")
    assert answer.status_code == 422
    assert problem(answer)["errors"][0]["pointer"] == query.split("=")[0]


def older(folder: Path) -> None:
    """A data folder from before migrations."""
    with closing(sqlite3.connect(folder / DATABASE_NAME)) as connection, connection:
        connection.execute("CREATE TABLE schema_version (version INTEGER)")
        connection.execute("INSERT INTO schema_version VALUES (1)")


def newer(folder: Path) -> None:
    """A data folder of a version to come."""
    with closing(sqlite3.connect(folder / DATABASE_NAME)) as connection, connection:
        connection.execute("CREATE TABLE alembic_version (version_num VARCHAR(32))")
        connection.execute("INSERT INTO alembic_version VALUES ('9999')")


@pytest.mark.parametrize(
    ("prepare", "options", "variables", "words"),
    [
        (None, ["--engine", "celery"], {}, "engine = celery (command line) is not an engine"),
        (None, ["--engine", "tcp://10.1.2.3:8786"], {}, "Use tls://"),
        (None, [], {"LIMITS_RUNS_PER_JOB": "-1"}, "limits.runs_per_job = -1"),
        (None, [], {"QUOTA_BYTES": "-1"}, "must be at least 0"),
        (None, [], {"LIMIT_RUNS": "1"}, "is not a setting"),
        (None, ["--config", "none.toml"], {}, "--config"),
        (None, ["--database", "mysql://h/d"], {}, "is not a database"),
        (None, ["--store", "memory://"], {}, "memory://"),
        (older, [], {}, "trainbridge migrate"),
        (newer, [], {}, "Upgrade trainbridge"),
    ],
    ids=lambda value: getattr(value, "__name__", str(value)),
)
def test_a_server_that_cannot_start_says_why(
    tmp_path: Path,
    prepare: Callable[[Path], None] | None,
    options: list[str],
    variables: dict[str, str],
    words: str,
) -> None:
    if prepare is not None:
        prepare(tmp_path)
    settings = {f"TRAINBRIDGE_{name}": value for name, value in variables.items()}
    refused = refused_here("serve", "--data", str(tmp_path), "--port", "0", *options, **settings)
    assert refused.returncode == 1
    assert words in refused.stderr
    assert "Traceback" not in refused.stderr


# A guard: a second server that were to start would serve for ever.
@pytest.mark.timeout(600)
def test_a_second_server_leaves_the_first_alone(tmp_path: Path) -> None:
    settings = settings_for(tmp_path)
    with serving(settings, compute=odd_batches.finish) as client:
        for serve in (trainbridge, refused_here):
            refused = serve("serve", "--data", str(settings.data), "--port", "0")
            assert refused.returncode == 1
            assert "--data" in refused.stderr
            assert "Traceback" not in refused.stderr
        job = client.post("/api/v1/jobs", json={"study": beam_study()}).json()
        assert ended(client, job["id"])["state"] == "done"


def test_the_server_stays_up(client: Client) -> None:
    # After everything above.
    assert client.json("health")["status"] == "ok"
    job = client.post("/api/v1/jobs", json={"study": beam_study()}).json()
    assert ended(client, job["id"])["state"] == "done"


def test_values_are_shown_shortened(client: Client) -> None:
    answer = client.post("/api/v1/jobs", json={"study": beam_study(mesh_level="x" * 10_000)})
    [item] = problem(answer)["errors"]
    assert len(item["value"]) == 80
    answer = client.post("/api/v1/jobs", json={"study": beam_study(**{"k" * 10_000: 1})})
    assert len(answer.content) < 2000


def test_ordinary_depth_and_brackets_in_texts_are_taken() -> None:
    text = '{"a": "[[[[\\"]]' + "[" * 500 + '", "b": ' + "[" * 60 + "1.5" + "]" * 60 + "}"
    assert read_json(text.encode())["a"].endswith("[[[")


# A guard against hanging, no measurement: this takes a second, and work that grows with the square
# of the size would take hours.
@pytest.mark.timeout(600)
def test_large_bodies_are_read_quickly() -> None:
    read_json(b"[" + b"[],{}," * 600_000 + b"0]")


def problem(answer: httpx.Response) -> dict[str, Any]:
    """The answer as a problem, its form checked."""
    assert answer.headers["content-type"] == "application/problem+json", answer.text[:300]
    document = answer.json()
    assert set(document) == {"type", "title", "status", "detail", "errors"}
    assert document["status"] == answer.status_code
    assert 400 <= answer.status_code < 500
    assert document["title"]
    assert document["detail"]
    for item in document["errors"]:
        assert set(item) == {"pointer", "value", "reason", "remedy"}
        assert len(item["value"]) <= 80
        assert item["reason"]
    return document
