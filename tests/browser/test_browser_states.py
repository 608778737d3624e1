"""Every state of every page has a face, drawn from recorded answers: nothing computes."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

import pytest

from tests.browser.recorded import LOG, SILENT_STREAM, answer, job_address, play
from tests.browser.waiting import still, until

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect

WORDS = {
    "queued": ("Queued", ["Waiting for a free process"]),
    "running": ("Running", ["25 %", "step 900 of 3"]),
    "failed": (
        "Failed",
        ["the contact search did not settle at t = 1.25 s", "Try a shorter time step"],
    ),
    "cancelled": ("Cancelled", ["This job was cancelled.", "Partial"]),
    "timed_out": ("Out of time", ["longer than is allowed here", "0.3 s"]),
    "out_of_memory": ("Out of memory", ["The run took 300 MB, the limit is 250 MB."]),
    "done": ("Done", ["Not judged: a plain beam is no ballasted deck"]),
    "judged": ("Done", ["Exceeds the limit at 432 km/h", "3.5 m/s²", "EN 1990"]),
    "sweep": ("Done", ["3 speeds, 72 to 108 km/h"]),
    "modes": ("Done", ["Natural modes", "bending, 1 half wave"]),
}
"""Of each job: its tag, and words that must be read without any click."""
LISTEN = """() => {
  window.said = [];
  const note = () => window.said.push(document.querySelector("tb-connection").textContent);
  new MutationObserver(note).observe(document.body, { childList: true, subtree: true });
}"""
"""Keeps what the page says of its connection: some of it stays for four seconds only."""


@pytest.mark.parametrize("state", WORDS)
def test_a_jobs_state_is_told_in_words(
    page: Any, picture: Callable[[Any, str], None], state: str
) -> None:
    tag, words = WORDS[state]
    play(page)
    page.goto(job_address(state))
    expect(page.locator("main .tag").first).to_have_text(tag)
    for text in words:
        expect(page.locator("main")).to_contain_text(text)
    still(page)
    picture(page, f"state-{state}")


@pytest.mark.parametrize("state", ["queued", "running"])
def test_a_live_job_can_be_cancelled_and_an_ended_one_not(page: Any, state: str) -> None:
    play(page)
    page.goto(job_address(state))
    page.get_by_role("button", name="Cancel", exact=True).wait_for()
    page.goto(job_address("failed"))
    page.get_by_role("button", name="Retry", exact=False).wait_for()
    still(page)
    assert page.get_by_role("button", name="Cancel", exact=True).count() == 0


def test_a_failed_job_shows_its_log(page: Any) -> None:
    play(page)
    page.goto(job_address("failed"))
    page.get_by_role("tab", name="Log").click()
    expect(page.get_by_role("tabpanel")).to_contain_text(LOG.split("  ")[-1].strip())


def test_a_job_that_ends_while_one_looks_changes_its_face(page: Any) -> None:
    play(page)
    page.goto(job_address("running"))
    expect(page.locator("main .tag").first).to_have_text("Running")
    ended = {**answer("job-failed"), "id": "jobRunning"}
    page.evaluate(
        """(job) => window.streams.forEach((stream) => stream.dispatchEvent(
            new MessageEvent("job", { data: JSON.stringify(job) })))""",
        ended,
    )
    expect(page.locator("main .tag").first).to_have_text("Failed")
    expect(page.locator("main")).to_contain_text("the contact search did not settle")


def test_a_job_that_is_not_there_leads_on(page: Any, picture: Callable[[Any, str], None]) -> None:
    play(page)
    page.goto("/#/jobs/0000000000000000")
    page.get_by_text("There is no such job here.", exact=False).wait_for()
    page.get_by_role("link", name="Jobs").first.wait_for()
    picture(page, "state-unknown")


def test_an_empty_server_invites(page: Any, picture: Callable[[Any, str], None]) -> None:
    empty = {"items": [], "next": None}
    play(page, changes={"/jobs": empty})
    for name, address in (("home", "/#/"), ("jobs", "/#/jobs"), ("compare", "/#/compare")):
        page.goto(address)
        page.locator("main .empty").first.wait_for()
        assert page.locator("main a, main button").count() > 0
        picture(page, f"empty-{name}")


def test_a_server_that_does_not_answer_is_named(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    play(page, changes={"/jobs": None, "/templates": None}, stream=SILENT_STREAM)
    page.goto("/")
    page.get_by_text("The server does not answer.", exact=False).first.wait_for()
    page.get_by_text("No connection to the server.").wait_for()
    picture(page, "state-disconnected")


def test_a_page_outlives_its_server_and_resumes_by_itself(
    page: Any, another_server: Callable[[], AbstractContextManager[str]]
) -> None:
    lost = page.get_by_text("No connection to the server.")
    with another_server() as address:
        page.goto(f"{address}/#/jobs")
        page.locator("main .empty").wait_for()
        assert not lost.is_visible()
    lost.wait_for()
    page.evaluate(LISTEN)
    with another_server() as address:
        until(
            lambda: page.evaluate("window.said"),
            "the page says that it is connected again",
            page=page,
            met=lambda said: "Connected again." in said,
        )
        study = page.request.get(f"{address}/api/v1/templates/sprung-mass-beam").json()
        job = {"study": {**study, "name": "After the pause"}}
        assert page.request.post(f"{address}/api/v1/jobs", data=job).status == 202
        # Told by the event stream, without a reload.
        page.get_by_text("After the pause").first.wait_for()
        page.get_by_text("Connected again.").wait_for(state="detached")


def test_code_that_does_not_arrive_leaves_a_page_that_says_so(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    page.route("**/static/js/pages/jobs-page.js", lambda route: route.abort())
    page.goto("/#/jobs")
    page.get_by_role("heading", name="This page could not be opened").wait_for()
    page.unroute("**/static/js/pages/jobs-page.js")
    page.get_by_role("button", name="Try again").click()
    page.get_by_role("heading", name="Jobs").first.wait_for()
    page.goto("/#/nowhere")
    page.get_by_role("heading", name="There is no such page").wait_for()
    picture(page, "state-no-such-page")
