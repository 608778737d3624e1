"""The 3D view in a real Chromium: its pixels follow the time, and stand when it stands."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from tests.browser.viewer_page import NEEDS_CHROMIUM, View, changed, drawn, launched, viewed
from tests.browser.waiting import until
from tests.server.viewer_run import ExampleRun

pytestmark = [pytest.mark.slow, NEEDS_CHROMIUM]

RUN = ExampleRun()


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    yield from launched()


@pytest.fixture(params=["light", "dark"])
def view(browser: Any, request: pytest.FixtureRequest) -> Iterator[View]:
    with viewed(browser, RUN, request.param) as view:
        yield view


def test_pixels_change_with_the_time_and_only_with_it(view: View) -> None:
    pictures = []
    for time in (0.60, 0.90, 1.20):
        view.reach(RUN, time, scale=200.0)
        # The time stands still where nothing changes for two seconds.
        pictures.append(view.settled(apart=1.0))
    # The train alone covers several percent of the picture; half a percent is far above noise.
    assert changed(pictures[0], pictures[1]) > 0.005
    assert changed(pictures[1], pictures[2]) > 0.005
    view.reach(RUN, 0.60)
    view.settled(
        lambda picture: changed(picture, pictures[0]) < 0.001, "the same time is the same picture"
    )
    view.keep("overview")


def test_presets_hidden_layers_and_playing_show(view: View) -> None:
    view.reach(RUN, 0.8, camera="overview")
    overview = view.settled()
    for camera in ("side", "section", "follow"):
        view.put(camera=camera)
        view.settled(lambda picture: changed(overview, picture) > 0.02, camera)
        view.keep(camera)
    view.put(camera="overview")
    view.settled(lambda picture: changed(overview, picture) < 0.001, "the overview again")
    view.put(layers=["slab"])
    view.settled(lambda picture: drawn(picture) < 0.7 * drawn(overview), "the slab alone")
    view.put(layers=["slab", "wheels"])
    first = view.settled(lambda picture: drawn(picture) < 0.9 * drawn(overview), "slab and wheels")
    view.put(playing=True)
    until(
        lambda: changed(first, view.pixels()),
        "the picture plays",
        page=view.page,
        met=lambda share: share > 0.001,
    )
