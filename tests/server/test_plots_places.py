"""Figures of places: the slab's map, envelopes, the point somebody pointed at."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from server.plots import Figure, FigureRequest, figures, figures_of, read_place
from server.plots.slab_grid import SlabGrid
from solver.errors import InputError
from solver.results import SlabPeaks
from solver.standards.low_pass import low_pass
from tests.server.plots_case import (
    AXIS,
    FILTERED,
    STEP,
    TIME,
    Run,
    draw,
    finished_run,
    make_run,
)


def mapped() -> Run:
    """A judged run whose peaks are those of its slab's histories."""
    run = finished_run()
    indices = np.arange(len(run.plan.slab.coordinates))
    raw = run.slab_histories(indices)
    counted = run.plan.window_start <= TIME
    rows: dict[str, Any] = {}
    for name, values in (("raw", raw), ("filtered", low_pass(raw, STEP, 30.0))):
        sizes = np.abs(values[counted])
        rows[name] = sizes.max(axis=0)
        rows[f"{name}_time"] = TIME[counted][sizes.argmax(axis=0)]
    run.peaks = SlabPeaks(**rows)
    return run


def cell(figure: Figure, x: float, y: float) -> float:
    drawn = figure["data"][0]
    return drawn["z"][drawn["y"].index(y)][drawn["x"].index(x)]


@pytest.mark.parametrize("variant", ["filtered", "raw"])
def test_the_map_shows_the_greatest_of_each_points_history(variant: str) -> None:
    run = mapped()
    figure = draw("slab-map", run, variant=variant)
    for point in (0, 20, 29):
        x, y, _ = run.plan.slab.coordinates[point]
        history = run.slab_point(point)[:, None]
        history = low_pass(history, STEP, 30.0) if variant == "filtered" else history
        expected = np.abs(history[run.plan.window_start <= TIME]).max()
        assert cell(figure, x, y) == pytest.approx(expected, rel=1e-4, abs=1e-12)  # five figures


def test_the_maps_peak_is_the_judged_slabs_and_the_limit_is_a_contour() -> None:
    figure = draw("slab-map", mapped())
    heat, contour, peak = figure["data"]
    assert heat["type"] == "heatmap"
    assert (contour["contours"]["start"], contour["contours"]["end"]) == (3.5, 3.5)
    assert (peak["x"], peak["marker"]["symbol"]) == ([20.0], "x")
    assert "outside 3.5 m/s²" in figure["summary"]
    rows = {row["span"]: row for row in figure["table"]}
    assert (rows[1]["judged"], rows[2]["judged"]) == ("no", "yes")
    assert rows[2]["value"] == pytest.approx(np.nanmax(np.array(heat["z"], dtype=float)), rel=1e-4)
    words = [note["text"] for note in figure["layout"]["annotations"]]
    assert "span 1: shown, not judged" in words
    assert "left rail" in words


@pytest.mark.parametrize("side", [-1, 1])
def test_the_words_of_a_peak_at_the_slabs_edge_stand_on_the_map(side: int) -> None:
    run = mapped()
    assert run.peaks is not None
    assert run.peaks.filtered is not None
    slab, values = run.plan.slab, run.peaks.filtered.copy()
    inside = np.flatnonzero(np.isin(slab.span, slab.judged_spans))
    edge = inside[np.argmax(side * slab.coordinates[inside, 1])]
    values[edge] = 2.0 * values.max()
    run.peaks = replace(run.peaks, filtered=values)
    (note,) = [n for n in draw("slab-map", run)["layout"]["annotations"] if n["showarrow"]]
    assert note["y"] == slab.coordinates[:, 1].max() * side
    assert note["ay"] * side > 0  # plotly counts pixels downwards: outside lies the axis' title


def test_limits_are_not_held_against_accelerations_as_computed() -> None:
    figure = draw("slab-map", mapped(), variant="raw")
    assert [trace["type"] for trace in figure["data"]] == ["heatmap", "scatter"]
    assert "limits are for filtered accelerations" in figure["summary"]


def test_a_run_without_stored_peaks_has_no_map_and_says_why() -> None:
    run = finished_run()
    assert "slab-map" not in [kind.name for kind in figures_of(run)]
    assert "compute it again" in draw("slab-map", run)["summary"]
    assert "slab-map" in [kind.name for kind in figures_of(make_run())]  # it will have one


def test_where_spans_meet_the_map_shows_the_greater_value() -> None:
    run = mapped()
    slab = run.plan.slab
    grid = SlabGrid.of(slab)
    assert (grid.x.size, grid.y.size) == (17, 3)  # 0 to 40 m every 2.5 m; joints count once
    sizes = np.where(slab.span == 1, 2.0, 1.0)
    values = grid.values(sizes, grid.points(sizes))
    assert values[1, grid.x.tolist().index(10.0)] == 2.0


def test_a_modal_run_has_no_histories_to_draw() -> None:
    run = make_run()
    run.plan.modal = True
    assert figures_of(run) == []
    with pytest.raises(InputError, match="holds shapes"):
        draw("displacement", run)


