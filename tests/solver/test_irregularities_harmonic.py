"""The harmonic irregularity: shape, derivatives, where it begins and ends."""

from __future__ import annotations

import numpy as np
import pytest

from solver.errors import InputError
from solver.irregularities.harmonic import HarmonicIrregularity

WAVE = HarmonicIrregularity(amplitude=0.5e-3, wavelength=5.0, start=0.0, end=25.0)


def test_shape_of_the_thesis() -> None:
    places = np.array([[0.0, 1.25], [3.75, 25.0]])
    # Equation 4.66: a quarter of the wavelength after the start comes the first crest.
    assert WAVE.elevation(places) == pytest.approx(
        np.array([[0.0, 0.5e-3], [-0.5e-3, 0.0]]), abs=1e-18
    )
    assert np.all(WAVE.elevation(np.array([-1.25, 26.25])) == 0.0)
    assert np.all(WAVE.slope(np.array([-0.1, 25.1])) == 0.0)


def test_slope_and_curvature_are_the_derivatives() -> None:
    x, h = np.linspace(0.5, 24.5, 97), 1e-4
    slope = (WAVE.elevation(x + h) - WAVE.elevation(x - h)) / (2 * h)
    curvature = (WAVE.slope(x + h) - WAVE.slope(x - h)) / (2 * h)
    # Central differences: error h^2/6 times the third derivative, about 3e-9 of the values.
    assert WAVE.slope(x) == pytest.approx(slope, abs=1e-11)
    assert WAVE.curvature(x) == pytest.approx(curvature, abs=1e-11)


@pytest.mark.parametrize(
    ("change", "field"), [({"wavelength": 0.0}, "wavelength"), ({"end": -1.0}, "end")]
)
def test_bad_values_are_refused(change: dict[str, float], field: str) -> None:
    values = {"amplitude": 1e-3, "wavelength": 5.0, "start": 0.0, "end": 25.0, **change}
    with pytest.raises(InputError, match=field):
        HarmonicIrregularity(**values)
