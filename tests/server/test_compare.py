"""Runs side by side: what differs, how much results changed, and runs of different kinds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from server.reports.comparison import Outcome
from server.reports.inputs import differences, inputs, nearest_template
from solver import studies
from solver.units import Units
from tests.server.server_case import Client, ended, serving, settings_for, short_study, submit

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """A server that computes."""
    with serving(settings_for(tmp_path_factory.mktemp("server"))) as client:
        yield client


@pytest.fixture(scope="module")
def runs(client: Client) -> list[str]:
    """A run, the same at another speed with another mass, and a modal analysis."""
    other = short_study(sweep={"speeds": [20.0, 35.0]}, name="Another")
    other["train"]["mass"] = 8000.0
    jobs = [submit(client, short_study()), submit(client, other)]
    jobs.append(submit(client, short_study(), kind="modes"))
    done = [ended(client, job["id"]) for job in jobs]
    assert [job["state"] for job in done] == ["done"] * 3, done
    return [run["id"] for job in done for run in job["runs"]]


def compared(client: Client, names: list[str]) -> dict[str, Any]:
    answer = client.get("/api/v1/compare", params={"run": names})
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_inputs_that_differ_and_no_others(client: Client, runs: list[str]) -> None:
    found = compared(client, runs[:3])
    assert [run["id"] for run in found["runs"]] == runs[:3]
    differ = {item["pointer"]: item for item in found["inputs"]}
    # Names are no inputs, and each run of a sweep has its own speed alone.
    assert set(differ) == {"/train/mass", "/sweep/speeds"}
    assert differ["/train/mass"]["values"] == [5750.0, 8000.0, 8000.0]
    assert differ["/train/mass"]["unit"] == {"symbol": "kg", "display": "t", "scale": 0.001}
    assert differ["/sweep/speeds"]["values"][1:] == [[20.0], [35.0]]
    assert found["remarks"] == []


def test_results_change_against_the_first_run(client: Client, runs: list[str]) -> None:
    name = "mid-span 1, displacement, least"
    for order in (runs[:2], runs[1::-1]):
        found = {item["name"]: item for item in compared(client, order)["results"]}[name]
        first, second = found["values"]
        assert first < 0.0
        assert found["unit"]["display"] == "mm"
        assert found["changes"][0] == 0.0
        assert found["changes"][1] == pytest.approx(second / first - 1.0)
        assert all(remark.startswith("t = ") for remark in found["remarks"])
    heavier = compared(client, runs[:2])["channels"]
    assert {"mid-span 1/displacement", "wheel 01/contact force"} <= {c["name"] for c in heavier}


def test_runs_of_different_kinds_are_said_to_be_so(client: Client, runs: list[str]) -> None:
    found = compared(client, [runs[0], runs[3]])
    assert any("modal" in remark for remark in found["remarks"])
    assert [run["kind"] for run in found["runs"]] == ["crossing", "modes"]
    assert [run["has_histories"] for run in found["runs"]] == [True, False]
    modes = {item["name"]: item for item in found["results"] if item["group"] == "modes"}
    assert modes["mode 1"]["values"][0] is None
    assert modes["mode 1"]["values"][1] > 0.0
    assert modes["mode 1"]["changes"] == [None, None]


def test_a_run_is_put_beside_others_once(client: Client, runs: list[str]) -> None:
    assert len(compared(client, [runs[0], runs[0]])["runs"]) == 1
    assert client.get("/api/v1/compare").status_code == 422
    assert client.get("/api/v1/compare", params={"run": ["x"] * 13}).status_code == 422
    assert client.get("/api/v1/compare", params={"run": [runs[0], "none"]}).status_code == 404
    assert client.get("/api/v1/compare", params={"run": ["\0"]}).status_code == 404


def test_a_change_of_equal_signs_is_one_of_size() -> None:
    def change(*values: float | None) -> tuple[float | None, ...]:
        return Outcome(
            name="", group="", unit=Units.length, values=values, remarks=("",) * len(values)
        ).changes

    assert change(-2.0, -3.0, 1.0, None) == (0.0, 0.5, 1.5, None)
    assert change(0.0, 1.0) == (None, None)
    assert change(None, 1.0) == (None, None)


def test_every_leaf_of_a_study_is_an_input() -> None:
    """A field of the solver that the walk missed would be missing in every report."""
    study = studies.template("khst-alverca").study

    def leaves(value: Any, path: str) -> Iterator[str]:
        if isinstance(value, dict):
            for key, item in value.items():
                yield from leaves(item, f"{path}/{key}")
        elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
            for index, item in enumerate(value):
                yield from leaves(item, f"{path}/{index}")
        else:
            yield path

    assert set(inputs(study)) == set(leaves(studies.to_json(study), ""))
    assert inputs(study)["/sweep/speeds"].unit == Units.speed
    assert inputs(study)["/integration/alpha"].unit is None


def test_the_nearest_template_is_found() -> None:
    for name, template in studies.templates().items():
        found = nearest_template(template.study, template.kind)
        assert found is not None
        assert found[1] == [], name
        assert found[0].study.name == template.study.name
    beam = studies.template("sprung-mass-beam").study
    assert nearest_template(beam, "modes") is None or differences([beam, beam]) == []
