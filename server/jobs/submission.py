"""From JSON to a checked submission: parse strictly, check the study, compare with the limits."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from threading import RLock
from typing import Any, cast, get_args

import psutil
from pydantic import TypeAdapter, ValidationError

from server.errors import Finding, Problem, pointer, shortened, validation_findings
from server.jobs.variants import errors_of_chosen_kinds, kinds_of
from server.settings import LARGEST_PRIORITY, Limits
from solver import studies
from solver.errors import InputError
from solver.studies import JobKind, Study

__all__ = [
    "KINDS",
    "READING_SOURCES",
    "Capacity",
    "Submission",
    "admit",
    "limit_findings",
    "read_study",
    "read_submission",
    "report_document",
    "stored_study",
]

KINDS: tuple[JobKind, ...] = get_args(JobKind)
"""What a job can compute."""

READING_SOURCES = RLock()
"""Held while pydantic learns of the study's fields: it parses our sources for what stands beside
them, and of two threads that parse at once Python 3.11 lets one fail (cpython 106905)."""
_EVERY_DIGIT = 17
"""So many digits tell any two floating-point numbers apart."""


@dataclass(frozen=True, kw_only=True)
class Submission:
    """A study and what to do with it.

    Attributes:
        kind: One of ``KINDS``.
        study: The study.
        path: Where the study stands in what was sent, for pointers.
        priority: Greater ones begin first.
    """

    kind: JobKind
    study: Study
    path: tuple[str, ...] = ("study",)
    priority: int = 0


def read_submission(body: Any) -> Submission:
    """A submission ``{"kind": ..., "priority": ..., "study": {...}}`` from parsed JSON.

    Raises:
        Problem: 422 with every finding.
    """
    if not isinstance(body, dict):
        raise _unusable([_finding((), body, "is not an object", 'Send {"study": {...}}.')])
    fields = cast(dict[str, Any], body)
    findings = [
        _finding((name,), fields[name], "is not a field here", "Remove it, or correct its name.")
        for name in fields
        if name not in ("kind", "priority", "study")
    ]
    kind = fields.get("kind", "crossing")
    if kind not in KINDS:
        findings.append(
            _finding(("kind",), kind, "is not a kind of job", f"Choose one of {', '.join(KINDS)}.")
        )
    priority = fields.get("priority", 0)
    if not _is_priority(priority):
        span = f"{-LARGEST_PRIORITY} to {LARGEST_PRIORITY}"
        findings.append(
            _finding(("priority",), priority, f"is no whole number of {span}", "Give such a one.")
        )
    if "study" not in fields:
        findings.append(_finding(("study",), "", "is missing", "Add the study."))
    study, more = _validated(fields.get("study", {}), ("study",))
    findings += more if "study" in fields else []
    if findings or study is None:
        raise _unusable(findings)
    return Submission(kind=kind, study=study, priority=priority)


def _is_priority(value: Any) -> bool:
    exact = isinstance(value, int) and not isinstance(value, bool)
    return exact and abs(value) <= LARGEST_PRIORITY


def read_study(body: Any, path: tuple[str, ...] = ()) -> Study:
    """A study from parsed JSON.

    Raises:
        Problem: 422 with every finding.
    """
    study, findings = _validated(body, path)
    if study is None:
        raise _unusable(findings)
    return study


def stored_study(document: Mapping[str, Any]) -> Study:
    """A study that was accepted before."""
    return read_study(document)


@dataclass(frozen=True, kw_only=True)
class Capacity:
    """What one study may take.

    Attributes:
        memory_bytes: Of a batch. [B]
        disk_bytes: Of all results. [B]
    """

    memory_bytes: float
    disk_bytes: float

    @classmethod
    def now(cls, limits: Limits, folder: Path | None, *, computes_here: bool = True) -> Capacity:
        """What there is at this moment.

        Args:
            limits: The shares of it that may be taken.
            folder: Where results are stored; None where that is no disk of this machine.
            computes_here: Whether batches take this machine's memory; others' is not known.
        """
        free = psutil.virtual_memory().available if computes_here else math.inf
        disk = math.inf if folder is None else _free(folder)
        return cls(
            memory_bytes=limits.memory_fraction * free,
            disk_bytes=limits.disk_fraction * disk,
        )


def _free(folder: Path) -> int:
    """Free disk where a folder is, or will be. [B]"""
    existing = next(item for item in (folder, *folder.absolute().parents) if item.exists())
    return shutil.disk_usage(existing).free


def admit(submission: Submission, limits: Limits, capacity: Capacity) -> Any:
    """Checks a study and what it takes, by closed formulas: nothing is allocated.

    Args:
        submission: The study and what to do with it.
        limits: What is accepted.
        capacity: What there is.

    Returns:
        The solver's report.

    Raises:
        Problem: 422 with everything that is wrong.
    """
    report = studies.check(submission.study, submission.kind)
    findings = [*_report_findings(report.errors, submission.path)]
    findings += limit_findings(report, limits, capacity, submission.path)
    if findings:
        raise _unusable(findings)
    return report


def limit_findings(
    report: Any, limits: Limits, capacity: Capacity, path: Sequence[str] = ()
) -> list[Finding]:
    """Where a study asks for more than this server accepts or there is."""
    estimate = report.estimate
    if estimate is None:
        return []
    rules: list[tuple[str, float, float, str, tuple[str, ...], str]] = [
        ("runs", estimate.runs, limits.runs_per_job, "", ("sweep", "speeds"), "Give fewer speeds."),
        (
            "time steps",
            estimate.steps,
            limits.steps_per_job,
            "",
            ("integration", "time_step"),
            "Choose a longer time step, fewer speeds or a shorter extent.",
        ),
        (
            "of memory",
            estimate.memory_bytes,
            capacity.memory_bytes,
            "GB",
            ("mesh_level",),
            "Choose a coarser mesh.",
        ),
        (
            "of disk",
            estimate.disk_bytes,
            capacity.disk_bytes,
            "GB",
            ("outputs", "frame_interval"),
            "Choose a longer frame interval or a coarser mesh, or free some disk.",
        ),
    ]
    findings: list[Finding] = []
    for name, value, limit, unit, place, remedy in rules:
        if not value <= limit:
            needed, allowed = _amounts(value, limit, unit)
            reason = f"needs {needed} {name}; the limit is {allowed}"
            findings.append(_finding((*path, *place), needed, reason, remedy))
    return findings


def report_document(
    report: Any, limits: Limits, capacity: Capacity, path: tuple[str, ...]
) -> dict[str, Any]:
    """A report as the API sends it, the server's limits among its errors."""
    beyond = limit_findings(report, limits, capacity, path)
    errors = [*_report_findings(report.errors, path), *beyond]
    return {
        "errors": errors,
        "warnings": _report_findings(report.warnings, path),
        "derived": report.derived,
        "estimate": report.estimate,
    }


