"""The gather: what all runs of a job gave, in one document, read from the store."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from server.jobs.orders import Order, RunTask
from server.jobs.states import State
from server.jobs.submission import stored_study
from server.store import Place, RunReader, job_place, plain, run_place, write_document
from solver import studies

__all__ = ["SUMMARY", "gather_job", "worst_verdicts"]

SUMMARY = "summary.json"
"""Name of the document in the job's place."""


def gather_job(store: Place, order: Order) -> None:
    """Reads the summaries of a job's finished runs and stores what they say together."""
    parameters = studies.runs_of(stored_study(order.study))
    runs = [_gathered(store, run, parameters[run.index]) for run in order.runs]
    done = [run for run in runs if run["done"]]
    document = {"runs": runs, "verdicts": worst_verdicts(done), "judged": len(done)}
    write_document(job_place(store, order.job), SUMMARY, plain(document))


def worst_verdicts(runs: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Of each rule the verdict that is furthest beyond its limit, or nearest to it.

    Args:
        runs: With ``run`` (its id) and ``verdicts``.
    """
    worst: dict[str, dict[str, Any]] = {}
    for run in runs:
        for verdict in run["verdicts"] or ():
            rule = str(verdict.get("rule"))
            if rule not in worst or _severity(verdict) > _severity(worst[rule]):
                worst[rule] = {**verdict, "run": run["run"]}
    return list(worst.values())


def _gathered(store: Place, run: RunTask, parameters: Mapping[str, float]) -> dict[str, Any]:
    """One run's share; ``done`` is whether it has results.

    A run that was cancelled just as it ended may have a complete attempt: its state decides.
    """
    summary = _newest_summary(run_place(store, run.id)) if run.state == State.DONE else None
    return {
        "run": run.id,
        "index": run.index,
        "parameters": parameters,
        "state": run.state,
        "done": summary is not None,
        "verdicts": summary["verdicts"] if summary else [],
        "peaks": summary["peaks"] if summary else {},
    }


def _newest_summary(place: Place) -> dict[str, Any] | None:
    """Of the newest attempt that is complete."""
    for attempt in sorted(filter(str.isdigit, place.names()), reverse=True):
        reader = RunReader(place.child(attempt))
        if reader.done:
            return reader.summary
    return None


def _severity(verdict: Mapping[str, Any]) -> tuple[bool, float]:
    limit = abs(float(verdict.get("limit") or 0.0)) or 1.0
    return bool(verdict.get("exceeds")), abs(float(verdict.get("value") or 0.0)) / limit
