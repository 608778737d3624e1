"""What a browser receives through the proxy, decoded, against what is stored."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx
import numpy as np
import pytest
from fastapi import FastAPI

from server.store import RunReader, RunWriter
from server.viewer import ViewerLimits, router
from server.viewer.picture import Picture, PictureMaker
from solver.results import Sample
from tests.server.viewer_client import SceneClient, served
from tests.server.viewer_run import RAIL_TOP, SPEED, START, STRIDE, TIME_STEP, ExampleRun

RUN = ExampleRun()
INTERVAL = STRIDE * TIME_STEP


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    app = FastAPI()
    app.include_router(router(lambda _: RUN, ViewerLimits(idle=30.0)))
    with served(app) as address:
        yield address


@pytest.fixture
def view(address: str) -> Iterator[tuple[SceneClient, str]]:
    opened = httpx.post(f"http://{address}/api/v1/runs/run-1/viewer", json={}).json()
    resource = f"http://{address}/api/v1/viewer/{opened['session']}"
    with SceneClient(address, opened["session"]) as client:
        client.settle()
        yield client, resource
    httpx.delete(resource)


def put(resource: str, **change: object) -> dict[str, object]:
    answer = httpx.put(resource, json=change)
    assert answer.status_code == 200, answer.text
    return answer.json()


@pytest.mark.parametrize(("time", "scale"), [(0.40, 200.0), (0.80, 500.0), (1.50, 1.0)])
def test_vertices_and_wheels_are_the_stored_ones(
    view: tuple[SceneClient, str], time: float, scale: float
) -> None:
    client, resource = view
    put(resource, time=time, scale=scale)
    client.settle()
    geometry, index = RUN.plan.geometry, round(time / INTERVAL)
    stored = geometry.vertices + scale * RUN.frame(index).displacement
    for layer in geometry.layers:
        used = np.unique(layer.faces)
        sent = client.nodes[f"/{layer.name}"]["vertices"].reshape(-1, 3)
        # float32 on the wire: half a unit in the last place of 64 m is 4e-6 m.
        np.testing.assert_allclose(sent, stored[used], atol=5e-6, rtol=0.0)

    step, wheels = index * STRIDE, geometry.wheels
    names = [f"{name}/displacement" for name in wheels.names]
    displacement = RUN.channel_rows(names, step, step + 1)[0]
    sent = client.nodes["/wheels"]["batched_positions"].reshape(-1, 3)
    assert sent.shape == (92, 3)
    # Half a unit in the last place of 512 m.
    np.testing.assert_allclose(
        sent[:, 0], START + SPEED * step * TIME_STEP + wheels.offsets, atol=3.1e-5, rtol=0.0
    )
    np.testing.assert_allclose(sent[:, 1], wheels.lateral, atol=1e-7)
    np.testing.assert_allclose(sent[:, 2], RAIL_TOP + 0.46 + scale * displacement, atol=1e-6)


def test_the_stored_peak_bends_the_span_under_the_train(view: tuple[SceneClient, str]) -> None:
    """At t = 0.75 s the first bogies stand on the second span and none on the third."""
    client, resource = view
    put(resource, time=0.75, scale=100.0)
    client.settle()
    slab = client.nodes["/slab"]["vertices"].reshape(-1, 3)
    deepest = slab[np.argmin(slab[:, 2]), 0]
    third = slab[slab[:, 0] > 37.6, 2]
    assert 16.5 < deepest < 37.5
    np.testing.assert_allclose(third, 1.335, atol=1e-6)


def test_nothing_is_sent_while_the_time_stands_still(view: tuple[SceneClient, str]) -> None:
    client, resource = view
    put(resource, time=0.5)
    client.settle()
    assert client.settle(quiet=0.8) == 0
    put(resource, time=0.5)
    assert client.settle() == 0


def test_wheels_without_contact_are_red(view: tuple[SceneClient, str]) -> None:
    client, resource = view
    step = next(
        step
        for step in range(0, 3000, STRIDE)
        if (RUN.channel_rows(["wheel 01 right/contact force"], step, step + 1) <= 0.0).all()
    )
    put(resource, time=step * TIME_STEP)
    client.settle()
    names = [f"{name}/contact force" for name in RUN.plan.geometry.wheels.names]
    lost = RUN.channel_rows(names, step, step + 1)[0] <= 0.0
    colours = client.nodes["/wheels"]["batched_colors"].reshape(-1, 3)
    red = (colours[:, 0] > 150) & (colours[:, 1] < 60) & (colours[:, 2] < 60)
    assert red.tolist() == lost.tolist()
    assert 0 < red.sum() < 92


def test_carbodies_move_with_what_they_did_since_the_static_start(
    view: tuple[SceneClient, str],
) -> None:
    """The static settlement of 0.4 m times the scale would lift the cars off the picture."""
    client, resource = view
    put(resource, time=1.0, scale=100.0)
    client.settle()
    bodies = RUN.plan.geometry.bodies[:20]
    moved = RUN.frame(round(1.0 / INTERVAL)).bodies - RUN.frame(0).bodies
    sent = client.nodes["/carbodies"]["batched_positions"].reshape(-1, 3)
    expected = [
        RAIL_TOP + body.base + body.size[2] / 2 + 100.0 * bounce
        for body, bounce in zip(bodies, moved[:20, 0], strict=True)
    ]
    np.testing.assert_allclose(sent[:, 2], expected, atol=1e-5)


def test_playing_sends_at_most_fifteen_pictures_a_second(view: tuple[SceneClient, str]) -> None:
    client, resource = view
    put(resource, layers=["slab"], time=0.4, rate=0.5, playing=True)
    client.settle(quiet=0.05)
    before = client.messages
    started = client.nodes["/slab"]["vertices"].copy()
    state = httpx.get(resource).json()
    while state["time"] < 0.9:
        client.settle(quiet=0.05)
        state = httpx.get(resource).json()
    assert state["playing"]
    sent = client.messages - before
    assert 0 < sent <= 15 * 1.2 + 2  # about one real second, one update a picture
    assert not np.array_equal(started, client.nodes["/slab"]["vertices"])


def test_a_hidden_layer_is_not_sent_and_is_right_when_shown_again(
    view: tuple[SceneClient, str],
) -> None:
    client, resource = view
    state = put(resource, layers=["slab"], time=0.4, scale=100.0)
    client.settle()
    before = client.nodes["/rails"]["vertices"].copy()
    put(resource, time=0.8)
    client.settle()
    assert np.array_equal(before, client.nodes["/rails"]["vertices"])
    put(resource, layers=state["available_layers"])
    client.settle()
    rails = next(layer for layer in RUN.plan.geometry.layers if layer.name == "rails")
    stored = RUN.plan.geometry.vertices + 100.0 * RUN.frame(round(0.8 / INTERVAL)).displacement
    sent = client.nodes["/rails"]["vertices"].reshape(-1, 3)
    np.testing.assert_allclose(sent, stored[np.unique(rails.faces)], atol=5e-6, rtol=0.0)


def test_another_theme_changes_colours_and_nothing_else(view: tuple[SceneClient, str]) -> None:
    client, resource = view
    state = put(resource, time=0.7, layers=["slab", "carbodies"])
    client.settle()
    light = {name: dict(node) for name, node in client.nodes.items()}
    put(resource, theme="dark")
    client.settle()
    cars = client.nodes["/carbodies"]
    assert not np.array_equal(cars["batched_colors"], light["/carbodies"]["batched_colors"])
    assert np.array_equal(cars["batched_positions"], light["/carbodies"]["batched_positions"])
    assert np.array_equal(client.nodes["/slab"]["vertices"], light["/slab"]["vertices"])
    put(resource, theme="light", layers=state["available_layers"])


def test_a_run_is_shown_from_the_store_while_it_computes_and_after(tmp_path: Path) -> None:
    run = ExampleRun(n_step=320)
    writer = RunWriter(tmp_path, run.plan)
    rows = run.channel_rows([channel.name for channel in run.plan.channels], 0, 321)

    def append(start: int, stop: int) -> None:
        for step in range(start, stop):
            frame = run.frame(step // STRIDE) if step % STRIDE == 0 else None
            time = step * TIME_STEP
            writer.append(
                Sample(step=step, time=time, channels=rows[step], slab=np.zeros(0), frame=frame)
            )

    append(0, 161)
    writer.flush()
    maker = PictureMaker(RunReader(tmp_path))
    names = list(run.plan.geometry.wheels.names)
    for index in (0, 7, 20):
        _assert_picture(maker.picture(index, 50.0), run, index, rows, names)
    append(161, 321)
    writer.seal()
    writer.finish({})
    for index in (20, 21, 40):
        _assert_picture(maker.picture(index, 50.0), run, index, rows, names)


def _assert_picture(
    picture: Picture, run: ExampleRun, index: int, rows: np.ndarray, names: list[str]
) -> None:
    stored = run.plan.geometry.vertices + 50.0 * run.frame(index).displacement
    # Frames are stored in float32: 50 times half a unit in the last place of 5 mm.
    np.testing.assert_allclose(picture.vertices, stored, atol=50 * 2.4e-10, rtol=0.0)
    displacement = rows[index * STRIDE, len(names) :]
    np.testing.assert_allclose(picture.wheels[:, 2], RAIL_TOP + 0.46 + 50.0 * displacement)
    assert picture.lost.tolist() == (rows[index * STRIDE, : len(names)] <= 0.0).tolist()


def test_a_running_run_shows_what_is_committed() -> None:
    run = ExampleRun(done=False)
    run.committed = 0
    app = FastAPI()
    app.include_router(router(lambda _: run))
    with served(app) as address:
        opened = httpx.post(f"http://{address}/api/v1/runs/run-2/viewer").json()
        resource = f"http://{address}/api/v1/viewer/{opened['session']}"
        with SceneClient(address, opened["session"]) as client:
            client.settle()
            assert put(resource, time=1.0, playing=True)["time"] == 0.0
            run.committed = 801
            state = put(resource, time=1.0)
            assert state["last_time"] == pytest.approx(0.4)
            assert state["time"] == pytest.approx(0.4)
            assert state["playing"], "a running run is waited for"
            client.settle()
            stored = RUN.channel_rows(["wheel 01 left/displacement"], 800, 801)[0, 0]
            sent = client.nodes["/wheels"]["batched_positions"].reshape(-1, 3)
            scale = float(state["scale"])
            assert sent[0, 2] == pytest.approx(RAIL_TOP + 0.46 + scale * stored, abs=1e-6)
            run.committed, run.done = 1601, True
            put(resource, rate=10.0)
            client.settle()
            ended = httpx.get(resource).json()
            assert ended["time"] == pytest.approx(0.8)
            assert not ended["playing"], "playing ends with the last frame of a finished run"
