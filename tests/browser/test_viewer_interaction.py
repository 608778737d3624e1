"""The 3D view in a real Chromium: clicks, camera presets, and replays without a network."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from fastapi import FastAPI

from server.errors import install_errors
from server.viewer import router
from server.viewer.camera import Preset, View, view
from tests.server.viewer_client import served
from tests.server.viewer_run import ExampleRun
from tests.server.viewer_small_runs import BeamRun

image = pytest.importorskip("PIL.Image")

RUN, BEAM = ExampleRun(), BeamRun()
WIDTH, HEIGHT = 900, 500
TIME, SCALE = 0.8, 200.0
VERMILION = np.array([213.0, 94.0, 0.0])


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    app = FastAPI()
    install_errors(app)
    app.include_router(router(lambda run: BEAM if run == "beam" else RUN))
    with served(app) as address:
        yield address


class Window:
    """A page that shows one session."""

    def __init__(self, page: Any, resource: str) -> None:
        self.page = page
        self.resource = resource

    def put(self, **change: object) -> dict[str, Any]:
        answer = httpx.put(self.resource, json=change)
        assert answer.status_code == 200, answer.text
        self.page.wait_for_timeout(600)
        return answer.json()

    def state(self) -> dict[str, Any]:
        return httpx.get(self.resource).json()

    def pixels(self) -> np.ndarray:
        return np.asarray(
            image.open(io.BytesIO(self.page.screenshot())).convert("RGB"), dtype=float
        )

    def marker(self) -> np.ndarray | None:
        """Middle of the marker in the picture, once it stands still."""
        before = None
        for _ in range(30):
            rows, columns = np.nonzero(_like(self.pixels(), VERMILION))
            now = np.array([columns.mean(), rows.mean()]) if len(rows) > 3 else None
            if now is not None and before is not None and np.allclose(now, before, atol=0.2):
                return now
            before = now
            self.page.wait_for_timeout(200)
        return None


def _like(picture: np.ndarray, colour: np.ndarray) -> np.ndarray:
    """Pixels of a colour, in whatever light."""
    length = np.linalg.norm(picture, axis=2)
    cosine = picture @ colour / np.where(length > 0, length, 1.0) / np.linalg.norm(colour)
    return (cosine > 0.97) & (length > 120.0)


@pytest.fixture
def window(chromium: Any, address: str) -> Iterator[Window]:
    opened = httpx.post(f"http://{address}/api/v1/runs/run/viewer").json()
    page = chromium.new_page(viewport={"width": WIDTH, "height": HEIGHT})
    page.goto(f"http://{address}{opened['url']}?fixedDpr=1")
    page.wait_for_selector("canvas[data-engine]")
    window = Window(page, f"http://{address}/api/v1/viewer/{opened['session']}")
    for _ in range(60):
        if window.state()["clients"] and np.ptp(window.pixels()) > 60.0:
            break
        page.wait_for_timeout(250)
    # Forces and wheels have nearly the marker's colour, or cover it.
    window.put(time=TIME, scale=SCALE, layers=["slab", "beam", "walls"], camera="overview")
    yield window
    page.close()
    httpx.delete(window.resource)


def looks(preset: Preset) -> View:
    first_axle = RUN.plan.start_position + RUN.plan.speed * TIME
    return view(preset, RUN.plan.geometry, first_axle, WIDTH / HEIGHT)


def pixel(camera: View, point: np.ndarray) -> np.ndarray:
    """Where a point is seen, by the pinhole's equations."""
    forward = camera.target - camera.position
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right = right / np.linalg.norm(right)
    away = point - camera.position
    focus = HEIGHT / 2.0 / np.tan(camera.field / 2.0)
    across, down = away @ right, away @ np.cross(forward, right)
    return np.array([WIDTH / 2.0, HEIGHT / 2.0]) + focus * np.array([across, down]) / (
        away @ forward
    )


def edge_vertex(x: float) -> int:
    """The slab's vertex on the near edge."""
    vertices = RUN.plan.geometry.vertices
    slab = next(layer for layer in RUN.plan.geometry.layers if layer.name == "slab")
    used = np.unique(slab.faces)
    far = np.abs(vertices[used] - np.array([x, -3.6, 1.335])).sum(axis=1)
    return int(used[np.argmin(far)])


def displayed(vertex: int) -> np.ndarray:
    """Where a vertex is at the moment and scale that are shown."""
    index = round(TIME / (RUN.plan.time_step * RUN.plan.frame_stride))
    displacement = RUN.frame(index).displacement[vertex]
    return RUN.plan.geometry.vertices[vertex] + SCALE * displacement


