"""From a job to its report: the sections, in the order in which an engineer reads them."""

from __future__ import annotations

from collections.abc import Mapping

from server.reports.basis import (
    all_inputs_section,
    data_section,
    identity_section,
    input_section,
    statement_section,
    study_digest,
)
from server.reports.document import Block, Document, Facts, Paragraph, Picture, Section
from server.reports.figures import Illustration
from server.reports.material import Material
from server.reports.numerics import accuracy_section
from server.reports.results import result_section, speeds_section
from server.reports.words import shown, speed
from solver.models.beam_bridge import BeamBridge
from solver.units import Units

__all__ = ["build_report"]


def build_report(material: Material, figures: Mapping[str, Illustration]) -> Document:
    """The report of a job.

    Args:
        material: What is known of it.
        figures: By name, in the order in which they stand in the report.

    Returns:
        The document; its pictures are not drawn yet.
    """
    sections = [
        result_section(material),
        speeds_section(material),
        _figures_section(material, figures),
        input_section(material),
        data_section(material),
        accuracy_section(material),
        statement_section(material),
        identity_section(material),
        all_inputs_section(material),
    ]
    kept = [section for section in sections if section is not None]
    return Document(
        title=material.head.project,
        subtitle=_subtitle(material),
        head=_head(material),
        sections=tuple(
            Section(title=f"{number}. {section.title}", blocks=section.blocks)
            if not section.title.startswith("Appendix")
            else section
            for number, section in enumerate(kept, start=1)
        ),
        footer=f"Job {material.job.id}, study {study_digest(material)[:12]}",
    )


def _subtitle(material: Material) -> str:
    if material.modal:
        return f"Natural modes: {material.job.name}"
    speeds = [run.speed for run in material.runs if run.speed is not None]
    if not speeds:
        return material.job.name
    span = speed(speeds[0])
    if len(speeds) > 1:
        span = f"{len(speeds)} speeds, {speed(min(speeds))} to {speed(max(speeds))}"
    return f"Dynamic interaction of train, track and bridge: {material.job.name}, {span}"


def _head(material: Material) -> Facts:
    head = material.head
    rows = [
        ("Project", head.project),
        ("Author", head.author or "–"),
        ("Date", head.date),
        ("Remark", head.remark),
        ("Study", material.study.name),
        *_what(material),
    ]
    return Facts(rows=tuple(row for row in rows if row[1]))


def _what(material: Material) -> list[tuple[str, str]]:
    """Train, structure and irregularity in a few words."""
    study, facts = material.study, material.deciding.facts
    spans = shown(study.viaduct.spans, Units.length)
    kind = "plain beams" if isinstance(study.viaduct, BeamBridge) else "viaduct"
    train = ("Train", str(facts.get("train", study.train.name)))
    structure = ("Structure", f"{kind}, spans {spans}")
    if material.modal:
        parts = {"train": train, "track": ("Track", study.track.type), "viaduct": structure}
        return [("Modes of", f"the {study.modes.part}"), parts[study.modes.part]]
    return [train, structure, ("Irregularity", str(facts.get("irregularity", "–")))]


def _figures_section(material: Material, figures: Mapping[str, Illustration]) -> Section | None:
    if not figures:
        return None
    run = material.deciding
    blocks: list[Block] = []
    if len(material.runs) > 1 and run.speed is not None:
        which = "that decides, at" if material.verdicts else "at"
        words = f"Figures of one run show the run {which} {speed(run.speed)}."
        blocks.append(Paragraph(text=words))
    blocks += [
        Picture(name=name, caption=f"Figure {number}: {figure.title}", words=figure.words)
        for number, (name, figure) in enumerate(figures.items(), start=1)
    ]
    return Section(title="Figures", blocks=tuple(blocks))
