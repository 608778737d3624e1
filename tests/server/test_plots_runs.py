"""Figures of the train, of a sweep, and of runs beside each other."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from server.plots import (
    Figure,
    FigureRequest,
    NamedRun,
    Sweep,
    SweepPoint,
    comparisons,
    speed_sweep,
)
from server.routes.service import Service
from server.routes.sweeps import read_sweep
from server.store import JobRecord, RunRecord, attempt_place, write_summary
from server.store.place import as_place
from solver import studies
from solver.errors import InputError
from solver.results import SlabPeaks
from tests.server.plots_case import (
    AXIS,
    FILTERED,
    TIME,
    Run,
    draw,
    finished_run,
    make_run,
)


def test_carbodies_are_held_against_the_levels_of_comfort() -> None:
    figure = draw("vehicle-acceleration", finished_run())
    names = [curve["name"] for curve in figure["data"]]
    assert names == ["carbody 01", "carbody 02", "carbody 03"]  # first, worst, last
    assert [row["comfort"] for row in figure["table"]] == ["very good", "good", "very good"]
    lines = {abs(shape["y0"]) for shape in figure["layout"]["shapes"] if shape["type"] == "line"}
    assert lines == {1.0, 1.3, 2.0}
    low, high = figure["layout"]["yaxis"]["range"]
    assert high > 2.0 or high > 1.3  # the next level above 1.2 is in sight
    assert low == -high
    assert "Carbody 02: greatest magnitude 1.2 m/s²" in figure["summary"]
    words = "Of the cars with passengers carbody 02 shakes most, 1.2 m/s²: comfort is good (EN 1990"
    assert words in figure["summary"]


def test_bogies_have_no_level_of_comfort() -> None:
    figure = draw("vehicle-acceleration", finished_run(), variant="bogies")
    assert [curve["name"] for curve in figure["data"]] == ["bogie 01"]
    assert {shape["type"] for shape in figure["layout"]["shapes"]} == {"rect"}  # the run-in
    assert figure["layout"]["title"]["text"] == "Vertical acceleration of the bogies"


def test_runs_of_before_have_no_levels_and_are_drawn_all_the_same() -> None:
    run = finished_run()
    assert run.summary is not None
    run.summary = {key: value for key, value in run.summary.items() if key != "comfort"}
    figure = draw("vehicle-acceleration", run)
    assert len(figure["data"]) == 3
    assert "comfort" not in figure["summary"]


SWEEP = Sweep(
    points=(
        SweepPoint(run="b", speed=120.0, acceleration=9.4, displacement=8e-3),
        SweepPoint(run="a", speed=100.0, acceleration=2.5, displacement=3e-3),
    ),
    planned=(100.0, 110.0, 120.0),
    open=1,
    limit=3.5,
    quantity="below 30 Hz",
    frequency=6.4,
    resonances=((1, 115.0), (2, 57.5)),
)


def test_a_sweep_is_drawn_over_the_speed_and_leads_to_its_runs() -> None:
    figure = speed_sweep(SWEEP, FigureRequest())
    above, below = figure["data"]
    assert above["x"] == [360.0, 432.0]
    assert above["y"] == [2.5, 9.4]
    assert below["y"] == [3.0, 8.0]
    # Spans that are shown but not judged may move more: the Overview says by how much.
    assert below["name"] == "greatest |displacement| at judged mid-spans"
    assert (above["customdata"], below["customdata"]) == (["a", "b"], ["a", "b"])
    assert (above.get("yaxis", "y"), below["yaxis"]) == ("y", "y2")
    assert above["marker"]["symbol"] != below["marker"]["symbol"]
    low, high = figure["layout"]["xaxis"]["range"]
    assert low < 360.0 < 432.0 < high  # all planned speeds, so that it stands still
    assert [row["verdict"] for row in figure["table"]] == ["within", "exceeds"]
    assert "9.40 m/s² at 432 km/h, outside 3.5 m/s²; 1 of 2 speeds exceed it" in figure["summary"]
    assert "1 of 3 runs are still to come" in figure["summary"]


def test_a_sweep_marks_its_limit_and_the_resonances_in_sight() -> None:
    figure = speed_sweep(SWEEP, FigureRequest())
    shapes = figure["layout"]["shapes"]
    assert [shape["x0"] for shape in shapes if shape["yref"] == "paper"] == [414.0]
    assert [shape["y0"] for shape in shapes if shape["yref"] == "y"] == [3.5]
    words = [note["text"] for note in figure["layout"]["annotations"]]
    assert "f d / 1 = 414 km/h" in words
    # Its words would cover those of the peak, which is near: they stand over the displacements.
    (resonance,) = [
        note for note in figure["layout"]["annotations"] if note["text"].startswith("f d")
    ]
    assert resonance["yref"] == "y2 domain"
    assert "v = f d / i, f = 6.4 Hz: 414 km/h for i = 1" in figure["summary"]


def test_a_sweep_of_which_nothing_has_ended_says_so() -> None:
    sweep = replace(SWEEP, points=(), open=3, limit=None, resonances=(), frequency=None)
    figure = speed_sweep(sweep, FigureRequest())
    assert figure["table"] == []
    assert figure["summary"] == "No run has been judged yet. 3 of 3 runs are still to come."


def test_a_sweep_without_a_verdict_has_no_side() -> None:
    figure = speed_sweep(replace(SWEEP, limit=None, quantity="as computed"), FigureRequest())
    assert {row["verdict"] for row in figure["table"]} == {""}
    assert figure["data"][1]["name"] == "greatest |displacement| at mid-span"
    assert "outside" not in figure["summary"]


def pair() -> list[NamedRun]:
    """A baseline, and a faster run that shakes half as much again."""
    one, other = finished_run(), finished_run()
    other.plan.speed = 60.0
    for name in (AXIS, FILTERED):
        other.histories[name] = 1.5 * other.histories[name]
    return [
        NamedRun(name="slow <b>", run="a", source=one),
        NamedRun(name="fast", run="b", source=other),
    ]


def compared(name: str, runs: list[NamedRun], **request: Any) -> Figure:
    return comparisons()[name](runs, FigureRequest(**request))


def test_histories_lie_over_one_another_under_the_names_of_their_runs() -> None:
    figure = compared("histories", pair())
    one, other = figure["data"]
    assert (one["name"], other["name"]) == ("slow &lt;b&gt;", "fast")
    assert one["line"]["dash"] != other["line"]["dash"]
    assert max(other["y"]) == pytest.approx(1.5 * max(one["y"]), rel=1e-6)
    assert [row["change"] for row in figure["table"]] == pytest.approx([0.0, 0.5])
    assert [row["run"] for row in figure["table"]] == ["a", "b"]
    assert "(+50.0 percent)" in figure["summary"]
    assert "The speeds differ" in figure["summary"]
    # Filtered histories were stored: they are the ones that the limit is for.
    assert max(one["y"]) == pytest.approx(finished_run().histories[FILTERED].max(), rel=1e-6)
    assert figure["layout"]["xaxis"]["title"]["text"] == "time [s]"


def test_raw_histories_are_compared_when_asked_for() -> None:
    figure = compared("histories", pair(), variant="raw")
    assert max(figure["data"][0]["y"]) == pytest.approx(make_run().histories[AXIS].max(), rel=1e-6)


def test_over_the_position_each_run_moves_at_its_own_speed() -> None:
    runs = pair()
    figure = compared("histories", runs, variant="position", channels=(AXIS,))
    for curve, item in zip(figure["data"], runs, strict=True):
        plan = item.source.plan
        end = plan.start_position + plan.speed * TIME[-1]
        assert (curve["x"][0], curve["x"][-1]) == pytest.approx((plan.start_position, end))
    assert figure["layout"]["xaxis"]["title"]["text"] == "x of the first axle [m]"


def test_a_run_without_the_channel_is_named_and_left_out() -> None:
    runs = pair()
    source = runs[1].source
    assert isinstance(source, Run)
    source.plan.channels = source.plan.channels[1:]
    figure = compared("histories", runs, channels=(AXIS,))
    assert len(figure["data"]) == 1
    assert "Without this channel: fast." in figure["summary"]


@pytest.mark.parametrize(
    ("request_", "field"),
    [
        ({"channels": ("no such",)}, "channel"),
        ({"channels": (AXIS, "wheel 01 left/contact force")}, "channel"),
        ({"variant": "smooth"}, "variant"),
    ],
)
def test_a_comparison_that_cannot_be_names_the_field(request_: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as caught:
        compared("histories", pair(), **request_)
    assert caught.value.field == field


def test_shapes_of_modes_cannot_be_compared_as_histories() -> None:
    runs = pair()
    source = runs[1].source
    assert isinstance(source, Run)
    source.plan.modal = True
    with pytest.raises(InputError, match="no histories"):
        compared("envelope", runs)


def test_envelopes_of_runs_have_one_style_and_one_name_each() -> None:
    figure = compared("envelope", pair())
    assert [curve["showlegend"] for curve in figure["data"]] == [True, False, True, False]
    assert len({curve["line"]["color"] for curve in figure["data"]}) == 2
    values = [row["value"] for row in figure["table"] if row["extreme"] == "least"]
    assert values == pytest.approx([-2.0, -2.0])


def test_an_envelope_of_accelerations_leaves_out_runs_without_peaks() -> None:
    runs = pair()
    source = runs[0].source
    assert isinstance(source, Run)
    n = len(source.plan.slab.coordinates)
    flat = np.full(n, 2.0)
    source.peaks = SlabPeaks(raw=2 * flat, raw_time=flat, filtered=flat, filtered_time=flat)
    figure = compared("envelope", runs, variant="acceleration")
    [curve] = figure["data"]
    assert set(curve["y"]) == {2.0}
    assert "of fast" in figure["summary"]


def test_a_power_car_shakes_no_passengers() -> None:
    run = finished_run()
    assert run.summary is not None
    comfort = run.summary["comfort"]
    cars = [{**car, "passengers": car["name"] != "carbody 02"} for car in comfort["cars"]]
    run.summary = {**run.summary, "comfort": {**comfort, "cars": cars, "worst": cars[2]}}
    figure = draw("vehicle-acceleration", run)
    assert [row["comfort"] for row in figure["table"]] == [
        "very good",
        "very good",
        "no passengers",
    ]
    assert "carbody 03 shakes most, 0.6 m/s²: comfort is very good" in figure["summary"]


def test_a_resonance_just_beyond_the_sweep_is_in_sight() -> None:
    figure = speed_sweep(replace(SWEEP, resonances=((1, 125.0), (2, 62.5))), FigureRequest())
    assert figure["layout"]["xaxis"]["range"][1] > 450.0
    assert "f d / 1 = 450 km/h" in [note["text"] for note in figure["layout"]["annotations"]]


def test_the_sweeps_values_are_the_verdicts_of_the_runs_that_are_done(tmp_path: Path) -> None:
    study = studies.to_json(studies.template("khst-alverca").study)
    job = JobRecord(
        sequence=1, id="j", kind="crossing", name="", study=study, state="running", steps=1,
        error=None, created=0.0, started=None, ended=None,
    )  # fmt: skip
    speeds = {"a": 100.0, "b": 120.0, "c": 110.0}
    runs = [
        RunRecord(
            id=name, job="j", batch="x", index=index, parameters={"speed": speed}, attempt=1,
            state="running" if name == "c" else "done", progress={}, verdicts=None, error=None,
            started=None, ended=None,
        )
        for index, (name, speed) in enumerate(speeds.items())
    ]  # fmt: skip
    store = as_place(tmp_path)
    for name, value in (("a", 2.5), ("b", 9.4)):
        spans = [{"number": 1, "judged": False}, {"number": 2, "judged": True}]
        verdict = {
            "rule": "deck acceleration", "value": value, "limit": 3.5, "cut_off": 30.0,
            "spans": spans,
        }  # fmt: skip
        # Span 20 begins with a 2, and is another one.
        least = {"mid-span 1, axis": -0.5, "mid-span 2, axis": -1e-3 * value, "mid-span 20": -0.6}
        times = {"time_of_least": 1.0, "time_of_greatest": 0.0}
        peaks = {
            f"{place}/displacement": {"least": size, "greatest": 0.0, **times}
            for place, size in least.items()
        }
        facts = {"member_frequencies": [6.4, 8.0, 17.0]}
        document = {"verdicts": [verdict], "peaks": peaks, "facts": facts}
        write_summary(attempt_place(store, name, 1), document)
    records = SimpleNamespace(runs_of=lambda jobs: {jobs[0]: runs})
    sweep = read_sweep(cast(Service, SimpleNamespace(database=records, store=store)), job)
    found = [(point.run, point.acceleration, point.displacement) for point in sweep.points]
    assert found == [("a", 2.5, 2.5e-3), ("b", 9.4, 9.4e-3)]  # of the judged span alone
    assert (sweep.limit, sweep.open, sweep.quantity) == (3.5, 1, "below 30 Hz")
    assert sweep.frequency == 6.4
    # KHST: bogies of the articulated cars lie 18.7 m apart.
    assert sweep.resonances[0] == (1, pytest.approx(6.4 * 18.7, rel=1e-3))
