"""What the 3D view costs at 20,000 coloured vertices, beside what was promised.

Run with ``python -m tests.benchmarks.viewer`` (half a minute on two free cores) and read the table.
Without Chromium the rows that need one are left out. Nothing else should compute meanwhile.
"""

from __future__ import annotations

import contextlib
import shutil
import subprocess
import sys
import time
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

import httpx
import numpy as np
from fastapi import FastAPI

from server.store import RunReader, RunWriter
from server.viewer import router
from server.viewer.decimation import MOST_VERTICES
from server.viewer.scene import Scene
from solver.results import Frame, Layer, Sample
from tests.benchmarks.table import Row, print_table
from tests.browser.waiting import LAUNCH_MS, patient
from tests.server.viewer_client import PROTOCOL, SceneClient, served
from tests.server.viewer_run import STRIDE, ExampleRun
from tests.server.viewer_waiting import PATIENCE

ALONG, ACROSS = 500, 40
"""Vertices of the slab: just as many as move at most."""
FRAMES = 150
"""More than are sent while it plays: else the stored ones would set the pace."""
FRAME_RATE = 15.0
FLAGS = (
    "--no-sandbox",
    "--use-angle=gl-egl",
    "--ignore-gpu-blocklist",
    "--disable-accelerated-2d-canvas",
)
"""Mesa's software renderer in Chromium."""

_RECEIVER = """
import sys
from websockets.sync.client import connect
options = {"max_size": None, "compression": None, "proxy": None}
with connect(sys.argv[1], subprotocols=[sys.argv[2]], **options) as connection:
    connection.recv()
    print("begun", flush=True)
    for message in connection:
        pass
"""
_HOOK = """() => {
  const scene = window.__viserMutable.scene, before = scene.onBeforeRender;
  window.rendered = 0;
  scene.onBeforeRender = (...values) => { before.apply(scene, values); window.rendered += 1; };
}"""
_COUNTS = "[window.rendered, window.trainbridgeColours.updates]"


@dataclass(frozen=True, kw_only=True)
class Streamed:
    """What a client received while a run played.

    Attributes:
        vertices: Of the surface.
        surface_bytes: Of vertices and colours in one picture.
        frame_bytes: Of the whole message, train included.
        rate: Pictures in a second. [Hz]
    """

    vertices: int
    surface_bytes: int
    frame_bytes: float
    rate: float


class CountingClient(SceneClient):
    """A client that weighs what it receives."""

    def __init__(self, address: str, session: str) -> None:
        super().__init__(address, session)
        self.sizes: list[int] = []

    def __enter__(self) -> CountingClient:
        return self

    def _take(self, packet: bytes) -> None:
        self.sizes.append(len(packet))
        super()._take(packet)


@contextlib.contextmanager
def stored_run() -> Generator[RunReader]:
    """A run of 20,000 vertices in a store, with velocities and accelerations."""
    example = ExampleRun(n_step=STRIDE * FRAMES)
    x, y = np.linspace(0.0, 58.5, ALONG), np.linspace(-3.6, 3.6, ACROSS)
    grid = np.stack(np.meshgrid(x, y, [1.335], indexing="ij"), axis=-1).reshape(-1, 3)
    at = np.arange(len(grid)).reshape(ALONG, ACROSS)
    faces = np.stack((at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]), axis=2).reshape(-1, 4)
    layers = (Layer(name="slab", faces=faces),)
    geometry = replace(example.plan.geometry, vertices=grid, layers=layers)
    plan = replace(example.plan, geometry=geometry)
    still = np.zeros(len(plan.slab.coordinates))
    with TemporaryDirectory() as folder:
        writer = RunWriter(Path(folder), plan)
        rows = example.channel_rows([item.name for item in plan.channels], 0, plan.n_sample)
        for step in range(plan.n_sample):
            frame = _frame(grid, step, len(geometry.bodies)) if step % STRIDE == 0 else None
            time_ = step * plan.time_step
            writer.append(
                Sample(step=step, time=time_, channels=rows[step], slab=still, frame=frame)
            )
        writer.finish({"verdicts": [], "timings": {}, "versions": {}, "peaks": {}})
        yield RunReader(Path(folder))


def _frame(grid: np.ndarray, step: int, n_body: int) -> Frame:
    """A travelling wave, another one at every step."""
    wave = 1e-3 * np.sin(grid[:, 0] / 3.0 + 0.02 * step) * np.cos(grid[:, 1])
    still = np.zeros(len(grid))
    return Frame(
        displacement=np.column_stack((still, still, wave)),
        bodies=np.zeros((n_body, 3)),
        velocity=10.0 * wave,
        acceleration=1e3 * wave,
    )


@contextlib.contextmanager
def opened(run: RunReader) -> Generator[tuple[str, dict[str, Any]]]:
    """An address and a new view of a run there."""
    app = FastAPI()
    app.include_router(router(lambda _: run))
    with served(app) as address:
        yield address, httpx.post(f"http://{address}/api/v1/runs/run/viewer").json()


def play(address: str, view: dict[str, Any], run: RunReader, seconds: float) -> None:
    """Plays the run once, in so many seconds, coloured by acceleration."""
    whole = run.plan.n_step * run.plan.time_step
    change = {"time": 0.0, "rate": whole / seconds, "colour": "acceleration", "playing": True}
    answer = httpx.put(f"http://{address}/api/v1/viewer/{view['session']}", json=change)
    answer.raise_for_status()


