"""The library: what is kept, what is refused and where, and that a job never changes with it."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Iterator
from typing import Any

import pytest

from server.library.built_in import built_in_entries
from server.library.parts import LARGEST_PART, PARTS, read_part
from server.store import Database, LibraryFullError, NewEntry
from server.store import library as store_library
from solver import studies
from tests.server import odd_batches
from tests.server.server_case import Client, serving, settings_for, short_study, submit


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """A server whose batches end at once."""
    settings = settings_for(tmp_path_factory.mktemp("server"))
    with serving(settings, compute=odd_batches.finish) as client:
        yield client


def entry(**changes: Any) -> dict[str, Any]:
    """A train of one mass."""
    value = {"type": "sprung_masses", "name": "mine", "mass": 6000.0}
    return {"name": "My mass", "source": "scale", "confidence": "B", "value": value, **changes}


def add(client: Client, kind: str = "trains", **changes: Any) -> dict[str, Any]:
    answer = client.post(f"/api/v1/library/{kind}", json=entry(**changes))
    assert answer.status_code == 201, answer.text
    assert answer.headers["location"] == f"/api/v1/library/{kind}/{answer.json()['id']}"
    return answer.json()


def findings(client: Client, method: str, path: str, body: Any) -> dict[str, str]:
    """Pointer to reason of what was refused."""
    answer = client.request(method, f"/api/v1/library{path}", json=body)
    assert answer.status_code == 422, answer.text
    return {item["pointer"]: item["reason"] for item in answer.json()["errors"]}


def test_what_is_built_in_has_source_and_confidence_and_can_be_used(client: Client) -> None:
    items = client.json("library")["items"]
    built_in = [item for item in items if item["built_in"]]
    assert {item["kind"] for item in built_in} == set(PARTS)
    for item in built_in:
        assert item["source"], item["id"]
        assert item["confidence"], item["id"]
        value, wrong = read_part(item["kind"], item["value"])
        assert (value, wrong) == (item["value"], [])
        for remark in item["remarks"]:
            place: Any = item["value"]
            for key in remark["pointer"].split("/")[1:]:
                place = place[key]  # It speaks of a figure that is there.
    ids = [(item.kind, item.id) for item in built_in_entries()]
    assert len(set(ids)) == len(ids)


def test_the_built_in_parts_are_those_of_the_templates(client: Client) -> None:
    study = studies.to_json(studies.template("khst-alverca").study)
    for kind, name in (("trains", "khst"), ("viaducts", "alverca"), ("tracks", "ballasted-60e1")):
        assert client.json(f"library/{kind}/{name}")["value"] == study[PARTS[kind]]


def test_assumed_figures_are_marked(client: Client) -> None:
    remarks = client.json("library/trains/khst")["remarks"]
    assumed = {item["pointer"] for item in remarks if item["confidence"] == "assumed"}
    assert {"/damper_heights/upper", "/damper_heights/lower", "/roll_coupling"} <= assumed


def test_an_entry_is_kept_changed_and_forgotten(client: Client) -> None:
    made = add(client)
    assert made["value"]["stiffness"] == 1.595e6  # What was left out has its default.
    assert client.json(f"library/trains/{made['id']}") == made
    changed = entry(name="Mine, heavier", value={"type": "sprung_masses", "mass": 7000.0})
    answer = client.put(f"/api/v1/library/trains/{made['id']}", json=changed)
    assert answer.status_code == 200
    assert answer.json()["value"]["mass"] == 7000.0
    assert answer.json()["created"] == made["created"]
    assert answer.json()["changed"] > made["changed"]
    listed = client.json("library/trains")["items"]
    assert [item["name"] for item in listed if not item["built_in"]][-1] == "Mine, heavier"
    assert client.get(f"/api/v1/library/tracks/{made['id']}").status_code == 404
    assert client.delete(f"/api/v1/library/trains/{made['id']}").status_code == 204
    for method in ("GET", "PUT", "DELETE"):
        gone = client.request(method, f"/api/v1/library/trains/{made['id']}", json=entry())
        assert gone.status_code == 404


def test_what_is_built_in_stays(client: Client) -> None:
    for method in ("PUT", "DELETE"):
        answer = client.request(method, "/api/v1/library/trains/khst", json=entry())
        assert answer.status_code == 409
        assert "Clone it" in answer.json()["detail"]


def test_a_job_does_not_change_with_the_library(client: Client) -> None:
    made = add(client)
    job = submit(client, short_study(train=made["value"]))
    before = client.json(f"jobs/{job['id']}/study")
    assert before["train"]["mass"] == 6000.0
    heavier = entry(value={"type": "sprung_masses", "mass": 9000.0})
    assert client.put(f"/api/v1/library/trains/{made['id']}", json=heavier).status_code == 200
    assert client.json(f"jobs/{job['id']}/study") == before
    assert client.delete(f"/api/v1/library/trains/{made['id']}").status_code == 204
    assert client.json(f"jobs/{job['id']}/study") == before


def test_bad_values_are_refused_at_their_place(client: Client) -> None:
    khst = client.json("library/trains/khst")["value"]
    wrong = copy.deepcopy(khst)
    wrong["vehicle_types"][1]["bogie_mass"] = -1.0
    wrong["wheels"] = 4
    found = findings(client, "POST", "/trains", entry(value=wrong))
    assert found["/value/vehicle_types/1/bogie_mass"] == "must be greater than 0.0"
    assert found["/value/wheels"] == "is not a field here"
    wrong = copy.deepcopy(khst)
    wrong["consist"][3] = "locomotive"
    found = findings(client, "POST", "/trains", entry(value=wrong))
    assert found == {"/value/consist/3": "no vehicle type has this name"}
    viaduct = {**client.json("library/viaducts/alverca")["value"], "web_position": 3.0}
    assert "/value/web_position" in findings(client, "POST", "/viaducts", entry(value=viaduct))
    assert "/value/type" in findings(client, "POST", "/tracks", entry(value={"type": "slab"}))
    assert "/value" in findings(client, "POST", "/irregularities", entry(value=[1]))
    assert "/value" in findings(client, "POST", "/irregularities", entry(value=None))
    assert "/name" in findings(client, "POST", "/trains", entry(name=""))
    assert "/colour" in findings(client, "POST", "/trains", entry(colour="red"))
    assert "/remarks/0/pointer" in findings(
        client, "POST", "/trains", entry(remarks=[{"pointer": "x", "confidence": "", "text": ""}])
    )
    made = add(client)
    short = entry(value={"type": "sprung_masses", "count": 0})
    assert "/value/count" in findings(client, "PUT", f"/trains/{made['id']}", short)
    assert client.json(f"library/trains/{made['id']}") == made
    assert client.get("/api/v1/library/boats").status_code == 422


def test_malformed_and_large_bodies_are_refused(client: Client) -> None:
    headers = {"content-type": "application/json"}
    for body in (b"{", b'{"name": "a", "value": {"mass": NaN}}', b'{"a": 1, "a": 2}'):
        answer = client.post("/api/v1/library/trains", content=body, headers=headers)
        assert answer.status_code == 400, body
    long = {"type": "sprung_masses", "name": "x" * (LARGEST_PART + 1)}
    assert "is larger than" in findings(client, "POST", "/trains", entry(value=long))["/value"]


def test_an_export_can_be_imported_again(client: Client) -> None:
    made = add(client, name="Exported")
    exported = client.get("/api/v1/library").json()
    again = client.post("/api/v1/library", json=exported)
    assert again.status_code == 201
    assert again.json()["items"] == []
    assert set(again.json()["skipped"]) >= {"Exported", "Perfect rails"}
    assert client.delete(f"/api/v1/library/trains/{made['id']}").status_code == 204
    answer = client.post("/api/v1/library", json={"items": [made]}).json()
    [back] = answer["items"]
    assert back["id"] != made["id"]
    assert {**back, "id": "", "created": "", "changed": ""} == {
        **made,
        "id": "",
        "created": "",
        "changed": "",
    }


def test_an_import_keeps_what_comes_twice_once(client: Client) -> None:
    twice = [{"kind": "trains", **entry(name="Twice")}] * 2
    answer = client.post("/api/v1/library", json={"items": twice}).json()
    assert [item["name"] for item in answer["items"]] == ["Twice"]
    assert answer["skipped"] == ["Twice"]


def test_a_name_is_more_than_blanks(client: Client) -> None:
    assert "/name" in findings(client, "POST", "/trains", entry(name="   "))
    assert add(client, name="  Mine ")["name"] == "Mine"


def test_an_import_takes_all_or_nothing(client: Client) -> None:
    before = client.json("library")
    good = {"kind": "trains", **entry(name="Good")}
    bad = {"kind": "tracks", **entry(value={"type": "ballasted", "ballast_depth": 9.0})}
    found = findings(client, "POST", "", {"items": [good, bad]})
    assert found == {"/items/1/value/ballast_depth": "must be at most 2.0"}
    assert client.json("library") == before
    assert "/items" in findings(client, "POST", "", {"items": [good] * 201})
    assert "/items/0/kind" in findings(client, "POST", "", {"items": [{**good, "kind": "boats"}]})


def test_the_library_is_bounded(migrated_url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store_library, "MOST_ENTRIES", 2)
    database = Database(migrated_url)
    new = NewEntry(
        kind="trains", name="a\0b", source="", confidence="", remarks=(), value={"type": "x"}
    )
    with pytest.raises(LibraryFullError):
        database.add_library_entries([new, new, new])
    assert database.library_entries() == []
    [first, _] = database.add_library_entries([new, new])
    assert first.name == "a\N{REPLACEMENT CHARACTER}b"
    with pytest.raises(LibraryFullError, match="2 entries"):
        database.add_library_entries([new])
    # Nor may a few large ones make the list of all too long for an answer.
    large = dataclasses.replace(new, value={"type": "x" * 1000})
    monkeypatch.setattr(store_library, "LARGEST_LIBRARY", 1000)
    with pytest.raises(LibraryFullError, match="MiB"):
        database.change_library_entry(first.id, large)
    monkeypatch.setattr(store_library, "MOST_ENTRIES", 3)
    with pytest.raises(LibraryFullError, match="MiB"):
        database.add_library_entries([large])
    assert [item.value for item in database.library_entries()] == [{"type": "x"}] * 2
    assert database.library_entry("tracks", first.id) is None
    assert database.delete_library_entry("trains", first.id)
    assert not database.delete_library_entry("trains", first.id)
    database.close()
