"""The same crossing by the four methods of chapter 2, at several sizes.

Run with ``OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 python -m tests.benchmarks.methods`` (two minutes
or so): writes the tables into ``docs/methods.md`` and draws ``docs/methods.svg``. Every run is a
process of its own, so that its CPU time and its memory are its own; large meshes take few steps,
since the cost of a step is what is compared.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from solver.arrays import FloatArray
from solver.errors import SolverError
from solver.integrators.hht import HHT
from solver.methods.iterative import predict_convergence
from solver.methods.settings import Settings
from tests.benchmarks.methods_runs import (
    VARIANTS,
    Case,
    Result,
    Run,
    beam,
    cases,
    compare,
    error,
    run,
    solids,
    warm_up,
)

BEGIN, END = "<!-- tables: begin -->", "<!-- tables: end -->"

Text = Callable[[Run, Run], str]
"""What a cell says of a run, and of the direct method's on the same case."""


def _cell(result: Result, variant: str, text: Text) -> str:
    one = result.runs[variant]
    return "fails" if one.failure else text(one, result.runs["direct"])


def table(results: list[Result], title: str, text: Text, variants: list[str]) -> str:
    """A Markdown table: a row for each case, a column for each method."""
    lines = [
        f"**{title}**\n",
        "| | unknowns | " + " | ".join(variants) + " |",
        "|---|--:|" + "--:|" * len(variants),
    ]
    for result in results:
        cells = [_cell(result, variant, text) for variant in variants]
        lines.append(f"| {result.case.title} | {result.unknowns:,} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _step(one: Run, direct: Run) -> str:
    return f"{1e3 * one.step:.2f} ms" if one is direct else f"{one.step / direct.step:.2f}"


def tables(results: list[Result]) -> str:
    """All tables, in Markdown."""
    everyone = list(VARIANTS)
    others = everyone[1:]
    sweeping = [variant for variant in everyone if VARIANTS[variant][0] == "iterative"]
    large = [result for result in results if result.unknowns > 5000]
    return "\n\n".join(
        [
            table(results, "CPU time of a step, over that of the direct method", _step, everyone),
            table(results, "CPU time before the first step [s], the static start included",
                  lambda one, _: f"{one.set_up:.2f}", everyone),
            table(large, "Memory beyond the assembled problem [MB]",
                  lambda one, _: f"{one.memory / 1e6:.0f}", everyone),
            table(results, "Contact force: greatest difference to the direct method over the "
                  "greatest force", lambda one, d: f"{error(one, d, 'forces'):.0e}", others),
            table(results, "Mid-span deflection, likewise",
                  lambda one, d: f"{error(one, d, 'deflection'):.0e}", others),
            sweeps(results, sweeping),
            failures(results),
        ]
    )  # fmt: skip


def sweeps(results: list[Result], variants: list[str]) -> str:
    """Predicted spectral radius and the sweeps that were needed."""
    lines = [
        "**Spectral radius of a sweep, predicted before the run, and sweeps of a step**\n",
        "| | radius | " + " | ".join(variants) + " |",
        "|---|--:|" + "--:|" * len(variants),
    ]
    for result in results:
        cells = [_cell(result, v, lambda one, _: f"{one.iterations:.1f}") for v in variants]
        lines.append(f"| {result.case.title} | {result.radius:.2g} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def failures(results: list[Result]) -> str:
    """What the methods that failed said."""
    said = [
        f"- {result.case.title}, {variant}: {one.failure}"
        for result in results
        for variant, one in result.runs.items()
        if one.failure
    ]
    return "**Failures**\n\n" + "\n".join(said or ["- none"])


def radii(case: Case, steps: FloatArray) -> FloatArray:
    """Spectral radius at the start of a case, for other time steps."""
    problem, _ = case.build()
    return np.array(
        [
            predict_convergence(
                problem, Settings(method=HHT(-0.1, float(step)), n_step=1), np.zeros(1)
            ).radius
            for step in steps
        ]
    )


def penalty_errors(case: Case, factors: FloatArray, solution: str) -> FloatArray:
    """Error of the contact force by the penalty's factor; not a number where it breaks down."""
    problem, middle = case.build()
    reference = run(case, problem, middle, "direct", {})
    found = np.full(factors.size, np.nan)
    for index, factor in enumerate(factors):
        options = {"factor": float(factor), "solution": solution}
        try:
            ours = run(case, problem, middle, "penalty", options)
        except SolverError:
            continue
        found[index] = error(ours, reference, "forces")
    return found


def draw(results: list[Result], target: Path) -> None:
    """The plot: cost against size, error against penalty, radius against time step."""
    mpl.use("svg")
    mpl.rcParams["svg.hashsalt"] = "methods"
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(14, 4.5), layout="constrained")
    _draw_cost(axes[0], results)
    _draw_penalty(axes[1])
    _draw_radius(axes[2])
    figure.savefig(target, metadata={"Date": None})
    plt.close(figure)


def _draw_cost(axes: Axes, results: list[Result]) -> None:
    light = [r for r in results if r.case.wheels == 4 and not r.case.unsprung]
    for variant in VARIANTS:
        done = [r for r in light if not r.runs[variant].failure]
        cost = [1e3 * r.runs[variant].step for r in done]
        axes.loglog([r.unknowns for r in done], cost, "o-", label=variant)
    axes.set(title="Four sprung masses", xlabel="unknowns", ylabel="CPU time of a step [ms]")
    axes.set_ylim(top=3e4)
    axes.legend(fontsize="small", loc="upper left")


def _draw_penalty(axes: Axes) -> None:
    case = Case(mesh=partial(beam, 50), name="", wheels=4, unsprung=1800.0, n_step=60)
    factors = np.logspace(0, 9, 10)
    for solution, name in (("refactorise", "penalty"), ("update", "penalty, updated")):
        axes.loglog(factors, penalty_errors(case, factors, solution), "o-", label=name)
    axes.set(
        title="Penalty: beam, four wheels of 1800 kg",
        xlabel="penalty factor over the greatest stiffness at the contact",
        ylabel="error of the contact force",
    )
    axes.legend(fontsize="small")


def _draw_radius(axes: Axes) -> None:
    one, fine = partial(Case, name="", wheels=1), partial(solids, 100, 4, 6)
    curves = {
        "beam, sprung mass": one(mesh=partial(beam, 50)),
        "beam, wheel of 600 kg": one(mesh=partial(beam, 50), unsprung=600.0),
        "beam, wheel of 1800 kg": one(mesh=partial(beam, 50), unsprung=1800.0),
        "solids, sprung mass": one(mesh=fine),
        "solids, wheel of 1800 kg, linear Hertz": one(mesh=fine, unsprung=1800.0, hertz=1.2e9),
        "solids, wheel of 1800 kg": one(mesh=fine, unsprung=1800.0),
    }
    steps = np.logspace(-5, -2.5, 11)
    for name, case in curves.items():
        axes.loglog(1e3 * steps, radii(case, steps), label=name)
    axes.axhline(1.0, color="black", linewidth=0.8)
    axes.set(
        title="Gauss-Seidel: one wheel", xlabel="time step [ms]", ylabel="spectral radius",
        ylim=(1e-5, 1e7),
    )  # fmt: skip
    axes.legend(fontsize="small", loc="upper right")


def write(results: list[Result], page: Path) -> None:
    """Puts the tables between the page's markers."""
    text = page.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    page.write_text(f"{before}{BEGIN}\n\n{tables(results)}\n\n{END}{after}", encoding="utf-8")


def main(arguments: list[str] | None = None) -> None:
    """Runs everything and writes page and plot."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--docs", type=Path, default=Path("docs"), help="folder of methods.md")
    docs: Path = parser.parse_args(arguments).docs
    warm_up()
    results: list[Result] = []
    for case in cases():
        start = time.perf_counter()
        results.append(compare(case))
        print(f"{case.title}: {time.perf_counter() - start:.1f} s", flush=True)
    write(results, docs / "methods.md")
    draw(results, docs / "methods.svg")


if __name__ == "__main__":
    main()
