"""The 3D view in a real Chromium: its pixels follow the time, and stand when it stands."""

from __future__ import annotations

import io
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from fastapi import FastAPI

from server.viewer import router
from tests.server.viewer_client import served
from tests.server.viewer_run import ExampleRun

sync_api = pytest.importorskip("playwright.sync_api")
image = pytest.importorskip("PIL.Image")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        CHROMIUM is None,
        reason="needs the Debian packages chromium libegl1 libegl-mesa0 libgl1-mesa-dri",
    ),
]

# Mesa's software renderer, about 200 times faster than Chromium's own.
FLAGS = [
    "--no-sandbox",
    "--use-angle=gl-egl",
    "--ignore-gpu-blocklist",
    "--disable-accelerated-2d-canvas",
]


class View:
    """A page that shows one viewing session."""

    def __init__(self, page: Any, resource: str) -> None:
        self.page = page
        self.resource = resource

    def put(self, **change: object) -> None:
        """Changes what is shown."""
        assert httpx.put(self.resource, json=change).status_code == 200

    def pixels(self) -> np.ndarray:
        """The page's picture, shape (height, width, 3)."""
        # Page screenshots: those of a locator miss the canvas.
        picture = image.open(io.BytesIO(self.page.screenshot()))
        return np.asarray(picture.convert("RGB"), dtype=np.int16)

    def settled(self) -> np.ndarray:
        """The picture once two in a row are equal."""
        before = self.pixels()
        for _ in range(40):
            self.page.wait_for_timeout(250)
            now = self.pixels()
            if np.array_equal(before, now):
                return now
            before = now
        raise AssertionError("the picture does not come to rest")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(params=["light", "dark"])
def view(browser: Any, request: pytest.FixtureRequest) -> Iterator[View]:
    app = FastAPI()
    app.include_router(router(lambda _: ExampleRun()))
    with served(app) as address:
        opened = httpx.post(
            f"http://{address}/api/v1/runs/run/viewer", json={"theme": request.param}
        ).json()
        page = browser.new_page(viewport={"width": 900, "height": 500})
        # Without this viser lowers the resolution where the machine is slow, and pixels change.
        page.goto(f"http://{address}{opened['url']}?fixedDpr=1")
        resource = f"http://{address}/api/v1/viewer/{opened['session']}"
        page.wait_for_selector("canvas[data-engine]")
        view = View(page, resource)
        _wait_for_scene(view)
        yield view
        page.close()


def _wait_for_scene(view: View) -> None:
    """Until the background is no longer all there is."""
    for _ in range(60):
        if drawn(view.pixels()) > 0.05:
            return
        view.page.wait_for_timeout(250)
    raise AssertionError("nothing was drawn")


def drawn(pixels: np.ndarray) -> float:
    """Share of pixels that differ from the top left one, which is background."""
    return float(np.mean(np.abs(pixels - pixels[0, 0]).max(axis=2) > 12))


def changed(one: np.ndarray, other: np.ndarray) -> float:
    """Share of pixels that differ visibly."""
    return float(np.mean(np.abs(one - other).max(axis=2) > 12))


def test_pixels_change_with_the_time_and_only_with_it(view: View) -> None:
    pictures = []
    for time in (0.60, 0.90, 1.20):
        view.put(time=time, scale=200.0)
        view.page.wait_for_timeout(500)
        picture = view.settled()
        view.page.wait_for_timeout(1000)
        assert np.array_equal(picture, view.pixels()), "the time stands still"
        pictures.append(picture)
    # The train alone covers several percent of the picture; half a percent is far above noise.
    assert changed(pictures[0], pictures[1]) > 0.005
    assert changed(pictures[1], pictures[2]) > 0.005
    view.put(time=0.60)
    view.page.wait_for_timeout(500)
    assert changed(view.settled(), pictures[0]) < 0.001, "the same time is the same picture"
    _keep(view, "overview")


def test_presets_hidden_layers_and_playing_show(view: View) -> None:
    view.put(time=0.8)
    view.page.wait_for_timeout(500)
    overview = view.settled()
    for camera in ("side", "section", "follow"):
        view.put(camera=camera)
        view.page.wait_for_timeout(500)
        assert changed(overview, view.settled()) > 0.02, camera
        _keep(view, camera)
    view.put(camera="overview")
    view.page.wait_for_timeout(500)
    assert changed(overview, view.settled()) < 0.001
    view.put(layers=["slab"])
    view.page.wait_for_timeout(500)
    assert drawn(view.settled()) < 0.7 * drawn(overview)
    view.put(layers=["slab", "wheels"], playing=True)
    first = view.pixels()
    view.page.wait_for_timeout(1000)
    assert changed(first, view.pixels()) > 0.001


def _keep(view: View, name: str) -> None:
    """Leaves a screenshot where the variable ``TRAINBRIDGE_SCREENSHOTS`` says, for people."""
    folder = os.environ.get("TRAINBRIDGE_SCREENSHOTS")
    if folder:
        theme = httpx.get(view.resource).json()["theme"]
        view.page.screenshot(path=Path(folder) / f"viewer-{name}-{theme}.png")
