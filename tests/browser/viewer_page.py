"""A page that shows one viewing session, for tests in a real Chromium."""

from __future__ import annotations

import contextlib
import io
import os
import shutil
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from fastapi import FastAPI

from server.viewer import router
from server.viewer.source import FrameSource
from tests.browser.waiting import (
    LAUNCH_MS,
    PATIENCE,
    patient,
    patient_expectations,
    pixels_at_rest,
    until,
)
from tests.server.viewer_client import served

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
NEEDS_CHROMIUM = pytest.mark.skipif(
    CHROMIUM is None,
    reason="needs the Debian packages chromium libegl1 libegl-mesa0 libgl1-mesa-dri",
)
FLAGS = [
    "--no-sandbox",
    "--use-angle=gl-egl",
    "--ignore-gpu-blocklist",
    "--disable-accelerated-2d-canvas",
]
"""Mesa's software renderer, about 200 times faster than Chromium's own."""
MESH = """const mesh = window.__viserMutable?.nodeRefFromName["/slab"]?.children
  .find((child) => child.isMesh);"""
"""The slab as the page has it."""
SEEN_AT = f"""(index) => {{ {MESH}
  if (!mesh) return null;
  const at = mesh.geometry.attributes.position.array.slice(3 * index, 3 * index + 3);
  const camera = window.__viserMutable.camera;
  const point = new camera.position.constructor(...at);
  mesh.localToWorld(point).project(camera);
  return [(point.x + 1) / 2 * window.innerWidth, (1 - point.y) / 2 * window.innerHeight]; }}"""
"""Where a vertex of the slab is in the picture. [px]"""


class View:
    """A page that shows one viewing session."""

    def __init__(self, page: Any, resource: str) -> None:
        self.page = page
        self.resource = resource

    def put(self, **change: object) -> dict[str, Any]:
        """Changes what is shown."""
        answer = httpx.put(self.resource, json=change, timeout=PATIENCE)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def state(self) -> dict[str, Any]:
        """What is shown."""
        return httpx.get(self.resource, timeout=PATIENCE).json()

    def pixels(self) -> np.ndarray:
        """The page's picture, shape (height, width, 3)."""
        from PIL import Image

        # Page screenshots: those of a locator miss the canvas.
        picture = Image.open(io.BytesIO(self.page.screenshot()))
        return np.asarray(picture.convert("RGB"), dtype=np.int16)

    def settled(
        self,
        met: Callable[[np.ndarray], Any] = lambda _: True,
        what: str = "a picture that stands still",
        apart: float = 0.1,
    ) -> np.ndarray:
        """The picture once three in a row are equal, and it shows what is waited for."""
        return pixels_at_rest(self.pixels, self.page, met, what, apart)

    def until(self, script: str) -> None:
        """Waits until a script gives something true; the page's policy forbids the usual way."""
        until(lambda: self.page.evaluate(script), script, page=self.page)

    def reach(self, run: FrameSource, time: float, **change: object) -> dict[str, Any]:
        """Shows a time and waits until the slab is where the run has it; others may be served."""
        state = self.put(time=time, **change)
        plan = run.plan
        (layer,) = (layer for layer in plan.geometry.layers if layer.name == "slab")
        slab = np.unique(layer.faces)
        index = round(time / (plan.frame_stride * plan.time_step))
        moved = run.frame(index).displacement[slab]
        vertex = int(np.argmax(np.abs(moved[:, 2])))
        wanted = plan.geometry.vertices[slab[vertex], 2] + state["scale"] * moved[vertex, 2]
        self.until(
            f"""() => {{ {MESH}
              const at = mesh?.geometry.attributes.position.array[{3 * vertex + 2}];
              return Math.abs(at - {wanted:.9g}) < 1e-5; }}"""
        )
        return state

    def keep(self, name: str) -> None:
        """Leaves a screenshot where the variable ``TRAINBRIDGE_SCREENSHOTS`` says, for people."""
        folder = os.environ.get("TRAINBRIDGE_SCREENSHOTS")
        if folder:
            path = Path(folder) / f"viewer-{name}-{self.state()['theme']}.png"
            self.page.screenshot(path=path)


def launched() -> Iterator[Any]:
    """A browser that draws with Mesa."""
    sync_api = pytest.importorskip("playwright.sync_api")
    patient_expectations()
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=CHROMIUM, args=FLAGS, timeout=LAUNCH_MS
        )
        yield browser
        browser.close()


@contextlib.contextmanager
def viewed(browser: Any, run: FrameSource, theme: str) -> Generator[View]:
    """A view of a run, once something is drawn."""
    app = FastAPI()
    app.include_router(router(lambda _: run))
    with served(app) as address:
        opened = httpx.post(
            f"http://{address}/api/v1/runs/run/viewer", json={"theme": theme}, timeout=PATIENCE
        ).json()
        page = patient(browser.new_page(viewport={"width": 900, "height": 500}))
        # Without this viser lowers the resolution where the machine is slow, and pixels change.
        page.goto(f"http://{address}{opened['url']}?fixedDpr=1")
        page.wait_for_selector("canvas[data-engine]")
        view = View(page, f"http://{address}/api/v1/viewer/{opened['session']}")
        until(
            lambda: drawn(view.pixels()),
            "something is drawn",
            page=page,
            met=lambda share: share > 0.05,
        )
        yield view
        page.close()


def drawn(pixels: np.ndarray) -> float:
    """Share of pixels that differ from the top left one, which is background."""
    return float(np.mean(np.abs(pixels - pixels[0, 0]).max(axis=2) > 12))


def changed(one: np.ndarray, other: np.ndarray) -> float:
    """Share of pixels that differ visibly."""
    return float(np.mean(np.abs(one - other).max(axis=2) > 12))
