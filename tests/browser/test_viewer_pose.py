"""A shared link shows the same picture in 3D, also where somebody turned the camera by hand."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Callable, Iterator
from typing import Any
from urllib.parse import parse_qs

import numpy as np
import pytest

from tests.browser.waiting import DONE_MS, patient, until

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
image = pytest.importorskip("PIL.Image")
expect = sync_api.expect

WHERE = """() => {
  const camera = window.__viserMutable?.camera;
  if (!camera) return null;
  const { x, y, z } = camera.position;
  return [-z, -x, y, camera.fov];
}"""
"""Eye, from viser's axes into ours, in which z is up [m], and field of view [degrees]."""
SIDE, FOLLOW = 10.0, 34.0


@pytest.fixture(scope="module")
def job(chromium: Any, server: str) -> Iterator[str]:
    """A crossing of seconds, done."""
    context = patient(chromium.new_context(base_url=server))
    study = context.request.get("/api/v1/templates/sprung-mass-beam").json()
    body = {"kind": "crossing", "study": study}
    made = context.request.post("/api/v1/jobs", data=body).json()["id"]
    until(
        lambda: context.request.get(f"/api/v1/jobs/{made}").json()["state"],
        "the crossing is done",
        met=lambda state: state == "done",
        seconds=DONE_MS / 1e3,
    )
    yield made
    context.close()


class Watcher:
    """Somebody who looks at the 3D view of a job."""

    def __init__(self, page: Any, address: str, field: float) -> None:
        self.page = page
        self.asked: list[str] = []
        page.on("request", self._note)
        page.goto(address)
        page.locator("tb-viewer-frame[data-session]").wait_for()
        self.until(lambda: self.camera()[3:], f"a field of {field} degrees", lambda f: f == [field])

    def until(self, look: Callable[[], Any], what: str, met: Callable[[Any], Any] = bool) -> Any:
        return until(look, what, page=self.page, met=met)

    def camera(self) -> list[float]:
        """Where the page has its camera now, and how wide it sees."""
        frames = [frame for frame in self.page.frames if "/viewer/" in frame.url]
        seen = frames[0].evaluate(WHERE) if frames else None
        return [] if seen is None else [*seen[:3], round(seen[3], 6)]

    def state(self) -> dict[str, Any]:
        session = self.page.locator("tb-viewer-frame").get_attribute("data-session")
        return dict(self.page.request.get(f"/api/v1/viewer/{session}").json())

    @property
    def said(self) -> dict[str, str]:
        """What the address says of the picture."""
        return {key: value for key, (value,) in parse_qs(self.page.url.partition("?")[2]).items()}

    @property
    def pose(self) -> list[float]:
        """In the address."""
        return [float(number) for number in self.said.get("pose", "").split(",") if number]

    def told(self) -> list[float]:
        """What the server knows."""
        pose = self.state()["pose"]
        return [] if pose is None else [*pose["position"], *pose["look_at"]]

    def turn(self) -> list[float]:
        """Drags the view; gives the pose of the address once the camera is at rest."""
        at = self.page.locator("tb-viewer-frame iframe").bounding_box()
        x, y = at["x"] + 0.5 * at["width"], at["y"] + 0.5 * at["height"]
        mouse = self.page.mouse
        mouse.move(x, y)
        mouse.down()
        mouse.move(x + 80.0, y + 30.0, steps=5)
        mouse.up()
        return self.until(lambda: self.pose, "a pose", lambda pose: pose and pose == self.told())

    def is_at(self, pose: list[float]) -> None:
        """Waits until the camera is there, to the millimetre."""
        self.until(
            self.camera,
            f"the camera at {pose}",
            lambda seen: seen and np.allclose(seen[:3], pose[:3], atol=2e-3),
        )

    def pixels(self) -> np.ndarray:
        clip = self.page.locator("tb-viewer-frame iframe").bounding_box()
        shot = image.open(io.BytesIO(self.page.screenshot(clip=clip))).convert("RGB")
        return np.asarray(shot, dtype=float)

    def pose_requests(self) -> int:
        """How often the page has told the server a pose."""
        return sum("pose" in json.loads(body) for body in self.asked)

    def _note(self, request: Any) -> None:
        if request.method == "PUT" and "/api/v1/viewer/" in request.url:
            self.asked.append(request.post_data)


def apart(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.abs(one - other).mean())


@pytest.fixture
def watch(new_page: Callable[..., Any]) -> Callable[[str, float], Watcher]:
    def opened(address: str, field: float) -> Watcher:
        page = new_page(viewer=True, viewport={"width": 1280, "height": 860})
        return Watcher(page, address, field)

    return opened


def test_a_link_shows_what_somebody_turned_to(
    job: str, watch: Callable[[str, float], Watcher], picture: Callable[[Any, str], None]
) -> None:
    one = watch(f"/#/jobs/{job}?camera=side&t=0.3", SIDE)
    preset, usual = one.pixels(), one.camera()
    assert one.pose == one.told() == []
    pose = one.turn()
    expect(one.page.get_by_label("Camera")).to_have_value("free")
    assert one.said["camera"] == "side"
    assert one.pose_requests() == 0, "what the viewer said itself is not sent back"
    moved = one.until(one.pixels, "the picture turns", lambda seen: apart(seen, preset) > 1.0)
    other = watch(one.page.url, SIDE)
    other.is_at(pose)
    one.is_at(pose)
    other.until(
        lambda: apart(one.pixels(), other.pixels()),
        f"the same picture; the preset's is {apart(moved, preset)} away",
        lambda far: far < 0.1 * apart(moved, preset),
    )
    assert other.page.url == one.page.url
    assert other.pose_requests() == 1
    picture(one.page, "pose-turned")
    picture(other.page, "pose-linked")
    # The preset brings it back, the same one too.
    one.page.get_by_label("Camera").select_option("side")
    expect(one.page).not_to_have_url(re.compile("pose="))
    one.until(one.camera, "the camera is back", lambda seen: np.allclose(seen, usual, atol=1e-2))
    assert one.until(one.told, "no pose is left", lambda told: told == []) == []
    expect(one.page).not_to_have_url(re.compile("pose="))


def test_a_camera_beside_the_train_is_where_it_was_at_that_time(
    job: str, watch: Callable[[str, float], Watcher]
) -> None:
    one = watch(f"/#/jobs/{job}?camera=follow&t=0.3", FOLLOW)
    before = one.turn()
    expect(one.page.get_by_label("Camera")).to_have_value("follow")
    one.page.locator("h1").click()
    one.page.keyboard.press("Shift+ArrowRight")
    after = one.until(lambda: one.pose, "it goes along", lambda pose: pose and pose[0] > before[0])
    step = np.subtract(after, before)
    np.testing.assert_allclose(step, [step[0], 0, 0, step[0], 0, 0], atol=2e-3)
    other = watch(one.page.url, FOLLOW)
    other.is_at(after)
    assert other.page.url == one.page.url
    assert other.state()["time"] == pytest.approx(one.state()["time"], abs=1e-4)
