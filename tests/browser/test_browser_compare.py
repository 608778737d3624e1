"""Comparison and report in Chromium: baseline, picker, address, curves; preview and files."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest

from tests.browser.waiting import DONE_MS, PAGE_MS, until

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect

PREVIEW_MS = 3 * PAGE_MS
"""All figures of a report are drawn on the server first. [ms]"""


def _done(page: Any, server: str, **changes: Any) -> dict[str, Any]:
    """A finished job of the beam, with some inputs changed."""
    study = page.request.get(f"{server}/api/v1/templates/sprung-mass-beam").json()
    study["integration"]["time_step"] = 1e-3
    study["train"]["mass"] = changes.pop("mass", study["train"]["mass"])
    study |= changes
    made = page.request.post(f"{server}/api/v1/jobs", data={"study": study}).json()

    def look() -> dict[str, Any]:
        job = page.request.get(f"{server}/api/v1/jobs/{made['id']}").json()
        assert job["state"] in ("queued", "running", "done"), job
        return dict(job)

    return until(
        look,
        f"the end of the job {study['name']}",
        page=page,
        met=lambda job: job["state"] == "done",
        seconds=DONE_MS / 1e3,
    )


def test_runs_stand_side_by_side(
    page: Any, server: str, picture: Callable[[Any, str], None]
) -> None:
    light = _done(page, server, name="Light mass")["runs"][0]["id"]
    heavy = _done(page, server, name="Heavy mass", mass=8000.0)["runs"][0]["id"]
    page.goto(f"/#/compare?runs={light},{heavy}")
    inputs = page.get_by_role("region", name="Inputs that differ").get_by_role("table")
    expect(inputs.get_by_role("row").nth(1)).to_contain_text("Train")
    expect(inputs.get_by_role("row").nth(1)).to_contain_text("5.75 t")
    expect(inputs.get_by_role("row").nth(1)).to_contain_text("8 t")
    expect(inputs.get_by_role("row")).to_have_count(2)
    deck = page.get_by_role("region", name="Deck").get_by_role("row")
    sag = deck.filter(has_text="Mid-span 1, displacement, least")
    expect(sag.locator(".change")).to_have_count(1)
    # The heavier mass sinks deeper.
    expect(sag.locator(".change")).to_have_text(re.compile(r"^\+"))
    page.locator("tb-chart[data-figure=histories] .trace").nth(1).wait_for()
    page.locator("tb-chart[data-figure=envelope] .trace").nth(1).wait_for()
    picture(page, "compare")
    # The baseline is pinned: the first column, and every change is against it.
    page.get_by_role("radio", name="Baseline: Heavy mass").check()
    expect(page).to_have_url(re.compile("base="))
    expect(page.locator(".compare-runs li").first).to_contain_text("Heavy mass")
    expect(sag.locator(".change")).to_contain_text("−")
    page.get_by_label("History", exact=True).select_option("wheel 01/contact force")
    chart = page.locator("tb-chart[data-figure=histories]")
    expect(chart.get_by_role("heading")).to_contain_text("ontact force")
    expect(page).to_have_url(re.compile("channel=wheel"))
    # A shared link shows the same.
    page.reload()
    expect(page.locator(".compare-runs li").first).to_contain_text("Heavy mass")
    expect(chart.get_by_role("heading")).to_contain_text("ontact force")


def test_runs_are_added_and_removed(page: Any, server: str) -> None:
    job = _done(page, server, name="Two speeds", sweep={"speeds": [20.0, 30.0]})
    page.goto("/#/compare")
    page.get_by_text("No run is chosen yet").wait_for()
    page.get_by_label("Find").fill("Two speeds")
    found = page.locator(".compare-found li")
    expect(found).to_have_count(2)
    found.first.get_by_role("button", name="Add").click()
    page.get_by_text("One run alone").wait_for()
    expect(found).to_have_count(1)
    found.first.get_by_role("button", name="Add").click()
    expect(page.locator(".compare-runs li")).to_have_count(2)
    for run in job["runs"]:
        expect(page).to_have_url(re.compile(run["id"]))
    # Runs of one job are told apart by their speeds.
    expect(page.locator(".compare-name")).to_have_text(["72 km/h", "108 km/h"])
    page.get_by_role("button", name="Remove 72 km/h").click()
    expect(page.locator(".compare-runs li")).to_have_count(1)
    page.goto("/#/compare?runs=0000000000000000")
    page.get_by_text("There is no run").wait_for()


def test_the_report_is_previewed_and_saved(
    page: Any, server: str, picture: Callable[[Any, str], None]
) -> None:
    job = _done(page, server, name="For the file")
    page.goto(f"/#/report/{job['id']}")
    project = page.get_by_label("Project")
    expect(project).to_have_value("For the file")
    paper = page.frame_locator("iframe.report-preview")
    paper.get_by_role("heading", name="1. Result").wait_for(timeout=PREVIEW_MS)
    figure = paper.get_by_role("img").first
    until(lambda: figure.evaluate("img => img.naturalWidth") > 100, "a figure", page=page)
    page.get_by_label("Author").fill("E. <b>Engineer</b>")
    paper.get_by_text("E. <b>Engineer</b>").wait_for(timeout=PREVIEW_MS)
    expect(page).to_have_url(re.compile("author="))
    picture(page, "report")
    for name, magic in (("Download PDF", b"%PDF"), ("Download HTML", b"<!doctype html>")):
        with page.expect_download(timeout=PREVIEW_MS) as download:
            page.get_by_role("link", name=name).click()
        content = download.value.path().read_bytes()
        assert content.startswith(magic)
        assert download.value.suggested_filename.startswith("report-for-the-file")
    # The saved file stands alone: its figures are in it, and it asks nobody for anything.
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.set_content(content.decode())
    page.get_by_role("heading", name="1. Result").wait_for()
    assert [url for url in asked if not url.startswith(("data:", "about:"))] == []


def test_a_job_without_results_has_no_report(page: Any, server: str) -> None:
    study = page.request.get(f"{server}/api/v1/templates/sprung-mass-beam").json()
    study["integration"]["time_step"] = 1e-6
    job = page.request.post(f"{server}/api/v1/jobs", data={"study": study}).json()
    page.request.post(f"{server}/api/v1/jobs/{job['id']}/cancel")
    page.goto(f"/#/report/{job['id']}")
    page.get_by_text("nothing to report yet").wait_for()
    page.get_by_role("link", name="Watch the job").wait_for()
