"""Section 5.3.2 at full size: what a step and a Newton iteration cost, as ratios of one run."""

from __future__ import annotations

import pytest

from tests.benchmarks.direct_method import FULL_SIZE, in_own_process, iteration_share


@pytest.mark.slow
def test_a_step_costs_its_large_solve_and_an_iteration_next_to_nothing() -> None:
    linear = in_own_process(FULL_SIZE, 2, 4, "rigid")
    nonlinear = in_own_process(FULL_SIZE, 2, 4, "nonlinear")
    assert linear.unknowns == 58_696 + 8
    # Measured 1.1: the rest is histories, contact and bookkeeping.
    assert linear.step < 1.5 * (linear.large + linear.products)
    # Measured 0.02, contact lost and found in every other step; both contain the same large solve.
    assert nonlinear.status_changes >= 10
    assert nonlinear.iterations > linear.iterations + 0.5
    assert iteration_share(linear, nonlinear) < 0.1
    # Measured 0.7 GB, Python and its libraries included.
    assert max(linear.peak_memory, nonlinear.peak_memory) < 1.2e9
