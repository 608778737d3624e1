"""Colours in a real Chromium: those of the bar, on the right vertices, in the same picture."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from server.viewer.colour_map import ColourBar
from solver.results import Frame
from tests.browser.viewer_page import MESH, NEEDS_CHROMIUM, SEEN_AT, View, changed, launched, viewed
from tests.browser.waiting import drawn_again, until
from tests.server.viewer_run import STRIDE, TIME_STEP, ExampleRun

pytestmark = [pytest.mark.slow, NEEDS_CHROMIUM]

RUN = ExampleRun()
INTERVAL = STRIDE * TIME_STEP
(SLAB,) = (np.unique(layer.faces) for layer in RUN.plan.geometry.layers if layer.name == "slab")
VALUES: dict[str, Callable[[Frame], np.ndarray]] = {
    "displacement": lambda frame: 1e3 * np.linalg.norm(frame.displacement, axis=1),
    "velocity": lambda frame: 1e3 * frame.velocity,
    "acceleration": lambda frame: frame.acceleration,
}
"""In display units."""


def peak_time(colour: str) -> float:
    """When the slab has the greatest value."""
    frames = range(100, 300, 5)
    greatest = {i: np.abs(VALUES[colour](RUN.frame(i))[SLAB]).max() for i in frames}
    return max(greatest, key=greatest.__getitem__) * INTERVAL


PEAK_TIME = peak_time("displacement")
_COLOURS = f"""() => {{ {MESH}
  const colours = mesh.geometry.attributes.color;
  return mesh.material.vertexColors ? [...colours.array] : null; }}"""
_WATCH = f"""(index) => {{ {MESH}
  const scene = window.__viserMutable.scene, before = scene.onBeforeRender;
  window.watched = [];
  scene.onBeforeRender = (...values) => {{
    before.apply(scene, values);
    const of = (name) => [...mesh.geometry.attributes[name].array.slice(3 * index, 3 * index + 3)];
    window.watched.push([of("position"), of("color")]);
  }}; }}"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    yield from launched()


@pytest.fixture(params=["light", "dark"])
def view(browser: Any, request: pytest.FixtureRequest) -> Iterator[View]:
    with viewed(browser, RUN, request.param) as view:
        view.until("window.trainbridgeColours?.ok ?? false")
        yield view


def bar_of(state: dict[str, Any]) -> ColourBar:
    """The bar that the page shows."""
    fields = dict(state["colour_bar"])
    stops = tuple((float(place), str(colour)) for place, colour in fields.pop("stops"))
    return ColourBar(stops=stops, **fields)


def coloured(view: View, time: float, **change: object) -> tuple[np.ndarray, ColourBar]:
    """The slab's colours as the browser has them, sRGB, once they are those asked for."""
    updates = view.page.evaluate("window.trainbridgeColours.updates")
    state = view.reach(RUN, time, **change)
    view.until(f"window.trainbridgeColours.updates > {updates}")
    taken: list[Any] = []

    def look() -> list[Any]:
        drawn_again(view.page)
        taken.append(view.page.evaluate(_COLOURS))
        return taken[-3:]

    def at_rest(last: list[Any]) -> bool:
        return len(last) == 3 and last[0] is not None and last[0] == last[1] == last[2]

    until(look, "colours that change no more", page=view.page, met=at_rest)
    light = np.array(taken[-1]).reshape(-1, 3) / 65535.0
    value = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return 255.0 * value, bar_of(state)


@pytest.mark.parametrize("colour", VALUES)
def test_at_the_peak_every_vertex_has_its_colour_of_the_bar(view: View, colour: str) -> None:
    time = peak_time(colour)
    seen, bar = coloured(view, time, scale=100.0, colour=colour)
    stored = VALUES[colour](RUN.frame(round(time / INTERVAL)))[SLAB]
    # One level for the way to linear light and back.
    np.testing.assert_allclose(seen, bar.colours(stored), atol=1.01)
    assert np.ptp(seen, axis=0).max() > 60, "they differ along the bridge"
    view.keep(f"colour-{colour}")


