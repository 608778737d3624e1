"""What the runs of a job found, against their speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from server.jobs.states import ENDED, State
from server.jobs.submission import stored_study
from server.plots import Sweep, SweepPoint, mid_span_peak
from server.routes.service import Service
from server.store import JobRecord, RunReader, RunRecord, attempt_place
from solver.studies import Study
from solver.studies.resonance import first_frequency, resonance_speeds

__all__ = ["read_sweep"]

_RULE = "deck acceleration"


def read_sweep(service: Service, job: JobRecord) -> Sweep:
    """A job's runs as far as they have ended; their summaries alone are read."""
    runs = service.database.runs_of([job.id])[job.id]
    done = [run for run in runs if run.state == State.DONE]
    summaries = [(run, summary) for run in done if (summary := _summary(service, run))]
    verdicts = [verdict for _, summary in summaries if (verdict := _verdict(summary))]
    study = stored_study(job.study)
    frequency, origin = _first_frequency(study, [summary for _, summary in summaries])
    # Judged and unjudged values are not comparable; all runs of a job have the same bridge.
    words = f"below {verdicts[0]['cut_off']:.3g} Hz" if verdicts else "as computed"
    return Sweep(
        points=tuple(_point(run, summary) for run, summary in summaries),
        planned=tuple(_speed(run) for run in runs),
        open=sum(run.state not in ENDED for run in runs),
        limit=float(verdicts[0]["limit"]) if verdicts else None,
        quantity=words,
        frequency=frequency,
        origin=origin,
        resonances=tuple(resonance_speeds(study, frequency)),
    )


def _summary(service: Service, run: RunRecord) -> Mapping[str, Any] | None:
    return RunReader(attempt_place(service.store, run.id, run.attempt)).summary


def _speed(run: RunRecord) -> float:
    return float(run.parameters.get("speed", 0.0))


def _verdict(summary: Mapping[str, Any]) -> Mapping[str, Any] | None:
    verdicts: Sequence[Mapping[str, Any]] = summary.get("verdicts", ())
    return next((verdict for verdict in verdicts if verdict["rule"] == _RULE), None)


def _point(run: RunRecord, summary: Mapping[str, Any]) -> SweepPoint:
    verdict = _verdict(summary)
    raw, moved = (mid_span_peak(summary, what) for what in ("acceleration", "displacement"))
    at_mid_span = None if raw is None else raw.value
    return SweepPoint(
        run=run.id,
        speed=_speed(run),
        acceleration=at_mid_span if verdict is None else float(verdict["value"]),
        displacement=None if moved is None else moved.value,
    )


def _first_frequency(study: Study, summaries: Sequence[Mapping[str, Any]]) -> tuple[float, str]:
    """Of the span that decides, and where it is from: the modes of a run, else a closed form."""
    for summary in summaries:
        known: Sequence[float] = summary.get("facts", {}).get("member_frequencies") or ()
        if known:
            return float(known[0]), "modes of the viaduct"
    estimate = first_frequency(study)
    return estimate.frequency, estimate.origin