def _amounts(value: float, limit: float, unit: str) -> tuple[str, str]:
    """A need and its limit in words, with as many digits as tell them apart."""
    scale, few = (1e9, 3) if unit else (1.0, 9)
    texts = ("", "")
    for digits in range(few, _EVERY_DIGIT + 1):
        needed, allowed = (f"{each / scale:.{digits}g} {unit}".rstrip() for each in (value, limit))
        texts = needed, allowed
        if needed != allowed:
            break
    return texts


def _report_findings(findings: Sequence[Any], path: Sequence[str]) -> list[Finding]:
    return [
        _finding((*path, *item.path), item.value, item.reason, item.remedy) for item in findings
    ]


def _finding(path: Sequence[str | int], value: Any, reason: str, remedy: str) -> Finding:
    return Finding(pointer=pointer(path), value=shortened(value), reason=reason, remedy=remedy)


def _unusable(findings: Sequence[Finding]) -> Problem:
    detail = "; ".join(f"{item.pointer or 'the body'} {item.reason}" for item in findings[:3])
    return Problem(422, "The study cannot be used", detail, errors=findings)


def _adapter() -> TypeAdapter[Study]:
    with READING_SOURCES:
        return _made_adapter()


@cache
def _made_adapter() -> TypeAdapter[Study]:
    return TypeAdapter(Study)


@cache
def _kinds() -> dict[str, str]:
    return kinds_of(_adapter().json_schema())


def _validated(body: Any, path: Sequence[str]) -> tuple[Study | None, list[Finding]]:
    # As JSON again: pydantic's strict mode then takes lists for tuples and whole numbers for
    # floats, and nothing else.
    text = json.dumps(body, allow_nan=False)
    try:
        return _adapter().validate_json(text, strict=True, extra="forbid"), []
    except ValidationError as error:
        errors = cast(Any, error.errors(include_url=False))
        meant = [*errors_of_chosen_kinds(errors, body, _kinds())]
        return None, validation_findings(meant, body, prefix=path)
    except InputError as error:
        at = (*path, *error.field.split("."))
        return None, [_finding(at, error.value, error.reason, error.remedy)]
