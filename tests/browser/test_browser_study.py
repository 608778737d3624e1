"""The study editor in Chromium: errors at fields, undo, JSON both ways, ranges, tables, run."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.browser.spreadsheet import PASTE
from tests.browser.waiting import DONE_MS, drawn_again, until

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect

ROOT = Path(__file__).parents[2]
BEAM = "/#/study/sprung-mass-beam"
KHST = "/#/study/khst-alverca"
FULL = "The queue is full here."
READY = "Checked: ready to run."
POINTERS = """
[...document.querySelectorAll("tb-study-form [data-pointer]")].map((item) => item.dataset.pointer)
"""
KHST_CONSIST = "power_car, motorised_trailer, 16 × passenger_car, motorised_trailer, power_car"


def _open(page: Any, address: str) -> None:
    page.goto(address)
    page.get_by_text(READY).wait_for(timeout=DONE_MS)


def _input(page: Any, pointer: str) -> Any:
    return page.locator(f"tb-field[data-pointer='{pointer}'] :is(input, select)")


def _unfold(page: Any, section: str) -> None:
    page.locator(f"#section-{section} .advanced > summary").click()


def _follow(page: Any, pointer: str, advice: str) -> None:
    choice = page.locator(f"tb-choice[data-pointer='{pointer}']")
    choice.get_by_role("button", name=advice).click()


def _submitted(page: Any, button: str = "Run") -> dict[str, Any]:
    """What the page sends to the queue; nothing is computed."""
    page.route("**/api/v1/jobs", lambda route: route.fulfill(status=503, json={"detail": FULL}))
    page.get_by_text(READY).wait_for()
    with page.expect_request("**/api/v1/jobs") as sent:
        page.get_by_role("button", name=button, exact=True).click()
    page.get_by_text(FULL).wait_for()
    return sent.value.post_data_json


def test_home_has_a_card_for_every_study_and_says_what_waits_and_where(
    page: Any, server: str
) -> None:
    templates = page.request.get(f"{server}/api/v1/templates").json()["items"]
    page.goto("/")
    page.locator("tb-template-card").first.wait_for()
    titles = [template["title"] for template in templates]
    expect(page.locator("tb-template-card h2")).to_have_text(titles)
    for template in templates:
        card = page.locator(
            "tb-template-card", has=page.get_by_role("heading", name=template["title"], exact=True)
        )
        expect(card.locator("svg.elevation")).to_have_count(1)
        until(
            lambda card=card: card.locator("dt").all_inner_texts()[-2:],
            "the last two amounts",
            page=page,
            met=lambda names: names == ["Unknowns", "Time"],
        )
        until(
            lambda card=card: card.locator("dd").all_inner_texts(),
            "every amount is told",
            page=page,
            met=lambda amounts: amounts and "–" not in amounts,
        )
        expect(
            card.get_by_role("link", name=f"Customise {template['title']}", exact=True)
        ).to_be_visible()
    page.locator("tb-machine").get_by_text("Cores").wait_for()
    expect(page.locator("tb-queue h2")).to_have_text("Queue")


def test_every_input_of_the_solver_is_in_the_form(page: Any, server: str) -> None:
    _open(page, KHST)
    schemas = page.request.get(f"{server}/api/v1/openapi.json").json()["components"]["schemas"]
    study = page.request.get(f"{server}/api/v1/templates/khst-alverca").json()
    shown = set(page.evaluate(POINTERS))
    for key, part in study.items():
        if key in ("schema_version", "modes"):
            continue  # the first is no input, the second of modal studies only
        names = [f"/{key}/{name}" for name in part] if isinstance(part, dict) else [f"/{key}"]
        for name in names:
            inside = any(pointer == name or pointer.startswith(f"{name}/") for pointer in shown)
            assert inside or name.endswith("/type"), name
    cells = page.locator("#section-train tb-table [data-cell]").count()
    assert cells == 3 * len(schemas["VehicleType"]["properties"])


def test_advice_is_followed_with_one_click(page: Any) -> None:
    _open(page, KHST)
    step = page.locator("tb-field[data-pointer='/integration/time_step']")
    step.locator("input").fill("3")
    step.get_by_role("button", name="Use 1.25 ms").click()
    page.get_by_text(READY).wait_for()
    assert _submitted(page)["study"]["integration"]["time_step"] == pytest.approx(1.25e-3)


def test_warnings_stand_at_their_fields_and_do_not_forbid(page: Any) -> None:
    _open(page, KHST)
    level = page.locator("tb-field[data-pointer='/mesh_level']")
    level.locator(".field-warning", has_text="Is a screening mesh.").wait_for()
    expect(page.get_by_role("button", name="Run", exact=True)).to_be_enabled()
    level.get_by_role("button", name="Use standard").click()
    level.locator(".field-warning").wait_for(state="detached")


def test_a_range_of_speeds_is_typed_checked_and_drawn_again_as_one(page: Any) -> None:
    _open(page, BEAM)
    speeds = _input(page, "/sweep/speeds")
    speeds.fill("200:400:10")
    page.get_by_text("Time, 21 runs").wait_for()
    speeds.fill("200:400")
    page.get_by_text("Write a range as start:end:step", exact=False).wait_for()
    expect(page.get_by_role("button", name="Run", exact=True)).to_be_disabled()
    speeds.fill("200:230:10, 432")
    sent = _submitted(page)["study"]["sweep"]["speeds"]
    assert sent == pytest.approx([speed / 3.6 for speed in (200, 210, 220, 230, 432)])


def test_undo_and_redo_go_through_every_change_and_keep_the_focus(page: Any) -> None:
    _open(page, BEAM)
    mass = _input(page, "/train/mass")
    mass.fill("6")
    _input(page, "/train/count").fill("3")
    page.get_by_label("Isolated defect").check()
    undo, redo = page.get_by_role("button", name="Undo"), page.get_by_role("button", name="Redo")
    undo.click()
    expect(page.locator("#section-irregularities").get_by_label("None")).to_be_checked()
    mass.focus()
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    expect(mass).to_have_value("5.75")
    expect(mass).to_be_focused()
    expect(undo).to_be_disabled()
    page.get_by_text("As the template", exact=True).wait_for()
    page.keyboard.press("Control+Shift+z")
    expect(mass).to_have_value("6")
    redo.click()
    expect(_input(page, "/train/count")).to_have_value("3")


def test_undo_takes_back_what_is_no_value(page: Any) -> None:
    _open(page, BEAM)
    mass = _input(page, "/train/mass")
    mass.fill("heavy")
    page.get_by_text("Give a number", exact=False).wait_for()
    page.keyboard.press("Control+z")
    expect(mass).to_have_value("5.75")
    page.get_by_text(READY).wait_for()


def test_what_differs_is_marked_in_words_and_can_be_reset(page: Any) -> None:
    _open(page, BEAM)
    field = page.locator("tb-field[data-pointer='/train/mass']")
    field.locator("input").fill("7")
    field.get_by_text("Changed, was 5.75 t").wait_for()
    page.locator("#section-train .section-mark", has_text="1 changed").wait_for()
    field.get_by_role("button", name="Reset Mass").click()
    expect(field.locator("input")).to_have_value("5.75")
    page.get_by_text("As the template", exact=True).wait_for()


def test_changes_are_back_after_a_reload_until_one_begins_again(page: Any) -> None:
    _open(page, BEAM)
    _input(page, "/train/mass").fill("7")
    page.get_by_text(READY).wait_for()
    page.reload()
    page.get_by_text("Your changes of", exact=False).wait_for()
    expect(_input(page, "/train/mass")).to_have_value("7")
    page.get_by_role("button", name="Begin again from the template").click()
    expect(_input(page, "/train/mass")).to_have_value("5.75")
    page.reload()
    page.get_by_text(READY).wait_for()
    assert page.get_by_text("Your changes of", exact=False).count() == 0


def test_json_both_ways_with_errors_at_their_lines(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    _open(page, BEAM)
    _input(page, "/train/mass").fill("7")
    page.get_by_role("radio", name="JSON").check(force=True)
    text = page.locator("#study-json")
    study = json.loads(text.input_value())
    assert study["train"]["mass"] == 7000
    study["integration"]["time_step"] = 5
    broken = json.dumps(study, indent=2)
    line = 1 + [row.strip() for row in broken.split("\n")].index('"time_step": 5')
    text.fill(broken)
    page.get_by_role("button", name=f"Line {line}", exact=True).wait_for()
    text.fill(broken.replace('"time_step": 5', '"time_step": 0.0005 oops'))
    page.locator(f".line-numbers .error:text('{line}')").wait_for()
    expect(page.get_by_role("button", name="Run", exact=True)).to_be_disabled()
    picture(page, "study-json")
    mended = broken.replace('"time_step": 5', '"time_step": 0.0005')
    text.fill(mended)
    page.get_by_text(READY).wait_for()
    text.fill(mended + "}")
    page.get_by_text("To mend first: JSON text").wait_for()
    text.fill(mended)  # The very study of before is looked at again.
    page.get_by_text(READY).wait_for()
    page.get_by_role("radio", name="Form").check(force=True)
    expect(_input(page, "/integration/time_step")).to_have_value("0.5")
    expect(_input(page, "/train/mass")).to_have_value("7")


def test_a_table_takes_cells_of_a_spreadsheet(
    page: Any, picture: Callable[[Any, str], None]
) -> None:
    _open(page, KHST)
    _unfold(page, "train")
    cell = page.get_by_label("Carbody mass, power_car", exact=False)
    cell.evaluate(PASTE, "55,5\t40\t27\r\n60000\t56000\toops\r\n")
    page.get_by_text("These cells were left as they were:", exact=False).wait_for()
    picture(page, "study-table")
    types = _submitted(page)["study"]["train"]["vehicle_types"]
    assert [item["carbody_mass"] for item in types] == pytest.approx([55500, 40000, 27000])
    assert [item["carbody_roll_inertia"] for item in types] == pytest.approx([60000, 56000, 33940])


def test_a_column_of_a_spreadsheet_becomes_the_spans(page: Any) -> None:
    _open(page, KHST)
    spans = _input(page, "/viaduct/spans")
    spans.focus()
    spans.evaluate(PASTE, "Span\r\n16,5\r\n21\r\n21\r\n25,25\r\n")
    expect(spans).to_have_value("16.5, 21, 21, 25.25")
    page.locator("tb-elevation text", has_text="25.25 m").wait_for()


def test_another_kind_of_viaduct_is_mended_by_following_the_advice(page: Any) -> None:
    _open(page, KHST)
    page.get_by_label("Plain beams").check()
    page.locator("#section-viaduct .section-mark", has_text="1 changed").wait_for()
    _follow(page, "/track", "Use none")
    _follow(page, "/train", "Use sprung masses")
    page.get_by_text(READY).wait_for()
    page.get_by_label("Box girder viaduct").check()
    _follow(page, "/track", "Use ballasted track")
    _follow(page, "/train", "Use articulated train")
    expect(_input(page, "/train/consist")).to_have_value(KHST_CONSIST)
    page.get_by_text("As the template", exact=True).wait_for()


def test_the_drawing_follows_what_is_typed(page: Any) -> None:
    _open(page, KHST)
    section = page.locator("tb-cross-section")
    section.get_by_text("7.2 m").wait_for()
    _input(page, "/viaduct/slab_width").fill("8.4")
    section.get_by_text("8.4 m").wait_for()
    page.get_by_label("Isolated defect").check()
    expect(section.locator(".flaw")).to_have_count(1)
    _input(page, "/irregularity/rail").select_option("both")
    expect(section.locator(".flaw")).to_have_count(2)
    expect(page.locator("tb-study-drawing tb-elevation .point.judged")).to_have_count(1)


def test_a_train_comes_from_the_library(page: Any, server: str) -> None:
    trains = page.request.get(f"{server}/api/v1/library/trains").json()["items"]
    own = next(item for item in trains if item["value"]["type"] == "sprung_masses")
    _open(page, BEAM)
    _input(page, "/train/mass").fill("9")
    page.get_by_label("Train from the library").select_option(own["id"])
    assert _submitted(page)["study"]["train"]["mass"] == own["value"]["mass"]


def test_a_copy_of_a_jobs_study_can_be_changed(page: Any, server: str) -> None:
    beam = page.request.get(f"{server}/api/v1/templates/sprung-mass-beam").json()
    job = page.request.post(
        f"{server}/api/v1/jobs", data={"study": {**beam, "name": "Mine"}}
    ).json()
    _open(page, f"/#/study?job={job['id']}")
    page.get_by_role("heading", name="Mine").wait_for()
    _input(page, "/name").fill("Mine, heavier")
    page.get_by_text("As the job", exact=False).wait_for(state="detached")
    assert _submitted(page)["study"]["name"] == "Mine, heavier"


def _ran(way: str, code: str, folder: Path) -> str:
    """Runs a copied command or program as it is; `trainbridge` is this checkout's."""
    shell = 'trainbridge() { "$PYTHON" -m server "$@"; }\n'
    command = [sys.executable, "-c", code] if way == "python" else ["bash", "-c", shell + code]
    own = {"PYTHON": sys.executable, "PYTHONPATH": str(ROOT), "HOME": str(folder)}
    environment = {**own, "PATH": os.defpath, "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{way}: {done.stderr}{done.stdout}"
    return done.stdout


def test_copied_commands_and_programs_run_as_they_are(page: Any, tmp_path: Path) -> None:
    _open(page, BEAM)
    name = 'It\'s "mine" \\ £'
    _input(page, "/name").fill(name)
    page.get_by_role("button", name="Copy as…").click()
    told: dict[str, str] = {}
    for way in ("curl", "submit", "run", "python"):
        if way == "curl" and not shutil.which("curl"):
            continue
        page.locator(f"dialog input[value={way}]").check()
        told[way] = _ran(way, page.locator("dialog pre").inner_text(), tmp_path)
    assert json.loads(told.get("curl", json.dumps({"name": name})))["name"] == name
    assert told["python"].startswith("done")
    assert (tmp_path / "results" / "summary.json").exists()


def test_run_and_modes_go_to_the_queue_with_the_keyboard_alone(page: Any) -> None:
    _open(page, BEAM)
    assert _submitted(page, "Natural modes")["kind"] == "modes"
    page.unroute("**/api/v1/jobs")
    _input(page, "/train/count").focus()
    page.keyboard.press("Control+a")
    page.keyboard.type("2")
    page.get_by_text(READY).wait_for()
    page.keyboard.press("Control+Enter")
    page.wait_for_url("**/#/jobs/*")


def test_a_modal_study_asks_for_its_part(page: Any) -> None:
    _open(page, "/#/study/train-modes")
    expect(page.locator("tb-study-form section h2").first).to_have_text("Modes")
    _input(page, "/modes/part").select_option("viaduct")
    page.locator("tb-elevation .span").first.wait_for(state="attached")
    assert _submitted(page)["kind"] == "modes"


def test_what_a_modal_analysis_does_not_read_is_folded(page: Any) -> None:
    _open(page, "/#/study/train-modes")
    read = page.locator("tb-study-form > section h2")
    expect(read).to_have_text(["Modes", "Train", "Contact"])
    speeds = _input(page, "/sweep/speeds")
    assert not speeds.is_visible()
    _input(page, "/modes/part").focus()
    _input(page, "/modes/part").select_option("track")
    expect(read).to_have_text(["Modes", "Track"])
    expect(_input(page, "/modes/part")).to_be_focused()
    expect(_input(page, "/mesh_level")).to_be_visible()
    page.get_by_text("Not used by this modal analysis").click()
    speeds.fill("-1")
    page.get_by_text("Must be greater than 0 km/h").wait_for()
    # What is folded away can still be reached where it forbids the run.
    page.locator(".unread > summary").click()
    page.locator("tb-study-run").get_by_role("button", name="Speeds").click()
    expect(speeds).to_be_focused()


def test_an_address_leads_to_an_input(page: Any, server: str) -> None:
    study = page.request.get(f"{server}/api/v1/templates/sprung-mass-beam").json()
    job = page.request.post(f"{server}/api/v1/jobs", data={"study": study}).json()["id"]
    _open(page, f"/#/study?job={job}&field=/integration/time_step")
    expect(_input(page, "/integration/time_step")).to_be_focused()
    expect(_input(page, "/integration/time_step")).to_be_in_viewport()


def test_an_address_leads_to_a_folded_input_and_from_another_page(page: Any) -> None:
    page.goto("/#/library")
    page.get_by_role("heading", name="Library").wait_for()
    page.evaluate("location.hash = '#/study/khst-alverca?field=/viaduct/web_position'")
    expect(_input(page, "/viaduct/web_position")).to_be_focused()
    expect(_input(page, "/viaduct/web_position")).to_be_in_viewport()


def test_cost_and_derived_values_are_said_once(page: Any) -> None:
    _open(page, KHST)
    said = page.locator("tb-study-report dt").all_inner_texts()
    assert len(said) == len(set(said))
    assert len([name for name in said if "steps" in name.lower()]) == 1
    assert len([name for name in said if "nknowns" in name]) == 1


def test_whoever_leaves_while_a_job_starts_is_not_called_back(page: Any) -> None:
    _open(page, BEAM)
    waiting: list[Any] = []
    page.route("**/api/v1/jobs", lambda route: waiting.append(route))
    page.get_by_role("button", name="Run", exact=True).click()
    page.get_by_text("Starting…").wait_for()
    page.evaluate("location.hash = '#/library'")
    page.get_by_role("heading", name="Library").wait_for()
    until(lambda: waiting, "the request for a job", page=page)
    with page.expect_response("**/api/v1/jobs"):
        waiting[0].fulfill(status=201, json={"id": "0123456789abcdef"})
    page.wait_for_load_state("networkidle")
    drawn_again(page)
    assert page.evaluate("location.hash") == "#/library"
