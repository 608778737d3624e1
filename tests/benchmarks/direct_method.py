"""What a step of the direct method costs: ``python -m tests.benchmarks.direct_method``.

Ratios and exponents of one process on one core: a step against the large solves and products that
it cannot do without, a Newton iteration against a linear step, cost against unknowns and wheels.
Every size runs in a process of its own, so that its peak memory is its own.
"""

from __future__ import annotations

import json
import os
import re
import resource
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402 (the environment comes first)

from solver.contact.laws import ContactLaw, NonlinearHertz, RigidContact  # noqa: E402
from solver.factorisation.blocks import FirstBlock  # noqa: E402
from solver.integrators.hht import HHT  # noqa: E402
from solver.irregularities.harmonic import HarmonicIrregularity  # noqa: E402
from solver.methods import DirectMethod, PrescribedSpeed, Problem, Settings  # noqa: E402
from solver.methods.vehicles import sprung_masses  # noqa: E402
from solver.models.solid_beam import SolidBeams, solid_beams  # noqa: E402

SIZES = ((40, 8, 8), (80, 10, 10), (120, 12, 12), (140, 16, 18), (160, 22, 22))
"""Elements of one span: 1e4 to 2.5e5 unknowns."""
WHEELS = (1, 4, 12, 36, 92)
FULL_SIZE = (80, 10, 10)
"""Elements of each of the two spans of section 5.3.2."""
WAVES = HarmonicIrregularity(amplitude=2e-3, wavelength=1.6)
"""Throws the wheels off the rail and back again all the time."""
LAWS: dict[str, ContactLaw] = {
    "rigid": RigidContact(),
    "nonlinear": NonlinearHertz(coefficient=7.958e10, reference_force=294300.0),
}


@dataclass(frozen=True, kw_only=True)
class Cost:
    """Processor times of one size.

    Attributes:
        unknowns: Free freedoms of structure and vehicle.
        wheels: Number of wheels.
        law: Contact law.
        setup: Static start and factorisation. [s]
        step: [s]
        large: One forward and one backward pass. [s]
        products: The two products with the mass matrix. [s]
        iterations: Newton iterations or contact searches of a step, mean.
        status_changes: Contacts lost or found in these steps.
        peak_memory: Of the process. [B]
    """

    unknowns: int
    wheels: int
    law: str
    setup: float
    step: float
    large: float
    products: float
    iterations: float
    status_changes: int
    peak_memory: int


def measure(
    elements: tuple[int, int, int], n_span: int, n_wheel: int, law: str, n_step: int = 40
) -> Cost:
    """Runs ``n_step`` steps of sprung masses over solid beams of 20 m."""
    beams = SolidBeams(
        spans=(20.0,) * n_span, width=2.45, height=2.45, young_modulus=25e9, poisson_ratio=0.2,
        mass_per_length=30e3, elements=elements,
    )  # fmt: skip
    spacing = 20.0 if n_wheel <= 4 else 0.4
    bridge = solid_beams(beams, before=spacing * n_wheel + 1.0, after=60.0)
    places = 10.0 - spacing * np.arange(n_wheel)
    vehicle = sprung_masses(places, mass=30e3, stiffness=156.55e6)
    problem = Problem(
        structure=bridge.structure, vehicle=vehicle.subsystem, wheels=vehicle.wheels,
        path=bridge.path, law=LAWS[law], drive=PrescribedSpeed(speed=115.0), irregularity=WAVES,
    )  # fmt: skip
    before = time.process_time()
    method = DirectMethod(problem, Settings(method=HHT(-0.1, 1e-3), n_step=n_step + 5))
    setup = time.process_time() - before
    states = method.states()
    for _ in range(6):
        next(states)
    before, iterations = time.process_time(), 0
    for state in states:
        iterations += state.iterations
    step = (time.process_time() - before) / n_step
    return Cost(
        unknowns=method.stacked.free.size, wheels=n_wheel, law=law, setup=setup, step=step,
        large=_large(method), products=_products(method), iterations=iterations / n_step,
        status_changes=method.state.status_changes,
        peak_memory=_peak_memory(),
    )  # fmt: skip


