"""What a report is made from: a job, its runs, the study, read once and then left alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from server.jobs.gather import worst_verdicts
from server.jobs.submission import stored_study
from server.plots import MidSpanPeak, mid_span_peak
from server.store import JobRecord, Place, RunReader, RunRecord, attempt_place
from solver.studies import Study

__all__ = ["Material", "NothingToReportError", "ReportHead", "RunMaterial"]


class NothingToReportError(Exception):
    """No run of the job has come to its end."""


@dataclass(frozen=True, kw_only=True)
class ReportHead:
    """What people write at the head of a report.

    Attributes:
        project: The project.
        author: Who answers for it.
        date: Of the report, as it shall be printed.
        remark: Anything else.
    """

    project: str
    author: str
    date: str
    remark: str


@dataclass(frozen=True, kw_only=True)
class RunMaterial:
    """A run that is done.

    Attributes:
        record: Its row.
        reader: Its results.
        summary: What it found.
    """

    record: RunRecord
    reader: RunReader
    summary: Mapping[str, Any]

    @property
    def speed(self) -> float | None:
        """Of the train; None where nothing moves. [m/s]"""
        return self.record.parameters.get("speed")

    @property
    def facts(self) -> Mapping[str, Any]:
        """Plain facts of the run."""
        return self.summary.get("facts") or {}

    @property
    def verdicts(self) -> Sequence[Mapping[str, Any]]:
        """Its verdicts."""
        return self.summary.get("verdicts") or ()

    @property
    def peaks(self) -> Mapping[str, Mapping[str, float]]:
        """Extremes by channel, SI."""
        return self.summary.get("peaks") or {}

    @property
    def greatest_displacement(self) -> MidSpanPeak | None:
        """At the middle of the spans that decide; None where no such point is recorded. [m]"""
        return mid_span_peak(self.summary, "displacement")


@dataclass(frozen=True, kw_only=True)
class Material:
    """Everything of one job.

    Attributes:
        job: Its row.
        study: As it was submitted.
        runs: Those that are done, in the order of the sweep.
        n_run: All runs of the job.
        head: What people wrote.
        version: Of this program.
    """

    job: JobRecord
    study: Study
    runs: tuple[RunMaterial, ...]
    n_run: int
    head: ReportHead
    version: str

    @classmethod
    def of(
        cls,
        job: JobRecord,
        records: Sequence[RunRecord],
        store: Place,
        head: ReportHead,
        version: str,
    ) -> Material:
        """Reads the summaries of a job's runs.

        Raises:
            NothingToReportError: None is done.
        """
        runs: list[RunMaterial] = []
        for record in records:
            if record.state != "done":
                continue
            reader = RunReader(attempt_place(store, record.id, record.attempt))
            summary = reader.summary
            if summary is not None:
                runs.append(RunMaterial(record=record, reader=reader, summary=summary))
        if not runs:
            raise NothingToReportError(f"The job is {job.state} and none of its runs is done.")
        return cls(
            job=job,
            study=stored_study(job.study),
            runs=tuple(runs),
            n_run=len(records),
            head=head,
            version=version,
        )

    @cached_property
    def verdicts(self) -> list[dict[str, Any]]:
        """Of each rule the worst verdict of all runs, with its ``run``."""
        return worst_verdicts({"run": run.record.id, "verdicts": run.verdicts} for run in self.runs)

    @cached_property
    def deciding(self) -> RunMaterial:
        """The run of the first rule's worst verdict; without verdicts the last one."""
        named = self.verdicts[0]["run"] if self.verdicts else self.runs[-1].record.id
        return next(run for run in self.runs if run.record.id == named)

    @property
    def modal(self) -> bool:
        """Whether the job looked for modes."""
        return self.job.kind == "modes"
