"""The sections of results: verdicts, comfort, speeds, modes, peaks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from server.plots.deciding import where
from server.reports.document import Block, Bullets, Facts, Paragraph, Section, Table
from server.reports.material import Material, RunMaterial
from server.reports.words import number, percent, speed, unit_text
from solver.results import ChannelSpec

__all__ = ["result_section", "speeds_section"]

_MOST_PEAKS = 24


def result_section(material: Material) -> Section:
    """What was found, the verdict first."""
    if material.modal:
        return Section(title="Natural modes", blocks=tuple(_modes(material.deciding)))
    blocks: list[Block] = []
    for verdict in material.verdicts:
        blocks += _verdict(verdict)
    for run in material.runs[:1]:
        if not material.verdicts and run.summary.get("unjudged"):
            blocks.append(Paragraph(text=str(run.summary["unjudged"]), tone="note"))
    blocks += _contact(material.deciding)
    blocks += _comfort(material.deciding)
    if not material.verdicts:
        blocks.append(_peaks(material.deciding))
    if len(material.runs) < material.n_run:
        blocks.append(
            Paragraph(
                heading="Not complete.",
                text=(
                    f"{len(material.runs)} of {material.n_run} runs are done; the others are not "
                    "part of this report."
                ),
                tone="bad",
            )
        )
    return Section(title="Result", blocks=tuple(blocks))


def _verdict(verdict: Mapping[str, Any]) -> list[Block]:
    unit = unit_text(str(verdict["unit"]))
    exceeds = bool(verdict["exceeds"])
    word = "Exceeds the limit" if exceeds else "Within the limit"
    scope = verdict["scope"]
    place = verdict["place"]
    rows = (
        ("Criterion", str(verdict["title"])),
        ("Clause", str(verdict["clause"])),
        ("Limit", f"{number(verdict['limit'], 3)} {unit}"),
        ("Value", f"{number(verdict['value'], 4)} {unit}"),
        ("Share of the limit", percent(verdict["value"] / verdict["limit"], 3)),
        ("Where", f"{where(place)}, {place['name']}"),
        ("When", f"{verdict['time']:.3f} s"),
        ("Filter", str(verdict["filter"])),
        ("Cut-off", f"{number(verdict['cut_off'], 4)} Hz: {verdict['cut_off_origin']}"),
        (
            "Holds for",
            f"{scope['train']} at {speed(scope['speed'])}, {scope['irregularity']}, "
            f"{scope['mesh_level']} mesh, and nothing else",
        ),
        ("Before the filter", f"{number(verdict['raw']['value'], 4)} {unit}, informative"),
    )
    statement = _sentence(str(verdict["statement"]))
    tone = "bad" if exceeds else "good"
    return [
        Paragraph(heading=f"{word}.", text=statement, tone=tone),
        Facts(rows=rows),
        _spans(verdict, unit),
        Bullets(items=tuple(str(note) for note in verdict["notes"])),
    ]


def _spans(verdict: Mapping[str, Any], unit: str) -> Table:
    rows = [
        _peak_row(f"Span {span['number']}, greatest", span, span["remark"] or "decides")
        for span in verdict["spans"]
    ]
    judged = tuple(index for index, span in enumerate(verdict["spans"]) if span["judged"])
    rows += [_peak_row(str(point["name"]), point, "") for point in verdict["points"]]
    return Table(
        heads=("Where", f"filtered [{unit}]", "x, y [m]", "t [s]", f"raw [{unit}]", "remark"),
        rows=tuple(rows),
        caption=f"{str(verdict['rule']).capitalize()}: spans and named points",
        words=(0, 5),
        marked=judged,
        widths=(2.1, 1.5, 1.4, 0.8, 1.3, 2.6),
    )


def _peak_row(name: str, item: Mapping[str, Any], remark: str) -> tuple[str, ...]:
    filtered, raw = item["filtered"], item["raw"]
    place = filtered["place"]
    return (
        name,
        number(filtered["value"], 4),
        f"{place['x']:.2f}, {place['y']:.2f}".replace("-", "\N{MINUS SIGN}"),
        f"{filtered['time']:.3f}",
        number(raw["value"], 4),
        remark,
    )


def _contact(run: RunMaterial) -> list[Block]:
    """The least force between any wheel and its rail since the first axle's arrival."""
    forces = [
        (float(peak["least"]), name.rpartition("/")[0], float(peak["time_of_least"]))
        for name, peak in run.peaks.items()
        if name.endswith("/contact force")
    ]
    if not forces:
        return []
    least, wheel, time = min(forces)
    text = (
        f"{number(1e-3 * least, 3)} kN at {wheel}, t = {time:.3f} s; of {len(forces)} contacts "
        f"{_lost(least)}."
    )
    return [Paragraph(heading="Least contact force.", text=text)]


def _lost(least: float) -> str:
    """What the least force says of all contacts. [N]"""
    if least > 0.0:
        return "none is lost"
    return "at least one is lost" if least == 0.0 else "at least one bears tension, as modelled"


