"""The HHT-alpha method by itself, on one oscillator."""

from __future__ import annotations

import numpy as np
import pytest

from solver.errors import InputError
from solver.integrators import HHT, HHTIntegrator, Motion

ALPHAS = [0.0, -0.05, -0.3]
FREQUENCY, DAMPING, LOAD = 9.0, 0.04, 3.0


class Oscillator:
    """a'' + 2 zeta omega a' + omega^2 a = p cos(3 t), as the integrator sees a system."""

    def __init__(self, method: HHT) -> None:
        self.method = method
        self.time = 0.0

    def begin(self, part: int, motion: Motion, inertia: np.ndarray, viscous: np.ndarray) -> None:
        method, factor = self.method, self.method.force_factor
        motion.imbalance = (method.alpha * motion.imbalance - motion.acceleration) / factor
        self._load = inertia + factor * 2 * DAMPING * FREQUENCY * viscous
        self._load = self._load + method.alpha * motion.imbalance

    def couple(self, time: float) -> None:
        self.time = time

    def finish(self, part: int) -> np.ndarray:
        method, factor = self.method, self.method.force_factor
        load = self._load + factor * LOAD * np.cos(3.0 * self.time)
        return load / (
            method.a0 + factor * method.a1 * 2 * DAMPING * FREQUENCY + factor * FREQUENCY**2
        )


def exact(times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacement, velocity and acceleration from rest at the static place LOAD / omega^2."""
    amplitude = LOAD / (FREQUENCY**2 - 9.0 + 2j * DAMPING * FREQUENCY * 3.0)
    root = -DAMPING * FREQUENCY + 1j * FREQUENCY * np.sqrt(1 - DAMPING**2)
    start = LOAD / FREQUENCY**2 - amplitude.real
    slope = 3.0 * amplitude.imag
    coefficient = start - 1j * (slope + DAMPING * FREQUENCY * start) / root.imag
    steady, free = amplitude * np.exp(3j * times), coefficient * np.exp(root * times)
    return tuple((steady * (3j) ** k + free * root**k).real for k in range(3))


def errors(alpha: float, step: float) -> np.ndarray:
    """Greatest error of displacement, velocity, and of the acceleration at t + alpha dt."""
    method = HHT(alpha, step)
    motion = Motion.at_rest(np.array([LOAD / FREQUENCY**2]))
    integrator = HHTIntegrator(method, Oscillator(method), [motion])
    # The bracket C a' + K a - F of the first step: the load is in balance at t = 0.
    times = step * np.arange(1, round(2.0 / step) + 1)
    found = []
    for time in times:
        integrator.advance(float(time))
        found.append([motion.displacement[0], motion.velocity[0], motion.acceleration[0]])
    values = np.array(found)
    wanted = exact(times)
    late = exact(times + alpha * step)[2]
    settled = times > 10 * step
    return np.array(
        [
            np.abs(values[settled, 0] - wanted[0][settled]).max(),
            np.abs(values[settled, 1] - wanted[1][settled]).max(),
            np.abs(values[settled, 2] - late[settled]).max(),
        ]
    )


@pytest.mark.parametrize("alpha", ALPHAS)
def test_second_order_in_displacement_velocity_and_shifted_acceleration(alpha: float) -> None:
    ratios = errors(alpha, 4e-3) / errors(alpha, 2e-3)
    # Four for the second order; the terms of higher order move it by some percent.
    assert np.all(ratios > 3.6)


@pytest.mark.parametrize("alpha", [0.1, -0.34, float("nan")])
def test_alpha_outside_its_range_is_refused(alpha: float) -> None:
    with pytest.raises(InputError, match="alpha"):
        HHT(alpha, 1e-3)


def test_parameters_are_the_corrected_ones() -> None:
    """Sections 6.4.3 and 7.3 print beta = 9/20 and gamma = 9025/40000 for alpha = -0.05."""
    method = HHT(-0.05, 2.5e-4)
    assert method.beta == pytest.approx(0.275625)
    assert method.gamma == pytest.approx(0.55)
