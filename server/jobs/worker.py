"""Runs studies: the one place where the solver's steps are taken.

The queue's child process and ``trainbridge run`` call the same function.
"""

from __future__ import annotations

import platform
import resource
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Protocol

from server.jobs.gather import gather_job
from server.jobs.orders import Commands, Order, RunTask, Send
from server.jobs.progress import ProgressMeter, Report
from server.jobs.resuming import CancelledError, Resumable
from server.jobs.submission import stored_study
from server.store import (
    ModelStore,
    Place,
    RunReader,
    RunWriter,
    StoreError,
    attempt_place,
    claim,
    model_place,
    open_place,
    plain,
    run_place,
)
from solver import studies
from solver.arrays import Cache, IntVector, Matrix
from solver.results import RunPlan
from solver.simulation import Extremes, Simulation

__all__ = ["run_modes", "run_order", "run_study"]

_BLOCK_BYTES = 12 * 1024 * 1024
"""Memory of one block of slab histories; the filter takes about eight times as much. [B]"""
_DIGITS = 16
"""Of the digest of the solver's source: enough to tell two versions apart."""
_POINTS_PER_CHUNK = 64
"""Slab points that the store keeps together."""


def run_order(order: Order, send: Send, commands: Commands) -> None:
    """Computes a batch: its runs one after the other, or the model that runs share, or a gather."""
    store = open_place(order.store)
    if order.purpose == "gather":
        gather_job(store, order)
    elif order.purpose == "prepare":
        _prepare_model(store, order, send)
    else:
        for run in order.runs:
            _compute_run(store, order, run, send, commands)


def _prepare_model(store: Place, order: Order, send: Send) -> None:
    """Makes what the runs of a sweep share, once for all jobs that have the same model."""
    models = ModelStore(model_place(store, order.model))
    if models.complete():
        send(("log", "", {"text": "the prepared model is there already"}))
        return

    def report(stage: str) -> None:
        send(("log", "", {"text": f"preparing the model: {stage}"}))

    studies.prepare_model(stored_study(order.study), models, report)
    models.finish()


def _compute_run(store: Place, order: Order, run: RunTask, send: Send, commands: Commands) -> None:
    place = attempt_place(store, run.id, order.attempt)
    if not claim(place, order.key):
        # An outer engine began this attempt a second time, for it lost the first: a new attempt
        # goes on from its checkpoint.
        send(("lost", "", {}))
        return

    def report(state: Mapping[str, Any]) -> None:
        send(("progress", run.id, state))

    study = stored_study(order.study)
    try:
        if order.kind == "modes":
            summary = run_modes(study, place, report)
        else:
            meter = ProgressMeter(report, seconds=order.limits.progress_seconds)
            keeper = Resumable(store, order, run, send, commands)
            models = ModelStore(model_place(store, order.model)) if order.model else None
            summary = _integrate(study, run.index, meter, keeper, models)
    except CancelledError:
        send(("cancelled", run.id, {}))
        return
    send(("finished", run.id, {"verdicts": summary.get("verdicts", [])}))
    with suppress(StoreError):
        # What is left over can be cleaned away; the run is done.
        _remove_earlier_attempts(store, run.id, order.attempt)


def run_study(
    study: Any,
    run_index: int,
    place: Place | Path,
    report: Report,
    *,
    progress_seconds: float = 0.1,
) -> dict[str, Any]:
    """Integrates one run of a study in time and stores it, in one go.

    Args:
        study: The study.
        run_index: Place of the run in the sweep.
        place: Where the results go; it is emptied first.
        report: Takes progress.
        progress_seconds: Least time between two reports. [s]

    Returns:
        The stored summary: ``verdicts``, ``unjudged`` (why there is none), ``peaks`` (of the
        channels), ``filtered`` (names), ``cut_off``, ``comfort`` (of articulated trains),
        ``facts``, ``timings``, ``versions``.

    Raises:
        SolverError: The study cannot be computed.
    """
    meter = ProgressMeter(report, seconds=progress_seconds)
    return _integrate(study, run_index, meter, _Uninterrupted(place), None)


class _Keeper(Protocol):
    """Where an attempt's samples go, and what happens between steps."""

    def begin(self, simulation: Simulation) -> RunWriter: ...

    def after_step(self, simulation: Simulation) -> None: ...

    def end(self) -> None: ...


class _Uninterrupted:
    """An attempt from the first step to the last."""

    def __init__(self, place: Place | Path) -> None:
        self._place = place

    def begin(self, simulation: Simulation) -> RunWriter:
        return RunWriter(self._place, simulation.plan)

    def after_step(self, simulation: Simulation) -> None:
        del simulation

    def end(self) -> None:
        return


@dataclass(frozen=True, kw_only=True)
class _Outcome:
    """What a simulation leaves behind for the verdicts: not its factor, which is large."""

    plan: RunPlan
    extremes: Extremes
    facts: Mapping[str, object]