def _comfort(run: RunMaterial) -> list[Block]:
    """Levels of comfort, where the train has cars and they were looked at."""
    comfort: Mapping[str, Any] | None = run.summary.get("comfort")
    if not comfort or not comfort.get("cars"):
        return []
    levels = ", ".join(
        f"{level['name']} up to {number(level['limit'], 3)} m/s²" for level in comfort["levels"]
    )
    worst = comfort.get("worst") or max(comfort["cars"], key=lambda car: car["peak"])
    text = (
        f"{_level(worst)} in {worst['name']}: {number(worst['peak'], 3)} m/s² vertically "
        f"({comfort['clause']}: {levels})."
    )
    rows = tuple(
        (str(car["name"]), f"{car['peak']:.3f}", f"{car['time']:.3f}", _level(car))
        for car in comfort["cars"]
    )
    heads = ("Car", "greatest [m/s²]", "t [s]", "level")
    return [
        Paragraph(heading="Passenger comfort.", text=text[:1].upper() + text[1:]),
        Table(heads=heads, rows=rows, caption="Vertical acceleration in the cars", words=(0, 3)),
        *([Paragraph(text=str(comfort["note"]))] if comfort.get("note") else []),
    ]


def _level(car: Mapping[str, Any]) -> str:
    level = str(car.get("level") or "beyond every level")
    return level if car.get("passengers", True) else f"{level}, no passengers"


def _peaks(run: RunMaterial) -> Table:
    """Extremes of the recorded histories, of the deck and of the first and last wheels."""
    specs = {spec.name: spec for spec in run.reader.plan.channels}
    known = [(specs[name], peak) for name, peak in run.peaks.items() if name in specs]
    rows = tuple(_extremes_row(spec, peak) for spec, peak in known[:_MOST_PEAKS])
    left = len(known) - len(rows)
    more = f"; {left} more in the job's files" if left > 0 else ""
    return Table(
        heads=("History", "least", "at t [s]", "greatest", "at t [s]", "unit"),
        rows=rows,
        caption=f"Extremes of the recorded histories{more}",
        words=(0, 5),
        widths=(3.0, 1.1, 1.0, 1.1, 1.0, 0.8),
    )


def _extremes_row(spec: ChannelSpec, peak: Mapping[str, float]) -> tuple[str, ...]:
    scale = spec.unit.scale
    return (
        spec.name.replace("/", ", "),
        number(peak["least"] * scale),
        f"{peak['time_of_least']:.3f}",
        number(peak["greatest"] * scale),
        f"{peak['time_of_greatest']:.3f}",
        unit_text(spec.unit),
    )


def _modes(run: RunMaterial) -> list[Block]:
    """The table of frequencies, and what they are of."""
    facts = run.facts
    said = [facts.get("support"), facts.get("damping")]
    words = "; ".join(str(words) for words in said if words)
    return [*([Paragraph(text=_sentence(words))] if words else []), _mode_table(run)]


def _mode_table(run: RunMaterial) -> Table:
    modes: Sequence[Mapping[str, Any]] = run.summary.get("modes") or ()
    named = [index for index, mode in enumerate(modes) if mode["name"]]
    # Names that follow from the model, as those of a train's modes, are compared with nothing.
    likened = any(mode["assurance"] > 0.0 for mode in modes)
    heads = ("Mode", "frequency [Hz]", "damping [%]")
    heads += (("shape",) if named else ()) + (("MAC",) if likened else ())
    caption = "Natural frequencies"
    if likened:
        caption += "; MAC is the modal assurance criterion of the named shape"
    return Table(
        heads=heads,
        rows=tuple(_mode_row(mode)[: len(heads)] for mode in modes),
        caption=caption,
        words=(0, 3) if named else (0,),
        marked=tuple(named) if len(named) < len(modes) else (),
        widths=(0.7, 1.2, 1.0, 3.0, 0.8)[: len(heads)],
    )


def _mode_row(mode: Mapping[str, Any]) -> tuple[str, ...]:
    return (
        str(mode["number"]),
        number(mode["frequency"], 5),
        f"{100.0 * mode['damping']:.2f}",
        str(mode["name"]) or "–",
        f"{mode['assurance']:.3f}" if mode["name"] else "–",
    )


def speeds_section(material: Material) -> Section | None:
    """One row a speed, where there are several."""
    if len(material.runs) < 2 or material.modal:
        return None
    judged = bool(material.verdicts)
    rows: list[tuple[str, ...]] = []
    for run in material.runs:
        verdict = run.verdicts[0] if run.verdicts else None
        greatest = run.greatest_displacement
        moved = "–" if greatest is None else number(1e3 * greatest.value, 4)
        peak = (number(verdict["value"], 4), number(verdict["raw"]["value"], 4)) if verdict else ()
        side = ("exceeds" if verdict["exceeds"] else "within",) if verdict else ()
        name = "–" if run.speed is None else number(round(3.6 * run.speed, 1), 5)
        rows.append((name, *peak, moved, *side))
    heads = ("speed [km/h]", "filtered [m/s²]", "raw [m/s²]", "displacement [mm]", "limit")
    index = material.runs.index(material.deciding)
    return Section(
        title="Speeds",
        blocks=(
            Table(
                heads=heads if judged else (heads[0], heads[3]),
                rows=tuple(rows),
                caption=(
                    "Greatest acceleration that decides, and greatest displacement at the middle "
                    "of the spans that decide, by speed; the row that decides is marked"
                    if judged
                    else "Greatest displacement at mid-span, by speed"
                ),
                words=(4,) if judged else (),
                marked=(index,) if judged else (),
            ),
        ),
    )


def _sentence(text: str) -> str:
    raised = text.replace("m/s2", "m/s²")
    return f"{raised[:1].upper()}{raised[1:]}."
