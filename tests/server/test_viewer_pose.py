"""The camera's pose: what a hand made of it is told, what is asked for is shown, and no more.

Slow are those that wait until nothing more is sent.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from io import BytesIO

import numpy as np
import pytest
from fastapi import FastAPI

from server.errors import install_errors
from server.viewer import ViewerLimits, router
from tests.server.viewer_camera import Page, View
from tests.server.viewer_client import served
from tests.server.viewer_small_runs import BeamRun, ModalRun
from tests.server.viewer_waiting import http

RUNS = {"beam": BeamRun(), "another": BeamRun(), "modes": ModalRun("viaduct")}
SPEED = RUNS["beam"].plan.speed
EYE, AIM = (-12.0, -25.5, 9.25), (8.0, 1.0, 1.5)
POSE = {"position": list(EYE), "look_at": list(AIM)}
FARTHER = {"position": [-20.0, -40.0, 15.0], "look_at": list(AIM)}
WAIT = 60.0
"""For what takes a moment, on a machine that does other things meanwhile. [s]"""


def until(met: Callable[[], bool]) -> None:
    end = time.monotonic() + WAIT
    while not met():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    app = FastAPI()
    install_errors(app)
    app.include_router(router(lambda run: RUNS[run], ViewerLimits(sessions=4, idle=60.0)))
    with served(app) as address:
        yield address


@pytest.fixture
def view(address: str) -> Iterator[View]:
    view = View(address)
    yield view
    http.delete(view.resource)


@pytest.mark.slow
def test_a_preset_is_no_pose(view: View) -> None:
    with view.page() as page:
        for preset in ("side", "section", "follow", "overview"):
            assert view.put(camera=preset)["pose"] is None
            page.settle()
            page.tell()
            page.settle()
            assert view.pose is None, preset


def test_the_state_tells_where_a_hand_moved_the_camera(view: View) -> None:
    with view.page() as page:
        page.look((EYE[0], EYE[1], EYE[2] + 4e-4), AIM)
        until(lambda: view.pose is not None)
        assert view.pose == {**POSE, "fov": None}, "in whole millimetres"
        assert view.put(scale=20.0)["camera"] == "overview"


def test_a_pose_that_is_asked_for_moves_the_cameras_once(view: View) -> None:
    with view.page() as page, view.page() as other:
        before = page.sent, other.sent
        assert view.put(camera="side", pose=POSE)["pose"] == {**POSE, "fov": None}
        for one in (page, other):
            one.is_at(POSE)
            one.settle()
            one.tell()
        said = page.sent - before[0], other.sent - before[1]
        for one in (page, other, page, other):
            one.tell()
            assert one.settle(0.3) == 0, "an answer is not answered"
        assert max(said) <= 6  # near, far, field, position, target twice
        assert view.pose == {**POSE, "fov": None}, "it does not drift with its answers"


@pytest.mark.slow
def test_what_is_told_of_before_does_not_undo_what_was_asked(view: View) -> None:
    """A camera that still glides tells of it until it has heard where it should be."""
    with view.page() as page:
        page.look(EYE, AIM)
        until(lambda: view.pose is not None)
        before = page.sent
        view.put(camera="side")
        page.look((EYE[0] + 0.1, EYE[1], EYE[2]), AIM)
        page.until_sent(before)
        page.tell()
        until(lambda: view.pose is None)


@pytest.mark.slow
@pytest.mark.parametrize("change", [{"camera": "overview"}, {"pose": None}])
def test_a_preset_takes_the_pose_back_even_the_same_again(
    view: View, change: dict[str, object]
) -> None:
    with view.page() as page:
        begun = {"position": page.camera["position"], "look_at": page.camera["lookat"]}
        page.look(EYE, AIM)
        until(lambda: view.pose is not None)
        page.forget()
        assert view.put(**change)["pose"] is None
        page.is_at(begun)
        page.tell()
        page.settle()
        assert view.pose is None


@pytest.mark.slow
def test_a_new_client_begins_where_the_last_one_looked_from(view: View) -> None:
    view.put(camera="section", pose=FARTHER)
    with view.page() as page:
        page.is_at(FARTHER)
        assert page.camera["near"] > 1.0, "the section is cut all the same"
        assert page.camera["fov"] == pytest.approx(np.radians(16.0))
        page.look(EYE, AIM)
        until(lambda: view.pose == {**POSE, "fov": None})
    with view.page() as again:
        again.is_at(POSE)
        assert view.pose == {**POSE, "fov": None}


@pytest.mark.slow
def test_a_page_that_takes_up_its_first_place_late_is_sent_on(view: View) -> None:
    """viser's page does so where it is slow to open; nobody has moved its camera there."""
    view.put(camera="side", pose=FARTHER)
    with view.page() as page:
        page.forget()
        page.begin()
        page.is_at(FARTHER)
        page.settle()
        assert view.pose == {**FARTHER, "fov": None}
        page.tell()
        page.settle()
        before = page.sent
        for _ in range(6):
            page.begin()
            page.settle(0.2)
        assert page.sent - before <= 6, "not for ever: twice, and three words each time"


