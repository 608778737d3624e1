"""Cost of a step, as a ratio to the large solve in it: same machine, same run.

Run with ``pytest tests/benchmarks -s`` to read the table.
"""

from __future__ import annotations

import resource
import time
from itertools import islice

import numpy as np
import pytest

from solver.studies import prepare, template

N_STEP = 60


@pytest.mark.slow
@pytest.mark.parametrize("name", ["khst-alverca", "khst-alverca-standard"])
def test_a_step_costs_little_more_than_its_large_solve(name: str) -> None:
    """Everything beside the one forward and backward pass: products, rails, contact, recording."""
    simulation = prepare(template(name).study)
    structure = simulation.effective.structure
    assert structure is not None
    samples = simulation.samples()
    for _ in islice(samples, 5):
        pass
    start = time.process_time()
    for _ in islice(samples, N_STEP):
        pass
    step = (time.process_time() - start) / N_STEP
    load = np.random.default_rng(0).standard_normal(structure.matrices.mass.shape[0])
    start = time.process_time()
    for _ in range(N_STEP):
        structure.begin_load(load)
        structure.finish(np.zeros(structure.matrices.seats.size))
    solve = (time.process_time() - start) / N_STEP
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(
        f"\n{name}: {load.size} unknowns, {1e3 * step:.1f} ms a step, "
        f"{1e3 * solve:.1f} ms of it the large solve (ratio {step / solve:.2f}), "
        f"factor {structure.memory_bytes / 1e6:.0f} MB, peak so far {peak:.0f} MB"
    )
    # The naive Schur complement of 92 wheels would make this ratio about 20. Three leaves room
    # for a busy machine on the coarse mesh, where the rails cost as much as the structure.
    assert step < 3.0 * solve + 2e-3
