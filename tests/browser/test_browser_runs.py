"""Which run of a job is shown while answers are still on their way."""

from __future__ import annotations

import re
from typing import Any

import pytest

from tests.browser.recorded import job_address, play
from tests.browser.waiting import until

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect


def test_a_run_chosen_while_the_first_one_opens_is_shown(page: Any) -> None:
    play(page)
    held: list[Any] = []  # requests without an answer yet
    page.route("**/api/v1/runs/runSweep3/plots", lambda route: held.append(route))
    page.goto(job_address("sweep") + "?run=runSweep3")
    page.get_by_label("Run", exact=True).select_option(label="72 km/h")
    expect(page).to_have_url(re.compile("run=runSweep(&|$)"))
    until(lambda: held, "the first run to ask for its figures", page=page)
    for route in held:
        route.fallback()
    page.locator("tb-chart[data-figure=displacement] .trace").first.wait_for()
    expect(page.get_by_role("slider", name="Time")).to_be_enabled()
    expect(page.get_by_label("Run", exact=True)).to_have_value("runSweep")
