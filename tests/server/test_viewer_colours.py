"""The colours of the surface against the stored values, and the bar that explains them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from server.viewer.colour_map import DIVERGING, SEQUENTIAL, ColourBar, ColourMap, rounded_up
from server.viewer.colouring import SurfaceColours
from server.viewer.picture import PictureMaker
from solver.results import Frame
from tests.server.viewer_run import ExampleRun

RUN = ExampleRun()
PEAK = 200
"""A frame at which the second span is loaded."""


def used(layer: str) -> np.ndarray:
    (faces,) = (item.faces for item in RUN.plan.geometry.layers if item.name == layer)
    return np.unique(faces)


def value_of(colours: np.ndarray, bar: ColourBar) -> np.ndarray:
    """What a reader with the bar in hand takes a colour for, shape (n,)."""
    table = bar.table().astype(float)
    nearest = np.argmin(np.linalg.norm(colours[:, None, :] - table[None, :, :], axis=2), axis=1)
    return bar.minimum + (bar.maximum - bar.minimum) * nearest / 255.0


@pytest.mark.parametrize(
    ("colouring", "layer", "unit"),
    [
        ("displacement", "slab", "mm"),
        ("displacement", "rails", "mm"),
        ("velocity", "beam", "mm/s"),
        ("acceleration", "slab", "m/s²"),
    ],
)
def test_read_off_the_bar_a_colour_gives_the_stored_value(colouring, layer, unit) -> None:
    maker = PictureMaker(RUN)
    bar = maker.colour_bar(colouring)
    assert bar is not None
    assert bar.unit == unit
    frame = RUN.frame(PEAK)
    stored = {
        "displacement": 1e3 * np.linalg.norm(frame.displacement, axis=1),
        "velocity": 1e3 * frame.velocity,
        "acceleration": frame.acceleration,
    }[colouring][used(layer)]
    read = value_of(maker.picture(PEAK, 100.0, colouring).colours[layer], bar)
    # Half a step of 256, and more where neighbours on the bar look the same.
    step = (bar.maximum - bar.minimum) / 255.0
    np.testing.assert_allclose(read, stored, atol=2.0 * step)
    assert np.ptp(stored) > 20 * step


@pytest.mark.parametrize("colouring", ["velocity", "acceleration"])
def test_signed_quantities_have_a_bar_with_zero_in_its_grey_middle(colouring) -> None:
    bar = PictureMaker(RUN).colour_bar(colouring)
    assert bar is not None
    assert bar.minimum == -bar.maximum
    (red, green, blue) = bar.colours(np.zeros(1))[0].tolist()
    assert max(red, green, blue) - min(red, green, blue) <= 8


def test_the_bar_stands_still_over_the_whole_run_and_holds_all_of_the_bridge() -> None:
    maker = PictureMaker(RUN)
    bars = set()
    for index in (0, 100, 200, 300):
        maker.picture(index, 1.0, "displacement")
        bars.add(maker.colour_bar("displacement"))
    (bar,) = bars
    assert bar is not None
    greatest = max(
        1e3 * np.linalg.norm(RUN.frame(index).displacement, axis=1).max()
        for index in range(0, RUN.committed_frames, 20)
    )
    assert 0.95 * greatest < bar.maximum < 1.5 * greatest


def test_a_running_run_has_the_range_of_what_it_has_done_so_far() -> None:
    run = ExampleRun(done=False)
    run.committed = 1000  # the train is still on the approach
    colours = SurfaceColours(run)
    early = colours.bar("displacement")
    run.committed = 4000
    late = colours.bar("displacement")
    assert early is not None
    assert late is not None
    assert early.maximum < late.maximum
    assert "peak" not in colours.available


def test_only_what_a_run_has_stored_is_offered() -> None:
    assert PictureMaker(RUN).available_colourings == (
        "none",
        "displacement",
        "velocity",
        "acceleration",
        "peak",
    )
    old = ExampleRun()
    old.plan = replace(old.plan, frame_motion=False)
    old.slab_peaks = lambda: None
    maker = PictureMaker(old)
    assert maker.available_colourings == ("none", "displacement")
    assert maker.colour_bar("acceleration") is None
    assert maker.picture(PEAK, 1.0, "acceleration").colours == {}


def test_the_map_of_the_peaks_colours_the_slab_where_it_has_points_and_nothing_else() -> None:
    maker = PictureMaker(RUN)
    picture, bar = maker.picture(PEAK, 1.0, "peak"), maker.colour_bar("peak")
    peaks = RUN.slab_peaks()
    assert bar is not None
    assert peaks is not None
    assert peaks.filtered is not None
    assert set(picture.colours) == {"slab"}
    assert "filtered" in bar.quantity
    slab, points = RUN.plan.geometry.vertices[used("slab")], RUN.plan.slab.coordinates
    deciding = points[np.argmax(peaks.filtered)]
    at = int(np.argmin(np.linalg.norm(slab - deciding, axis=1)))
    read = value_of(picture.colours["slab"][[at]], bar)[0]
    assert read == pytest.approx(peaks.filtered.max(), abs=bar.maximum / 255.0)
    beyond = np.abs(slab[:, 1]) > 3.0
    assert np.ptp(picture.colours["slab"][beyond], axis=0).tolist() == [0, 0, 0]
    assert {"ballast", "sleepers"} == picture.veiled, "they lie over the map"


def test_a_mode_is_coloured_by_its_shape_times_the_phase() -> None:
    run = ExampleRun()
    run.plan = replace(run.plan, modal=True, frame_stride=1)
    shape = np.zeros_like(run.plan.geometry.vertices)
    shape[used("slab"), 2] = np.linspace(0.0, 1.0, len(used("slab")))
    run.frame = lambda index, motion=(): Frame(displacement=shape, bodies=np.zeros((43, 3)))
    maker = PictureMaker(run)
    assert maker.available_colourings == ("none", "displacement")
    bar = maker.colour_bar("displacement")
    assert bar is not None
    assert (bar.minimum, bar.maximum) == (0.0, 1.0)
    half = maker.picture(0, 2.0, "displacement", -0.5)
    np.testing.assert_allclose(half.vertices - run.plan.geometry.vertices, -1.0 * shape, atol=1e-12)
    read = value_of(half.colours["slab"], bar)
    np.testing.assert_allclose(
        read, 0.5 * shape[used("slab"), 2], atol=2.0 / 255.0
    )  # neighbours may look alike
    assert len(half.arrows) == 0, "modes have no contact forces"


@pytest.mark.parametrize(
    ("value", "expected"), [(0.0, 1.0), (0.93, 1.0), (1.01, 1.2), (3.47, 3.5), (8.0e-5, 8.0e-5)]
)
def test_a_bar_ends_at_a_round_number(value: float, expected: float) -> None:
    assert rounded_up(value) == pytest.approx(expected)


def _seen(table: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Colours as an eye without one kind of cone sees them, in linear light, shape (n, 3)."""
    value = table / 255.0
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return np.clip(linear @ missing.T, 0.0, 1.0)


DEUTERANOPIA = np.array(
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]]
)
PROTANOPIA = np.array(
    [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ]
)
"""Machado, Oliveira and Fernandes (2009), severity 1."""


@pytest.mark.parametrize("eyes", [np.eye(3), DEUTERANOPIA, PROTANOPIA])
def test_lightness_alone_tells_the_value_to_every_eye(eyes: np.ndarray) -> None:
    """Of the sequential map from end to end, of the diverging one from its middle to each end."""
    weights = np.array([0.2126, 0.7152, 0.0722])
    rising = _seen(SEQUENTIAL.table().astype(float), eyes) @ weights
    assert np.all(np.diff(rising) > -2e-3)
    both = _seen(DIVERGING.table().astype(float), eyes) @ weights
    assert np.all(np.diff(both[:128]) > -2e-3)
    assert np.all(np.diff(both[128:]) < 2e-3)
    ends = _seen(ColourMap(stops=(DIVERGING.stops[1], DIVERGING.stops[-2])).table(), eyes)
    assert np.abs(ends[0] - ends[-1]).max() > 0.2, "the two signs differ in hue as well"
