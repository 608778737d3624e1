"""axe-core finds nothing against WCAG 2.2 A and AA on any page, tab and state, light and dark; and
a telephone never scrolls sideways."""

from __future__ import annotations

from collections.abc import Callable
from importlib.resources import files
from typing import Any

import pytest

from tests.browser.recorded import SILENT_STREAM, answer, job_address, play
from tests.browser.waiting import still

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
pytest.importorskip("axe_playwright_python", reason="pip install axe-playwright-python")

expect = sync_api.expect

WIDE = {"width": 1280, "height": 860}
NARROW = {"width": 390, "height": 800}
STATES = (
    "queued",
    "running",
    "failed",
    "cancelled",
    "timed_out",
    "out_of_memory",
    "done",
    "judged",
    "sweep",
    "modes",
)
PAGES = {
    "home": "/",
    "jobs": "/#/jobs",
    "study-khst": "/#/study/khst-alverca",
    "study-beam": "/#/study/sprung-mass-beam",
    "study-modes": "/#/study/train-modes",
    "study-of-a-job": "/#/study?job=jobDone",
    "compare-empty": "/#/compare",
    "compare": "/#/compare?runs=runDone,runSweep",
    "library": "/#/library",
    "library-item": "/#/library/trains/khst",
    "report": "/#/report/jobDone",
    "nowhere": "/#/nowhere",
    **{f"job-{state}": job_address(state) for state in STATES},
}
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
WIDEST = """(width) => [...document.querySelectorAll("body *")]
  .filter((item) => item.getBoundingClientRect().right > width + 1)
  .filter((item) => {
    for (let at = item.parentElement; at; at = at.parentElement)
      if (getComputedStyle(at).overflowX !== "visible") return false;
    return true;
  })
  .slice(0, 3).map((item) => item.outerHTML.slice(0, 90))"""
UNFOLD = """() => {
  for (const item of document.querySelectorAll("main details")) {
    item.open = true;
    // A menu lies over what is below it, and closes by itself.
    const floats = (part) => /absolute|fixed/.test(getComputedStyle(part).position);
    if ([...item.children].some(floats)) item.open = false;
  }
}"""
RUN = """(rules) => axe.run(document, {
  runOnly: rules, iframes: false, resultTypes: ["violations"],
})"""


def _source() -> str:
    return files("axe_playwright_python").joinpath("axe.min.js").read_text(encoding="utf-8")


def violations(page: Any) -> list[str]:
    """What axe-core objects to, one element a line.

    The script comes in by the debugger's door, which the page's content policy does not watch.
    """
    page.evaluate(_source())
    found = page.evaluate(RUN, RULES)["violations"]
    return [
        f"{rule['id']}: {node['target']} {node['html'][:160]}: {node['failureSummary']}"
        for rule in found
        for node in rule["nodes"]
    ]


def _settle(page: Any) -> None:
    """Until what was asked for has been drawn: axe judges no half-drawn page."""
    page.locator("main > *").first.wait_for()
    expect(page.locator("main .skeleton")).to_have_count(0)
    still(page)


ALIKE = ("job-failed", "job-timed_out", "job-out_of_memory", "job-cancelled", "job-queued")
"""Their tabs are those of a job that is done, with less in them."""


def _every_view(page: Any, name: str, look: Callable[[str], None]) -> None:
    """Looks at a page, at each of its tabs, and with everything unfolded."""
    look("as it opens")
    tabs = page.get_by_role("tab")
    for index in range(0 if name in ALIKE else tabs.count()):
        tab = tabs.nth(index)
        if not tab.is_visible():
            continue
        tab.click()
        _settle(page)
        look(f"tab {tab.inner_text()}")
    page.evaluate(UNFOLD)
    _settle(page)
    look("unfolded")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", PAGES)
