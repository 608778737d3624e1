"""Eight tabs of one browser: they share one event stream and none freezes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.browser.waiting import DONE_MS

pytestmark = pytest.mark.slow

BEAM = "One sprung mass on a simple beam"


def test_eight_tabs_load_and_hear_of_a_job_started_in_one(new_page: Callable[..., Any]) -> None:
    first = new_page(viewport={"width": 900, "height": 700})
    tabs = [first, *(first.context.new_page() for _ in range(7))]
    for tab in tabs:
        # With one stream a tab the seventh would wait for ever for a free connection.
        tab.goto("/#/jobs")
        tab.get_by_role("heading", name="Jobs").first.wait_for()
    first.goto("/#/")
    first.get_by_role("button", name=f"Run {BEAM}", exact=True).click()
    first.wait_for_url("**/#/jobs/*")
    job = first.url.split("/jobs/")[1].split("?")[0]
    for tab in tabs[1:]:
        row = tab.locator(f"tb-job-list a[href='#/jobs/{job}']")
        row.locator(".tag.done").wait_for(timeout=DONE_MS)


def test_the_stream_passes_on_when_its_tab_closes(new_page: Callable[..., Any]) -> None:
    first = new_page(viewport={"width": 900, "height": 700})
    first.goto("/")
    second = first.context.new_page()
    second.goto("/")
    first.close()
    second.get_by_role("button", name=f"Run {BEAM}", exact=True).click()
    second.wait_for_url("**/#/jobs/*")
    second.locator("tb-job-head .tag.done").wait_for(timeout=DONE_MS)