def _large(method: DirectMethod, repeats: int = 10) -> float:
    """Processor time of one forward and one backward pass over the factor."""
    block: FirstBlock = method.first_block
    load = np.random.default_rng(0).normal(size=block.n_dof)
    before = time.process_time()
    for _ in range(repeats):
        block.forward(load)
        block.backward(block.free)
    return (time.process_time() - before) / repeats


def _products(method: DirectMethod, repeats: int = 10) -> float:
    """Processor time of the two products with M that the histories and the imbalance need."""
    mass = method.stacked.mass_ff
    vector = np.random.default_rng(0).normal(size=mass.shape[0])
    before = time.process_time()
    for _ in range(2 * repeats):
        mass @ vector
    return (time.process_time() - before) / repeats


def _peak_memory() -> int:
    """Greatest resident memory of this process. [B]

    Linux's ``ru_maxrss`` starts from that of the process which started this one; VmHWM does not.
    """
    status = Path("/proc/self/status")
    if status.exists():
        found = re.search(r"VmHWM:\s+(\d+) kB", status.read_text(encoding="ascii"))
        if found:
            return 1024 * int(found.group(1))
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def in_own_process(elements: tuple[int, int, int], n_span: int, n_wheel: int, law: str) -> Cost:
    """``measure`` in a fresh process."""
    order = json.dumps([elements, n_span, n_wheel, law])
    done = subprocess.run(
        [sys.executable, "-m", "tests.benchmarks.direct_method", order],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return Cost(**json.loads(done.stdout.splitlines()[-1]))


def exponent(sizes: list[float], costs: list[float]) -> float:
    """Slope of log cost against log size."""
    return float(np.polyfit(np.log(sizes), np.log(costs), 1)[0])


def iteration_share(linear: Cost, nonlinear: Cost) -> float:
    """Cost of one more iteration over that of a linear step.

    Both are told in what a step cannot do without, measured in the same process just then: two
    processes of a machine that others use are not equally fast.
    """
    more = nonlinear.iterations - linear.iterations
    one, other = (cost.step / (cost.large + cost.products) for cost in (linear, nonlinear))
    return max(0.0, other - one) / more / one


def _row(cost: Cost) -> str:
    needed = cost.large + cost.products
    return (
        f"| {cost.unknowns:,} | {cost.wheels} | {cost.law} | {1e3 * cost.step:.1f} | "
        f"{1.0 / cost.step:.0f} | {cost.step / needed:.2f} | {cost.iterations:.2f} | "
        f"{cost.setup:.1f} | {cost.peak_memory / 1e9:.2f} |"
    )


def main() -> None:
    """Prints the tables as Markdown."""
    print("| unknowns | wheels | contact | step [ms] | steps/s | step / (large solve + products) "
          "| searches a step | set-up [s] | peak memory [GB] |")  # fmt: skip
    print("|---|---|---|---|---|---|---|---|---|")
    full = [in_own_process(FULL_SIZE, 2, 4, law) for law in LAWS]
    by_size = [in_own_process(elements, 1, 4, "rigid") for elements in SIZES]
    by_wheels = [in_own_process(FULL_SIZE, 1, count, "nonlinear") for count in WHEELS]
    for cost in (*full, *by_size, *by_wheels):
        print(_row(cost))
    print(f"\nA Newton iteration costs {iteration_share(*full):.3f} of a linear step, with "
          f"{full[1].status_changes} changes of contact in 45 steps.")  # fmt: skip
    unknowns = [float(cost.unknowns) for cost in by_size]
    of_step = exponent(unknowns, [cost.step for cost in by_size])
    of_memory = exponent(unknowns, [float(cost.peak_memory) for cost in by_size])
    print(f"Step ~ unknowns^{of_step:.2f}; memory ~ unknowns^{of_memory:.2f}.")
    wheels = [float(cost.wheels) for cost in by_wheels]
    small = [cost.step - cost.large - cost.products for cost in by_wheels]
    print(f"Step less its large solve and products ~ wheels^{exponent(wheels, small):.2f}.")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(json.dumps(asdict(measure(*json.loads(sys.argv[1])))))
    else:
        main()
