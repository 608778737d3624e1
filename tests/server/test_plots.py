"""Figures: what is drawn, said and tabulated; decimation keeps every extreme; files open."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from server.plots import MEDIA_TYPES, figures, render
from server.plots.decimation import extreme_indices
from server.plots.text import beside, quantity
from solver.arrays import Vector
from solver.errors import InputError
from solver.units import Units
from tests.server.plots_case import (
    AXIS,
    FILTERED,
    TIME,
    Plan,
    Run,
    draw,
    finished_run,
    make_run,
    spec,
)


@pytest.mark.parametrize("points", [4, 50, 333, 2000])
def test_decimation_keeps_every_buckets_extremes_and_the_ends(points: int) -> None:
    rng = np.random.default_rng(3)
    values = rng.normal(size=21_001)
    values[[7, 10_007, 20_999]] = [9.0, -11.0, 10.0]
    keep = extreme_indices(values, points)
    assert keep.size <= points
    assert (np.diff(keep) > 0).all()
    assert {0, values.size - 1, 10_007} <= set(keep.tolist())
    assert values[keep].max() == values.max()
    if points >= 50:
        assert {7, 20_999} <= set(keep.tolist())


def test_decimation_leaves_short_histories_alone_and_passes_over_gaps() -> None:
    assert extreme_indices(np.arange(30.0), 50).tolist() == list(range(30))
    values = np.sin(np.linspace(0, 20, 5000))
    values[1000:2000] = np.nan
    assert np.nanmax(values[extreme_indices(values, 200)]) == np.nanmax(values)


def test_a_running_slab_figure_draws_raw_only_and_within_what_is_committed() -> None:
    figure = draw("slab-acceleration", make_run(committed=1500))
    (raw,) = figure["data"]
    assert raw["name"] == "mid-span 2, axis, raw"
    assert max(raw["x"]) == pytest.approx(1.499)
    assert figure["layout"]["xaxis"]["range"] == [0.0, 4.0]  # the whole run, so that it grows
    assert figure["layout"]["title"]["text"] == "Vertical acceleration of the slab"


def test_a_plain_beams_acceleration_is_of_no_slab() -> None:
    run = make_run()
    run.plan.slab = replace(run.plan.slab, judged_spans=())
    title = draw("slab-acceleration", run)["layout"]["title"]["text"]
    assert title == "Vertical acceleration of the deck"


def test_a_finished_slab_figure_draws_band_and_named_peak_of_the_filtered_curve() -> None:
    figure = draw("slab-acceleration", finished_run())
    raw, bold = figure["data"]
    assert raw["line"]["width"] < bold["line"]["width"]
    assert bold["name"] == "mid-span 2, axis, below 30 Hz"
    band = [shape for shape in figure["layout"]["shapes"] if shape.get("y0") == -3.5]
    assert {shape["type"] for shape in band} == {"rect", "line"}
    (peak,) = [note for note in figure["layout"]["annotations"] if note["showarrow"]]
    slow = np.abs(np.array(bold["y"]))
    assert abs(peak["y"]) == pytest.approx(slow.max(), rel=1e-6)
    assert "mid-span 2, axis" in peak["text"]
    assert "outside ±3.5 m/s²" in figure["summary"]
    assert "3.98 m/s² at x = 29.2 m, y = 0.00 m, t = 2.310 s" in figure["summary"]


DECIDING = "deciding point/acceleration (filtered)"


def _decided(place: dict[str, Any], factor: float = 1.25) -> Run:
    """A finished run whose verdict lies beside the named points: 1.25 times mid-span's history."""
    run = finished_run()
    assert run.summary is not None
    history = factor * run.histories[FILTERED]
    peak = int(np.argmax(np.abs(history)))
    (verdict,) = run.summary["verdicts"]
    verdict |= {"place": place, "value": abs(history[peak]), "time": TIME[peak]}
    stored = [*run.summary["filtered"], {"name": "deciding point", "channel": DECIDING}]
    run.histories[DECIDING] = history
    run.summary = {**run.summary, "filtered": stored}
    return run