def _integrate(
    study: Any, run_index: int, meter: ProgressMeter, keeper: _Keeper, cache: Cache | None
) -> dict[str, Any]:
    """Prepares, takes every step, judges and stores; gives the stored summary."""
    clock = _Clock()
    simulation = studies.prepare(study, run_index, meter.stage, cache)
    clock.lap("preparation")
    writer = keeper.begin(simulation)
    meter.start(simulation.plan, max(0, writer.expected_step - 1))
    try:
        for sample in simulation.samples():
            if sample.step < writer.expected_step:
                continue  # The step of the checkpoint itself.
            writer.append(sample)
            meter.step(sample)
            keeper.after_step(simulation)
    except BaseException:
        writer.abort()
        raise
    keeper.end()
    clock.lap("steps")
    outcome = _Outcome(
        plan=simulation.plan,
        extremes=simulation.extremes,
        facts=simulation.plan.facts | simulation.contact_facts,
    )
    del simulation
    return _judge(study, outcome, writer, meter, clock)


def _judge(
    study: Any, outcome: _Outcome, writer: RunWriter, meter: ProgressMeter, clock: _Clock
) -> dict[str, Any]:
    """Judges the stored histories and stores the summary."""
    plan = outcome.plan
    meter.stage("storing the histories")
    writer.seal()
    clock.lap("storage")
    meter.stage("judging")
    reader = RunReader(writer.place)
    assessment = studies.assess(
        study, plan, outcome.extremes, _slab_blocks(reader), reader.slab_point
    )
    writer.add_filtered({_filtered(name): v for name, v in assessment.filtered.items()})
    writer.add_slab_peaks(assessment.slab_peaks)
    clock.lap("assessment")
    summary = _summary(
        facts=outcome.facts,
        timings=clock.timings(plan.n_step),
        verdicts=assessment.verdicts,
        unjudged=assessment.unjudged,
        cut_off=assessment.cut_off,
        peaks=assessment.peaks,
        filtered=[{"name": name, "channel": _filtered(name)} for name in assessment.filtered],
        **({} if assessment.comfort is None else {"comfort": assessment.comfort}),
    )
    writer.finish(summary)
    return summary


class _Clock:
    """How long each part of a run took, in this attempt."""

    def __init__(self) -> None:
        self._began = self._last = time.monotonic()
        self._laps: dict[str, float] = {}

    def lap(self, name: str) -> None:
        """Ends a part."""
        now = time.monotonic()
        self._laps[name] = now - self._last
        self._last = now

    def timings(self, n_step: int) -> dict[str, float]:
        """Seconds by part, in total, and of a step."""
        per_step = self._laps["steps"] / max(1, n_step)
        return {**self._laps, "per step": per_step, "total": self._last - self._began}


def run_modes(study: Any, place: Place | Path, report: Report) -> dict[str, Any]:
    """Computes the frequencies and shapes of a part of a study and stores them.

    Args:
        study: The study; its ``modes`` say of which part, and how many.
        place: Where the results go; it is emptied first.
        report: Takes progress.

    Returns:
        The stored summary: ``modes``, ``facts``, ``timings``, ``versions``.

    Raises:
        SolverError: The part cannot be computed.
    """
    meter = ProgressMeter(report, steps=1)
    clock = _Clock()
    run = studies.modal_run(study, meter.stage)
    clock.lap("steps")
    meter.stage("storing the shapes")
    writer = RunWriter(place, run.plan)
    for sample in run.samples():
        writer.append(sample)
    writer.seal()
    clock.lap("storage")
    meter.complete()
    timings = {"total": clock.timings(1)["total"]}
    summary = _summary(timings=timings, verdicts=(), peaks={}, **run.summary)
    writer.finish(summary)
    return summary


def _remove_earlier_attempts(store: Place, run: str, attempt: int) -> None:
    """Frees the disk of attempts that this one has replaced."""
    runs = run_place(store, run)
    for earlier in range(1, attempt):
        runs.remove(f"{earlier:03d}")


def _filtered(point: str) -> str:
    """Name of a named point's filtered history: its channel's, and what was done to it."""
    return f"{point}/acceleration (filtered)"


def _slab_blocks(reader: RunReader) -> Callable[[], Iterable[tuple[IntVector, Matrix]]]:
    chunks = _BLOCK_BYTES // (8 * reader.plan.n_sample * _POINTS_PER_CHUNK)
    return lambda: reader.slab_blocks(_POINTS_PER_CHUNK * max(1, chunks))


def _summary(**parts: Any) -> dict[str, Any]:
    timings = parts.pop("timings") | {"memory": _peak_memory()}
    return plain({**parts, "timings": timings, "versions": _versions()})


def _peak_memory() -> int:
    """Largest resident memory of this process so far. [B]"""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


def _versions() -> dict[str, str]:
    found = {
        "python": platform.python_version(),
        "machine": platform.machine(),
        "solver source": studies.source_digest()[:_DIGITS],
    }
    for name in ("trainbridge", "numpy", "scipy", "zarr", "pypardiso", "mkl"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
