"""Jobs in Chromium beyond the single crossing: natural modes, sweeps, failures, the list."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from typing import Any

import pytest

from tests.browser.waiting import DONE_MS, still, until

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect


def _job(name: str, **changes: Any) -> dict[str, Any]:
    """A job as the API sends it."""
    return {
        "id": name,
        "kind": "crossing",
        "name": name.title(),
        "state": "queued",
        "progress": None,
        "created": "2024-01-01T00:00:00Z",
        "started": None,
        "ended": None,
        "error": None,
        "position": None,
        "runs": [],
        **changes,
    }


def _submitted(
    page: Any, server: str, template: str, kind: str = "crossing", **changes: Any
) -> tuple[dict[str, Any], str]:
    """A template's viaduct, and the id of a job of that template with some inputs changed."""
    study = page.request.get(f"{server}/api/v1/templates/{template}").json()
    for key, value in changes.items():
        study[key] = {**study[key], **value}
    body = {"kind": kind, "study": study}
    job = page.request.post(f"{server}/api/v1/jobs", data=body).json()
    return study["viaduct"], job["id"]


def _answer(page: Any, address: str, document: Any) -> None:
    """Has the page find a document in place of the server's."""
    page.route(f"**/api/v1/{address}", lambda route: route.fulfill(body=json.dumps(document)))


@pytest.mark.parametrize("kind", ["crossing", "modes"])
def test_a_failed_job_says_what_happened_and_what_to_try(
    page: Any, picture: Callable[[Any, str], None], kind: str
) -> None:
    error = {"title": "No convergence", "detail": "The search did not settle at t = 1 s."}
    _answer(page, "jobs/broken", _job("broken", kind=kind, state="failed", error=error))
    page.goto("/#/jobs/broken")
    page.get_by_text("The search did not settle at t = 1 s.").wait_for()
    assert page.locator("tb-chart").count() == 0
    picture(page, f"failed-{kind}")


def test_each_row_of_the_modes_chooses_the_shape_that_swings(
    page: Any, server: str, picture: Callable[[Any, str], None]
) -> None:
    beam, job = _submitted(page, server, "sprung-mass-beam", "modes")
    page.goto(f"/#/jobs/{job}")
    table = page.locator("tb-modes-table table")
    table.locator("tbody tr").nth(2).wait_for(timeout=DONE_MS)
    rigidity = beam["young_modulus"] * beam["second_moment"]
    (span,) = beam["spans"]
    for mode in (1, 2, 3):  # f = n2 pi / (2 L2) sqrt(EI / m), Euler-Bernoulli
        exact = mode**2 * math.pi / (2 * span**2) * math.sqrt(rigidity / beam["mass_per_length"])
        cells = table.locator("tbody tr").nth(mode - 1).locator("th, td").all_inner_texts()
        assert cells[0] == str(mode)
        assert float(cells[1]) == pytest.approx(exact, rel=2e-3)  # two decimals, finite elements
        assert cells[2] == "0.00"  # the template has no damping
    page.get_by_text("How it was computed").wait_for()
    page.locator("tb-viewer-frame iframe").wait_for()
    with page.expect_request(
        lambda sent: sent.method == "PUT" and '"mode":1' in (sent.post_data or "")
    ):
        page.get_by_role("button", name="Show mode 2", exact=True).click()
    expect(table.locator("tr[aria-current]")).to_contain_text("2")
    expect(page).to_have_url(re.compile("mode=2"))
    for absent in ("tb-chart", "tb-verdict-bar"):
        assert page.locator(absent).count() == 0
    picture(page, "modes-beam")


