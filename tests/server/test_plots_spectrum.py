"""Spectra: a known sinusoid, Parseval, and what the figure says of them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from server.plots.fourier import amplitude_spectrum
from tests.server.plots_case import AXIS, STEP, TIME, draw, finished_run, make_run


@pytest.mark.parametrize("taper", [False, True])
def test_a_sinusoid_has_its_amplitude_at_its_frequency(taper: bool) -> None:
    # 4.000 s of 12.5 Hz are 50 whole periods: the harmonic lies on a line, nothing leaks.
    time = np.arange(4000) * STEP
    found = amplitude_spectrum(2.5 + 0.75 * np.sin(2 * np.pi * 12.5 * time), STEP, taper=taper)
    [peak] = found.peaks(1)
    assert found.frequency[peak] == pytest.approx(12.5, rel=1e-12)
    assert found.amplitude[peak] == pytest.approx(0.75, rel=1e-9)  # rounding of 4000 terms
    assert found.amplitude[0] == pytest.approx(0.0, abs=1e-9)  # the mean is taken off


@settings(max_examples=30, deadline=None)
@given(n=st.integers(16, 301), seed=st.integers(0, 2**31))
def test_without_a_taper_the_harmonics_carry_the_whole_variance(n: int, seed: int) -> None:
    values = np.random.default_rng(seed).normal(size=n)
    found = amplitude_spectrum(values, STEP, taper=False)
    power = 0.5 * found.amplitude**2
    if n % 2 == 0:
        power[-1] *= 2.0  # a cosine at half the sampling rate is +-A at every sample
    assert power.sum() == pytest.approx(np.var(values), rel=1e-9)


def test_between_lines_the_taper_keeps_more_of_the_amplitude_and_fewer_side_lobes() -> None:
    time = np.arange(4000) * STEP
    values = np.sin(2 * np.pi * 12.625 * time)  # half-way between two lines: the worst case
    plain, tapered = (amplitude_spectrum(values, STEP, taper=taper) for taper in (False, True))
    # Scalloping losses in the closed form: 2 / pi and 8 / (3 pi).
    assert plain.amplitude.max() == pytest.approx(2 / np.pi, rel=0.01)
    assert tapered.amplitude.max() == pytest.approx(8 / (3 * np.pi), rel=0.01)
    far = plain.frequency > 20.0
    assert tapered.amplitude[far].max() < 0.01 * plain.amplitude[far].max()


def test_the_figure_names_peaks_cut_off_and_own_frequencies() -> None:
    run = finished_run()
    run.plan.facts = {"member_frequencies": [6.64, 8.33, 17.5]}
    run.histories[AXIS] = 3.0 * np.sin(2 * np.pi * 6.5 * TIME)
    figure = draw("spectrum", run, start=0.0, stop=3.9995)
    row = figure["table"][0]
    assert (row["frequency [Hz]"], row["value"]) == pytest.approx((6.5, 3.0), rel=1e-6)
    assert "3 m/s² at 6.5 Hz" in figure["summary"]
    lines = [shape["x0"] for shape in figure["layout"]["shapes"]]
    assert lines == [6.64, 8.33, 17.5, 30.0]
    words = " ".join(note["text"] for note in figure["layout"]["annotations"])
    assert "cut-off 30 Hz" in words
    assert figure["layout"]["xaxis"]["range"] == [0.0, 90.0]  # three cut-offs
    assert figure["layout"]["meta"]["axis"] == "frequency"


def test_the_run_in_does_not_count_and_every_line_in_sight_is_drawn() -> None:
    run = finished_run()
    run.histories[AXIS] = np.where(TIME < 0.4, 50.0, np.sin(2 * np.pi * 5 * TIME))
    figure = draw("spectrum", run, variant="plain", points=500)
    [curve] = figure["data"]
    assert len(curve["x"]) <= 500
    assert figure["table"][0]["value"] == pytest.approx(1.0, rel=0.01)
    # Decimation keeps the peak itself.
    assert max(curve["y"]) == pytest.approx(figure["table"][0]["value"], rel=1e-6)


def test_channels_of_different_units_say_so() -> None:
    channels = (AXIS, "wheel 01 left/contact force")
    figure = draw("spectrum", make_run(), channels=channels)
    assert figure["layout"]["yaxis"]["title"]["text"] == "amplitude, each in its unit"
    assert [curve["name"][-7:] for curve in figure["data"]] == [" [m/s²]", "ce [kN]"]
    assert [curve["line"]["dash"] for curve in figure["data"]] == ["solid", "dash"]


def test_a_window_that_is_too_short_says_so() -> None:
    figure = draw("spectrum", finished_run(), start=1.0, stop=1.005)
    assert figure["data"] == []
    assert figure["summary"] == "The window holds too few samples for a spectrum."
