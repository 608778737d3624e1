"""The job page as an instrument: one time, one address, keys, colours, a point of the deck."""

from __future__ import annotations

import contextlib
import itertools
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import pytest

from tests.browser.waiting import DONE_MS, patient, still, until

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect

MAIN = "KHST over the Alverca viaduct"
MAIN_MS = 800_000
"""The coarse crossing takes 75 s of a core that it has for itself. [ms]"""
PICK_MS = 6_000
"""The page asks for the point of a click for 2.8 s, and each answer takes its time. [ms]"""
NO_WEBGL = """
const before = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
  return String(kind).startsWith("webgl") ? null : before.call(this, kind, ...more);
};
"""


# The first test waits for the crossing, on a machine that may be five times slower.
pytestmark = pytest.mark.timeout(1800)


@dataclass(frozen=True, kw_only=True)
class Crossing:
    """The one-click job as somebody watched it.

    Attributes:
        job: Its id.
        shares: Shares of the work that the page named, in percent.
        partial: Whether a curve was drawn while it computed.
        verdict: What the page says at the end.
    """

    job: str
    shares: list[int]
    partial: bool
    verdict: str


@pytest.fixture(scope="module")
def crossing(chromium: Any, server: str) -> Iterator[Crossing]:
    """One press on the main template, watched to its end; the tests after it share the job."""
    context = patient(
        chromium.new_context(base_url=server, viewport={"width": 1280, "height": 860})
    )
    context.route(
        "**/viewer/*/", lambda route: route.fulfill(content_type="text/html", body="<p>3D</p>")
    )
    page = context.new_page()
    page.goto("/")
    page.get_by_role("button", name=f"Run {MAIN}", exact=True).click()
    page.wait_for_url("**/#/jobs/*")
    share = page.locator("tb-run-progress strong")
    shares: list[int] = []
    page.locator("tb-chart .scatterlayer .trace").first.wait_for(timeout=MAIN_MS)
    partial = page.locator(".tag.running").count() == 1
    for _ in range(2):
        text = share.inner_text()
        shares.append(int(text.split()[0]))
        expect(share).not_to_have_text(text, timeout=MAIN_MS)
    verdict = page.locator("tb-verdict-bar h2")
    verdict.wait_for(timeout=MAIN_MS)
    job = page.url.split("/jobs/")[1].split("?")[0]
    yield Crossing(job=job, shares=shares, partial=partial, verdict=verdict.inner_text())
    context.close()


def _open(page: Any, crossing: Crossing, query: str = "") -> None:
    page.goto(f"/#/jobs/{crossing.job}{query}")
    page.locator("tb-viewer-frame[data-session]").wait_for(timeout=DONE_MS)
    expect(page.get_by_role("slider", name="Time")).to_be_enabled(timeout=DONE_MS)


def _viewer(page: Any, server: str) -> dict[str, Any]:
    session = page.locator("tb-viewer-frame[data-session]").get_attribute("data-session")
    return dict(page.request.get(f"{server}/api/v1/viewer/{session}").json())


def test_one_click_leads_over_live_progress_to_the_verdict(crossing: Crossing) -> None:
    assert crossing.partial
    assert crossing.shares[0] < crossing.shares[1] < 100
    assert crossing.verdict == "Exceeds the limit at 432 km/h (screening mesh)"


@pytest.mark.parametrize("tab", ["accelerations", "vehicle", "slab-map", "inputs", "log", "files"])
def test_every_tab_has_its_face(
    page: Any, crossing: Crossing, picture: Callable[[Any, str], None], tab: str
) -> None:
    page.goto(f"/#/jobs/{crossing.job}?tab={tab}")
    panel = page.get_by_role("tabpanel")
    content = {
        "accelerations": "tb-chart[data-figure=spectrum] .trace",
        "vehicle": "tb-comfort-table",
        "slab-map": "tb-chart[data-figure=slab-map] .hm",
        "inputs": "text=Sleeper spacing",
        "log": "text=judging",
        "files": "text=Replay",
    }[tab]
    panel.locator(content).first.wait_for(timeout=DONE_MS)
    picture(page, f"job-{tab}")


