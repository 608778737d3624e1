"""The low-pass filter of the verdicts: zero phase, one convention for everybody.

Butterworth of order 4, forwards and backwards, -3 dB at the cut-off *after both passes*. The order
and the convention alone move a deck acceleration by 10 percent, so both are fixed here and printed
with every verdict.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.arrays import Matrix
from solver.errors import InputError

__all__ = ["DESIGN_FACTOR", "FILTER_TEXT", "low_pass"]

ORDER = 4
DESIGN_FACTOR = (np.sqrt(2.0) - 1.0) ** (-1.0 / (2 * ORDER))
"""Design cut-off of one pass over the cut-off of both: 1.1165 for order 4."""
PADDING = 1.0
"""Zeros before and after the history, so that no filter transient enters it. [s]"""
FILTER_TEXT = (
    "Butterworth of order 4, forwards and backwards, -3 dB at the cut-off after both passes "
    "(design cut-off 1.1165 times it), ends padded with 1 s of zeros"
)


def low_pass(history: Matrix, time_step: float, cut_off: float) -> Matrix:
    """Removes what lies above a frequency, without moving anything in time.

    Args:
        history: Shape (n_step, n_point): evenly sampled, undecimated.
        time_step: Between samples. [s]
        cut_off: Frequency at which the gain is 1/sqrt(2). [Hz]

    Returns:
        Shape (n_step, n_point).

    Raises:
        InputError: The cut-off is not positive or the samples are too far apart for it.
    """
    # Imported here: it takes 45 MB that a server which only asks for limits does not need.
    from scipy import signal

    design = DESIGN_FACTOR * cut_off
    nyquist = 0.5 / time_step
    if not 0.0 < design < nyquist:
        raise InputError(
            "cut_off_frequency",
            cut_off,
            f"it must be positive and below {nyquist / DESIGN_FACTOR:.4g} Hz, "
            f"the most that samples every {time_step:.3g} s can show",
            "Lower the cut-off or shorten the time step.",
        )
    # Second-order sections: the plain polynomial form loses digits at a low cut-off.
    sections: Any = signal.butter(ORDER, design, fs=1.0 / time_step, output="sos")
    n_padding = round(PADDING / time_step)
    padded = np.pad(history, ((n_padding, n_padding), (0, 0)))
    filtered: Matrix = signal.sosfiltfilt(sections, padded, axis=0, padlen=0)
    return filtered[n_padding : n_padding + len(history)]
