"""Runs side by side: the inputs in which they differ, and what came out against the first one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from server.jobs.submission import stored_study
from server.reports.inputs import Difference, differences
from server.store import JobRecord, RunReader, RunRecord
from solver.results import ChannelSpec
from solver.studies import Study
from solver.studies.study import Sweep
from solver.units import Unit, Units

__all__ = ["ComparedRun", "Comparison", "Outcome", "compare"]

_WORDS = {"least": "least", "greatest": "greatest"}


@dataclass(frozen=True, kw_only=True)
class ComparedRun:
    """One run of a comparison.

    Attributes:
        job: Its job.
        record: Its row.
        reader: Its results; None where it has come to no step.
        summary: What it found; None before its end.
    """

    job: JobRecord
    record: RunRecord
    reader: RunReader | None
    summary: Mapping[str, Any] | None

    @property
    def study(self) -> Study:
        """The study at this run's point of the sweep: its own speed alone."""
        study = stored_study(self.job.study)
        speed = self.record.parameters.get("speed")
        return study if speed is None else replace(study, sweep=Sweep(speeds=(speed,)))

    @property
    def channels(self) -> Sequence[ChannelSpec]:
        """Its histories."""
        if self.reader is None or self.reader.plan.modal:
            return ()
        return self.reader.plan.channels


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """One result of all runs.

    Attributes:
        name: In words, unique.
        group: ``verdict``, ``comfort``, ``deck``, ``contact``, ``vehicle``, ``modes`` or ``cost``.
        unit: None where it has none.
        values: Of each run, SI; None where a run has none.
        remarks: Of each run, for example whether a limit is exceeded.
    """

    name: str
    group: str
    unit: Unit | None
    values: tuple[float | None, ...]
    remarks: tuple[str, ...]

    @property
    def changes(self) -> tuple[float | None, ...]:
        """Of each run, relative to the first; None where there is nothing to divide by. [1]

        Of two values of one sign the change of their size: a deflection of -3 mm is half as much
        again as one of -2 mm.
        """
        base = self.values[0]
        return tuple(None if value is None else _change(value, base) for value in self.values)


def _change(value: float, base: float | None) -> float | None:
    if not base:
        return None
    ratio = value / base
    return ratio - 1.0 if ratio >= 0.0 else (value - base) / abs(base)


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """What differs and what came out.

    Attributes:
        inputs: Those that are not the same in all runs.
        outcomes: Results that at least one run has.
        channels: Histories that every run with histories has.
        remarks: What to know before comparing.
    """

    inputs: list[Difference]
    outcomes: list[Outcome]
    channels: list[ChannelSpec]
    remarks: list[str]


def compare(runs: Sequence[ComparedRun]) -> Comparison:
    """Puts runs side by side; the first one is the baseline."""
    return Comparison(
        inputs=differences([run.study for run in runs]),
        outcomes=_outcomes(runs),
        channels=_common_channels(runs),
        remarks=_remarks(runs),
    )


def _remarks(runs: Sequence[ComparedRun]) -> list[str]:
    found: list[str] = []
    if len({run.job.kind for run in runs}) > 1:
        found.append(
            "Crossings and modal analyses stand side by side: they have few results in common."
        )
    if len({run.study.viaduct.type for run in runs}) > 1:
        found.append(
            "The structures are of different kinds: equal names of places need not mean the same "
            "point."
        )
    unfinished = sum(run.summary is None for run in runs)
    if unfinished:
        whose = "One run is" if unfinished == 1 else f"{unfinished} runs are"
        found.append(f"{whose} not done: what {'it' if unfinished == 1 else 'they'} found is left "
                     "empty.")  # fmt: skip
    levels = {run.study.mesh_level for run in runs if run.study.viaduct.type != "beam"}
    if len(levels) > 1:
        found.append("The meshes differ: part of a change may be their error.")
    return found