def test_the_clicked_point_is_that_point(window: Window) -> None:
    vertex = edge_vertex(27.0)
    at = pixel(looks("overview"), displayed(vertex))
    # The edge itself is half a pixel wide: click a little way onto the slab.
    window.page.mouse.click(at[0], at[1] - 1.5)
    window.page.wait_for_timeout(600)
    picked = window.state()["picked"]
    assert picked is not None
    assert picked["layer"] == "slab"
    assert picked["sequence"] == 1
    np.testing.assert_allclose(picked["point"], RUN.plan.geometry.vertices[vertex])
    marker = window.marker()
    assert marker is not None
    np.testing.assert_allclose(marker, at, atol=2.5)  # a ball of some five pixels


def test_every_preset_looks_from_where_it_says(window: Window) -> None:
    """The marker on a known vertex is seen where the pinhole's equations put it."""
    vertex = edge_vertex(35.0)
    at = pixel(looks("overview"), displayed(vertex))
    window.page.mouse.click(at[0], at[1] - 1.5)
    window.page.wait_for_timeout(600)
    np.testing.assert_allclose(
        window.state()["picked"]["point"], RUN.plan.geometry.vertices[vertex]
    )
    for preset in ("side", "follow", "section", "overview"):
        window.put(camera=preset)
        expected, marker = pixel(looks(preset), displayed(vertex)), window.marker()
        inside = bool((expected > 0).all() and expected[0] < WIDTH and expected[1] < HEIGHT)
        assert (marker is not None) == inside, preset
        if marker is not None:
            # The slab hides up to half of the ball, which is some 25 pixels wide from near.
            np.testing.assert_allclose(marker, expected, atol=10.0, err_msg=preset)


def test_dragging_turns_the_camera_and_picks_nothing(window: Window) -> None:
    before = window.pixels()
    at = pixel(looks("overview"), displayed(edge_vertex(27.0)))
    mouse = window.page.mouse
    mouse.move(at[0], at[1] - 2.0)
    mouse.down()
    mouse.move(at[0] + 30.0, at[1] + 10.0, steps=4)
    mouse.up()
    window.page.wait_for_timeout(800)
    assert window.state()["picked"] is None
    assert np.mean(np.abs(window.pixels() - before).max(axis=2) > 12) > 0.01


@pytest.mark.parametrize("change", [{"theme": "dark"}, {"smooth": False}])
def test_a_scene_that_is_drawn_anew_is_seen_from_where_one_was(
    window: Window, change: dict[str, object]
) -> None:
    where = "window.__viserMutable.camera.position.toArray()"
    window.put(camera="side")
    before = window.page.evaluate(where)
    window.put(camera="free")
    window.put(**change)
    window.page.wait_for_timeout(800)
    # A camera that went back to its beginning would be tens of metres away.
    np.testing.assert_allclose(window.page.evaluate(where), before, atol=1e-3)


_OWN_LAMPS = """() => {
  let bright = 0;
  window.__viserMutable.scene.traverse((thing) => {
    if (thing.isLight && thing.visible) bright += 1;
  });
  return bright === 3;
}"""
"""A sky and two lamps shine: the scene's own."""


def test_a_replay_plays_from_disk_without_a_network(
    chromium: Any, address: str, tmp_path: Path
) -> None:
    query = {"from": 0.0, "to": 0.2, "colour": "displacement", "scale": 500.0}
    answer = httpx.get(
        f"http://{address}/api/v1/runs/beam/viewer/replay.html", params=query, timeout=30.0
    )
    assert answer.status_code == 200
    file = tmp_path / "replay.html"
    file.write_bytes(answer.content)
    context = chromium.new_context(viewport={"width": WIDTH, "height": HEIGHT}, offline=True)
    page = context.new_page()
    asked: list[str] = []
    errors: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(file.as_uri())
    page.wait_for_selector("canvas[data-engine]")
    window = Window(page, "")
    for _ in range(80):
        if np.mean(np.abs(window.pixels() - 255.0).max(axis=2) > 12) > 0.08:
            break
        page.wait_for_timeout(250)
    assert "t = 0.000 to 0.200 s" in page.inner_text("#replay-words")
    assert "displacement [mm]" in page.inner_text("#replay-bar")
    page.wait_for_function("window.trainbridgeColours?.updates > 3", timeout=20_000)
    pictures = [window.pixels()[90:440]]
    for _ in range(8):
        page.wait_for_timeout(400)
        pictures.append(window.pixels()[90:440])
    moved = max(np.mean(np.abs(one - pictures[0]).max(axis=2) > 12) for one in pictures[1:])
    assert moved > 0.005
    # The yellow of the greatest displacement is on the bridge, and plays with it.
    assert _like(np.array(pictures).reshape(-1, WIDTH, 3), np.array([254.0, 232.0, 56.0])).any()
    # It has begun anew several times since, and the light is still that of the scene.
    assert page.evaluate("window.__viserMutable.scene.environment") is None
    page.wait_for_function(_OWN_LAMPS, timeout=10_000)
    outside = [url for url in asked if not url.startswith(("file:", "blob:", "data:"))]
    assert outside == []
    assert errors == []
    context.close()