def test_the_point_pointed_at_is_the_nearest_and_its_filtered_history_the_stored_one() -> None:
    run = finished_run()
    run.histories[FILTERED] = low_pass(run.histories[AXIS][:, None], STEP, 30.0)[:, 0]
    place = (20.4, 0.3, 2.0)
    figure = draw("point-acceleration", run, place=place, low_pass=low_pass, points=5000)
    raw, filtered = figure["data"]
    # The same filter on the same samples: only the seven figures of JSON differ.
    stored = run.histories[FILTERED]
    np.testing.assert_allclose(filtered["y"], stored, rtol=1e-6, atol=1e-6)
    assert raw["line"]["width"] < filtered["line"]["width"]
    assert figure["summary"].startswith(
        "The slab at x = 20.00 m, y = 0.00 m, z = 1.30 m is the nearest that is recorded, 0.50 m "
    )
    assert {"rect", "line"} == {shape["type"] for shape in figure["layout"]["shapes"][1:]}


def test_before_the_verdict_a_points_history_is_as_computed() -> None:
    figure = draw("point-acceleration", make_run(), place=(20.0, 0.0, 0.0), low_pass=low_pass)
    assert [curve["name"] for curve in figure["data"]] == ["as computed"]


def test_a_point_beside_the_recorded_ones_moves_as_the_stored_shapes_do() -> None:
    run = finished_run()
    figure = draw("point-displacement", run, place=(10.0, 0.9, 1.4))
    [curve] = figure["data"]
    sag = -2.0 * np.sin(np.pi * np.array(curve["x"]) / 4) * np.sin(np.pi / 4)
    np.testing.assert_allclose(curve["y"], sag, atol=1e-6)
    assert np.diff(curve["x"]) == pytest.approx(0.01)  # every tenth step is stored
    assert "slab at x = 10.00 m, y = 1.00 m" in figure["summary"]
    assert "as seen every 10 ms" in figure["summary"]
    rail = draw("point-displacement", run, place=(10.0, 0.7, 2.4))
    assert "The rails at x = 10.00 m" in rail["summary"]


def test_a_point_that_is_recorded_is_drawn_at_every_step() -> None:
    figure = draw("point-displacement", finished_run(), place=(20.1, 0.0, 1.3), points=50_000)
    assert len(figure["data"][0]["x"]) == TIME.size
    assert figure["table"][0]["channel"] == "mid-span 2, axis/displacement"


def test_the_window_limits_the_shapes_that_are_read() -> None:
    figure = draw("point-displacement", finished_run(), place=(10.0, 1.0, 1.3), start=1.0, stop=1.5)
    [curve] = figure["data"]
    assert (curve["x"][0], curve["x"][-1]) == pytest.approx((1.0, 1.5), abs=0.0101)


def test_the_envelope_is_the_extreme_of_every_stored_shape() -> None:
    figure = draw("envelope", finished_run())
    least, greatest, recorded = figure["data"]
    shape = -2.0 * np.sin(np.pi * np.array(least["x"]) / 40.0)
    np.testing.assert_allclose(least["y"], shape, atol=1e-5)  # sin reaches 1 at a stored shape
    assert max(greatest["y"]) <= 0.0
    assert recorded["x"] == [20.0, 20.0]
    assert min(recorded["y"]) == pytest.approx(-2.0)
    assert least["x"].count(10.0) == 2  # both sides of a joint


def test_a_window_that_ends_before_peaks_count_is_looked_at_all_the_same() -> None:
    least = draw("envelope", finished_run(), stop=0.2)["data"][0]
    expected = -2.0 * np.sin(np.pi * 0.21 / 4)  # the shape beyond the window's end is seen too
    assert min(least["y"]) == pytest.approx(expected, rel=0.06)


def test_the_accelerations_envelope_is_the_maps_greatest_over_the_width() -> None:
    run = mapped()
    figure = draw("envelope", run, variant="acceleration")
    heat = np.array(draw("slab-map", run)["data"][0]["z"], dtype=float)
    np.testing.assert_allclose(figure["data"][1]["y"], heat.max(axis=0), rtol=1e-4, atol=1e-9)
    assert any(shape.get("y0") == 3.5 for shape in figure["layout"]["shapes"])


@pytest.mark.parametrize("text", ["", "1,2,3", "-3.5,0.7", "1e3,0,0"])
def test_places_are_read(text: str) -> None:
    assert (read_place(text) is None) == (text == "")


@pytest.mark.parametrize("text", ["1", "1,2,3,4", "a,b,c", "nan,0,0", "1e9,0,0", ",,", "=1,2,3"])
def test_a_bad_place_names_the_field(text: str) -> None:
    with pytest.raises(InputError) as caught:
        read_place(text)
    assert caught.value.field == "place"


@pytest.mark.parametrize(
    ("name", "request_", "field"),
    [
        ("point-acceleration", {}, "place"),
        ("point-displacement", {}, "place"),
        ("slab-map", {"variant": "median"}, "variant"),
        ("displacement", {"variant": "raw"}, "variant"),
    ],
)
def test_what_a_figure_cannot_use_names_the_field(
    name: str, request_: dict[str, Any], field: str
) -> None:
    with pytest.raises(InputError) as caught:
        figures()[name](finished_run(), FigureRequest(**request_))
    assert caught.value.field == field