def streamed(seconds: float = 3.0) -> Streamed:
    """What travels to a client while a run plays."""
    with (
        stored_run() as run,
        opened(run) as (address, view),
        CountingClient(address, view["session"]) as client,
    ):
        client.settle()
        client.sizes.clear()
        begin = time.monotonic()  # The first pictures may come before the answer.
        play(address, view, run, seconds + 1.0)
        whole = client.nodes["/slab"]["vertices"].nbytes
        # On a busy machine the first one may be late.
        while time.monotonic() - begin < seconds or max(client.sizes, default=0) <= whole:
            assert time.monotonic() - begin < PATIENCE, "it does not play"
            client.settle(quiet=0.02)
        elapsed = time.monotonic() - begin
        vertices, colours = (
            client.nodes["/slab"]["vertices"],
            client.nodes["/slab/colours"]["colors"],
        )
        frames = [size for size in client.sizes if size > vertices.nbytes]
        return Streamed(
            vertices=vertices.size // 3,
            surface_bytes=vertices.nbytes + colours.nbytes,
            frame_bytes=float(np.median(frames)),
            rate=len(frames) / elapsed,
        )


def streaming(seconds: float) -> Iterator[Row]:
    """Bytes and pictures."""
    found = streamed(seconds)
    per_vertex = found.surface_bytes / found.vertices
    yield Row(name="vertices that move", unit="", value=found.vertices, bound=MOST_VERTICES)
    yield Row(name="surface, a vertex and picture", unit="B", value=per_vertex, bound=15.0)
    yield Row(name="whole picture with the train", unit="kB", value=found.frame_bytes / 1e3)
    yield Row(name="pictures sent in a second", unit="", value=found.rate, bound=FRAME_RATE)


def serving(seconds: float) -> Iterator[Row]:
    """Processor time of the server: reading, colouring, viser, proxy.

    The client is another process, so that its time is not in it. A machine that is busy with other
    things makes the same work cost more: its caches are theirs.
    """
    with (
        stored_run() as run,
        opened(run) as (address, view),
        patch.object(Scene, "show", autospec=True, side_effect=Scene.show) as shown,
        _receiver(f"ws://{address}/viewer/{view['session']}"),
    ):
        play(address, view, run, seconds + 2.0)
        time.sleep(1.0)
        used, sent = time.process_time(), shown.call_count
        time.sleep(seconds)
        # Where others take all of the processor no picture may come in that time.
        used, sent = time.process_time() - used, max(1, shown.call_count - sent)
    yield Row(name="server's processor, a picture", unit="ms", value=1e3 * used / sent, bound=6.0)


@contextlib.contextmanager
def _receiver(url: str) -> Generator[None]:
    """A process that receives and throws away; it says when it begins."""
    client = subprocess.Popen(
        [sys.executable, "-c", _RECEIVER, url, PROTOCOL], stdout=subprocess.PIPE
    )
    assert client.stdout is not None
    try:
        client.stdout.readline()
        yield
    finally:
        client.kill()
        client.communicate()


def rendering(chromium: str, seconds: float) -> Iterator[Row]:
    """Pictures drawn by a browser without a graphics card."""
    from playwright.sync_api import sync_playwright

    with (
        stored_run() as run,
        opened(run) as (address, view),
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(
            executable_path=chromium, args=list(FLAGS), timeout=LAUNCH_MS
        )
        page = patient(browser.new_page(viewport={"width": 1000, "height": 560}))
        page.goto(f"http://{address}{view['url']}?fixedDpr=1")
        # The page's policy forbids what wait_for_function does.
        while not page.evaluate("window.trainbridgeColours?.ok ?? false"):
            page.wait_for_timeout(100)
        page.evaluate(_HOOK)
        play(address, view, run, seconds + 2.0)
        page.wait_for_timeout(1000)
        before, begin = page.evaluate(_COUNTS), time.monotonic()
        page.wait_for_timeout(1000 * seconds)
        elapsed, after = time.monotonic() - begin, page.evaluate(_COUNTS)
        while not all(late > early for late, early in zip(after, before, strict=True)):
            # On a busy machine it may have played to its end before one was drawn.
            assert time.monotonic() - begin < PATIENCE, "nothing is drawn"
            play(address, view, run, seconds + 2.0)
            page.wait_for_timeout(1000 * seconds)
            elapsed, after = time.monotonic() - begin, page.evaluate(_COUNTS)
        browser.close()
    drawn, fresh = (late - early for late, early in zip(after, before, strict=True))
    yield Row(name="rendered picture, Chromium", unit="ms", value=1e3 * elapsed / drawn, bound=100)
    yield Row(name="new picture on the screen", unit="ms", value=1e3 * elapsed / fresh, bound=100)


def rows(*, quick: bool) -> Iterator[Row]:
    """Every measurement, as it is made."""
    seconds = 1.5 if quick else 5.0
    yield from streaming(seconds)
    yield from serving(seconds)
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium:
        yield from rendering(chromium, seconds)


def main(arguments: Sequence[str] | None = None) -> None:
    """Prints the table."""
    print_table(__doc__, rows, arguments, quick="shorter")


if __name__ == "__main__":
    main()