def test_a_shared_link_shows_the_same_picture(
    page: Any, new_page: Callable[..., Any], server: str, crossing: Crossing
) -> None:
    _open(page, crossing, "?t=3.6")
    page.get_by_role("tab", name="Accelerations").click()
    page.get_by_label("Colours").select_option("acceleration")
    page.get_by_label("Camera").select_option("side")
    page.get_by_label("Scale of the deformation").select_option("200")
    page.locator("summary", has_text="Layers").click()
    page.get_by_label("Rails").uncheck()
    chart = page.locator("tb-chart[data-figure=slab-acceleration]:visible")
    chart.locator(".files a").first.wait_for(timeout=DONE_MS)  # It is drawn, and listens.
    still(page)
    box = chart.locator(".nsewdrag").bounding_box()
    page.mouse.move(box["x"] + box["width"] * 0.4, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.8, box["y"] + box["height"] / 2, steps=4)
    page.mouse.up()
    for end in ("from", "to"):
        expect(page).to_have_url(re.compile(f"[?&]{end}="))
    page.evaluate("location.hash += '&place=27,0,1.335'")
    page.locator("tb-chart[data-figure=point-acceleration] .trace").first.wait_for(timeout=DONE_MS)
    other = new_page(viewport={"width": 1280, "height": 860})
    other.goto(page.evaluate("location.href"))
    for one in (page, other):
        one.locator("tb-chart[data-figure=point-acceleration] .trace").first.wait_for(
            timeout=DONE_MS
        )
        expect(one.locator(".clock")).to_have_text("3.600 s")
        expect(one.get_by_role("tab", selected=True)).to_have_text("Accelerations")
        expect(one.get_by_label("Colours")).to_have_value("acceleration")
        one.locator("tb-chart[data-figure=spectrum] .trace").first.wait_for(timeout=DONE_MS)

    def seen(one: Any) -> tuple[Any, dict[str, Any]]:
        shown = "tb-chart[data-figure=slab-acceleration] .plot"
        ranges = one.evaluate(
            f"[...document.querySelectorAll('{shown}')].filter((plot) => plot.checkVisibility())"
            ".map((plot) => plot._fullLayout?.xaxis.range)"
        )
        state = _viewer(one, server)
        kept = ("run", "time", "scale", "camera", "colour", "layers", "playing", "picked")
        return ranges, {key: state[key] for key in kept}

    first = until(
        lambda: seen(page),
        "the first page shows what was chosen",
        page=page,
        met=lambda told: (
            told[0] and told[0][0] and told[0][0][0] > 1.0 and "rails" not in told[1]["layers"]
        ),
    )
    until(
        lambda: seen(other),
        f"the other page shows the same: {first}",
        page=other,
        met=lambda told: told == first,
    )
    assert (first[1]["time"], first[1]["scale"]) == (pytest.approx(3.6), 200.0)
    assert (first[1]["camera"], first[1]["colour"]) == ("side", "acceleration")


def test_the_keys_move_the_time(page: Any, crossing: Crossing) -> None:
    _open(page, crossing, "?t=2")
    clock = page.locator(".clock")
    expect(clock).to_have_text("2.000 s")
    page.locator("h1").click()
    page.keyboard.press("ArrowRight")
    expect(clock).to_have_text("2.010 s")  # one stored picture: 10 ms
    page.keyboard.press("Shift+ArrowLeft")
    expect(clock).to_have_text("1.910 s")
    page.keyboard.press("]")
    expect(page.get_by_label("Speed of the playback")).to_have_value("0.25")
    page.keyboard.press("Space")
    page.get_by_role("button", name="Pause").wait_for()
    page.keyboard.press("Space")
    page.get_by_role("button", name="Play", exact=True).wait_for()
    page.get_by_label("Jump to").wait_for(timeout=DONE_MS)  # The moments of interest are there.
    page.keyboard.press("p")
    expect(clock).to_have_text("3.484 s")  # the verdict's
    expect(page).to_have_url(re.compile(r"t=3\.48"))
    page.keyboard.press("?")
    page.get_by_role("dialog", name="Keys").wait_for()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog", name="Keys")).to_have_count(0)


def test_the_tabs_are_walked_with_the_arrows(page: Any, crossing: Crossing) -> None:
    _open(page, crossing)
    clock = page.locator(".clock")
    expect(clock).to_have_text("3.484 s", timeout=DONE_MS)  # where the page goes by itself
    page.get_by_role("tab", name="Overview").focus()
    page.keyboard.press("ArrowRight")
    expect(page.get_by_role("tab", name="Accelerations")).to_be_focused()
    expect(page).to_have_url(re.compile("tab=accelerations"))
    page.keyboard.press("End")
    expect(page.get_by_role("tab", selected=True)).to_have_text("Files")
    page.keyboard.press("ArrowRight")
    expect(page.get_by_role("tab", name="Overview")).to_be_focused()
    assert clock.inner_text() == "3.484 s"


