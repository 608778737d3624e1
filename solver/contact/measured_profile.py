"""A profile from a list of points: parsed from CSV text, smoothed by a spline.

The curve through the points is a parametric cubic spline over the chord length (FITPACK's
``splprep``), so that steep flanks are as well described as the tread. Its knots are the fewest for
which the mean square distance between points and curve is at most the square of the stated
``noise``:

    sum over the points of (dy^2 + dz^2) <= n_point noise^2

Without noise the spline passes through every point. Curvature, and with it the contact ellipse, is
a second derivative: noise of a few micrometres left in the points makes it useless.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline, splprep

from solver.arrays import FloatArray, Matrix
from solver.contact.profile import Profile
from solver.errors import InputError

__all__ = ["SplineCurve", "parse_profile", "smooth_profile"]

_FEWEST = 8
"""Points below which no curvature is to be had from a cubic spline."""
_MOST = 20_000
"""Points beyond any measuring device, which would only slow the smoothing down."""
_BREADTHS = (0.005, 0.5)
"""Breadths of a wheel's or rail's profile: others are a mistaken unit. [m]"""
_MILLIMETRE = 1e-3
_SAMPLES = 8
"""Samples in each knot interval for the first guess of the inversion."""
_NEWTON_STEPS = 6
"""Of the inversion: from a guess within an eighth of a knot interval, quadratic convergence."""


@dataclass(frozen=True, kw_only=True)
class SplineCurve:
    """A parametric spline (y(u), z(u)) with y growing, read as a function of y.

    Attributes:
        start: Its smallest lateral coordinate. [m]
        end: Its largest lateral coordinate. [m]
        curve: The spline; its values are pairs of lateral coordinate and height. [m]
        parameters: Parameters of the table for the inversion, shape (n_sample,).
        laterals: Lateral coordinates there, growing, shape (n_sample,). [m]
    """

    start: float
    end: float
    curve: BSpline
    parameters: FloatArray
    laterals: FloatArray

    def derivatives(self, lateral: FloatArray) -> FloatArray:
        """Height, slope and second derivative, shape (3, ...)."""
        u = np.interp(lateral, self.laterals, self.parameters)
        for _ in range(_NEWTON_STEPS):
            error = self.curve(u)[..., 0] - lateral
            u = np.clip(
                u - error / self.curve(u, 1)[..., 0], self.parameters[0], self.parameters[-1]
            )
        height = self.curve(u)[..., 1]
        first, second = self.curve(u, 1), self.curve(u, 2)
        slope = first[..., 1] / first[..., 0]
        bend = (second[..., 1] - slope * second[..., 0]) / first[..., 0] ** 2
        return np.stack((height, slope, bend))


def parse_profile(text: str, *, unit: float = _MILLIMETRE) -> Matrix:
    """Reads a list of points from CSV text.

    Args:
        text: Two columns, lateral coordinate and height, between commas, semicolons, tabs or
            blanks; empty lines and lines that begin with ``#`` are skipped, and so is one heading.
        unit: Length of one unit of the text. [m]

    Returns:
        The points, shape (n_point, 2). [m]

    Raises:
        InputError: The text holds no points, too many, or a line is not a pair of numbers.
    """
    if not 0.0 < unit < np.inf:
        raise InputError("profile.unit", unit, "it is not a positive length", "Use 1e-3 for mm.")
    if text.count("\n") > 2 * _MOST:
        raise InputError(
            "profile.text", text.count("\n"), "it has too many lines", f"Give at most {_MOST}."
        )
    rows: list[list[float]] = []
    heading_seen = False
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        cells = line.replace(",", " ").replace(";", " ").split()
        try:
            row = [float(cell) for cell in cells]
        except ValueError:
            row = []
        if len(row) == 2:
            rows.append(row)
        elif rows or heading_seen or len(row) > 0 or any(map(_is_number, cells)):
            raise InputError(
                f"profile.line {number}",
                line[:80],
                "it is not a lateral coordinate and a height",
                "Write two numbers with a decimal point, in millimetres, for example -10.5,0.3.",
            )
        else:
            heading_seen = True
    if not rows:
        raise InputError("profile.text", text[:80], "it holds no points", "Give one point a line.")
    return np.array(rows) * unit


def _is_number(cell: str) -> bool:
    """Whether a cell of a heading is a number after all: then the line is a faulty point."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def smooth_profile(points: ArrayLike, *, name: str, noise: float = 0.0) -> Profile:
    """The profile through, or near, a list of points.

    Args:
        points: Lateral coordinates (positive to the field side, from the rail's axis or the
            wheel's tread datum) and heights (upwards), shape (n_point, 2), the lateral coordinates
            growing. [m]
        name: For figures and error messages.
        noise: Root mean square distance between points and curve that smoothing may use up: the
            accuracy of the measurement, 1e-5 for a good device; 0 interpolates. [m]

    Returns:
        A profile of one spline.

    Raises:
        InputError: Points are missing, too few or many, not finite, equal or not sorted; the noise
            is negative or the spline cannot follow the points.
    """
    table = np.asarray(points, float)
    _check_points(table, name)
    if not 0.0 <= noise < 1e-3:
        raise InputError(
            "profile.noise", noise, "it is negative or above a millimetre", "Use 1e-5 m, or 0."
        )
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        try:
            # In millimetres: FITPACK's tolerances are made for numbers near one.
            fit = splprep((table / _MILLIMETRE).T, s=len(table) * (noise / _MILLIMETRE) ** 2, k=3)
        except (RuntimeWarning, ValueError) as failure:
            raise InputError(
                f"profile.{name}",
                noise,
                f"no spline within this noise was found ({failure})",
                "State a larger noise, or remove outliers.",
            ) from failure
    return Profile(name=name, pieces=(_curve(fit[0], name),))


