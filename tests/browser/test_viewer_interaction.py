"""The 3D view in a real Chromium: clicks, camera presets, and replays without a network."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from fastapi import FastAPI

from server.errors import install_errors
from server.viewer import router
from server.viewer.camera import Preset, View, view
from tests.browser.viewer_page import SEEN_AT
from tests.browser.waiting import PATIENCE, patient, pixels_at_rest, until
from tests.server.viewer_client import served
from tests.server.viewer_run import ExampleRun
from tests.server.viewer_small_runs import BeamRun

image = pytest.importorskip("PIL.Image")

RUN, BEAM = ExampleRun(), BeamRun()
WIDTH, HEIGHT = 900, 500
TIME, SCALE = 0.8, 200.0
(SLAB,) = (np.unique(layer.faces) for layer in RUN.plan.geometry.layers if layer.name == "slab")
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
        answer = httpx.put(self.resource, json=change, timeout=PATIENCE)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def state(self) -> dict[str, Any]:
        return httpx.get(self.resource, timeout=PATIENCE).json()

    def pixels(self) -> np.ndarray:
        return np.asarray(
            image.open(io.BytesIO(self.page.screenshot())).convert("RGB"), dtype=float
        )

    def settled(
        self,
        met: Callable[[np.ndarray], Any] = lambda _: True,
        what: str = "a picture that stands still",
    ) -> np.ndarray:
        """The picture once it stands still and shows what is waited for."""
        return pixels_at_rest(self.pixels, self.page, met, what)

    def until_marked_at(self, expected: np.ndarray | None, atol: float, what: str) -> None:
        """Waits until the marker rests at a place of the picture; None: until there is none."""

        def met(picture: np.ndarray) -> bool:
            at = _marker(picture)
            if at is None or expected is None:
                return at is expected
            return np.allclose(at, expected, atol=atol, rtol=0.0)

        self.settled(met, f"{what}: marker at {expected}")

    def picked(self) -> dict[str, Any]:
        """The point that a click hit, once the server has found it."""
        return until(lambda: self.state()["picked"], "the clicked point", page=self.page)

    def until_seen_at(self, vertex: int, expected: np.ndarray) -> None:
        """Waits until the page draws a vertex of the slab at a place: camera, time and scale."""
        until(
            lambda: self.page.evaluate(SEEN_AT, int(np.searchsorted(SLAB, vertex))),
            f"vertex {vertex} is drawn at {expected}",
            page=self.page,
            met=lambda at: at is not None and np.allclose(at, expected, atol=0.5, rtol=0.0),
        )


def _marker(picture: np.ndarray) -> np.ndarray | None:
    """Middle of the marker in a picture."""
    rows, columns = np.nonzero(_like(picture, VERMILION))
    return np.array([columns.mean(), rows.mean()]) if len(rows) > 3 else None


def _changed(one: np.ndarray, other: np.ndarray) -> float:
    """Share of pixels that differ visibly."""
    return float(np.mean(np.abs(one - other).max(axis=2) > 12))


def _like(picture: np.ndarray, colour: np.ndarray) -> np.ndarray:
    """Pixels of a colour, in whatever light."""
    length = np.linalg.norm(picture, axis=2)
    cosine = picture @ colour / np.where(length > 0, length, 1.0) / np.linalg.norm(colour)
    return (cosine > 0.97) & (length > 120.0)


@pytest.fixture
def window(chromium: Any, address: str) -> Iterator[Window]:
    where = f"http://{address}/api/v1/runs/run/viewer"
    opened = httpx.post(where, timeout=PATIENCE).json()
    page = patient(chromium.new_page(viewport={"width": WIDTH, "height": HEIGHT}))
    page.goto(f"http://{address}{opened['url']}?fixedDpr=1")
    page.wait_for_selector("canvas[data-engine]")
    window = Window(page, f"http://{address}/api/v1/viewer/{opened['session']}")
    until(
        lambda: window.state()["clients"] and np.ptp(window.pixels()) > 60.0,
        "something is drawn",
        page=page,
    )
    # Forces and wheels have nearly the marker's colour, or cover it.
    window.put(time=TIME, scale=SCALE, layers=["slab", "beam", "walls"], camera="overview")
    vertex = edge_vertex(27.0)
    window.until_seen_at(vertex, pixel(looks("overview"), displayed(vertex)))
    window.settled(lambda picture: _marker(picture) is None, "the deck without the train")
    yield window
    page.close()
    httpx.delete(window.resource, timeout=PATIENCE)


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
    far = np.abs(RUN.plan.geometry.vertices[SLAB] - np.array([x, -3.6, 1.335])).sum(axis=1)
    return int(SLAB[np.argmin(far)])


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
    picked = window.picked()
    assert picked["layer"] == "slab"
    assert picked["sequence"] == 1
    np.testing.assert_allclose(picked["point"], RUN.plan.geometry.vertices[vertex])
    window.until_marked_at(at, 2.5, "a ball of some five pixels")


def test_every_preset_looks_from_where_it_says(window: Window) -> None:
    """The marker on a known vertex is seen where the pinhole's equations put it."""
    vertex = edge_vertex(35.0)
    at = pixel(looks("overview"), displayed(vertex))
    window.page.mouse.click(at[0], at[1] - 1.5)
    np.testing.assert_allclose(window.picked()["point"], RUN.plan.geometry.vertices[vertex])
    for preset in ("side", "follow", "section", "overview"):
        window.put(camera=preset)
        expected = pixel(looks(preset), displayed(vertex))
        inside = bool((expected > 0).all() and expected[0] < WIDTH and expected[1] < HEIGHT)
        # The slab hides up to half of the ball, which is some 25 pixels wide from near.
        window.until_marked_at(expected if inside else None, 10.0, preset)


