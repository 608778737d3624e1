"""Irregularities: shape, derivatives and rails."""

from __future__ import annotations

import numpy as np
import pytest

from solver.irregularities import (
    BellShapedDefect,
    IsolatedDefect,
    NoIrregularity,
    describe,
    rail_irregularities,
)

X = np.linspace(20.0, 34.0, 281)


def test_perfect_rails_are_zero_in_the_shape_asked() -> None:
    for rail in rail_irregularities(NoIrregularity()):
        for function in (rail.elevation, rail.slope, rail.curvature):
            assert np.array_equal(function(np.ones((3, 2))), np.zeros((3, 2)))


@pytest.mark.parametrize(("rail", "defective"), [("left", {0}), ("right", {1}), ("both", {0, 1})])
def test_defect_lies_on_its_rail(rail: str, defective: set[int]) -> None:
    rails = rail_irregularities(IsolatedDefect(rail=rail))  # type: ignore[arg-type]
    highest = [float(r.elevation(X).max()) for r in rails]
    assert {i for i, value in enumerate(highest) if value > 0} == defective
    assert max(highest) == pytest.approx(0.010)


def test_widths_of_the_thesis() -> None:
    # Equation 7.3: widths at 1 percent of A for k = 0.5, 0.7, 0.9 1/m (equations.md, section 7).
    for wave_number, width in ((0.5, 12.1), (0.7, 8.7), (0.9, 6.7)):
        defect = BellShapedDefect(amplitude=0.016, wave_number=wave_number, centre=27.0)
        # Printed to 0.1 m: the hundredth of A is reached between 0.05 m less and 0.05 m more.
        inner, outer = defect.elevation(27.0 + 0.5 * (width + np.array([-0.05, 0.05])))
        assert inner > 0.01 * 0.016 > outer


def test_slope_and_curvature_are_the_derivatives() -> None:
    defect = BellShapedDefect(amplitude=-0.008, wave_number=0.9, centre=27.0)
    h = 1e-4
    slope = (defect.elevation(X + h) - defect.elevation(X - h)) / (2 * h)
    curvature = (defect.slope(X + h) - defect.slope(X - h)) / (2 * h)
    # Central differences: error h^2/6 times the third derivative, about 1e-8 of the values.
    assert defect.slope(X) == pytest.approx(slope, abs=1e-10)
    assert defect.curvature(X) == pytest.approx(curvature, abs=1e-10)
    assert defect.elevation(np.array(27.0)) == pytest.approx(-0.008), "a dip"


def test_words_for_verdicts() -> None:
    assert describe(NoIrregularity()) == "no irregularities"
    assert describe(IsolatedDefect()) == "isolated defect of 10 mm at x = 27.0 m on the right rail"