def test_nothing_stands_in_anyones_way(
    new_page: Callable[..., Any], picture: Callable[[Any, str], None], name: str, scheme: str
) -> None:
    page = new_page(viewport=WIDE, color_scheme=scheme)
    play(page)
    page.goto(PAGES[name])
    _settle(page)
    assert page.evaluate("document.documentElement.dataset.theme") == scheme
    picture(page, f"page-{name}-{scheme}")
    found: list[str] = []

    def look(view: str) -> None:
        found.extend(f"{view}: {words}" for words in violations(page))

    _every_view(page, name, look)
    assert found == [], "\n".join(found)


@pytest.mark.parametrize("name", PAGES)
def test_a_telephone_never_scrolls_sideways(
    new_page: Callable[..., Any], picture: Callable[[Any, str], None], name: str
) -> None:
    page = new_page(viewport=NARROW, has_touch=True, is_mobile=True)
    play(page)
    page.goto(PAGES[name])
    _settle(page)
    picture(page, f"phone-{name}")
    found: list[str] = []

    def look(view: str) -> None:
        width = page.evaluate("document.documentElement.scrollWidth")
        if width > NARROW["width"]:
            found.append(f"{view}: {width} px wide: {page.evaluate(WIDEST, NARROW['width'])}")

    _every_view(page, name, look)
    found.extend(violations(page))
    assert found == [], "\n".join(found)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_editing_an_entry_of_the_library_is_as_good(
    new_page: Callable[..., Any], picture: Callable[[Any, str], None], scheme: str
) -> None:
    page = new_page(viewport=NARROW, color_scheme=scheme)
    own = {**answer("library-item"), "built_in": False}
    play(page, changes={"/library/trains/khst": own})
    page.goto("/#/library/trains/khst?edit=1")
    _settle(page)
    found = violations(page)
    page.locator(".segments label", has_text="JSON").click()
    page.locator("#study-json").wait_for()
    picture(page, f"library-edit-json-{scheme}")
    found += violations(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= NARROW["width"]
    assert found == [], "\n".join(found)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_menu_and_banner_are_as_good(new_page: Callable[..., Any], scheme: str) -> None:
    page = new_page(viewport=WIDE, color_scheme=scheme)
    play(page, stream=SILENT_STREAM)
    page.goto("/#/jobs")
    _settle(page)
    page.get_by_text("No connection to the server.").wait_for()
    page.get_by_role("button", name="Theme: as the system").click()
    page.get_by_role("radio", name="Dark").wait_for()
    found = violations(page)
    assert found == [], "\n".join(found)


def test_the_theme_is_chosen_and_remembered(new_page: Callable[..., Any]) -> None:
    page = new_page(viewport=WIDE, color_scheme="light")
    play(page)
    page.goto("/")
    page.get_by_role("button", name="Theme: as the system").click()
    page.get_by_role("radio", name="Dark").check()
    theme = "document.documentElement.dataset.theme"
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")
    other = page.context.new_page()
    # Before any module has run: a dark page must not flash white.
    other.route("**/static/js/main.js", lambda route: route.abort())
    other.goto("/")
    assert other.evaluate(theme) == "dark"
    page.reload()
    page.get_by_role("button", name="Theme: dark").click()
    page.get_by_role("radio", name="As the system").check()
    expect(page.locator("html")).to_have_attribute("data-theme", "light")
    page.emulate_media(color_scheme="dark")
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")


def test_paper_is_light_and_motion_can_be_reduced(new_page: Callable[..., Any]) -> None:
    page = new_page(viewport=WIDE, color_scheme="dark", reduced_motion="reduce")
    play(page)
    page.goto("/")
    _settle(page)
    ground = "getComputedStyle(document.body).backgroundColor"
    assert page.evaluate(ground) == "rgb(14, 20, 26)"
    moving = page.evaluate("document.getAnimations().length")
    assert moving == 0
    page.emulate_media(media="print")
    assert page.evaluate(ground) == "rgb(245, 247, 249)"
    assert not page.get_by_role("navigation", name="Main").is_visible()