@pytest.mark.slow
@pytest.mark.parametrize("eye", [(-5.0, 0.0, -8e-16), (-3.0, -3.0, 3.0)])
def test_where_a_page_is_before_it_knows_of_any_place_is_no_pose(
    view: View, eye: tuple[float, ...]
) -> None:
    """A busy browser tells of its renderer's own camera, and once more after it was welcomed."""
    view.put(camera="side", pose=FARTHER)
    page = Page(view.address, view.session)
    with page:
        page.settle()
        for _ in range(2):
            page.look(eye, (0.0, 0.0, 0.0))
            page.settle()
        assert view.pose == {**FARTHER, "fov": None}
        page.is_at(FARTHER)
        page.tell()
        page.settle()
        assert view.pose == {**FARTHER, "fov": None}
        page.look(EYE, AIM)
        until(lambda: view.pose == {**POSE, "fov": None})


@pytest.mark.slow
def test_the_client_that_moved_last_is_told(view: View) -> None:
    with view.page() as page, view.page() as other:
        page.look(EYE, AIM)
        until(lambda: view.pose is not None)
        other.look(tuple(FARTHER["position"]), AIM)
        until(lambda: view.pose == {**FARTHER, "fov": None})
        other.tell()  # back where the preset had it
        until(lambda: view.pose is None)


@pytest.mark.slow
def test_a_free_camera_says_where_it_is_and_how_wide_it_sees(view: View) -> None:
    """No preset says it: a link with ``free`` alone would show another picture."""
    with view.page() as page:
        before = page.sent
        view.put(camera="side")
        page.until_sent(before)
        side = dict(page.camera)
        page.tell()
        told = view.put(camera="free")["pose"]
        np.testing.assert_allclose(told["position"], side["position"], atol=1e-3)
        assert told["fov"] == pytest.approx(np.radians(10.0), abs=1e-4)
    other = View(view.address)
    other.put(camera="free", pose=told)
    with other.page() as page:
        page.is_at(told)
        assert page.camera["fov"] == pytest.approx(told["fov"])
    http.delete(other.resource)


@pytest.mark.slow
def test_a_camera_that_follows_keeps_its_place_beside_the_train(view: View) -> None:
    """Also one that was shifted; and an address's pose counts from the address's time."""
    here = {"position": [3.0, -6.0, 4.0], "look_at": [-2.5, 0.5, 1.0]}
    later = {key: [x + 0.5 * SPEED, y, z] for key, (x, y, z) in here.items()}
    with view.page() as page:
        before = page.sent
        view.put(camera="follow", time=0.0)
        page.until_sent(before)
        page.tell()
        page.look(tuple(here["position"]), tuple(here["look_at"]))
        until(lambda: view.pose == {**here, "fov": None})
        assert view.put(time=0.5)["pose"] == {**later, "fov": None}
        page.is_at(later)
        page.settle()
        page.tell()
        assert page.settle(0.3) == 0
        assert view.pose == {**later, "fov": None}
    other = View(view.address)
    other.put(time=0.0)
    other.put(camera="follow", pose={**later, "time": 0.5})
    with other.page() as page:
        page.is_at(here)
        assert other.put(time=0.5)["pose"] == {**later, "fov": None}
        page.is_at(later)
    http.delete(other.resource)