def test_dragging_turns_the_camera_and_picks_nothing(window: Window) -> None:
    before = window.settled()
    at = pixel(looks("overview"), displayed(edge_vertex(27.0)))
    mouse = window.page.mouse
    mouse.move(at[0], at[1] - 2.0)
    mouse.down()
    mouse.move(at[0] + 30.0, at[1] + 10.0, steps=4)
    mouse.up()
    window.settled(lambda picture: _changed(before, picture) > 0.01, "the camera is turned")
    assert window.state()["picked"] is None


@pytest.mark.parametrize("change", [{"theme": "dark"}, {"smooth": False}])
def test_a_scene_that_is_drawn_anew_is_seen_from_where_one_was(
    window: Window, change: dict[str, object]
) -> None:
    where = "window.__viserMutable.camera.position.toArray()"
    vertex = edge_vertex(27.0)
    window.put(camera="side", colour="displacement")
    window.until_seen_at(vertex, pixel(looks("side"), displayed(vertex)))
    light = window.settled()
    before = window.page.evaluate(where)
    window.put(camera="free")
    window.put(**change)
    if "theme" in change:
        window.settled(lambda picture: _changed(light, picture) > 0.5, "the dark scene")
    else:
        squares = "Boolean(window.__viserMutable.nodeRefFromName['/slab-elements'])"
        until(lambda: window.page.evaluate(squares), "a square for each element", page=window.page)
        window.settled()
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
        f"http://{address}/api/v1/runs/beam/viewer/replay.html", params=query, timeout=PATIENCE
    )
    assert answer.status_code == 200
    file = tmp_path / "replay.html"
    file.write_bytes(answer.content)
    context = patient(
        chromium.new_context(viewport={"width": WIDTH, "height": HEIGHT}, offline=True)
    )
    page = context.new_page()
    asked: list[str] = []
    errors: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(file.as_uri())
    page.wait_for_selector("canvas[data-engine]")
    window = Window(page, "")
    white = np.full((HEIGHT, WIDTH, 3), 255.0)
    until(
        lambda: _changed(white, window.pixels()),
        "the replay is drawn",
        page=page,
        met=lambda share: share > 0.08,
    )
    assert "t = 0.000 to 0.200 s" in page.inner_text("#replay-words")
    assert "displacement [mm]" in page.inner_text("#replay-bar")
    page.wait_for_function("window.trainbridgeColours?.updates > 3")
    first = window.pixels()[90:440]
    moved, yellow = 0.0, False

    def look() -> tuple[float, bool]:
        nonlocal moved, yellow
        now = window.pixels()[90:440]
        moved = max(moved, _changed(first, now))
        # The yellow of the greatest displacement is on the bridge, and plays with it.
        yellow = yellow or bool(_like(now, np.array([254.0, 232.0, 56.0])).any())
        return moved, yellow

    until(
        look,
        "the replay moves, and shows the greatest displacement",
        page=page,
        met=lambda seen: seen[0] > 0.005 and seen[1],
    )
    # It has begun anew several times since, and the light is still that of the scene.
    assert page.evaluate("window.__viserMutable.scene.environment") is None
    page.wait_for_function(_OWN_LAMPS)
    outside = [url for url in asked if not url.startswith(("file:", "blob:", "data:"))]
    assert outside == []
    assert errors == []
    context.close()