def test_the_named_peak_of_a_judged_slab_is_the_verdicts_value_and_place() -> None:
    run = _decided({"name": "slab, span 2", "x": 29.2154, "y": -0.0, "z": 1.335})
    assert run.summary is not None
    (verdict,) = run.summary["verdicts"]
    figure = draw("slab-acceleration", run)
    (peak,) = [note for note in figure["layout"]["annotations"] if note["showarrow"]]
    assert abs(peak["y"]) == pytest.approx(verdict["value"], rel=1e-12)
    assert peak["x"] == pytest.approx(verdict["time"], abs=1e-6)  # as it is rounded for a figure
    assert peak["text"].split("<br>") == [
        f"{verdict['value']:.2f} m/s²",
        "deciding point, x = 29.2 m, y = 0.00 m",
        f"t = {verdict['time']:.3f} s",
    ]
    names = [curve["name"] for curve in figure["data"]]
    assert names[-1] == "deciding point, x = 29.2 m, y = 0.00 m, below 30 Hz"
    assert len(names) == 3  # over the raw and the filtered history of mid-span
    # It is no channel: the page offers neither its removal nor its file.
    assert [row["channel"] for row in figure["table"]] == [AXIS, AXIS, ""]


@pytest.mark.parametrize("factor", [1.25, -1.25])
def test_the_words_below_a_peak_hide_no_number_of_the_time_axis(factor: float) -> None:
    run = _decided({"name": "slab, span 2", "x": 29.2154, "y": -0.0, "z": 1.335}, factor)
    layout = draw("slab-acceleration", run)["layout"]
    (peak,) = [note for note in layout["annotations"] if note["showarrow"]]
    low, high = layout["yaxis"]["range"]
    # 34 pixels to the middle of three lines of 11 pixels; the page's charts are 207 pixels high.
    assert peak["y"] > 0.0 or (peak["y"] - low) / (high - low) > 58.0 / 207.0


def test_without_a_verdict_the_deciding_point_changes_nothing() -> None:
    run = _decided({"name": "slab, span 2", "x": 29.2, "y": 0.0, "z": 1.335})
    assert run.summary is not None
    run.summary = {**run.summary, "verdicts": []}
    plain = finished_run()
    assert plain.summary is not None
    plain.summary = {**plain.summary, "verdicts": []}
    assert draw("slab-acceleration", run) == draw("slab-acceleration", plain)


def test_a_deciding_point_that_is_drawn_already_is_not_drawn_twice() -> None:
    run = _decided({"name": "slab, span 2", "x": 27.0, "y": 0.0, "z": 1.335}, factor=1.0)
    run.plan.channels = (replace(run.plan.channels[0], place=(27.0, 0.0, 1.3)),)
    figure = draw("slab-acceleration", run)
    assert len(figure["data"]) == 2
    (peak,) = [note for note in figure["layout"]["annotations"] if note["showarrow"]]
    assert "mid-span 2, axis" in peak["text"]


def test_channels_asked_for_are_drawn_alone() -> None:
    run = _decided({"name": "slab, span 2", "x": 29.2, "y": 0.0, "z": 1.335})
    assert len(draw("slab-acceleration", run, channels=(AXIS,))["data"]) == 2


@pytest.mark.parametrize(
    ("value", "text"), [(9.403, "9.40 m/s²"), (3.5003, "3.5003 m/s²"), (3.5, "3.50 m/s²")]
)
def test_a_value_beside_its_limit_never_reads_as_the_limit(value: float, text: str) -> None:
    assert beside(value, 3.5, Units.acceleration) == text


def test_the_run_in_is_shaded_and_its_peaks_do_not_count() -> None:
    run = finished_run()
    run.histories[FILTERED][100] = 50.0  # before window_start = 0.4 s
    figure = draw("slab-acceleration", run)
    (peak,) = [note for note in figure["layout"]["annotations"] if note["showarrow"]]
    assert abs(peak["y"]) < 5.0
    assert any(shape.get("x1") == 0.4 for shape in figure["layout"]["shapes"])


