"""Without a mouse: from home to a result, through its tabs, and back; focus is always seen."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.browser.recorded import job_address, play
from tests.browser.waiting import DONE_MS, still

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect

BEAM = "One sprung mass on a simple beam"
MOST_STEPS = 90
"""More presses of Tab to the next thing than this are no way for anyone."""
FOCUSED = """() => {
  const item = document.activeElement;
  const style = getComputedStyle(item);
  const box = item.getBoundingClientRect();
  const edge = box.width && box.height && style.visibility !== "hidden";
  return {
    name: item.getAttribute("aria-label") || item.textContent.trim().slice(0, 60),
    role: item.getAttribute("role") || item.tagName.toLowerCase(),
    id: item.id,
    seen: Boolean(edge) && (style.outlineStyle !== "none" || style.boxShadow !== "none"),
    hidden: box.bottom < 0 || box.top > innerHeight,
  };
}"""


def _tab_to(page: Any, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    """Presses Tab until what is wanted has the focus; everything on the way must be seen."""
    unseen: list[dict[str, Any]] = []
    for _ in range(MOST_STEPS):
        page.keyboard.press("Tab")
        focused = page.evaluate(FOCUSED)
        if focused["role"] not in ("body", "iframe") and (not focused["seen"] or focused["hidden"]):
            unseen.append(focused)
        if wanted(focused):
            assert unseen == []
            return focused
    raise AssertionError(f"not reached in {MOST_STEPS} steps; unseen on the way: {unseen}")


def test_from_home_to_a_result_and_through_its_tabs(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    page.goto("/")
    page.get_by_role("button", name=f"Run {BEAM}", exact=True).wait_for()
    still(page)
    _tab_to(page, lambda item: item["name"] == "Skip to the content")
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "main"
    assert "#main" not in page.url
    _tab_to(page, lambda item: item["name"] == f"Run {BEAM}")
    page.keyboard.press("Enter")
    page.wait_for_url("**/#/jobs/*")
    page.locator("main .tag.done").first.wait_for(timeout=DONE_MS)
    page.get_by_text("Not judged", exact=False).first.wait_for()
    still(page)
    # The new page begins at its beginning, for eyes and for ears.
    assert page.evaluate("document.activeElement.id") == "main"
    first = _tab_to(page, lambda item: item["role"] == "tab")
    assert page.locator("[role=tab][aria-selected=true]").get_attribute("id") == first["id"]
    count = page.get_by_role("tab").count()
    seen = [first["name"]]
    for _ in range(count - 1):
        page.keyboard.press("ArrowRight")
        chosen = page.locator("[role=tab][aria-selected=true]")
        expect(chosen).to_be_focused()
        seen.append(chosen.inner_text())
        panel = chosen.get_attribute("aria-controls")
        expect(page.locator(f"#{panel}")).to_be_visible()
    assert len(set(seen)) == count > 3
    page.keyboard.press("ArrowRight")  # round to the first
    expect(page.locator("[role=tab]").first).to_be_focused()
    picture(page, "keyboard-tabs")


def test_time_plays_and_stops_by_the_keyboard(page: Any) -> None:
    play(page)
    page.goto(job_address("done"))
    slider = page.get_by_role("slider", name="Time")
    expect(slider).to_be_enabled()
    still(page)
    _tab_to(page, lambda item: item["name"] == "Time")
    clock = page.locator(".clock")
    before = clock.inner_text()
    page.keyboard.press("ArrowRight")
    expect(clock).not_to_have_text(before)
    page.keyboard.press("Home")
    expect(clock).to_have_text("0.000 s")


def test_the_theme_is_chosen_by_the_keyboard(page: Any) -> None:
    play(page)
    page.goto("/#/jobs")
    page.get_by_role("heading", name="Jobs").first.wait_for()
    still(page)
    _tab_to(page, lambda item: item["name"].startswith("Theme: "))
    page.keyboard.press("Enter")
    _tab_to(page, lambda item: item["role"] == "input")
    page.keyboard.press("ArrowUp")
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")
    page.keyboard.press("Escape")
    expect(page.get_by_role("button", name="Theme: dark")).to_be_focused()


@pytest.mark.parametrize(
    "address", ["/", "/#/jobs", "/#/study/khst-alverca", "/#/compare", "/#/library"]
)
def test_focus_is_seen_all_the_way_through_a_page(page: Any, address: str) -> None:
    play(page)
    page.goto(address)
    page.locator("main h1").first.wait_for()
    expect(page.locator("main .skeleton")).to_have_count(0)
    still(page)
    page.evaluate(
        "document.querySelector('.foot').insertAdjacentHTML('afterend', END)".replace(
            "END", "'<button id=\"end-of-page\">end</button>'"
        )
    )
    unseen: list[str] = []
    for _ in range(150):
        page.keyboard.press("Tab")
        focused = page.evaluate(FOCUSED)
        if focused["id"] == "end-of-page":
            break
        if not focused["seen"] or focused["hidden"]:
            unseen.append(f"{focused['role']} {focused['name']}")
    assert focused["id"] == "end-of-page", "the keyboard is caught before the end of the page"
    assert unseen == []