@pytest.mark.slow
def test_while_the_train_runs_the_camera_is_never_taken_for_moved(view: View) -> None:
    """What the page tells is of a moment before: it must not be left behind."""
    with view.page() as page:
        before = page.sent
        view.put(camera="follow", time=0.0, rate=0.2)
        page.until_sent(before)
        page.tell()
        view.put(playing=True)
        for _ in range(6):
            page.settle(0.02)
            page.tell()
        view.put(playing=False)
        page.settle()
        page.tell()
        page.settle()
        assert view.pose is None


@pytest.mark.slow
def test_another_run_is_seen_from_the_same_place(view: View) -> None:
    with view.page() as page:
        page.look(EYE, AIM)
        until(lambda: view.pose is not None)
        before = page.sent
        for run in ("another", "modes"):
            assert view.put(run=run)["pose"] == {**POSE, "fov": None}
        page.settle()
        assert page.sent == before, "it is there already"


@pytest.mark.slow
def test_a_place_beside_a_train_is_none_beside_a_mode(view: View) -> None:
    with view.page() as page:
        view.put(camera="follow", time=0.5, pose={**POSE, "time": 0.0})
        page.settle()
        page.tell()
        assert view.put(run="modes")["pose"] is None


@pytest.mark.parametrize(
    ("pose", "at"),
    [
        ({"position": [0, 0, 0]}, "/pose/look_at"),
        ({"position": [0, 0], "look_at": [1, 0, 0]}, "/pose/position"),
        ({"position": [0, 0, 2e5], "look_at": [1, 0, 0]}, "/pose/position/2"),
        ({"position": [0, 0, "1"], "look_at": [1, 0, 0]}, "/pose/position/2"),
        ({"position": [5, 5, 5], "look_at": [5, 5, 5]}, "/pose/look_at"),
        ({"position": [5, 5, 5], "look_at": [5, 5, 5.004]}, "/pose/look_at"),
        ({**POSE, "fov": 0.0}, "/pose/fov"),
        ({**POSE, "time": -1.0}, "/pose/time"),
        ({**POSE, "up": [0, 0, 1]}, "/pose/up"),
        ([1, 2, 3], "/pose"),
    ],
)
def test_a_pose_that_cannot_be_is_refused(view: View, pose: object, at: str) -> None:
    answer = http.put(view.resource, json={"camera": "side", "pose": pose})
    assert answer.status_code == 422
    assert [error["pointer"] for error in answer.json()["errors"]] == [at]
    state = http.get(view.resource).json()
    assert (state["camera"], state["pose"]) == ("overview", None)


@pytest.mark.parametrize("number", ["NaN", "1e999"])
def test_a_pose_without_end_is_refused(view: View, number: str) -> None:
    body = f'{{"pose": {{"position": [0, 0, {number}], "look_at": [1, 0, 0]}}}}'
    answer = http.put(view.resource, content=body, headers={"content-type": "application/json"})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"].startswith("/pose/position")


def test_stills_and_replays_are_seen_from_the_pose(address: str) -> None:
    image = pytest.importorskip("PIL.Image")
    base = f"http://{address}/api/v1/runs/beam/viewer"
    size = {"width": 300, "height": 200, "camera": "side"}
    pose = ",".join(str(number) for number in (*EYE, *AIM))
    pictures = []
    for query in (size, {**size, "pose": pose}):
        answer = http.get(f"{base}/still.png", params=query)
        assert answer.status_code == 200, answer.text
        pictures.append(np.asarray(image.open(BytesIO(answer.content)).convert("L"), dtype=float))
    assert np.abs(pictures[0] - pictures[1]).mean() > 2.0
    query = {"to": 0.01, "camera": "side", "pose": pose}
    assert http.get(f"{base}/replay.html", params=query).status_code == 200


@pytest.mark.parametrize("text", ["1,2,3", "1,2,3,4,5,six", "1,2,3,1,2,3", "nan,0,0,1,0,0", ","])
@pytest.mark.parametrize("file", ["still.png", "replay.html"])
def test_a_still_s_pose_that_cannot_be_is_refused(address: str, file: str, text: str) -> None:
    answer = http.get(f"http://{address}/api/v1/runs/beam/viewer/{file}", params={"pose": text})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "pose"
