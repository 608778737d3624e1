"""Figures over HTTP: lists, formats, variants, places, sweeps, comparisons, problems."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.server.server_case import Client, ended, serving, settings_for, short_study, submit

NAME = "=one <b>"
SPEEDS = (20.0, 30.0)


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Client, dict[str, Any]]]:
    """A server with a finished sweep of a mass on a beam."""
    with serving(settings_for(tmp_path_factory.mktemp("plots"))) as client:
        study = {**short_study(), "name": NAME, "sweep": {"speeds": list(SPEEDS)}}
        job = ended(client, submit(client, study)["id"])
        assert job["state"] == "done", job
        yield client, job


def run_of(swept: tuple[Client, dict[str, Any]]) -> str:
    return f"runs/{swept[1]['runs'][0]['id']}"


def test_a_run_lists_its_figures_and_every_one_of_them_comes(
    swept: tuple[Client, dict[str, Any]],
) -> None:
    client, run = swept[0], run_of(swept)
    items = client.json(f"{run}/plots")["items"]
    names = [item["name"] for item in items]
    assert "slab-map" not in names  # a beam is one line of points
    assert {"slab-acceleration", "contact-force", "spectrum", "envelope"} <= set(names)
    for item in items:
        for variant in item["variants"] or [{"name": ""}]:
            query = {"variant": variant["name"], "place": "5,0,0"}
            figure = client.json(f"{run}/plots/{item['name']}.json", **query)
            assert set(figure) == {"data", "layout", "table", "summary"}
            assert figure["layout"]["meta"]["axis"] == item["axis"]
            assert figure["data"], item["name"]


def test_a_table_and_a_dark_file_are_downloads(swept: tuple[Client, dict[str, Any]]) -> None:
    client, run = swept[0], run_of(swept)
    table = client.get(f"/api/v1/{run}/plots/displacement.csv", params={"points": 50})
    assert table.headers["content-type"] == "text/csv; charset=utf-8"
    assert table.headers["content-disposition"] == 'attachment; filename="displacement.csv"'
    rows = list(csv.reader(io.StringIO(table.text)))
    assert rows[0][0] == "time [s]"
    assert len(rows) <= 51
    picture = client.get(f"/api/v1/{run}/plots/displacement.png", params={"theme": "dark"})
    assert picture.content.startswith(b"\x89PNG")


def test_the_sweeps_values_are_the_runs_own_and_lead_to_them(
    swept: tuple[Client, dict[str, Any]],
) -> None:
    client, job = swept
    figure = client.json(f"jobs/{job['id']}/plots/speed-sweep.json")
    above, below = figure["data"]
    assert above["x"] == pytest.approx([3.6 * speed for speed in SPEEDS])
    assert above["customdata"] == [run["id"] for run in job["runs"]]
    for index, run in enumerate(job["runs"]):
        peaks = client.json(f"runs/{run['id']}")["summary"]["peaks"]
        for trace, quantity, scale in ((above, "acceleration", 1.0), (below, "displacement", 1e3)):
            peak = peaks[f"mid-span 1/{quantity}"]
            expected = scale * max(-peak["least"], peak["greatest"])
            assert trace["y"][index] == pytest.approx(expected, rel=1e-6)  # seven figures
    assert client.get(f"/api/v1/jobs/{job['id']}/plots/speed-sweep.svg").status_code == 200


def test_runs_beside_each_other_carry_their_names(swept: tuple[Client, dict[str, Any]]) -> None:
    client, job = swept
    runs = [run["id"] for run in job["runs"]]
    figure = client.json("compare/plots/histories.json", run=runs)
    assert [trace["name"] for trace in figure["data"]] == [
        "=one &lt;b&gt;, 72 km/h",
        "=one &lt;b&gt;, 108 km/h",
    ]
    named = client.json("compare/plots/histories.json", run=runs, channel="mid-span 1/displacement")
    assert named["data"][0]["meta"]["channel"] == "mid-span 1/displacement"
    table = client.get("/api/v1/compare/plots/envelope.csv", params={"run": runs})
    head = next(csv.reader(io.StringIO(table.text)))
    assert head[1] == "'=one <b>, 72 km/h [mm]"


@pytest.mark.parametrize(
    ("path", "pointer"),
    [
        ("displacement.json?variant=raw", "variant"),
        ("point-displacement.json", "place"),
        ("point-displacement.json?place=here", "place"),
        ("displacement.json?theme=blue", "theme"),
        ("displacement.json?points=1", "points"),
        ("displacement.json?channels=none", "channels"),
        ("displacement.xlsx", "file_format"),
    ],
)
def test_what_cannot_be_drawn_is_pointed_at(
    swept: tuple[Client, dict[str, Any]], path: str, pointer: str
) -> None:
    answer = swept[0].get(f"/api/v1/{run_of(swept)}/plots/{path}")
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["errors"][0]["pointer"] == pointer


@pytest.mark.parametrize(
    "path",
    [
        "jobs/none/plots/speed-sweep.json",
        "jobs/{job}/plots/displacement.json",
        "compare/plots/histories.json?run=none",
        "compare/plots/none.json?run={run}",
        "runs/none/plots",
        "runs/{run}/plots/none.json",
    ],
)
def test_figures_that_do_not_exist_are_problems(
    swept: tuple[Client, dict[str, Any]], path: str
) -> None:
    client, job = swept
    filled = path.format(job=job["id"], run=job["runs"][0]["id"])
    answer = client.get(f"/api/v1/{filled}")
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"


def test_a_run_without_a_step_has_no_figures_yet(tmp_path: Path) -> None:
    with serving(settings_for(tmp_path), compute=lambda *_: None) as client:
        job = submit(client, short_study())
        assert client.json(f"runs/{job['runs'][0]['id']}/plots") == {"items": []}
        figure = client.json(f"jobs/{job['id']}/plots/speed-sweep.json")
        assert "still to come" in figure["summary"] or "No run" in figure["summary"]


def test_modes_have_no_sweep(tmp_path: Path) -> None:
    """A shape has no speed: 0 km/h would be a lie."""
    with serving(settings_for(tmp_path), compute=lambda *_: None) as client:
        job = submit(client, short_study(), kind="modes")
        assert client.get(f"/api/v1/jobs/{job['id']}/plots/speed-sweep.json").status_code == 404
