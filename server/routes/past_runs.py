"""How long runs of the past took, beside what the closed formula had said."""

from __future__ import annotations

import statistics
from dataclasses import dataclass, replace
from threading import Lock

from server.errors import Problem
from server.jobs.submission import stored_study
from server.store import (
    Database,
    JobFilter,
    JobRecord,
    Place,
    RunReader,
    RunRecord,
    StoreError,
    attempt_place,
)
from solver import studies
from solver.studies import Estimate, JobKind, SpanFrequency, Study

__all__ = ["FORMULA", "PastRuns", "Scaled", "seconds_of"]

FORMULA = "closed formula"
"""Basis of an estimate where nothing alike was computed yet."""
_JOBS = 20
"""Jobs that are looked at, the newest."""
_RUNS = 20
"""Runs of a job that are looked at: its first."""
_NEW_JOBS = 3
"""Jobs that are looked at for the first time in one answer, so that it comes within 50 ms."""
_KEPT = 4 * _JOBS
"""Jobs that are remembered, of either kind."""
_ALIKE = 2.0
"""Runs whose numbers of unknowns differ by less than this factor are alike."""


@dataclass(frozen=True, kw_only=True)
class Scaled:
    """An estimate that past runs have corrected.

    Attributes:
        estimate: The estimate.
        basis: What its time is from, in words.
    """

    estimate: Estimate
    basis: str


@dataclass(frozen=True)
class _Measured:
    """A job that is done: how much longer than estimated its runs took, and what they found."""

    unknowns: int
    runs: int
    ratio: float
    study: Study
    frequency: float | None
    """The first of the deciding span; None where none was sought. [Hz]"""


class PastRuns:
    """Remembers what each of the last jobs has shown; a job is read once.

    Args:
        database: Knows the last jobs.
        store: Knows what they found.
    """

    def __init__(self, database: Database, store: Place) -> None:
        self._database, self._store = database, store
        self._lock = Lock()
        self._known: dict[str, _Measured | None] = {}

    def scaled(self, kind: JobKind, estimate: Estimate) -> Scaled:
        """Scales an estimate's time by what runs alike took.

        Args:
            kind: What is to be computed.
            estimate: By closed formulas.
        """
        alike = [
            job
            for job in self._measured(kind)
            if 1.0 / _ALIKE < job.unknowns / max(1, estimate.unknowns) < _ALIKE
        ]
        if not alike:
            return Scaled(estimate=estimate, basis=FORMULA)
        ratio = statistics.median(job.ratio for job in alike)
        count = sum(job.runs for job in alike)
        runs = "1 past run" if count == 1 else f"{count} past runs"
        return Scaled(
            estimate=replace(estimate, seconds=estimate.seconds * ratio),
            basis=f"{runs} on this machine",
        )

    def first_frequency(self, study: Study) -> SpanFrequency | None:
        """What an earlier crossing of the same deck has found; None where there was none."""
        for job in self._measured("crossing"):
            if job.frequency is not None and _deck(job.study) == _deck(study):
                return studies.known_frequency(study, job.frequency)
        return None

    def _measured(self, kind: JobKind) -> list[_Measured]:
        """What the last jobs of a kind have shown, some of them looked at now."""
        # Not under the lock: while the database is away each would wait for all before it, too.
        jobs = self._database.jobs(JobFilter(states=("done",), kind=kind), limit=_JOBS)
        with self._lock:
            unread = [job for job in jobs if job.id not in self._known]
            for job in unread[:_NEW_JOBS]:
                self._known[job.id] = self._look_at(job, kind)
            for old in list(self._known)[:-_KEPT]:
                del self._known[old]
            found = [self._known.get(job.id) for job in jobs]
        return [item for item in found if item is not None]

    def _look_at(self, job: JobRecord, kind: JobKind) -> _Measured | None:
        """None where a job says nothing: no run was computed in one go, or it cannot be read."""
        try:
            study = stored_study(job.study)
        except Problem:
            return None
        estimate = studies.check(study, kind).estimate
        runs = [
            run for run in self._database.runs(job.id, limit=_RUNS) if seconds_of(run) is not None
        ]
        if estimate is None or not runs:
            return None
        taken = statistics.fmean(seconds_of(run) or 0.0 for run in runs)
        return _Measured(
            unknowns=estimate.unknowns,
            runs=len(runs),
            ratio=taken / (estimate.seconds / estimate.runs),
            study=study,
            frequency=self._found_frequency(runs[0]) if kind == "crossing" else None,
        )

    def _found_frequency(self, run: RunRecord) -> float | None:
        """The first of the deciding span's frequencies, as a run's summary has it. [Hz]"""
        try:
            summary = RunReader(attempt_place(self._store, run.id, run.attempt)).summary or {}
        except StoreError:
            return None
        found = summary.get("facts", {}).get("member_frequencies")
        return float(found[0]) if found else None


def _deck(study: Study) -> tuple[object, ...]:
    """What the frequencies of a deck depend on."""
    return study.viaduct, study.track, study.mesh_level


def seconds_of(run: RunRecord) -> float | None:
    """How long a run took, where one attempt did all of it. [s]"""
    if run.state != "done" or run.attempt != 1 or run.started is None or run.ended is None:
        return None
    return run.ended - run.started if run.ended > run.started else None
