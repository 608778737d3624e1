"""The sections of what the results rest on: inputs, assumptions, mesh and step, software."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from server.library.built_in import BuiltInEntry, built_in_entries
from server.library.parts import PARTS
from server.reports.document import Block, Bullets, Facts, Paragraph, Section, Table
from server.reports.inputs import Difference, inputs, nearest_template
from server.reports.material import Material
from server.reports.words import input_name, shown
from solver import studies
from solver.data import load

__all__ = [
    "all_inputs_section",
    "data_section",
    "identity_section",
    "input_section",
    "statement_section",
    "study_digest",
]


def input_section(material: Material) -> Section:
    """Every input that differs from the nearest template."""
    title = "Inputs"
    found = nearest_template(material.study, material.job.kind)
    if found is None:
        text = "The study is like no template; the appendix lists every input."
        return Section(title=title, blocks=(Paragraph(text=text),))
    template, changed = found
    whose = f"the template “{template.title}” ({template.name})"
    if not changed:
        text = f"No input differs from {whose}; the appendix lists every input."
        return Section(title=title, blocks=(Paragraph(text=text),))
    count = f"{len(changed)} input{'s differ' if len(changed) > 1 else ' differs'}"
    text = f"{count} from {whose}, the nearest; the appendix lists every input."
    table = Table(
        heads=("Part", "input", "template", "this study"),
        rows=tuple(_changed_row(item) for item in changed),
        caption="Inputs that differ from the template",
        words=(0, 1, 2, 3),
        widths=(1.0, 1.8, 1.6, 1.6),
    )
    return Section(title=title, blocks=(Paragraph(text=text), table))


def _changed_row(item: Difference) -> tuple[str, ...]:
    before, after = (shown(value, item.unit, item.pointer) for value in item.values)
    return (*input_name(item.pointer), before, after)


def all_inputs_section(material: Material) -> Section:
    """The appendix: the study as it was computed, every default filled in."""
    rows: list[tuple[str, str, str]] = []
    for item in inputs(material.study).values():
        part, name = input_name(item.pointer)
        rows.append((part, name, shown(item.value, item.unit, item.pointer)))
    table = Table(
        heads=("Part", "input", "value"),
        rows=tuple(rows),
        caption="Every input of the study",
        words=(0, 1, 2),
        widths=(1.0, 2.0, 2.4),
    )
    return Section(title="Appendix: all inputs", blocks=(table,))


def data_section(material: Material) -> Section:
    """Where the data come from, how far they can be trusted, and what is assumed."""
    blocks: list[Block] = [_sources(material)]
    remarks = _remarks(material)
    if remarks:
        blocks.append(
            Table(
                heads=("Part", "figure", "confidence", "why"),
                rows=tuple(remarks),
                caption="Figures of low confidence among the inputs",
                words=(0, 1, 2, 3),
                widths=(0.8, 1.4, 1.0, 3.2),
            )
        )
    assumed: Sequence[str] = material.deciding.facts.get("assumed") or ()
    assumption = material.deciding.facts.get("assumption")
    said = [*assumed, *([str(assumption)] if assumption else [])]
    if said:
        heading = "Assumed by the model, for no source prints it:"
        blocks += [Paragraph(text=heading), Bullets(items=tuple(map(str, said)))]
    blocks.append(Paragraph(text=_LETTERS))
    return Section(title="Data, assumptions and confidence", blocks=tuple(blocks))


_LETTERS = (
    "Letters of confidence: A two independent sources or more; B one source (B+ agrees with "
    "practice); C from memory, or sources that conflict; D derived here. “Assumed” means that no "
    "source prints the figure."
)


def _sources(material: Material) -> Table:
    rows: list[tuple[str, ...]] = []
    document = studies.to_json(material.study)
    for kind, part in _parts(material).items():
        known = _known(kind, document[part])
        if known is None:
            name = document[part].get("name") or document[part]["type"].replace("_", " ")
            row = (f"{name}: figures of the study's author", "not known to this program", "–")
        else:
            row = (known.name, known.source, known.confidence)
        rows.append((part.capitalize(), *row))
    return Table(
        heads=("Part", "what", "source", "confidence"),
        rows=tuple(rows),
        caption="Sources of the data",
        words=(0, 1, 2, 3),
        widths=(0.9, 1.7, 2.4, 2.4),
    )


def _remarks(material: Material) -> list[tuple[str, ...]]:
    """What is known of single figures, of those that are still as their source has them."""
    document = studies.to_json(material.study)
    found: list[tuple[str, ...]] = []
    for kind, part in _parts(material).items():
        entry = _known(kind, document[part]) or _like(kind, document[part])
        for remark in () if entry is None else entry.remarks:
            given = _at(document[part], remark.pointer)
            if entry is not None and given == _at(entry.value, remark.pointer):
                _, name = input_name(f"/{part}{remark.pointer}")
                found.append((part.capitalize(), name, remark.confidence, remark.text))
    return found


_PARTS_OF_MODES: Mapping[str, Sequence[str]] = {
    "viaduct": ("viaducts", "tracks"),
    "track": ("tracks",),
    "train": ("trains",),
}


def _parts(material: Material) -> Mapping[str, str]:
    """The parts of the study that the results depend on: a modal analysis leaves some out."""
    kinds = _PARTS_OF_MODES[material.study.modes.part] if material.modal else tuple(PARTS)
    return {kind: PARTS[kind] for kind in kinds}


def _known(kind: str, value: Mapping[str, Any]) -> BuiltInEntry | None:
    """The built-in entry with exactly these values."""
    entries = (entry for entry in built_in_entries() if entry.kind == kind)
    return next((entry for entry in entries if entry.value == value), None)


def _like(kind: str, value: Mapping[str, Any]) -> BuiltInEntry | None:
    """The first built-in entry of the same type: what was changed of it is the author's.

    Of several it is the one of the same name: a table of axles is no universal train for its type.
    """
    entries = [entry for entry in built_in_entries() if entry.kind == kind]
    alike = [entry for entry in entries if entry.value["type"] == value["type"]]
    named = [entry for entry in alike if entry.value.get("name") == value.get("name")]
    return next(iter(named if len(alike) > 1 else alike), None)


def _at(value: Any, pointer: str) -> Any:
    for key in pointer.split("/")[1:]:
        value = value.get(key) if isinstance(value, dict) else None
    return value


_CRITERIA = ("deck_acceleration_ballasted", "deck_acceleration_direct", "frequency_range",
             "maximum_design_speed")  # fmt: skip
_NOT_CHECKED = (
    "deck twist (EN 1990:2002/A1 A2.4.4.2.2), vertical deformation of the deck (A2.4.4.2.3), "
    "transverse deformation and vibration (A2.4.4.2.4)",
    "stresses, fatigue, track stability, bearing uplift and the load models of EN 1991-2 "
    "(LM71, SW, HSLM) other than the study's own train",
)


def statement_section(material: Material) -> Section:
    """What the report states of conformity, and what it does not."""
    clauses = list(dict.fromkeys(str(item["clause"]) for item in material.verdicts))
    if clauses:
        stated = (
            f"Checked: {'; '.join(clauses)}, for the train, speeds, irregularities and mesh named "
            "with each verdict, by time integration of train, track and bridge together. The "
            "verdict states whether the computed value is beyond the limit; it is no certificate "
            "and replaces no judgement of the responsible engineer."
        )
    else:
        stated = (
            "No criterion of a standard was applied: the report states computed values only, and "
            "nothing about conformity."
        )
    comfort: Mapping[str, Any] | None = material.deciding.summary.get("comfort")
    if comfort:
        stated += f" Levels of comfort are stated after {comfort['clause']}; they are no limit."
    blocks: list[Block] = [
        Paragraph(text=stated),
        Paragraph(text="Not checked here:"),
        Bullets(items=_NOT_CHECKED),
    ]
    if clauses:
        blocks.append(_limits(material, clauses))
    return Section(title="What this report states, and what it does not", blocks=tuple(blocks))


def _limits(material: Material, clauses: Sequence[str]) -> Table:
    """The limits in use as far as they belong to the clauses, with the confidence in each."""
    limits = {float(verdict["limit"]) for verdict in material.verdicts}
    data = load("standards")
    entries = [data[name] for name in _CRITERIA]
    rows = tuple(
        (
            entry["clause"],
            entry["what"],
            shown(entry["value"], None),
            entry["unit"].replace("m/s2", "m/s²").replace("1", "–"),
            entry["confidence"],
        )
        for entry in entries
        if entry["unit"] == "1"
        or (entry["clause"] in clauses and (entry["unit"] != "m/s2" or entry["value"] in limits))
    )
    return Table(
        heads=("Clause", "what", "value", "unit", "confidence"),
        rows=rows,
        caption="Figures of the standards, and how far this program's copy of them can be trusted",
        words=(0, 1, 3, 4),
        widths=(2.0, 3.4, 0.7, 0.7, 1.1),
    )


def identity_section(material: Material) -> Section:
    """By what the computation can be known and done again."""
    versions: Mapping[str, Any] = material.deciding.summary.get("versions") or {}
    key = studies.model_key(material.study)
    rows = [
        ("Job", material.job.id),
        ("Run that decides" if material.verdicts else "Run shown", material.deciding.record.id),
        ("Computed until", _moment(material.deciding.record.ended)),
        ("Report written by", f"Trainbridge {material.version}"),
        *((str(name), str(value)) for name, value in versions.items()),
        ("Back end", str(material.deciding.facts.get("back_end", "–"))),
        ("Digest of the study (SHA-256)", study_digest(material)),
        ("Model hash", key or "none: a plain beam shares no model"),
    ]
    text = (
        "The digest of the study is that of its JSON with sorted keys, as the job holds it. "
        f"{_whose_source(versions)}"
    )
    return Section(
        title="Software and identity", blocks=(Facts(rows=tuple(rows)), Paragraph(text=text))
    )


def _moment(seconds: float | None) -> str:
    """Date and time of day, UTC, from seconds since 1970."""
    return "–" if seconds is None else f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%d %H:%M} UTC"


def _whose_source(versions: Mapping[str, Any]) -> str:
    """Whether the solver that computed is the one whose model hash stands here."""
    own, computed = studies.source_digest(), versions.get("solver source")
    if computed is None:
        return (
            "The run of an earlier version does not say which source of the solver computed it; "
            "the model hash is that of the program that wrote this report."
        )
    if own.startswith(str(computed)):
        return "The solver that computed is the one that wrote this report, by its source's digest."
    return (
        f"The solver has changed since: the source that wrote this report has the digest "
        f"{own[: len(str(computed))]}, and the model hash is that of its models."
    )


def study_digest(material: Material) -> str:
    """Digest of the study as the job holds it, 64 hexadecimal digits."""
    text = json.dumps(material.job.study, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