def test_the_colour_bar_says_what_the_server_colours(
    page: Any, server: str, crossing: Crossing
) -> None:
    _open(page, crossing)
    bar = page.locator("tb-colour-bar")
    expect(bar).to_be_hidden()
    page.get_by_label("Colours").select_option("acceleration")
    expect(bar).to_contain_text("[m/s²]")
    told = _viewer(page, server)["colour_bar"]
    figures = [pytest.approx(told[end], rel=5e-3) for end in ("minimum", "maximum")]  # 3 figures

    def ends() -> list[float]:
        texts = bar.locator(".ends span").all_inner_texts()
        return [float(texts[place].replace("−", "-")) for place in (0, 2)]

    until(ends, "the bar's ends", page=page, met=lambda shown: shown == figures)
    colours = bar.locator("stop").evaluate_all("stops => stops.map((s) => s.attributes[1].value)")
    assert colours == [colour for _, colour in told["stops"]]


def test_a_click_on_the_deck_opens_the_histories_of_that_point(
    new_page: Callable[..., Any],
    server: str,
    crossing: Crossing,
    picture: Callable[[Any, str], None],
) -> None:
    page = new_page(viewer=True, viewport={"width": 1280, "height": 900})
    _open(page, crossing)
    page.get_by_label("Camera").select_option("side")
    frame = page.locator("tb-viewer-frame iframe")
    page.frame_locator("tb-viewer-frame iframe").locator("canvas").first.wait_for(timeout=DONE_MS)
    until(
        lambda: _viewer(page, server),
        "the view is watched from the side",
        page=page,
        met=lambda state: state["clients"] and state["camera"] == "side",
    )
    # How far down the deck is depends on the picture's shape: the first click that meets it counts.
    shares = itertools.cycle((0.5, 0.55, 0.6, 0.65, 0.7, 0.45))

    def place_after_a_click() -> str:
        box = frame.bounding_box()
        page.mouse.click(box["x"] + box["width"] * 0.45, box["y"] + box["height"] * next(shares))
        with contextlib.suppress(sync_api.TimeoutError):
            page.wait_for_url(re.compile("place="), timeout=PICK_MS)
        return page.url

    until(place_after_a_click, "a click meets the deck", page=page, met=lambda url: "place=" in url)
    chart = page.locator("tb-chart[data-figure=point-acceleration]")
    chart.locator(".trace").first.wait_for(timeout=DONE_MS)

    def both_x() -> tuple[float, float]:
        told = page.locator("tb-point-plots h2").inner_text().replace("−", "-")
        asked = re.findall(r"place=([-\d.]+)", page.url)[0]
        return float(re.findall(r"x = ([-\d.]+)", told)[0]), float(asked)

    until(
        both_x,
        "the heading names the point of the address",
        page=page,
        met=lambda x: x[0] == pytest.approx(x[1], abs=0.01),
    )
    picture(page, "point")


def test_a_click_on_the_map_opens_the_histories_of_that_point(
    page: Any, crossing: Crossing
) -> None:
    _open(page, crossing, "?tab=slab-map")
    chart = page.locator("tb-chart[data-figure=slab-map]")
    chart.locator(".hm").first.wait_for(timeout=DONE_MS)
    chart.locator(".files a").first.wait_for(timeout=DONE_MS)  # It listens.
    chart.scroll_into_view_if_needed()
    still(page)
    box = chart.locator(".nsewdrag").bounding_box()
    place = (box["x"] + box["width"] * 0.45, box["y"] + box["height"] * 0.5)
    page.mouse.move(*place)
    page.mouse.click(*place)
    expect(page).to_have_url(re.compile("place=2[4-9]"))  # 45 percent of 58.5 m
    page.locator("tb-chart[data-figure=point-displacement] .trace").first.wait_for(timeout=DONE_MS)
    expect(page.locator("tb-point-plots h2")).to_contain_text("z = 1.33 m")


def test_without_webgl_the_server_draws_and_a_line_says_why(
    page: Any, crossing: Crossing, picture: Callable[[Any, str], None]
) -> None:
    page.add_init_script(NO_WEBGL)
    page.goto(f"/#/jobs/{crossing.job}")
    page.get_by_text("This browser offers no WebGL", exact=False).wait_for()
    still = page.locator("tb-viewer-stills img.still")
    expect(still).to_have_js_property("naturalWidth", 1200, timeout=DONE_MS)
    page.locator("tb-viewer-stills tb-elevation svg").wait_for()
    picture(page, "no-webgl")


