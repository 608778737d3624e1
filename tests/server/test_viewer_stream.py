"""What a browser receives through the proxy, decoded, against what is stored."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi import FastAPI

from server.store import RunReader, RunWriter
from server.viewer import ViewerLimits, router
from server.viewer.picture import Picture, PictureMaker
from solver.results import Sample
from tests.server.viewer_client import SceneClient, served
from tests.server.viewer_run import RAIL_TOP, SPEED, START, STRIDE, TIME_STEP, ExampleRun
from tests.server.viewer_waiting import http, quiet, until

RUN = ExampleRun()
INTERVAL = STRIDE * TIME_STEP


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    app = FastAPI()
    app.include_router(router(lambda _: RUN, ViewerLimits(idle=600.0)))
    with served(app) as address:
        yield address


@pytest.fixture
def view(address: str) -> Iterator[tuple[SceneClient, str]]:
    where = f"http://{address}/api/v1/runs/run-1/viewer"
    opened = http.post(where, json={}).json()
    resource = f"http://{address}/api/v1/viewer/{opened['session']}"
    with SceneClient(address, opened["session"]) as client:
        show(client, resource, time=0.3, scale=10.0)
        yield client, resource
    http.delete(resource)


def put(resource: str, **change: object) -> dict[str, Any]:
    answer = http.put(resource, json=change)
    assert answer.status_code == 200, answer.text
    return answer.json()


def show(client: SceneClient, resource: str, **change: object) -> dict[str, Any]:
    """Changes what is shown and waits until every visible surface is as it should be."""
    state = put(resource, **change)
    moved = RUN.frame(round(state["time"] / INTERVAL)).displacement
    wanted = RUN.plan.geometry.vertices + state["scale"] * moved

    def arrived() -> bool:
        surfaces = [layer.name for layer in RUN.plan.geometry.layers]
        return all(
            np.allclose(vertices(client, name), wanted[used(name)], atol=1e-5)
            for name in state["layers"]
            if name in surfaces
        )

    until(client, arrived)
    client.settle(quiet=0.2)
    return state


def vertices(client: SceneClient, layer: str) -> np.ndarray:
    """A layer's vertices as last sent, shape (n, 3). [m]"""
    return client.nodes[f"/{layer}"]["vertices"].reshape(-1, 3)


def used(layer: str) -> np.ndarray:
    """Indices of a layer's vertices."""
    (faces,) = (item.faces for item in RUN.plan.geometry.layers if item.name == layer)
    return np.unique(faces)


@pytest.mark.slow
@pytest.mark.parametrize(("time", "scale"), [(0.40, 200.0), (0.80, 500.0), (1.50, 1.0)])
def test_vertices_and_wheels_are_the_stored_ones(
    view: tuple[SceneClient, str], time: float, scale: float
) -> None:
    client, resource = view
    show(client, resource, time=time, scale=scale)
    geometry, index = RUN.plan.geometry, round(time / INTERVAL)
    stored = geometry.vertices + scale * RUN.frame(index).displacement
    for layer in geometry.layers:
        sent = client.nodes[f"/{layer.name}"]["vertices"].reshape(-1, 3)
        # float32 on the wire: half a unit in the last place of 64 m is 4e-6 m.
        np.testing.assert_allclose(sent, stored[used(layer.name)], atol=5e-6, rtol=0.0)

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
    show(client, resource, time=0.75, scale=100.0)
    slab = client.nodes["/slab"]["vertices"].reshape(-1, 3)
    deepest = slab[np.argmin(slab[:, 2]), 0]
    third = slab[slab[:, 0] > 37.6, 2]
    assert 16.5 < deepest < 37.5
    np.testing.assert_allclose(third, 1.335, atol=1e-6)


@pytest.mark.slow
def test_nothing_is_sent_while_the_time_stands_still(view: tuple[SceneClient, str]) -> None:
    client, resource = view
    show(client, resource, time=0.5)
    quiet(client, 0.8)
    before = client.messages
    put(resource, time=0.5)
    quiet(client, 0.8)
    assert client.messages == before


def test_wheels_without_contact_are_red(view: tuple[SceneClient, str]) -> None:
    client, resource = view
    step = next(
        step
        for step in range(0, 3000, STRIDE)
        if (RUN.channel_rows(["wheel 01 right/contact force"], step, step + 1) <= 0.0).all()
    )
    show(client, resource, time=step * TIME_STEP)
    names = [f"{name}/contact force" for name in RUN.plan.geometry.wheels.names]
    lost = RUN.channel_rows(names, step, step + 1)[0] <= 0.0
    colours = client.nodes["/wheels"]["batched_colors"].reshape(-1, 3)
    # The page takes these for linear light: 0.25 is a clear red, 0.02 next to nothing.
    red = (colours[:, 0] > 64) & (colours[:, 1] < 5) & (colours[:, 2] < 5)
    assert red.tolist() == lost.tolist()
    assert 0 < red.sum() < 92


