"""Eight tabs of one browser: they share one event stream and none freezes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

pytestmark = pytest.mark.slow

BEAM = "One sprung mass on a simple beam"


def test_eight_tabs_load_and_hear_of_a_job_started_in_one(new_page: Callable[..., Any]) -> None:
    first = new_page(viewport={"width": 900, "height": 700})
    tabs = [first, *(first.context.new_page() for _ in range(7))]
    for tab in tabs:
        # With one stream a tab the seventh would wait for ever for a free connection.
        tab.goto("/#/jobs")
        tab.get_by_role("heading", name="Jobs").first.wait_for(timeout=15_000)
    first.goto("/#/")
    first.get_by_role("button", name=f"Run {BEAM}", exact=True).click()
    first.wait_for_url("**/#/jobs/*")
    for tab in tabs[1:]:
        tab.locator("tb-job-list .tag.done").first.wait_for(timeout=60_000)


def test_the_stream_passes_on_when_its_tab_closes(new_page: Callable[..., Any]) -> None:
    first = new_page(viewport={"width": 900, "height": 700})
    first.goto("/")
    second = first.context.new_page()
    second.goto("/")
    first.close()
    second.get_by_role("button", name=f"Run {BEAM}", exact=True).click()
    second.wait_for_url("**/#/jobs/*")
    second.locator("tb-job-head .tag.done").wait_for(timeout=60_000)
