"""Figures as files: what is drawn is what the JSON says, in both themes, and as a table."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import matplotlib.image
import numpy as np
import pytest

from server.plots import Figure, FigureRequest, csv_lines, figures, render, speed_sweep
from server.plots.palette import CURVES, DARK, PAPER, line_style
from server.plots.spreadsheet import cell
from solver.units import Units
from tests.server.plots_case import AXIS, TIME, draw, finished_run, spec
from tests.server.test_plots_places import mapped
from tests.server.test_plots_runs import SWEEP


def pixels(figure: Figure) -> Any:
    return matplotlib.image.imread(io.BytesIO(render(figure, "png")), format="png")[..., :3]


def has_color(image: Any, color: str) -> bool:
    """Whether some pixel has a colour, but for the rounding to eight bits."""
    wanted = np.array([int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    return bool((np.abs(image - wanted).max(axis=-1) < 0.005).any())


@pytest.mark.parametrize("name", sorted(figures()))
def test_every_figure_is_drawn_on_dark_ground_too(name: str) -> None:
    request = FigureRequest(theme="dark", place=(20.0, 0.0, 1.3))
    figure = figures()[name](mapped(), request)
    assert figure["layout"]["meta"]["theme"] == "dark"
    light = json.dumps(draw(name, mapped(), place=(20.0, 0.0, 1.3)))
    assert PAPER not in json.dumps(figure)
    assert light.count(CURVES[0]) == json.dumps(figure).count(DARK[CURVES[0]])
    image = pixels(figure)
    assert tuple((image[0, 0] * 255).round().astype(int)) == (0x17, 0x1F, 0x27)


def test_the_theme_changes_colours_and_nothing_else() -> None:
    light, dark = (draw("slab-map", mapped(), theme=theme) for theme in ("light", "dark"))
    assert light["data"][0] == dark["data"][0]  # a map has its own scale on either ground
    assert light["table"] == dark["table"]
    assert light["summary"] == dark["summary"]


def test_a_name_that_reads_like_a_colour_stays() -> None:
    run = finished_run()
    name = f"{CURVES[0]}/displacement"
    run.plan.channels = (spec(name, "deck", Units.small_length),)
    run.histories[name] = TIME
    figure = draw("displacement", run, theme="dark")
    assert figure["data"][0]["name"] == CURVES[0]
    assert figure["data"][0]["line"]["color"] == DARK[CURVES[0]]


def test_twenty_five_curves_differ_and_five_of_one_colour_have_five_dashes() -> None:
    styles = [line_style(number) for number in range(25)]
    assert len({(style.color, style.dash) for style in styles}) == 25
    blue = [style.dash for style in styles if style.color == CURVES[0]]
    assert len(set(blue)) == 5


def test_a_map_is_drawn_with_its_scale_limit_and_peak() -> None:
    figure = draw("slab-map", mapped())
    image = pixels(figure)
    heat, contour, _ = figure["data"]
    for color in (heat["colorscale"][0][1], contour["line"]["color"]):
        assert has_color(image, color)
    svg = render(figure, "svg").decode()
    for words in ("[m/s²]", "limit 3.5 m/s²", "span 2: judged", "x along the track [m]"):
        assert words in svg


def test_a_map_with_holes_is_drawn_in_cells() -> None:
    figure = draw("slab-map", mapped())
    figure["data"][0]["z"][1][5] = None
    assert render(figure, "png").startswith(b"\x89PNG")


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_sweep_is_drawn_in_two_panels(theme: Any) -> None:
    figure = speed_sweep(SWEEP, FigureRequest(theme=theme))
    svg = render(figure, "svg").decode()
    for words in ("acceleration [m/s²]", "displacement [mm]", "f d / 1 = 414 km/h", "9.40 m/s²"):
        assert words in svg
    image = pixels(figure)
    assert image.shape[0] > 900  # higher than a figure of one panel
    for trace in figure["data"]:
        assert has_color(image, trace["marker"]["color"])


def rows_of(figure: Figure) -> list[list[str]]:
    return list(csv.reader(io.StringIO("".join(csv_lines(figure)))))


def test_a_table_holds_the_points_that_are_drawn() -> None:
    figure = draw("displacement", finished_run(), points=60, start=1.0, stop=2.0)
    head, *rows = rows_of(figure)
    assert head == ["time [s]", "mid-span 2, axis [mm]"]
    [curve] = figure["data"]
    assert [float(row[0]) for row in rows] == curve["x"]
    assert [float(row[1]) for row in rows] == curve["y"]
    assert len(rows) <= 60


def test_curves_of_different_length_stand_side_by_side() -> None:
    figure = draw("slab-acceleration", finished_run(), points=200)
    raw, filtered = figure["data"]
    head, *rows = rows_of(figure)
    assert head.count("time [s]") == 2  # extremes of one curve lie elsewhere than the other's
    assert "[m/s2]" in head[1]
    assert len([row for row in rows if row[0]]) == len(raw["x"])
    assert len([row for row in rows if row[2]]) == len(filtered["x"])


def test_a_map_has_one_row_a_point_and_a_sweep_names_its_runs() -> None:
    head, *rows = rows_of(draw("slab-map", mapped()))
    assert head[:4] == [
        "x along the track [m]",
        "y across the track [m]",
        "greatest |acceleration| [m/s2]",
        "time [s]",
    ]
    assert len(rows) == 17 * 3
    head, *rows = rows_of(speed_sweep(SWEEP, FigureRequest()))
    assert head[2] == "run"
    assert rows[0][:3] == ["360.0", "2.5", "a"]


@pytest.mark.parametrize("name", sorted(figures()))
def test_every_figure_has_a_table(name: str) -> None:
    figure = draw(name, mapped(), place=(20.0, 0.0, 1.3))
    head, *rows = rows_of(figure)
    assert head
    assert rows
    assert all(len(row) == len(head) for row in rows)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("=1+1", "'=1+1"),
        ("+49", "'+49"),
        ("@SUM(A1)", "'@SUM(A1)"),
        ("-x", "'-x"),
        (-1.5, "-1.5"),
        (None, ""),
        ("wheel", "wheel"),
    ],
)
def test_no_cell_is_a_formula_and_numbers_stay_numbers(value: Any, text: str) -> None:
    assert cell(value) == text


def test_names_that_users_typed_are_no_formula_in_a_table() -> None:
    run = finished_run()
    name = "=HYPERLINK(1)/displacement"
    run.plan.channels = (spec(name, "deck", Units.small_length),)
    run.histories[name] = TIME
    assert rows_of(draw("displacement", run))[0][1] == "'=HYPERLINK(1) [mm]"
    assert AXIS not in rows_of(draw("displacement", run))[0]