@pytest.mark.slow
def test_a_lost_contact_has_a_cross_as_well(view: tuple[SceneClient, str]) -> None:
    """So that colour is not the only sign."""
    client, resource = view
    show(client, resource, time=0.4)
    arrows = client.nodes["/forces"]["points"].reshape(-1, 2, 3)
    lost = arrows[:, 0, 2] - arrows[:, 1, 2] < 0.01
    crosses = client.nodes["/lost-contacts"]["batched_scales"].reshape(-1, 3)
    assert (crosses[:, 0] > 0.0).tolist() == lost.tolist()
    show(client, resource, time=0.73)
    arrows = client.nodes["/forces"]["points"].reshape(-1, 2, 3)
    lost = arrows[:, 0, 2] - arrows[:, 1, 2] < 0.01
    assert lost.any()
    crosses = client.nodes["/lost-contacts"]["batched_scales"].reshape(-1, 3)
    assert (crosses[:, 0] > 0.0).tolist() == lost.tolist()
    places = client.nodes["/lost-contacts"]["batched_positions"].reshape(-1, 3)
    assert np.all(places[lost, 2] > arrows[lost, 1, 2] + 1.0), "above the wheel"


@pytest.mark.slow
def test_colours_travel_below_their_mesh_and_leave_with_the_material(
    view: tuple[SceneClient, str],
) -> None:
    client, resource = view
    plain = tuple(client.nodes["/slab"]["color"])
    for colour in ("displacement", "acceleration", "peak"):
        show(client, resource, time=0.8, scale=100.0, colour=colour)
        expected = PictureMaker(RUN).picture(round(0.8 / INTERVAL), 100.0, colour).colours["slab"]

        def arrived(expected: np.ndarray = expected) -> bool:
            return np.array_equal(client.nodes["/slab/colours"]["colors"], expected.ravel())

        until(client, arrived)
        # The material multiplies the colours.
        assert tuple(client.nodes["/slab"]["color"]) == (255, 255, 255)
    show(client, resource, colour="none")
    until(client, lambda: tuple(client.nodes["/slab"]["color"]) == plain)
    assert client.nodes["/slab/colours"]["colors"].size == 3


@pytest.mark.slow
def test_without_the_page_script_every_element_has_its_colour(
    view: tuple[SceneClient, str],
) -> None:
    client, resource = view
    show(client, resource, time=0.8, scale=100.0, colour="displacement", smooth=False)
    picture = PictureMaker(RUN).picture(round(0.8 / INTERVAL), 100.0, "displacement")
    (faces,) = (item.faces for item in RUN.plan.geometry.layers if item.name == "slab")

    def arrived() -> bool:
        sent = client.nodes["/slab-elements"]["batched_positions"].reshape(-1, 3)
        return np.allclose(sent, picture.vertices[faces].mean(axis=1), atol=1e-5)

    until(client, arrived)
    loaded = np.argmax(np.linalg.norm(RUN.frame(picture.index).displacement, axis=1)[faces[:, 0]])
    colours = client.nodes["/slab-elements"]["batched_colors"].reshape(-1, 3).astype(int)
    still = np.argmax(RUN.plan.geometry.vertices[faces[:, 0], 0])
    assert colours[loaded].sum() > 3 * colours[still].sum(), "the loaded element is lighter"


@pytest.mark.slow
def test_carbodies_move_with_what_they_did_since_the_static_start(
    view: tuple[SceneClient, str],
) -> None:
    """The static settlement of 0.4 m times the scale would lift the cars off the picture."""
    client, resource = view
    show(client, resource, time=1.0, scale=100.0)
    bodies = RUN.plan.geometry.bodies[:20]
    moved = RUN.frame(round(1.0 / INTERVAL)).bodies - RUN.frame(0).bodies
    sent = client.nodes["/carbodies"]["batched_positions"].reshape(-1, 3)
    expected = [
        RAIL_TOP + body.base + body.size[2] / 2 + 100.0 * bounce
        for body, bounce in zip(bodies, moved[:20, 0], strict=True)
    ]
    np.testing.assert_allclose(sent[:, 2], expected, atol=1e-5)


