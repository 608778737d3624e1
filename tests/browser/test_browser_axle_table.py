"""A table of axles in Chromium: chosen, pasted from a spreadsheet, drawn, run, looked at, kept."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from tests.browser.spreadsheet import PASTE
from tests.browser.waiting import DONE_MS, still, until

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect

BEAM = "/#/study/sprung-mass-beam"
READY = "Checked: ready to run."
SHEET = "x\tP\n[m]\t[kN]\n0,0\t170,5\n2,5\t170,5\n17,5\t165\n20,0\t165,25\n"
"""Two columns as a spreadsheet of the Continent copies them, names and units above."""


def _cell(page: Any, row: int, column: str) -> Any:
    return page.locator(f"[data-cell='/train/axles/{row}/{column}']")


def _choose_a_table(page: Any) -> None:
    page.goto(BEAM)
    page.get_by_text(READY).wait_for(timeout=DONE_MS)
    page.get_by_role("radio", name="Table of axles").check()
    _cell(page, 0, "position").wait_for()


def _paste(page: Any, text: str) -> None:
    _cell(page, 0, "position").evaluate(PASTE, text)


def test_a_table_is_pasted_drawn_run_and_looked_at(
    page: Any, server: str, picture: Callable[[Any, str], None]
) -> None:
    _choose_a_table(page)
    _paste(page, SHEET)
    expect(_cell(page, 3, "load")).to_have_value("165.25")
    expect(_cell(page, 1, "position")).to_have_value("2.5")
    expect(_cell(page, 4, "load")).to_have_count(0)
    page.get_by_role("img", name="spans of 25 m; 4 axles").wait_for()
    expect(page.locator("tb-elevation .train .mass")).to_have_count(4)
    page.get_by_text(READY).wait_for(timeout=DONE_MS)
    name = page.locator("tb-field[data-pointer='/name'] input")
    name.fill("Four axles of a spreadsheet")
    page.get_by_text(READY).wait_for(timeout=DONE_MS)
    still(page)
    picture(page, "axle-table-editor")
    page.get_by_role("button", name="Run", exact=True).click()
    page.wait_for_url("**/#/jobs/*")
    job = page.url.rsplit("/", 1)[1].split("?")[0]
    api = f"{server}/api/v1/jobs/{job}"
    state = until(
        lambda: page.request.get(api).json()["state"],
        "the end of the job",
        page=page,
        met=lambda now: now in ("done", "failed", "timed_out", "cancelled"),
        seconds=DONE_MS / 1000,
    )
    assert state == "done"
    study = page.request.get(f"{api}/study").json()
    assert [axle["load"] for axle in study["train"]["axles"]] == [170500, 170500, 165000, 165250]
    page.get_by_role("heading", name="Four axles of a spreadsheet").wait_for()
    page.get_by_text("Wheel 01: between", exact=False).first.wait_for(timeout=DONE_MS)
    still(page)
    picture(page, "axle-table-job")
    # A mass of a table is no carbody: nothing is said of passengers.
    run = page.request.get(api).json()["runs"][0]["id"]
    summary = page.request.get(f"{server}/api/v1/runs/{run}").json()
    assert "comfort" not in json.dumps(summary.get("verdicts", [])).lower()
    page.get_by_role("tab", name="Vehicle").click()
    page.get_by_role("heading", name="Vertical acceleration of the masses").wait_for()
    expect(page.locator("tb-comfort-table")).to_have_count(0)
    still(page)
    picture(page, "axle-table-vehicle")


def test_rows_out_of_order_are_named_at_their_cells(page: Any) -> None:
    _choose_a_table(page)
    _paste(page, "0;170\n17,5;165\n2,5;170\n")
    table = page.locator("tb-table[data-pointer='/train/axles']")
    expect(table).to_contain_text("is not behind the axle of row 2, which stands at 17.5 m")
    expect(_cell(page, 2, "position")).to_have_attribute("aria-invalid", "true")
    expect(_cell(page, 1, "position")).to_have_attribute("aria-invalid", "false")
    expect(page.get_by_role("button", name="Run", exact=True)).to_be_disabled()
    _cell(page, 2, "position").fill("20")
    page.get_by_text(READY).wait_for(timeout=DONE_MS)


def test_a_universal_train_is_taken_from_the_library_and_cloned(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    page.goto("/#/library/trains/hslm-a1")
    drawing = page.get_by_role("img", name="50 axles over 397.525 m")
    drawing.wait_for()
    expect(drawing.locator(".axle-load text").first).to_have_text("170")
    still(page)
    picture(page, "axle-table-hslm")
    page.get_by_role("button", name="Clone").click()
    page.get_by_label("Name", exact=True).first.fill("HSLM-A1, shorter")
    _cell(page, 49, "position").wait_for()
    page.get_by_role("button", name="Remove the last of Axles").click()
    page.get_by_role("img", name="49 axles over 394.525 m").wait_for()
    page.get_by_role("button", name="Save").click()
    page.get_by_role("heading", name="HSLM-A1, shorter").wait_for()
    page.goto("/#/study/khst-alverca")
    page.get_by_text(READY).wait_for(timeout=DONE_MS)
    page.get_by_label("Train from the library").select_option(label="HSLM-A1, shorter")
    page.get_by_role("img", name="49 axles").wait_for()
    page.get_by_text(READY).wait_for(timeout=DONE_MS)
    expect(page.get_by_text("Regular distance d of the train's axle groups")).to_be_visible()
