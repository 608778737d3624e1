"""The amplitude spectrum of a history."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Vector

__all__ = ["AmplitudeSpectrum", "amplitude_spectrum"]


@dataclass(frozen=True, kw_only=True)
class AmplitudeSpectrum:
    """Amplitudes of the harmonics that make up a history, less its mean.

    Attributes:
        frequency: Of each harmonic, from 0, shape (n_sample // 2 + 1,). [Hz]
        amplitude: Zero to peak, in the history's unit, likewise.
    """

    frequency: Vector
    amplitude: Vector

    def peaks(self, count: int) -> list[int]:
        """Indices of the greatest local maxima, the greatest first."""
        inner = self.amplitude[1:-1]
        rises = (inner > self.amplitude[:-2]) & (inner >= self.amplitude[2:])
        found = np.flatnonzero(rises) + 1
        return found[np.argsort(-self.amplitude[found], kind="stable")][:count].tolist()


def amplitude_spectrum(values: Vector, time_step: float, *, taper: bool) -> AmplitudeSpectrum:
    """One-sided amplitude spectrum, the mean taken off first.

    Without a taper the harmonics carry the history's whole variance, sum(A_k^2) / 2 (Parseval), and
    a harmonic that fits the window a whole number of times has exactly its amplitude; any other
    spreads over its neighbours, in side lobes that look like peaks. The Hann taper, its mean gain
    taken out, keeps such lobes down; it weighs the middle of the window more.

    Args:
        values: Evenly sampled, shape (n_sample,), two at least.
        time_step: Between samples. [s]
        taper: Whether to taper.

    Returns:
        The spectrum.
    """
    n_sample = values.size
    weights = np.hanning(n_sample + 1)[:-1] if taper else np.ones(n_sample)
    harmonics = np.fft.rfft((values - values.mean()) * weights)
    amplitude = 2.0 * np.abs(harmonics) / weights.sum()
    amplitude[0] *= 0.5
    if n_sample % 2 == 0:
        amplitude[-1] *= 0.5  # the last harmonic of an even number of samples has no mirror image
    return AmplitudeSpectrum(frequency=np.fft.rfftfreq(n_sample, time_step), amplitude=amplitude)