def _common_channels(runs: Sequence[ComparedRun]) -> list[ChannelSpec]:
    """Histories of the baseline that every other run with histories has too."""
    known = [run.channels for run in runs if run.channels]
    if not known:
        return []
    names = set.intersection(*({spec.name for spec in specs} for specs in known))
    return [spec for spec in known[0] if spec.name in names]


Found = tuple[Unit | None, str, float | None, str]
"""Unit, group, value, remark."""


def _outcomes(runs: Sequence[ComparedRun]) -> list[Outcome]:
    found = [dict(_found(run)) for run in runs]
    names = list(dict.fromkeys(name for results in found for name in results))
    outcomes: list[Outcome] = []
    for name in names:
        items = [results.get(name) for results in found]
        unit, group = next((item[0], item[1]) for item in items if item is not None)
        outcomes.append(
            Outcome(
                name=name,
                group=group,
                unit=unit,
                values=tuple(None if item is None else item[2] for item in items),
                remarks=tuple("" if item is None else item[3] for item in items),
            )
        )
    return outcomes


def _found(run: ComparedRun) -> list[tuple[str, Found]]:
    """Every result of a run by its name, in the order of a page."""
    summary = run.summary
    if summary is None:
        return []
    return [
        *_verdicts(summary),
        *_comfort(summary),
        *_peaks(run, summary),
        *_modes(summary),
        *_cost(summary),
    ]


def _verdicts(summary: Mapping[str, Any]) -> list[tuple[str, Found]]:
    found: list[tuple[str, Found]] = []
    for verdict in summary.get("verdicts") or ():
        unit = Unit(str(verdict["unit"]))
        limit = f"{verdict['limit']:g}"
        side = f"exceeds {limit}" if verdict["exceeds"] else f"within {limit}"
        name = str(verdict["rule"])
        found += [
            (name, (unit, "verdict", float(verdict["value"]), side)),
            (f"{name}, raw", (unit, "verdict", float(verdict["raw"]["value"]), "informative")),
        ]
    return found


def _comfort(summary: Mapping[str, Any]) -> list[tuple[str, Found]]:
    worst = (summary.get("comfort") or {}).get("worst")
    if not worst:
        return []
    remark = f"{worst.get('level') or 'beyond every level'}, {worst['name']}"
    value: Found = (Units.acceleration, "comfort", float(worst["peak"]), remark)
    return [("carbody acceleration, worst car", value)]


def _peaks(run: ComparedRun, summary: Mapping[str, Any]) -> list[tuple[str, Found]]:
    """Least and greatest value of each history."""
    specs = {spec.name: spec for spec in run.channels}
    found: list[tuple[str, Found]] = []
    for name, peak in (summary.get("peaks") or {}).items():
        spec = specs.get(name)
        if spec is None:
            continue
        group = "contact" if name.endswith("/contact force") else spec.group
        for which, words in _WORDS.items():
            remark = f"t = {peak[f'time_of_{which}']:.3f} s"
            title = f"{name.replace('/', ', ')}, {words}"
            found.append((title, (spec.unit, group, float(peak[which]), remark)))
    return found


def _modes(summary: Mapping[str, Any]) -> list[tuple[str, Found]]:
    return [
        (
            f"mode {mode['number']}",
            (Units.frequency, "modes", float(mode["frequency"]), str(mode["name"])),
        )
        for mode in summary.get("modes") or ()
    ]


def _cost(summary: Mapping[str, Any]) -> list[tuple[str, Found]]:
    facts = summary.get("facts") or {}
    parts = [facts.get(f"unknowns_{part}", 0) for part in ("structure", "rails", "train")]
    unknowns = float(facts.get("unknowns", sum(parts)))
    seconds = (summary.get("timings") or {}).get("total")
    found: list[tuple[str, Found]] = [("unknowns", (None, "cost", unknowns, ""))]
    if seconds is not None:
        found.append(("computing time", (Units.time, "cost", float(seconds), "")))
    return found