@pytest.mark.parametrize("colour", ["displacement", "peak"])
def test_the_pixel_at_the_greatest_value_has_its_colour_of_the_bar(view: View, colour: str) -> None:
    """Seen from above, under the lamps, without anything in front."""
    view.put(layers=["slab"], camera="overview")
    seen, bar = coloured(view, PEAK_TIME, scale=0.0, colour=colour)
    inside = np.abs(RUN.plan.geometry.vertices[SLAB, 1]) < 1.0  # pixels of an edge are mixed
    greatest = int(np.argmax(np.where(inside, seen[:, 0], 0.0)))
    picture = view.settled()
    x, y = (round(value) for value in view.page.evaluate(SEEN_AT, greatest))
    pixel = picture[y - 1 : y + 2, x - 1 : x + 2].reshape(-1, 3).mean(axis=0)
    # Lamps and anti-aliasing take a few levels; the bar has 255 from end to end.
    np.testing.assert_allclose(pixel, seen[greatest], atol=16)
    along = np.linalg.norm(bar.table().astype(float) - pixel, axis=1)
    expected = np.linalg.norm(bar.table().astype(float) - seen[greatest], axis=1)
    assert abs(int(np.argmin(along)) - int(np.argmin(expected))) <= 12
    view.keep(f"deck-{colour}")


def test_shape_and_colours_change_in_the_same_picture(view: View) -> None:
    """A picture whose colours are those of another moment would show another value."""
    state = view.reach(RUN, 0.4, layers=["slab"], scale=100.0, colour="displacement")
    bar = bar_of(state)
    displacement = RUN.frame(round(PEAK_TIME / INTERVAL)).displacement[SLAB]
    index = int(np.argmax(np.linalg.norm(displacement, axis=1)))
    view.until(f"Boolean(({_COLOURS})())")
    before = view.settled()
    view.page.evaluate(_WATCH, index)
    rest = RUN.plan.geometry.vertices[SLAB[index]]
    watched: list[Any] = []

    def shown() -> np.ndarray:
        """Displacements that the watched vertex has had in pictures. [mm]"""
        watched[:] = view.page.evaluate("window.watched")
        moved = np.array([place for place, _ in watched]).reshape(-1, 3) - rest
        return 1e3 * np.linalg.norm(moved, axis=1) / 100.0

    # So slowly that a machine with little time draws several pictures before the end.
    view.put(playing=True, rate=0.05)
    until(lambda: len(np.unique(shown())), "it plays", page=view.page, met=lambda count: count > 5)
    until(
        lambda: changed(before, view.pixels()),
        "the picture plays",
        page=view.page,
        met=lambda share: share > 0.001,
    )
    displacements = shown()
    light = np.array([colour for _, colour in watched]) / 65535.0
    value = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    np.testing.assert_allclose(255.0 * value, bar.colours(displacements), atol=2.01)


def test_squares_in_place_of_the_script_look_much_the_same(view: View) -> None:
    view.reach(RUN, PEAK_TIME, layers=["slab"], scale=0.0, colour="displacement")
    smooth = view.settled()
    view.put(smooth=False)
    view.until("Boolean(window.__viserMutable.nodeRefFromName['/slab-elements'])")
    squares = view.settled(lambda picture: changed(smooth, picture) > 0.0, "squares")
    bridge = np.abs(smooth - smooth[0, 0]).max(axis=2) > 12
    difference = np.abs(smooth - squares).max(axis=2)[bridge]
    # A square has the mean of four corners, and a film's curve over it.
    assert np.median(difference) < 40
    view.keep("squares")
    view.put(smooth=True)
    view.until("window.trainbridgeColours.coloured.includes('slab')")
    view.settled(lambda picture: changed(smooth, picture) < 0.001, "smooth colours again")
