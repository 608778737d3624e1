"""The library in Chromium: drawn, cloned, edited with errors, imported, exported, deleted."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from tests.browser.waiting import still

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect


def _file(name: str, content: Any) -> dict[str, Any]:
    text = content if isinstance(content, str) else json.dumps(content)
    return {"name": name, "mimeType": "application/json", "buffer": text.encode()}


def test_every_kind_is_listed_and_drawn(page: Any, picture: Callable[[Any, str], None]) -> None:
    page.goto("/#/library")
    for title in ("Trains", "Viaducts", "Tracks", "Irregularities"):
        page.get_by_role("region", name=title).get_by_role("link").first.wait_for()
    picture(page, "library")
    page.get_by_role("link", name="Korean high-speed train").click()
    drawing = page.get_by_role("img", name="46 axles over 380.15 m, 779.8 t together")
    drawing.wait_for()
    # The load of each axle stands under it, and figures that nobody printed are marked.
    expect(drawing.locator(".axle-load text").first).to_have_text("17.0")
    marked = page.locator(".doubtful").filter(has_text="Roll coupling")
    expect(marked).to_contain_text("assumed")
    picture(page, "library-train")
    page.goto("/#/library/viaducts/alverca")
    page.get_by_role("img", name="Cross-section: deck 7.2 m wide").wait_for()
    page.goto("/#/library/tracks/ballasted-60e1")
    page.get_by_role("img", name="Sleepers every 0.6 m").wait_for()
    page.goto("/#/library/irregularities/isolated-16mm")
    page.get_by_role("img", name="16 mm high, 6.7 m from end to end").wait_for()


def test_an_entry_is_cloned_edited_and_deleted_by_keyboard(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    page.goto("/#/library/irregularities/isolated-10mm")
    clone = page.get_by_role("button", name="Clone")
    clone.focus()
    page.keyboard.press("Enter")
    name = page.get_by_label("Name", exact=True)
    expect(name).to_be_focused()
    expect(name).to_have_value("Isolated defect, 10 mm, 6.7 m long (copy)")
    name.fill("Bad joint")
    amplitude = page.get_by_label("Amplitude A")
    # Beyond the solver's bound: said at the field, and nothing is sent.
    amplitude.fill("90")
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_text("Must be at most 50 mm")).to_be_visible()
    expect(amplitude).to_be_focused()
    amplitude.fill("-7")
    page.get_by_role("img", name="7 mm deep").wait_for()  # Drawn as one types.
    picture(page, "library-edit")
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="Bad joint").wait_for()
    page.get_by_text("−7 mm").wait_for()
    page.reload()
    page.get_by_role("heading", name="Bad joint").wait_for()
    page.get_by_role("button", name="Delete").click()
    page.keyboard.press("Escape")  # Means no.
    page.get_by_role("button", name="Delete").click()
    page.get_by_role("dialog").get_by_role("button", name="Delete").click()
    page.wait_for_url("**/#/library/irregularities")
    page.get_by_role("link", name="Isolated defect, 16 mm").wait_for()
    expect(page.get_by_role("link", name="Bad joint")).to_have_count(0)


def test_what_the_server_refuses_is_shown_at_its_field(page: Any, server: str) -> None:
    built_in = page.request.get(f"{server}/api/v1/library/viaducts/alverca").json()
    body = {"name": "Mine", "value": built_in["value"]}
    made = page.request.post(f"{server}/api/v1/library/viaducts", data=body).json()
    page.goto(f"/#/library/viaducts/{made['id']}?edit=1")
    page.get_by_label("Web position").fill("3")  # Within its bounds, but outside of the walls.
    page.get_by_role("button", name="Save").click()
    expect(page.locator("tb-field.invalid")).to_contain_text("lie inside the walls")
    expect(page.get_by_role("alert").filter(has_text="Not saved")).to_be_visible()
    page.get_by_role("button", name="Cancel").click()
    page.get_by_text("1.55 m").first.wait_for()


def _copy(page: Any, server: str, kind: str, entry: str) -> str:
    """A copy of an entry that can be changed; gives its address."""
    built_in = page.request.get(f"{server}/api/v1/library/{kind}/{entry}").json()
    body = {"name": "Mine", "value": built_in["value"]}
    made = page.request.post(f"{server}/api/v1/library/{kind}", data=body).json()
    return f"/#/library/{kind}/{made['id']}"


def test_what_was_not_saved_waits(page: Any, server: str) -> None:
    address = _copy(page, server, "irregularities", "isolated-10mm")
    page.goto(f"{address}?edit=1")
    page.get_by_label("Name", exact=True).fill("Half done")
    page.get_by_label("Amplitude A").fill("8")
    page.get_by_role("link", name="Jobs", exact=True).click()
    page.get_by_role("heading", name="Jobs", exact=True).wait_for()
    page.goto(address)
    page.get_by_text("Changes of this entry wait to be saved.", exact=False).wait_for()
    page.get_by_role("button", name="Go on editing").click()
    expect(page.get_by_label("Name", exact=True)).to_have_value("Half done")
    expect(page.get_by_label("Amplitude A")).to_have_value("8")
    page.get_by_role("img", name="8 mm high").wait_for()
    page.get_by_role("button", name="Begin again from what is saved").click()
    expect(page.get_by_label("Amplitude A")).to_have_value("10")
    page.get_by_role("img", name="10 mm high").wait_for()
    page.get_by_label("Amplitude A").fill("9")
    page.get_by_role("button", name="Save").click()
    page.get_by_text("9 mm").first.wait_for()
    expect(page.get_by_text("wait to be saved", exact=False)).to_have_count(0)


def test_an_entry_is_edited_as_json(
    page: Any, server: str, picture: Callable[[Any, str], None]
) -> None:
    page.goto(f"{_copy(page, server, 'viaducts', 'alverca')}?edit=1")
    page.get_by_label("Slab width").fill("7.4")
    page.get_by_role("radio", name="JSON").check(force=True)
    text = page.get_by_label("The viaduct as JSON, all values in SI units")
    viaduct = json.loads(text.input_value())
    assert viaduct["slab_width"] == pytest.approx(7.4)
    text.fill("{")
    page.get_by_role("button", name="Save").click()
    expect(text).to_be_focused()  # Nothing was sent.
    wrong = json.dumps({**viaduct, "web_position": 3.0}, indent=2)
    line = 1 + [row.strip(" ,") for row in wrong.split("\n")].index('"web_position": 3.0')
    text.fill(wrong)
    page.get_by_role("button", name="Save").click()
    page.get_by_role("button", name=f"Line {line}", exact=True).wait_for()
    picture(page, "library-json")
    text.fill(json.dumps({**viaduct, "slab_width": 7.6}))
    page.get_by_role("img", name="Cross-section: deck 7.6 m wide").wait_for()
    page.get_by_role("radio", name="Form").check(force=True)
    expect(page.get_by_label("Slab width")).to_have_value("7.6")
    page.get_by_role("button", name="Save").click()
    page.get_by_text("7.6 m").first.wait_for()


def test_another_kind_keeps_the_focus(page: Any, server: str) -> None:
    page.goto(f"{_copy(page, server, 'irregularities', 'isolated-10mm')}?edit=1")
    page.get_by_label("Isolated defect").focus()
    page.keyboard.press("ArrowUp")
    page.get_by_text("Perfect rails").wait_for()
    expect(page.get_by_label("None")).to_be_focused()
    page.keyboard.press("ArrowDown")
    expect(page.get_by_label("Isolated defect")).to_be_focused()
    expect(page.get_by_label("Amplitude A")).to_have_value("10")  # As it is saved.


def _own_trains(page: Any, server: str) -> list[str]:
    items = page.request.get(f"{server}/api/v1/library/trains").json()["items"]
    return [item["name"] for item in items if not item["built_in"]]


def test_entries_travel_as_json(page: Any, server: str) -> None:
    before = _own_trains(page, server)  # other tests may have made some
    page.goto("/#/library/trains")
    with page.expect_download() as download:
        page.get_by_role("link", name="Export JSON").click()
    exported = json.loads(download.value.path().read_text())
    [khst] = [item for item in exported["items"] if item["id"] == "khst"]
    chooser = page.locator("#library-file")
    chooser.set_input_files(_file("again.json", exported))
    page.get_by_text("Nothing new").wait_for()
    chooser.set_input_files(_file("mine.json", {**khst, "name": "Imported train"}))
    page.get_by_text("Imported: Imported train").wait_for()
    page.get_by_role("link", name="Imported train").wait_for()
    chooser.set_input_files(_file("broken.json", "{"))
    expect(page.get_by_role("alert")).to_contain_text("broken.json was not imported")
    expect(page.get_by_role("alert")).to_contain_text("no JSON")
    khst["value"]["bogie_gap"] = -1
    chooser.set_input_files(_file("wrong.json", khst))
    expect(page.get_by_role("alert")).to_contain_text("/items/0/value/bogie_gap")
    expect(page.get_by_role("alert")).to_contain_text("Must be greater than 0")
    assert sorted(_own_trains(page, server)) == sorted([*before, "Imported train"])


def test_a_strange_address_has_a_face(page: Any) -> None:
    page.goto("/#/library/boats")
    page.get_by_text("The library holds no boats").wait_for()
    page.goto("/#/library/trains/none")
    page.get_by_text("There is no entry none").wait_for()
    page.get_by_role("link", name="Open the library").click()
    page.get_by_role("heading", name="Library").wait_for()


def test_an_entry_fits_a_telephone(
    new_page: Callable[..., Any], picture: Callable[[Any, str], None]
) -> None:
    page = new_page(viewport={"width": 390, "height": 844}, color_scheme="dark")
    for address in ("/#/library", "/#/library/trains/khst", "/#/library/viaducts/alverca"):
        page.goto(address)
        page.locator("h1").wait_for()
        still(page)
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
    picture(page, "library-390-dark")