@pytest.mark.slow
def test_playing_sends_at_most_fifteen_pictures_a_second(view: tuple[SceneClient, str]) -> None:
    client, resource = view
    show(client, resource, layers=["slab"], time=0.4)
    started, before = vertices(client, "slab").copy(), client.messages
    begin = time.monotonic()  # Its answer may be late: the first pictures come before it.
    state = put(resource, rate=0.25, playing=True)
    while state["time"] < 0.9:
        client.settle(quiet=0.05)
        state = http.get(resource).json()
    elapsed = time.monotonic() - begin
    # One update a picture; more for the window's edges and late ones of a busy machine.
    assert 0 < client.messages - before <= 15.0 * 1.2 * elapsed + 2
    assert not np.array_equal(started, vertices(client, "slab"))


@pytest.mark.slow
def test_a_hidden_layer_is_not_sent_and_is_right_when_shown_again(
    view: tuple[SceneClient, str],
) -> None:
    client, resource = view
    state = show(client, resource, layers=["slab"], time=0.4, scale=100.0)
    before = vertices(client, "rails").copy()
    show(client, resource, time=0.8)
    assert np.array_equal(before, vertices(client, "rails"))
    show(client, resource, layers=state["available_layers"])
    stored = RUN.plan.geometry.vertices + 100.0 * RUN.frame(round(0.8 / INTERVAL)).displacement
    np.testing.assert_allclose(
        vertices(client, "rails"), stored[used("rails")], atol=5e-6, rtol=0.0
    )


@pytest.mark.slow
def test_another_theme_changes_colours_and_nothing_else(view: tuple[SceneClient, str]) -> None:
    client, resource = view
    state = show(client, resource, time=0.7, layers=["slab", "carbodies"])
    light = {name: dict(node) for name, node in client.nodes.items()}

    def other_colours() -> bool:
        sent = client.nodes["/carbodies"]["batched_colors"]
        return not np.array_equal(sent, light["/carbodies"]["batched_colors"])

    put(resource, theme="dark")
    until(client, other_colours)
    cars = client.nodes["/carbodies"]
    assert np.array_equal(cars["batched_positions"], light["/carbodies"]["batched_positions"])
    assert np.array_equal(client.nodes["/slab"]["vertices"], light["/slab"]["vertices"])
    put(resource, theme="light", layers=state["available_layers"])


def test_a_run_is_shown_from_the_store_while_it_computes_and_after(tmp_path: Path) -> None:
    run = ExampleRun(n_step=320)
    writer = RunWriter(tmp_path, run.plan)
    rows = run.channel_rows([channel.name for channel in run.plan.channels], 0, 321)

    still = np.zeros(len(run.plan.slab.coordinates))

    def append(start: int, stop: int) -> None:
        for step in range(start, stop):
            frame = run.frame(step // STRIDE) if step % STRIDE == 0 else None
            time = step * TIME_STEP
            writer.append(
                Sample(step=step, time=time, channels=rows[step], slab=still, frame=frame)
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


@pytest.mark.slow
def test_a_running_run_shows_what_is_committed() -> None:
    run = ExampleRun(done=False)
    run.committed = 0
    app = FastAPI()
    app.include_router(router(lambda _: run))
    with served(app) as address:
        where = f"http://{address}/api/v1/runs/run-2/viewer"
        opened = http.post(where).json()
        resource = f"http://{address}/api/v1/viewer/{opened['session']}"
        with SceneClient(address, opened["session"]) as client:
            client.settle()
            assert put(resource, time=1.0, playing=True)["time"] == 0.0
            run.committed = 801
            state = put(resource, time=1.0)
            assert state["last_time"] == pytest.approx(0.4)
            assert state["time"] == pytest.approx(0.4)
            assert state["playing"], "a running run is waited for"
            stored = RUN.channel_rows(["wheel 01 left/displacement"], 800, 801)[0, 0]
            height = RAIL_TOP + 0.46 + float(state["scale"]) * stored

            def arrived() -> bool:
                sent = client.nodes["/wheels"]["batched_positions"].reshape(-1, 3)
                return sent[0, 2] == pytest.approx(height, abs=1e-6)

            until(client, arrived)
            run.committed, run.done = 1601, True
            put(resource, rate=10.0)
            until(client, lambda: not http.get(resource).json()["playing"])
            ended = http.get(resource).json()
            assert ended["time"] == pytest.approx(0.8)
            assert not ended["playing"], "playing ends with the last frame of a finished run"
