"""Runs studies: the one place where the solver's steps are taken.

The queue's child process and ``trainbridge run`` call the same function.
"""

from __future__ import annotations

import platform
import resource
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from server.jobs.progress import ProgressMeter, Report
from server.store import RunReader, RunWriter, plain, write_summary
from solver import studies
from solver.arrays import IntVector, Matrix

__all__ = ["RunTask", "Send", "Task", "run_modes", "run_study", "run_task"]

_BLOCK_BYTES = 12 * 1024 * 1024
"""Memory of one block of slab histories; the filter takes about eight times as much. [B]"""
_POINTS_PER_CHUNK = 64
"""Slab points that the store keeps together."""

Send = Callable[[tuple[Any, ...]], None]
"""Takes a message of a batch: ``("progress", run, report)`` or ``("finished", run, summary)``."""


@dataclass(frozen=True, kw_only=True)
class RunTask:
    """One run of a batch.

    Attributes:
        id: The run.
        index: Its place in the study's sweep.
        folder: Where its results go.
    """

    id: str
    index: int
    folder: Path


@dataclass(frozen=True, kw_only=True)
class Task:
    """What one batch computes.

    Attributes:
        kind: ``crossing`` or ``modes``.
        study: The study.
        runs: Its runs in this batch.
        progress_seconds: Least time between two reports. [s]
    """

    kind: str
    study: Any
    runs: tuple[RunTask, ...]
    progress_seconds: float = 0.1


def run_task(task: Task, send: Send) -> None:
    """Computes every run of a batch, one after the other."""
    compute = run_modes if task.kind == "modes" else run_study
    for run in task.runs:

        def report(state: Mapping[str, Any], run: RunTask = run) -> None:
            send(("progress", run.id, state))

        summary = compute(
            task.study, run.index, run.folder, report, progress_seconds=task.progress_seconds
        )
        send(("finished", run.id, summary))


def run_study(
    study: Any,
    run_index: int,
    folder: Path,
    report: Report,
    *,
    progress_seconds: float = 0.1,
) -> dict[str, Any]:
    """Integrates one run of a study in time and stores it.

    Args:
        study: The study.
        run_index: Place of the run in the sweep.
        folder: Where the results go; it is emptied first.
        report: Takes progress.
        progress_seconds: Least time between two reports. [s]

    Returns:
        The stored summary: ``verdicts``, ``unjudged`` (why there is none), ``peaks`` (of the
        channels), ``filtered`` (names), ``cut_off``, ``facts``, ``timings``, ``versions``.

    Raises:
        SolverError: The study cannot be computed.
    """
    meter = ProgressMeter(report, seconds=progress_seconds)
    started = time.monotonic()
    simulation = studies.prepare(study, run_index, meter.stage)
    plan = simulation.plan
    prepared = time.monotonic()
    writer = RunWriter(folder, plan)
    meter.start(plan)
    try:
        for sample in simulation.samples():
            writer.append(sample)
            meter.step(sample)
    except BaseException:
        writer.abort()
        raise
    extremes = simulation.extremes
    facts = plan.facts | simulation.contact_facts
    del simulation  # its factor would stay beside the histories while they are judged
    computed = time.monotonic()
    meter.stage("storing the histories")
    writer.seal()
    stored = time.monotonic()
    meter.stage("judging")
    reader = RunReader(folder)
    assessment = studies.assess(study, plan, extremes, _slab_blocks(reader), reader.slab_point)
    writer.add_filtered({_filtered(name): v for name, v in assessment.filtered.items()})
    timings = {
        "preparation": prepared - started,
        "steps": computed - prepared,
        "per step": (computed - prepared) / max(1, plan.n_step),
        "storage": stored - computed,
        "assessment": time.monotonic() - stored,
        "total": time.monotonic() - started,
    }
    summary = _summary(
        facts=facts,
        timings=timings,
        verdicts=assessment.verdicts,
        unjudged=assessment.unjudged,
        cut_off=assessment.cut_off,
        peaks=assessment.peaks,
        filtered=[{"name": name, "channel": _filtered(name)} for name in assessment.filtered],
    )
    writer.finish(summary)
    return summary


def run_modes(
    study: Any,
    run_index: int,
    folder: Path,
    report: Report,
    *,
    progress_seconds: float = 0.1,
) -> dict[str, Any]:
    """Computes the frequencies and shapes of a study's structure and stores them.

    Returns:
        The stored summary: ``modes``, ``timings``, ``versions``.

    Raises:
        SolverError: The structure cannot be computed.
    """
    del run_index, progress_seconds
    meter = ProgressMeter(report, steps=1)
    started = time.monotonic()
    analysis = studies.modal_analysis(study, meter.stage)
    meter.complete()
    timings = {"total": time.monotonic() - started}
    summary = _summary(timings=timings, verdicts=(), peaks={}, **analysis)
    write_summary(folder, summary)
    return summary


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
    found = {"python": platform.python_version(), "machine": platform.machine()}
    for name in ("trainbridge", "numpy", "scipy", "zarr", "pypardiso", "mkl"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
