"""What a figure shows as comma-separated values: the points that are drawn, one column a curve."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from io import StringIO
from itertools import zip_longest
from typing import Any

from server.plots.figure import Figure
from server.plots.text import plain

__all__ = ["cell", "csv_lines"]

_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def cell(value: Any) -> str:
    """A value as a cell that no spreadsheet takes for a formula."""
    if value is None:
        return ""
    if isinstance(value, int | float):
        return repr(value)
    text = str(value)
    return f"'{text}" if text.startswith(_FORMULA) else text


def csv_lines(figure: Figure) -> Iterator[str]:
    """The figure's traces side by side; those with the same abscissa share one column of it.

    Args:
        figure: As a page gets it: inside its window, decimated, in display units.

    Yields:
        Lines, each with its end.
    """
    x_title = plain(figure["layout"]["xaxis"]["title"]["text"])
    y_title = plain(figure["layout"]["yaxis"]["title"]["text"])
    columns: list[tuple[str, Sequence[Any]]] = []
    abscissa: Sequence[Any] | None = None
    named: Sequence[Any] | None = None
    for trace in figure["data"]:
        if trace["type"] == "heatmap":
            columns += _map_columns(trace, x_title, y_title)
            abscissa = None
        elif trace["type"] == "scatter":
            if trace["x"] != abscissa:
                abscissa = trace["x"]
                columns.append((x_title, trace["x"]))
            columns.append((_headed(trace), trace["y"]))
            if trace.get("customdata", named) != named:
                named = trace["customdata"]
                columns.append((trace["meta"].get("customdata", "at"), trace["customdata"]))
    yield _line([head for head, _ in columns])
    for row in zip_longest(*(values for _, values in columns)):
        yield _line(row)


def _headed(trace: dict[str, Any]) -> str:
    unit = trace.get("meta", {}).get("unit", "")
    return f"{plain(trace['name'])} [{unit}]" if unit else plain(trace["name"])


def _map_columns(
    trace: dict[str, Any], x_title: str, y_title: str
) -> list[tuple[str, Sequence[Any]]]:
    """A map as one row a point."""
    values = [value for row in trace["z"] for value in row]
    width = len(trace["x"])
    return [
        (x_title, list(trace["x"]) * len(trace["y"])),
        (y_title, [y for y in trace["y"] for _ in range(width)]),
        (_headed(trace), values),
        ("time [s]", [time for row in trace["customdata"] for time in row]),
    ]


def _line(cells: Sequence[Any]) -> str:
    buffer = StringIO()
    csv.writer(buffer).writerow([cell(value) for value in cells])
    return buffer.getvalue()
