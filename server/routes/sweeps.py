"""What the runs of a job found, against their speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from server.jobs.states import ENDED, State
from server.jobs.submission import stored_study
from server.plots import Sweep, SweepPoint
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
    peaks: Mapping[str, Mapping[str, float]] = summary.get("peaks", {})
    spans = _judged_spans(verdict)
    raw = _greatest(peaks, "/acceleration", spans)
    return SweepPoint(
        run=run.id,
        speed=_speed(run),
        acceleration=raw if verdict is None else float(verdict["value"]),
        displacement=_greatest(peaks, "/displacement", spans),
    )


def _judged_spans(verdict: Mapping[str, Any] | None) -> tuple[str, ...]:
    """Beginnings of the names of points that count: of all spans where nothing is judged."""
    if verdict is None:
        return ("mid-span ",)
    return tuple(f"mid-span {span['number']}" for span in verdict["spans"] if span["judged"])


def _greatest(
    peaks: Mapping[str, Mapping[str, float]], quantity: str, spans: tuple[str, ...]
) -> float | None:
    sizes = [
        max(-peak["least"], peak["greatest"])
        for name, peak in peaks.items()
        if name.endswith(quantity) and name.startswith(spans)
    ]
    return max(sizes, default=None)


def _first_frequency(study: Study, summaries: Sequence[Mapping[str, Any]]) -> tuple[float, str]:
    """Of the span that decides, and where it is from: the modes of a run, else a closed form."""
    for summary in summaries:
        known: Sequence[float] = summary.get("facts", {}).get("member_frequencies") or ()
        if known:
            return float(known[0]), "modes of the viaduct"
    estimate = first_frequency(study)
    return estimate.frequency, estimate.origin