def test_contact_forces_are_in_kilonewtons_with_static_load_and_loss_of_contact() -> None:
    figure = draw("contact-force", make_run())
    names = [curve["name"] for curve in figure["data"]]
    assert names == ["wheel 01 left", "wheel 01 right", "contact lost"]
    assert figure["data"][-1]["x"] == [2.0]  # where the loss begins, on the line of zero
    assert figure["data"][-1]["y"] == [0.0]
    assert figure["data"][0]["y"][0] == pytest.approx(83.4)
    levels = [shape["y0"] for shape in figure["layout"]["shapes"] if shape["type"] == "line"]
    assert levels == pytest.approx([0.0, 83.4])
    assert figure["table"][0]["contact_lost"] == pytest.approx(0.010)  # ten samples of 1 ms
    assert "contact lost for 10 ms" in figure["summary"]
    assert "always in contact" in figure["summary"]


def test_wheels_that_are_not_drawn_and_lose_contact_are_named() -> None:
    """Who reads that wheel 01 keeps contact takes it for the train."""
    run = make_run()
    least = {"01 left": 0.0, "02 left": 0.0, "07 left": 0.0, "03 left": 1.0}
    peaks = {f"wheel {name}/contact force": {"least": force} for name, force in least.items()}
    run.summary = {"peaks": peaks}
    words = draw("contact-force", run)["summary"]
    assert words.endswith("Not drawn: wheel 02 left, wheel 07 left, where contact is lost too.")
    run.summary = {"peaks": peaks | {name.replace("left", "right"): peaks[name] for name in peaks}}
    words = draw("contact-force", run)["summary"]
    assert words.endswith("Not drawn: 4 more wheels, where contact is lost too.")


@pytest.mark.parametrize(
    ("count", "drawn"), [(1, ["01"]), (4, ["01", "02", "03", "04"]), (9, ["01", "09"])]
)
def test_a_few_masses_on_one_path_are_all_drawn(count: int, drawn: list[str]) -> None:
    numbers = [f"{number:02d}" for number in range(1, count + 1)]
    forces = [spec(f"wheel {number}/contact force", "wheel", Units.force) for number in numbers]
    moves = [spec(f"mass {number}/displacement", "vehicle", Units.length) for number in numbers]
    channels = (*forces, *moves)
    histories = {channel.name: np.ones(TIME.size) for channel in channels}
    run = Run(plan=Plan(channels=channels), histories=histories)
    for figure, body in (("contact-force", "wheel"), ("displacement", "mass")):
        names = [curve["name"] for curve in draw(figure, run)["data"]]
        assert names == [f"{body} {number}" for number in drawn]


def test_a_contact_that_pulls_is_never_called_lost() -> None:
    run = make_run()
    force = run.histories["wheel 01 left/contact force"]
    run.histories["wheel 01 left/contact force"] = np.where(force <= 0.0, -2.0e5, force)
    figure = draw("contact-force", run)
    assert "contact lost" not in [curve["name"] for curve in figure["data"]]
    assert figure["table"][0]["contact_lost"] == 0.0
    assert "pulls for 10 ms: this contact cannot be lost" in figure["summary"]
    words = [note["text"] for note in figure["layout"]["annotations"]]
    assert "0: the contact pulls below" in words


def test_wheels_of_an_axle_that_feel_the_same_are_one_curve_that_says_so() -> None:
    run = make_run()
    run.histories["wheel 01 right/contact force"] = run.histories["wheel 01 left/contact force"]
    figure = draw("contact-force", run)
    assert [curve["name"] for curve in figure["data"]] == [
        "wheel 01 left and right",
        "contact lost",
    ]
    assert figure["summary"].startswith("Wheel 01 left and right: between")
    both = ("wheel 01 left/contact force", "wheel 01 right/contact force")
    assert len(draw("contact-force", run, channels=both)["data"]) == 3  # and the loss of contact


def test_a_run_that_gets_on_while_a_figure_is_drawn_is_drawn_as_far_as_it_was_read() -> None:
    class Computing(Run):
        def channel(self, name: str, start: int = 0, stop: int | None = None) -> Vector:
            self.committed += 250
            return super().channel(name, start, stop)

    run = Computing(**vars(make_run(committed=500)))
    run.histories["wheel 01 right/contact force"] = run.histories["wheel 01 left/contact force"]
    for name in ("slab-acceleration", "contact-force", "displacement"):
        assert draw(name, run)["data"]
    assert draw("contact-force", run)["data"][0]["name"] == "wheel 01 left and right"


