"""A measured profile in Chromium: pasted from a spreadsheet, mended, drawn, run to its end."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from tests.browser.spreadsheet import PASTE
from tests.browser.waiting import DONE_MS

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect

READY = "Checked: ready to run."
SAMPLES = "/irregularity/samples"


def _height(place: float) -> float:
    """Of the pasted profile, as its cells have it. [mm]"""
    return round(3.0 * math.sin(math.pi * place / 25.0) ** 2 * math.cos(1.3 * place), 3)


def _block(count: int, spacing: float) -> str:
    """Cells as a spreadsheet with decimal commas puts them on the clipboard, with headings."""
    lines = ["x (m)\tleft (mm)\tright (mm)"]
    for index in range(count):
        place = spacing * index
        cells = (f"{place:.2f}", f"{_height(place):.3f}", f"{_height(place):.3f}")
        lines.append("\t".join(cells).replace(".", ","))
    return "\r\n".join(lines) + "\r\n"


def _cell(page: Any, row: int, column: str) -> Any:
    return page.locator(f"[data-cell='{SAMPLES}/{row}/{column}']")


def _choose(page: Any, study: str) -> Any:
    """The editor with the kind of irregularity chosen; gives the table."""
    page.goto(f"/#/study/{study}")
    page.get_by_text(READY).wait_for()
    page.get_by_role("radio", name="Measured profile").check()
    table = page.locator(f"tb-table[data-pointer='{SAMPLES}']")
    table.get_by_text("Are all zero: the rails are perfect", exact=False).wait_for()
    return table


@pytest.mark.timeout(600)
def test_a_profile_is_pasted_mended_drawn_and_run(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    table = _choose(page, "sprung-mass-beam")
    _cell(page, 0, "position").evaluate(PASTE, _block(60, 0.4))
    expect(table.locator("tbody tr")).to_have_count(60)
    expect(_cell(page, 59, "position")).to_have_value("23.6")
    expect(_cell(page, 31, "left")).to_have_value(f"{_height(12.4):g}")
    # The mass would stand on the way up to the profile: said at the cell, with the way out.
    message = table.locator(".field-message")
    expect(message).to_contain_text("before the train's start")
    expect(message).to_contain_text("lengthen the run-in to 10 m")
    expect(_cell(page, 0, "position")).to_have_attribute("aria-invalid", "true")
    page.locator("tb-field[data-pointer='/extent/run_in'] input").fill("10")
    page.get_by_text(READY).wait_for()
    _cell(page, 7, "position").fill("2,4")
    expect(message).to_contain_text("Position, 8: does not follow the 2.4 m of row 7")
    expect(_cell(page, 7, "position")).to_have_attribute("aria-invalid", "true")
    expect(_cell(page, 6, "position")).to_have_attribute("aria-invalid", "false")
    expect(page.get_by_role("button", name="Run", exact=True)).to_be_disabled()
    _cell(page, 7, "position").fill("2,8")
    page.get_by_text(READY).wait_for()
    drawing = page.locator("tb-study-drawing")
    expect(drawing.locator("tb-elevation .stretch path").first).to_be_visible()
    expect(drawing.locator("tb-library-profile")).to_contain_text(
        "60 samples from x = 0 to 23.6 m, at most"
    )
    picture(page, "study-profile")
    page.get_by_role("button", name="Run", exact=True).click()
    page.wait_for_url("**/#/jobs/*")
    told = page.get_by_text("measured profile of 60 samples, x = 0.0 to 23.6 m").first
    told.wait_for(timeout=DONE_MS)
    picture(page, "job-profile")
    page.get_by_role("tab", name="Inputs").click()
    # Sixty samples are three lines, not a hundred and eighty.
    expect(page.locator(f"tb-job-inputs [data-pointer^='{SAMPLES}']")).to_have_count(3)
    expect(page.locator(f"[data-pointer='{SAMPLES}/position']")).to_contain_text("0:23.6:0.4")


@pytest.mark.timeout(600)
def test_the_longest_profile_is_pasted_and_a_shorter_one_takes_its_place(page: Any) -> None:
    table = _choose(page, "khst-alverca")
    _cell(page, 0, "position").evaluate(PASTE, _block(2001, 0.25))
    page.get_by_text("More than 2000 rows", exact=False).wait_for()
    expect(table.locator("tbody tr")).to_have_count(2000)
    page.get_by_text(READY).wait_for()
    _cell(page, 0, "position").evaluate(PASTE, _block(101, 0.25))
    expect(table.locator("tbody tr")).to_have_count(101)
    expect(page.locator("tb-study-drawing tb-library-profile")).to_contain_text("101 samples")
    page.get_by_text(READY).wait_for()
    page.get_by_role("button", name="Undo").click()
    expect(table.locator("tbody tr")).to_have_count(2000)