def test_a_viaducts_modes_bear_names_and_their_likeness(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    modes = [
        {"number": 1, "frequency": 6.4, "damping": 0.02, "name": "bending of span 2"}
        | {"assurance": 0.98},
        {"number": 2, "frequency": 17.0, "damping": 0.0198, "name": "", "assurance": 0.0},
    ]
    run = {"id": "r", "parameters": {}, "state": "done", "progress": None, "error": None}
    facts = {"mesh_level": "coarse", "unknowns": 20000, "assumption": "ratios are a diagonal"}
    summary = {"modes": modes, "facts": facts, "timings": {"total": 2.0}, "versions": {}}
    _answer(page, "jobs/shapes", _job("shapes", kind="modes", state="done", runs=[run]))
    _answer(page, "runs/r", {**run, "job": "shapes", "summary": summary, "verdicts": []})
    page.goto("/#/jobs/shapes")
    rows = page.locator("tb-modes-table tbody tr")
    expect(rows.nth(0)).to_have_text("16.402.00bending of span 20.980")
    expect(rows.nth(1)).to_have_text("217.001.98––")
    page.get_by_text("Ratios are a diagonal.").wait_for()
    picture(page, "modes-viaduct")


@pytest.mark.parametrize(
    ("state", "words"), [("queued", "Waiting for a free process"), ("running", "Finding the modes")]
)
def test_modes_that_are_not_there_yet_say_where_they_are(page: Any, state: str, words: str) -> None:
    progress = {"step": 0, "steps": 1, "fraction": 0.0, "stage": "finding the modes"}
    _answer(page, "jobs/shapes", _job("shapes", kind="modes", state=state, progress=progress))
    page.goto("/#/jobs/shapes")
    page.get_by_text(words).wait_for()
    assert page.get_by_text("0 %").count() == 0
    assert page.locator("tb-run-progress progress[value]").count() == 0


def test_each_run_of_a_sweep_can_be_shown_and_the_viewing_session_stays(
    page: Any, server: str, picture: Callable[[Any, str], None]
) -> None:
    _, job = _submitted(page, server, "sprung-mass-beam", sweep={"speeds": [25.0, 30.0]})
    page.goto(f"/#/jobs/{job}")
    page.locator("tb-job-head .tag.done").wait_for(timeout=DONE_MS)
    page.get_by_text("2 speeds, 90 to 108 km/h", exact=False).first.wait_for()
    view = page.locator("tb-viewer-frame")
    page.locator("tb-viewer-frame[data-session]").wait_for(timeout=DONE_MS)
    session = view.get_attribute("data-session")
    page.get_by_label("Run", exact=True).select_option(label="108 km/h")
    page.locator("tb-chart[data-figure=displacement] .trace").first.wait_for()
    expect(page.get_by_role("slider", name="Time")).to_be_enabled()
    expect(page.get_by_label("Run", exact=True).locator("option:checked")).to_have_text("108 km/h")
    runs = page.request.get(f"{server}/api/v1/jobs/{job}").json()["runs"]
    fast = next(run["id"] for run in runs if run["parameters"]["speed"] == 30.0)
    expect(page).to_have_url(re.compile(f"run={fast}"))
    until(  # The session is told beside the plots, not before them.
        lambda: page.request.get(f"{server}/api/v1/viewer/{session}").json()["run"],
        "the viewing session shows the faster run",
        page=page,
        met=lambda run: run == fast,
    )
    assert view.get_attribute("data-session") == session
    picture(page, "sweep-beam")


def test_a_point_of_the_sweep_opens_its_run(
    page: Any, server: str, picture: Callable[[Any, str], None]
) -> None:
    _, job = _submitted(page, server, "sprung-mass-beam", sweep={"speeds": [25.0, 30.0]})
    page.goto(f"/#/jobs/{job}?tab=sweep")
    page.locator("tb-job-head .tag.done").wait_for(timeout=DONE_MS)
    chart = page.locator("tb-chart[data-figure=speed-sweep]")
    chart.locator(".files a").first.wait_for()  # It is drawn, and listens.
    still(page)
    point = chart.locator(".scatterlayer .trace").first.locator(".point").last
    point.scroll_into_view_if_needed()
    box = point.bounding_box()
    place = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.move(*place)
    page.mouse.click(*place)
    expect(page).to_have_url(re.compile("run="))
    expect(page.get_by_label("Run", exact=True).locator("option:checked")).to_have_text("108 km/h")
    picture(page, "sweep-tab")


def test_of_a_sweep_the_worst_speed_is_shown_and_every_verdict_listed(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    def verdict(speed: float, value: float) -> dict[str, Any]:
        place = {"name": "slab, span 2", "x": 29.2, "y": -0.7, "z": 1.3}
        peak = {"value": value, "time": 2.5, "place": place}
        scope = {"train": "KHST", "speed": speed, "irregularity": "", "mesh_level": "coarse"}
        judgement = "exceeds" if value > 3.5 else "within the limit of"
        return {
            **peak,
            "rule": "deck acceleration",
            "clause": "EN 1990",
            "title": "deck acceleration",
            "limit": 3.5,
            "unit": "m/s2",
            "exceeds": value > 3.5,
            "speed": speed,
            "filter": "low-pass",
            "cut_off": 30.0,
            "cut_off_origin": "30 Hz",
            "statement": f"{judgement} 3.5 m/s2: {value} m/s2",
            "notes": ["Screening mesh: confirm on the standard mesh before using this value."],
            "raw": peak,
            "scope": scope,
            "points": [],
            "spans": [],
        }

    found = {"a": verdict(60.0, 1.2), "b": verdict(120.0, 9.4), "c": verdict(90.0, 3.4999)}
    runs = [
        {"id": name, "parameters": {"speed": item["speed"]}, "state": "done", "progress": None}
        for name, item in found.items()
    ]
    facts = {"mesh_accuracy": ["Measured against the standard mesh: within 10 percent."]}
    _answer(page, "jobs/sweep", _job("sweep", state="done", runs=runs))
    for run in runs:
        name = str(run["id"])
        page.route(f"**/api/v1/runs/{name}/**", lambda route: route.fulfill(status=404, body="{}"))
        _answer(page, f"runs/{name}/verdicts", {"items": [found[name]]})
        summary = {"facts": facts, "peaks": {}, "timings": {}, "versions": {}}
        document = {**run, "job": "sweep", "summary": summary, "verdicts": [found[name]]}
        _answer(page, f"runs/{name}", document)
    page.goto("/#/jobs/sweep?tab=sweep")
    page.get_by_role("heading", name="Exceeds the limit at 1 of 3 speeds computed").wait_for()
    words = page.locator("tb-verdict-bar")
    expect(words).to_contain_text("Exceeds the limit at 432 km/h (screening mesh)")
    expect(words).to_contain_text("Measured against the standard mesh: within 10 percent.")
    rows = page.locator("tb-sweep-table tbody tr")
    expect(rows.nth(1)).to_contain_text("3.4999")
    expect(rows.nth(1)).to_contain_text("within")
    rows.nth(1).get_by_role("button", name="324 km/h").click()
    expect(words).to_contain_text("Within the limit at 324 km/h")
    picture(page, "sweep")


def test_older_jobs_come_on_demand(page: Any, picture: Callable[[Any, str], None]) -> None:
    jobs = [_job(f"job {number}", state="done") for number in range(12)]

    def pages(route: Any) -> None:
        later = "cursor=7" in route.request.url
        document = {"items": jobs[6:], "next": None} if later else {"items": jobs[:6], "next": "7"}
        route.fulfill(body=json.dumps(document))

    page.route("**/api/v1/events*", lambda route: route.abort())  # would tell of real jobs
    page.route(re.compile(r"/api/v1/jobs(\?.*)?$"), pages)
    page.goto("/#/jobs")
    rows = page.locator("tb-job-list li")
    expect(rows).to_have_count(6)
    more = page.get_by_role("button", name="Show more")
    more.click()
    expect(rows).to_have_count(12)
    expect(more).to_have_count(0)
    page.goto("/#/")
    expect(rows).to_have_count(6)
    page.get_by_role("link", name="All jobs").wait_for()