def test_a_cancelled_crossing_keeps_what_there_is_and_marks_it(
    page: Any, server: str, picture: Callable[[Any, str], None]
) -> None:
    study = page.request.get(f"{server}/api/v1/templates/khst-alverca").json()
    body = {"kind": "crossing", "study": study}
    job = page.request.post(f"{server}/api/v1/jobs", data=body).json()["id"]
    page.goto(f"/#/jobs/{job}")
    page.locator("tb-chart .scatterlayer .trace").first.wait_for(timeout=MAIN_MS)
    page.get_by_role("button", name="Cancel").click()
    page.locator("tb-job-head .tag.cancelled").wait_for(timeout=DONE_MS)
    page.get_by_text("Partial data").wait_for()
    page.get_by_text("This job was cancelled.").wait_for()
    page.get_by_role("button", name="Retry").wait_for()
    picture(page, "cancelled-partial")


def test_a_failed_job_names_the_input_and_shows_the_end_of_its_log(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    detail = "integration.time_step = 0.05: is longer than a bay. Give less."
    progress = {"step": 40, "steps": 100, "fraction": 0.4, "simulated_time": 0.02, "stage": ""}
    job = {
        "id": "broken",
        "kind": "crossing",
        "name": "Broken",
        "state": "failed",
        "created": "2024-01-01T00:00:00Z",
        "error": {"title": "Unusable", "detail": detail},
        "progress": {**progress, "rate": None, "remaining": None},
        "runs": [],
    }
    page.route("**/api/v1/jobs/broken", lambda route: route.fulfill(body=json.dumps(job)))
    log = (
        "2024-01-01T00:00:00+00:00  job  queued\n2024-01-01T00:00:01+00:00  run 0 (a)  computing\n"
    )
    page.route("**/api/v1/jobs/broken/log", lambda route: route.fulfill(body=log))
    page.goto("/#/jobs/broken")
    page.get_by_text(detail).wait_for()
    page.get_by_text("up to t = 0.020 s, step 40 of 100", exact=False).wait_for()
    link = page.get_by_role("link", name="Change integration, time step in a copy")
    assert "field=%2Fintegration%2Ftime_step" in link.get_attribute("href")
    page.locator("tb-job-trouble .log li", has_text="computing").wait_for()
    page.get_by_role("button", name="Retry").wait_for()
    picture(page, "failed-field")


def test_a_mode_rests_where_motion_is_to_be_reduced(
    new_page: Callable[..., Any], server: str
) -> None:
    page = new_page(reduced_motion="reduce")
    study = page.request.get(f"{server}/api/v1/templates/sprung-mass-beam").json()
    body = {"kind": "modes", "study": study}
    job = page.request.post(f"{server}/api/v1/jobs", data=body).json()["id"]
    page.goto(f"/#/jobs/{job}")
    page.locator("tb-viewer-frame[data-session]").wait_for(timeout=DONE_MS)
    page.get_by_role("button", name="Play", exact=True).wait_for()
    still(page)
    assert _viewer(page, server)["playing"] is False


def test_jobs_are_filtered_compared_and_deleted_with_the_keyboard(
    page: Any, crossing: Crossing, server: str, picture: Callable[[Any, str], None]
) -> None:
    study = page.request.get(f"{server}/api/v1/templates/sprung-mass-beam").json()
    job = page.request.post(
        f"{server}/api/v1/jobs", data={"kind": "crossing", "study": {**study, "name": "To delete"}}
    ).json()["id"]
    page.goto("/#/jobs")
    row = page.locator(f"tb-job-list a[href='#/jobs/{job}']")
    row.locator(".tag.done").wait_for(timeout=DONE_MS)
    page.get_by_label("Select To delete").focus()
    page.keyboard.press("Space")
    page.locator(f"[data-tick='{crossing.job}']").focus()
    page.keyboard.press("Space")
    compare = page.get_by_role("link", name="Compare 2 runs")
    assert compare.get_attribute("href").count("%2C") == 1
    picture(page, "jobs-ticked")
    page.keyboard.press("Space")
    page.get_by_label("Search by name").fill("to del")
    expect(page.locator("tb-job-list li")).to_have_count(1)
    expect(page).to_have_url(re.compile(r"name=to\+del"))
    page.get_by_role("button", name="Delete 1").focus()
    page.keyboard.press("Enter")
    dialog = page.get_by_role("dialog")
    expect(dialog.get_by_role("button", name="Keep")).to_be_focused()
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    page.get_by_text("No job is like that.").wait_for()
    until(
        lambda: page.request.get(f"{server}/api/v1/jobs/{job}").status,
        "the job is gone",
        page=page,
        met=lambda status: status == 404,
    )