def test_displacements_are_in_millimetres_upward() -> None:
    figure = draw("displacement", make_run())
    assert min(figure["data"][0]["y"]) == pytest.approx(-2.0)
    assert "2 mm down" in figure["summary"]


@pytest.mark.parametrize("name", ["displacement", "slab-acceleration"])
def test_noise_before_the_train_arrives_is_not_stretched_over_the_chart(name: str) -> None:
    run = make_run()
    for channel, values in run.histories.items():
        run.histories[channel] = 1e-9 * np.asarray(values)
    assert draw(name, run)["layout"]["yaxis"]["range"] == [-0.01, 0.01]


def test_channels_window_and_points_are_as_asked() -> None:
    figure = draw(
        "contact-force",
        make_run(),
        channels=("wheel 02 left/contact force",),
        start=1.0,
        stop=1.5,
        points=60,
    )
    (curve,) = figure["data"]
    assert len(curve["x"]) <= 60
    assert (min(curve["x"]), max(curve["x"])) == pytest.approx((1.0, 1.501))
    assert figure["layout"]["xaxis"]["range"] == [1.0, 1.5]


@pytest.mark.parametrize(
    ("request_", "field"),
    [
        ({"points": 3}, "points"),
        ({"points": 10**9}, "points"),
        ({"start": 2.0, "stop": 1.0}, "from"),
        ({"stop": float("nan")}, "to"),
        ({"channels": ("a",) * 17}, "channels"),
        ({"channels": ("no such channel",)}, "channels"),
    ],
)
def test_bad_requests_name_the_field(request_: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as caught:
        draw("displacement", make_run(), **request_)
    assert caught.value.field == field


@pytest.mark.parametrize("name", sorted(figures()))
def test_before_the_first_step_a_figure_is_empty_and_says_so(name: str) -> None:
    figure = draw(name, make_run(committed=0), place=(20.0, 0.0, 1.3))
    assert "No step has been computed yet" in figure["summary"]
    assert render(figure, "png").startswith(b"\x89PNG")


@pytest.mark.parametrize("name", sorted(figures()))
def test_figures_are_plain_json(name: str) -> None:
    run = finished_run()
    run.histories[AXIS][5] = np.nan
    for variant in ("", *(item.name for item in figures()[name].variants)):
        figure = draw(name, run, place=(20.0, 0.0, 1.3), variant=variant)
        json.dumps(figure, allow_nan=False)


def test_names_with_markup_are_shown_and_never_read() -> None:
    run = make_run()
    evil = "<a href='x'>$\\frac{</a> & more/displacement"
    run.plan.channels = (spec(evil, "deck", Units.small_length),)
    run.histories = {evil: TIME}
    figure = draw("displacement", run)
    assert figure["data"][0]["name"].startswith("&lt;a href='x'&gt;$")
    svg = render(figure, "svg").decode()
    assert "<a href" not in svg
    assert "$\\frac{" in svg


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file_format", "magic"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")]
)
def test_files_are_drawn_from_the_same_dictionary_and_repeat(
    file_format: str, magic: bytes
) -> None:
    figure = draw("slab-acceleration", finished_run())
    first = render(figure, file_format)
    assert file_format in MEDIA_TYPES
    assert first.startswith(magic)
    assert render(figure, file_format) == first
    if file_format == "svg":
        assert "mid-span 2, axis, below 30 Hz" in first.decode()


def test_an_unknown_file_format_is_refused() -> None:
    with pytest.raises(InputError, match="png, svg or pdf"):
        render(draw("displacement", make_run()), "exe")


@pytest.mark.parametrize(
    ("value", "text"), [(3.98, "3.98 kN"), (-0.5, "−0.5 kN"), (12345.6, "12346 kN"), (4e-8, "0 kN")]
)
def test_quantities_read_as_engineers_write_them(value: float, text: str) -> None:
    assert quantity(value, Units.force) == text


def test_the_force_axis_shows_zero_only_when_a_wheel_comes_near_to_it() -> None:
    losing = draw("contact-force", make_run())["layout"]["yaxis"]["range"]
    assert losing[0] < 0.0
    steady = draw("contact-force", make_run(), stop=1.5)["layout"]["yaxis"]["range"]
    assert 80.0 < steady[0] < 82.0  # the band of +-1 kN about 83 kN fills the axis
