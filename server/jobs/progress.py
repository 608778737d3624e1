"""How far a run is: measured where it computes, summed for its job."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from solver.results import RunPlan, Sample

__all__ = ["ProgressMeter", "Report", "job_progress", "no_progress"]

Report = Callable[[Mapping[str, Any]], None]
"""Takes one progress report: plain JSON."""

_LEAST_REPORTS = 25
"""Reports of a run at least, however short it is: a bar that jumps from 0 to 1 says nothing."""
_CURVE_POINTS = 1000
"""Points of a live curve over a whole run."""
_RATE_WINDOW = 20
"""Reports over which the pace is taken."""


def no_progress(steps: int = 0, stage: str = "waiting") -> dict[str, Any]:
    """The progress of a run that has not begun."""
    return {
        "step": 0,
        "steps": steps,
        "fraction": 0.0,
        "stage": stage,
        "rate": None,
        "remaining": None,
        "simulated_time": None,
    }


class ProgressMeter:
    """Turns stages and samples into reports, at most one every ``seconds`` beyond the least.

    A report holds ``step``, ``steps``, ``fraction`` (step over steps), ``stage``, ``rate``
    [steps/s], ``remaining`` (low and high) [s], ``simulated_time`` [s], and ``points``: what a
    live curve gains, ``{"time": [...], "channels": {name: [...]}}``, SI.
    """

    def __init__(
        self,
        report: Report,
        *,
        seconds: float = 0.1,
        steps: int = 0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Reports to ``report``; ``steps`` is what is expected before the plan says so."""
        self._report = report
        self._seconds = seconds
        self._clock = clock
        self._state = no_progress(steps, "starting")
        self._marks: deque[tuple[float, int]] = deque(maxlen=_RATE_WINDOW)
        self._next_time = -math.inf
        self._next_step = 0
        self._live: tuple[tuple[str, int], ...] = ()
        self._live_stride = 1
        self._point_times: list[float] = []
        self._point_rows: list[list[float]] = []

    @property
    def state(self) -> dict[str, Any]:
        """The newest report, without points."""
        return dict(self._state)

    def stage(self, stage: str) -> None:
        """Reports a new stage at once."""
        self._state["stage"] = stage
        self._send()

    def start(self, plan: RunPlan, step: int = 0) -> None:
        """Begins the steps, after those that an earlier attempt has taken."""
        steps = max(1, plan.n_step)
        self._state |= {"step": step, "steps": plan.n_step, "fraction": step / steps}
        self._state["stage"] = "computing"
        self._live = _live_channels(plan)
        self._live_stride = max(1, plan.n_sample // _CURVE_POINTS)
        self._marks.append((self._clock(), step))
        self._send()

    def step(self, sample: Sample) -> None:
        """Counts a step; reports when it is time to."""
        if self._live and sample.step % self._live_stride == 0:
            self._point_times.append(sample.time)
            self._point_rows.append([float(sample.channels[column]) for _, column in self._live])
        now = self._clock()
        due = now >= self._next_time or sample.step >= self._next_step
        if due or sample.step == self._state["steps"]:
            self._count(sample, now)
            self._send()

    def complete(self) -> None:
        """Reports the end of work that takes no time steps."""
        self._state |= {"step": self._state["steps"], "fraction": 1.0}
        self._send()

    def _count(self, sample: Sample, now: float) -> None:
        steps = max(1, int(self._state["steps"]))
        self._marks.append((now, sample.step))
        low, high = _rates(self._marks)
        left = steps - sample.step
        self._state |= {
            "step": sample.step,
            "fraction": sample.step / steps,
            "simulated_time": sample.time,
            "rate": high,
            "remaining": None if not low or not high else [0.9 * left / high, 1.1 * left / low],
        }
        self._next_time = now + self._seconds
        self._next_step = sample.step + math.ceil(steps / _LEAST_REPORTS)

    def _send(self) -> None:
        report = dict(self._state)
        if self._point_times:
            columns = list(zip(*self._point_rows, strict=True))
            channels = {name: list(columns[i]) for i, (name, _) in enumerate(self._live)}
            report["points"] = {"time": self._point_times, "channels": channels}
            self._point_times, self._point_rows = [], []
        self._report(report)


def job_progress(runs: Iterable[Mapping[str, Any]], steps: int) -> dict[str, Any]:
    """Progress of a job: steps done by all runs over the steps of all.

    Args:
        runs: Progress of each run, empty where it has not begun.
        steps: Steps that the job was expected to take when it was submitted.
    """
    started = [run for run in runs if run]
    total = max(steps, sum(int(run["steps"]) for run in started))
    done = sum(int(run["step"]) for run in started)
    active = [run for run in started if run["step"] < run["steps"]] or started
    rates = [float(run["rate"]) for run in active if run["rate"]]
    rate = sum(rates) if rates else None
    left = total - done
    return {
        "step": done,
        "steps": total,
        "fraction": done / total if total else 0.0,
        "stage": active[0]["stage"] if active else "waiting",
        "rate": rate,
        "remaining": [0.8 * left / rate, 1.2 * left / rate] if rate else None,
        "simulated_time": active[0]["simulated_time"] if active else None,
    }


def _rates(marks: deque[tuple[float, int]]) -> tuple[float | None, float | None]:
    """Slowest and fastest pace: over the whole window and over its newer half. [steps/s]"""
    newest = marks[-1]
    rates = [
        (newest[1] - mark[1]) / (newest[0] - mark[0])
        for mark in (marks[0], marks[len(marks) // 2])
        if newest[0] > mark[0] and newest[1] > mark[1]
    ]
    return (min(rates), max(rates)) if rates else (None, None)


def _live_channels(plan: RunPlan) -> tuple[tuple[str, int], ...]:
    """The channels drawn while a run computes: those the plan names, else the first three."""
    names = [channel.name for channel in plan.channels]
    named = plan.facts.get("live_channels")
    chosen = [str(name) for name in named] if isinstance(named, (list, tuple)) else names[:3]  # pyright: ignore[reportUnknownVariableType, reportUnknownArgumentType]
    return tuple((name, names.index(name)) for name in chosen if name in names)
