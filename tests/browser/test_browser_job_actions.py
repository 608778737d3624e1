"""What can be done with a job and with its 3D view: every button is pressed once."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

import pytest

from tests.browser.recorded import answer, job_address, play
from tests.browser.waiting import DONE_MS, drawn_again, patient, until

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect

BLIND = """
Object.defineProperty(window, "trainbridgeColours", {
  get: () => ({ ok: false, coloured: [] }), set: () => {},
});
"""
"""A page of the viewer whose own test says that it shows no colours per vertex."""


@pytest.fixture(scope="module")
def beam(server: str, chromium: Any) -> str:
    """A finished job whose deck is a surface: two spans, one sprung mass."""
    return _submitted(chromium, server, "two-span-separation")


def _submitted(chromium: Any, server: str, template: str) -> str:
    context = patient(chromium.new_context(base_url=server))
    study = context.request.get(f"/api/v1/templates/{template}").json()
    job = context.request.post("/api/v1/jobs", data={"study": study}).json()["id"]
    page = context.new_page()
    page.route("**/viewer/*/", lambda route: route.fulfill(content_type="text/html", body=""))
    page.goto(f"/#/jobs/{job}")
    page.locator("tb-job-head .tag.done").wait_for(timeout=DONE_MS)
    context.close()
    return str(job)


def _open(page: Any, job: str, query: str = "") -> str:
    """Opens a job and waits for its viewing session."""
    return _opened(page, f"/#/jobs/{job}{query}")


def _opened(page: Any, address: str) -> str:
    page.goto(address)
    view = page.locator("tb-viewer-frame[data-session]")
    view.wait_for(timeout=DONE_MS)
    expect(page.get_by_role("slider", name="Time")).to_be_enabled(timeout=DONE_MS)
    return str(view.get_attribute("data-session"))


def _shown(page: Any, session: str, server: str = "") -> dict[str, Any]:
    return dict(page.request.get(f"{server}/api/v1/viewer/{session}").json())


def test_a_cancelled_job_is_tried_again(page: Any) -> None:
    study = page.request.get("/api/v1/templates/khst-alverca").json()
    job = page.request.post("/api/v1/jobs", data={"study": study}).json()["id"]
    page.goto(f"/#/jobs/{job}")
    page.get_by_role("button", name="Cancel").click()
    page.locator("tb-job-head .tag.cancelled").wait_for(timeout=DONE_MS)
    page.get_by_role("button", name="Retry").click()
    page.get_by_role("button", name="Cancel").wait_for(timeout=DONE_MS)
    expect(page.locator("tb-job-trouble")).to_be_hidden()
    expect(page.locator("tb-run-progress")).to_be_visible()
    page.get_by_role("button", name="Cancel").click()
    page.locator("tb-job-head .tag.cancelled").wait_for(timeout=DONE_MS)


def test_a_job_is_run_again_with_the_keyboard(page: Any, beam: str) -> None:
    page.goto(f"/#/jobs/{beam}")
    menu = page.locator("tb-job-head summary[aria-label=More]")
    menu.focus()
    page.keyboard.press("Enter")
    page.get_by_role("button", name="Run again").focus()
    page.keyboard.press("Enter")
    page.get_by_role("link", name="an earlier job").wait_for(timeout=DONE_MS)
    assert beam not in page.url
    assert page.get_by_role("link", name="an earlier job").get_attribute("href") == f"#/jobs/{beam}"
    page.locator("tb-job-head .tag.done").wait_for(timeout=DONE_MS)


@pytest.mark.parametrize(("button", "priority"), [("Sooner", 1), ("Later", -1)])
def test_a_queued_job_is_moved_in_the_queue(page: Any, button: str, priority: int) -> None:
    play(page)
    asked: list[Any] = []

    def prioritise(route: Any) -> None:
        if route.request.method != "PATCH":
            return route.fallback()
        asked.append(route.request.post_data_json)
        return route.fulfill(json={**answer("job-queued"), "priority": priority})

    page.route("**/api/v1/jobs/jobQueued", prioritise)
    page.goto(job_address("queued"))
    page.get_by_role("button", name=button).click()
    page.get_by_text(f"Priority {priority}.".replace("-", "−"), exact=False).wait_for()
    assert asked == [{"priority": priority}]


def test_a_view_that_was_paused_for_another_says_so_and_resumes(
    page: Any, chromium: Any, another_server: Callable[[], AbstractContextManager[str]]
) -> None:
    # A server of its own: views that other tests left playing would be paused in place of this one.
    with another_server() as server:
        job = _submitted(chromium, server, "two-span-separation")
        session = _opened(page, f"{server}/#/jobs/{job}?t=0.1")
        run = _shown(page, session, server)["run"]
        page.get_by_label("Speed of the playback").select_option("0.01")
        page.get_by_role("button", name="Play", exact=True).click()
        page.get_by_role("button", name="Pause").wait_for()
        until(
            lambda: _shown(page, session, server)["playing"],
            "the server plays what the page plays",
            page=page,
        )
        others: list[str] = []
        for _ in range(5):  # five may stream at once: the sixth stops the one that played longest
            opened = page.request.post(f"{server}/api/v1/runs/{run}/viewer", data={}).json()
            others.append(opened["session"])
            page.request.put(
                f"{server}/api/v1/viewer/{opened['session']}",
                data={"playing": True, "rate": 0.01, "time": 0.0},
            )
        message = page.locator("tb-viewer-message")
        expect(message).to_be_visible()
        page.get_by_role("button", name="Play", exact=True).wait_for()
        message.get_by_role("button", name="Resume").click()
        page.get_by_role("button", name="Pause").wait_for()
        expect(message).to_be_hidden()
        until(
            lambda: _shown(page, session, server)["playing"],
            "the server plays again what the page plays",
            page=page,
        )
        paused = [_shown(page, other, server)["paused"] for other in others]
        assert sum(bool(reason) for reason in paused) == 1
        page.goto("about:blank")


def test_a_replay_is_saved_of_what_is_zoomed_to(page: Any, beam: str) -> None:
    _open(page, beam, "?from=0.1&to=0.2&scale=20")
    with page.expect_download(timeout=DONE_MS) as saved:
        page.get_by_role("button", name="Save replay").click()
    assert re.search(r"[?&]from=0\.1(&|$)", saved.value.url)
    assert "scale=20" in saved.value.url
    with open(saved.value.path(), encoding="utf-8") as file:
        assert "<html" in file.read(4000).lower()


def test_a_point_is_chosen_with_the_keyboard_and_a_shared_link_marks_it(
    page: Any, new_page: Callable[..., Any], beam: str
) -> None:
    _open(page, beam, "?tab=accelerations")
    page.get_by_label("x [m]").focus()
    page.keyboard.type("10")
    page.keyboard.press("Tab")
    page.keyboard.type("0")
    page.keyboard.press("Enter")
    page.locator("tb-chart[data-figure=point-displacement] .trace").first.wait_for(timeout=DONE_MS)
    expect(page).to_have_url(re.compile("place=10%2C0%2C"))
    other = new_page(viewport={"width": 1280, "height": 860})
    other.goto(page.url)
    other.locator("tb-chart[data-figure=point-displacement] .trace").first.wait_for()
    expect(other.get_by_label("x [m]")).to_have_value("10")
    for one in (page, other):
        view = one.locator("tb-viewer-frame[data-session]")
        session = str(view.get_attribute("data-session"))
        picked = until(
            lambda one=one, session=session: _shown(one, session)["picked"],
            "the viewing session marks the point",
            page=one,
        )
        assert picked["point"][0] == pytest.approx(10.0, abs=1.0)


def test_a_page_without_smooth_colours_gets_one_colour_for_each_element(
    new_page: Callable[..., Any], beam: str
) -> None:
    page = new_page(viewer=True, viewport={"width": 1280, "height": 860})
    page.add_init_script(BLIND)
    session = _open(page, beam, "?colour=displacement")
    until(
        lambda: _shown(page, session)["smooth"],
        "one colour for each element",
        page=page,
        met=lambda smooth: smooth is False,
    )


def test_a_view_that_missed_what_was_chosen_hears_it_after_the_cut(page: Any, beam: str) -> None:
    session = _open(page, beam)
    address = re.compile(r"/api/v1/viewer/")
    cut: list[str] = []

    def abort(route: Any) -> None:
        cut.append(route.request.post_data or "")
        route.abort()

    page.route(address, abort)
    page.get_by_label("Camera").select_option("side")
    page.get_by_label("Scale of the deformation").select_option("20")
    until(
        lambda: "".join(cut),
        "both choices are told to nobody",
        page=page,
        met=lambda told: '"camera":"side"' in told and '"scale":20' in told,
    )
    page.unroute(address)
    assert _shown(page, session)["scale"] != 20
    for connected in (False, True):
        page.evaluate(
            "async (on) => (await import('/static/js/store.js')).store.set('connected', on)",
            connected,
        )
    until(
        lambda: _shown(page, session),
        "both choices are heard",
        page=page,
        met=lambda shown: (shown["scale"], shown["camera"]) == (20, "side"),
    )


def test_leaving_while_it_plays_leaves_the_next_address_alone(page: Any, beam: str) -> None:
    _open(page, beam, "?t=0.1")
    page.get_by_role("button", name="Play", exact=True).click()
    page.get_by_role("link", name="Jobs").first.click()
    page.locator("tb-job-list").wait_for()
    # That nothing comes cannot be waited for: twice the pace at which addresses are written.
    page.wait_for_timeout(400)
    drawn_again(page)
    assert page.url.endswith("#/jobs")


def test_a_job_that_no_longer_fits_the_filter_leaves_the_list(page: Any) -> None:
    play(page, changes={"/jobs": {"items": [answer("job-running")], "next": None}})
    page.goto("/#/jobs?state=active")
    rows = page.locator("tb-job-list li")
    expect(rows).to_have_count(1)
    ended = {**answer("job-failed"), "id": "jobRunning"}
    page.evaluate(
        """(job) => window.streams.forEach((stream) => stream.dispatchEvent(
            new MessageEvent("job", { data: job })))""",
        json.dumps(ended),
    )
    expect(rows).to_have_count(0)
