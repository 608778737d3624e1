"""The filter of the verdicts, as modelling fixes it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from solver.errors import InputError
from solver.standards import low_pass
from solver.standards.low_pass import DESIGN_FACTOR

STEP = 2.5e-4
TIME = np.arange(0.0, 4.0, STEP)


def gain(frequency: float, cut_off: float = 30.0) -> float:
    """Amplitude of a steady sine after the filter, from the middle of a long history."""
    sine = np.sin(2 * np.pi * frequency * TIME)[:, None]
    middle = slice(len(TIME) // 4, 3 * len(TIME) // 4)
    return float(np.abs(low_pass(sine, STEP, cut_off)[middle]).max())


def test_design_factor() -> None:
    assert abs(DESIGN_FACTOR - 1.1165) < 5e-5


@pytest.mark.parametrize("cut_off", [30.0, 60.0])
def test_gain_at_the_cut_off_is_minus_three_decibels(cut_off: float) -> None:
    # Bilinear warping at 60 Hz and 4 kHz costs 0.03 percent.
    assert gain(cut_off, cut_off) == pytest.approx(np.sqrt(0.5), rel=1e-3)


def test_gain_far_from_the_cut_off() -> None:
    # Both passes together: 1 / (1 + (f / 1.1165 f_c)^8).
    assert gain(6.0) == pytest.approx(1.0, abs=1e-4)
    assert gain(60.0) == pytest.approx(1 / (1 + (60 / 33.495) ** 8), rel=0.02)
    assert gain(200.0) < 1e-5


def test_zero_phase() -> None:
    pulse: NDArray[np.float64] = np.exp(-(((TIME - 2.0) / 0.05) ** 2))[:, None]
    filtered = low_pass(pulse, STEP, 30.0)[:, 0]
    centre = round(2.0 / STEP)
    assert np.argmax(filtered) == centre
    reach = 2000
    after = filtered[centre : centre + reach]
    before = filtered[centre : centre - reach : -1]
    # The first and the last pass see different ends of the padding: rounding only.
    assert after == pytest.approx(before, abs=1e-9)


def test_history_that_starts_at_once_is_not_reflected() -> None:
    # Zeros before the history: a step at its first sample is halved there, not extrapolated.
    filtered = low_pass(np.ones((4000, 1)), STEP, 30.0)
    assert filtered[0, 0] == pytest.approx(0.5, abs=0.02)
    assert filtered[2000, 0] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("cut_off", [0.0, -5.0, 2000.0])
def test_impossible_cut_offs_are_refused(cut_off: float) -> None:
    with pytest.raises(InputError) as caught:
        low_pass(np.ones((100, 1)), STEP, cut_off)
    assert caught.value.field == "cut_off_frequency"
