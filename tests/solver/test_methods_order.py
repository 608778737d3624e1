"""Order of the direct method in displacement, velocity, acceleration and contact force."""

from __future__ import annotations

import numpy as np
import pytest

from solver.contact.laws import ContactLaw, LinearHertz, NonlinearHertz, RigidContact
from tests.solver import platform_case as case

LAWS = {
    "rigid": RigidContact(),
    "linear": LinearHertz(stiffness=3.0e7),
    # The same tangent at the static load: resolved by the steps used here.
    "nonlinear": NonlinearHertz(coefficient=8.5e8, reference_force=case.WEIGHT),
}
DURATION = 0.4
STEPS = (400, 800)


def _errors(law: ContactLaw, alpha: float, n_step: int) -> np.ndarray:
    """Greatest errors: displacement, velocity, acceleration at t + alpha dt and at t, force."""
    dt = DURATION / n_step
    ours = case.integrate(law, alpha, dt, n_step)
    at_time, shifted = case.exact(law, ours.time), case.exact(law, ours.time + alpha * dt)
    later = slice(n_step // 8, None)
    pairs = [
        (ours.displacement, at_time.displacement), (ours.velocity, at_time.velocity),
        (ours.acceleration, shifted.acceleration), (ours.acceleration, at_time.acceleration),
        (ours.force, at_time.force),
    ]  # fmt: skip
    return np.array([np.abs(a[later] - b[later]).max() / np.abs(b).max() for a, b in pairs])


@pytest.mark.slow
@pytest.mark.parametrize("alpha", [0.0, -0.05, -0.3])
@pytest.mark.parametrize("name", LAWS)
def test_order_two(name: str, alpha: float) -> None:
    errors = np.array([_errors(LAWS[name], alpha, n_step) for n_step in STEPS])
    orders = np.log2(errors[:-1] / errors[1:])
    displacement, velocity, shifted, at_time, force = orders[-1]
    # The asymptote is approached from either side: 0.15 covers the finest pair of steps; some
    # errors cancel and fall faster.
    for order in (displacement, velocity, shifted, force):
        assert order > 1.85, orders
    if alpha == -0.3:
        # At the end of the step the acceleration is late by alpha dt: of order one.
        assert at_time < shifted - 0.1
        assert errors[-1, 3] > errors[-1, 2]