def _curve(knots: Any, name: str) -> SplineCurve:
    """The spline as a piece of a profile."""
    t, coefficients, degree = knots
    curve = BSpline(t, _MILLIMETRE * np.array(coefficients).T, degree)
    breaks = np.unique(t)
    steps = np.linspace(0.0, 1.0, _SAMPLES, endpoint=False)
    inner = (breaks[:-1, None] + np.diff(breaks)[:, None] * steps).ravel()
    parameters = np.append(inner, breaks[-1])
    laterals = curve(parameters)[:, 0]
    if np.any(np.diff(laterals) <= 0.0):
        place = float(laterals[np.argmax(np.diff(laterals) <= 0.0)])
        raise InputError(
            f"profile.{name}",
            place,
            "the smoothed curve runs back in the lateral direction there",
            "Cut the list where the surface overhangs, or state a larger noise.",
        )
    return SplineCurve(
        start=float(laterals[0]),
        end=float(laterals[-1]),
        curve=curve,
        parameters=parameters,
        laterals=laterals,
    )


def _check_points(table: Matrix, name: str) -> None:
    """Refuses lists from which no profile can be made."""
    field = f"profile.{name}"
    if table.ndim != 2 or table.shape[1] != 2 or not len(table):
        raise InputError(
            field, table.shape, "it is empty or no list of pairs", "Give pairs (lateral, height)."
        )
    if not _FEWEST <= len(table) <= _MOST:
        remedy = f"Give {_FEWEST} to {_MOST} points, one or two a millimetre."
        raise InputError(field, len(table), "it has too few points or too many", remedy)
    if not np.all(np.isfinite(table)):
        row = int(np.argmin(np.all(np.isfinite(table), axis=1)))
        raise InputError(
            f"{field}[{row}]", table[row].tolist(), "it is not finite", "Remove the point."
        )
    steps = np.diff(table[:, 0])
    if np.any(steps == 0.0):
        row = int(np.argmax(steps == 0.0)) + 1
        raise InputError(
            f"{field}[{row}]",
            float(table[row, 0]),
            "the lateral coordinate of the point before is repeated",
            "Give every lateral coordinate once; cut the list at vertical faces.",
        )
    if np.any(steps < 0.0):
        row = int(np.argmax(steps < 0.0)) + 1
        raise InputError(
            f"{field}[{row}]",
            float(table[row, 0]),
            "it is not sorted: the lateral coordinate is smaller than that of the point before",
            "Sort the points from the gauge side to the field side; cut where the face overhangs.",
        )
    breadth = float(table[-1, 0] - table[0, 0])
    if not _BREADTHS[0] <= breadth <= _BREADTHS[1]:
        raise InputError(
            field,
            breadth,
            f"its breadth in m is not within {_BREADTHS[0]} to {_BREADTHS[1]}",
            "Check the unit: lengths are in metres here, in millimetres in CSV text.",
        )
