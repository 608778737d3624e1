"""What a report says and how it is written, without a server."""

from __future__ import annotations

import base64
import re
import zlib
from dataclasses import replace
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from matplotlib import image

from server.reports.basis import data_section, statement_section
from server.reports.document import Bullets, Document, Facts, Paragraph, Picture, Section, Table
from server.reports.html_writer import write_html
from server.reports.material import Material, ReportHead, RunMaterial
from server.reports.numerics import step_error
from server.reports.pdf_writer import write_pdf
from server.reports.results import result_section, speeds_section
from server.reports.words import input_name, number, shown
from server.store import JobRecord, RunRecord
from solver import studies
from solver.units import Units
from tests.server.report_case import NASTY, text_of


def pixel() -> bytes:
    """A PNG of one pixel."""
    return base64.b64decode(
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
    )


def document(size: int = 3) -> Document:
    """One of each block, every text nasty."""
    return Document(
        title=NASTY,
        subtitle=NASTY,
        head=Facts(rows=((NASTY, NASTY),)),
        sections=(
            Section(
                title=NASTY,
                blocks=(
                    Paragraph(text=NASTY, heading=NASTY, tone="bad"),
                    Paragraph(text=NASTY * size),
                    Bullets(items=(NASTY,)),
                    Table(
                        heads=(NASTY, "b"),
                        rows=((NASTY, "1"),) * size,
                        caption=NASTY,
                        marked=(0,),
                    ),
                    Picture(name="p", caption=NASTY, words=NASTY),
                ),
            ),
        ),
        footer=NASTY,
    )


def test_every_block_escapes_its_text() -> None:
    page = write_html(document(), {"p": ("svg", b"<svg/>")})
    assert "<script" not in page
    assert page.count("<style>") == page.count("</style>") == 1
    assert page.count("</section>") == 1


def test_every_block_is_written_to_pdf_without_a_warning(capfd: pytest.CaptureFixture[str]) -> None:
    content = write_pdf(document(200), {"p": pixel()})
    assert content.startswith(b"%PDF-")
    assert len(re.findall(rb"/Type /Page\b", content)) > 2
    assert capfd.readouterr().err == ""


def test_a_heading_stands_on_the_page_of_its_picture() -> None:
    """Whatever is left of the page before it."""
    buffer = BytesIO()
    image.imsave(buffer, np.zeros((100, 200, 3)), format="png")
    pages: set[bytes] = set()
    for lines in range(4, 34, 5):
        sections = (
            Section(title="Words", blocks=(Paragraph(text="word"),) * lines),
            Section(title="Figures", blocks=(Picture(name="p", caption="c", words="w"),)),
        )
        head = Facts(rows=(("a", "b"),))
        content = write_pdf(
            Document(title="t", subtitle="s", head=head, sections=sections),
            {"p": buffer.getvalue()},
        )
        heading = re.findall(rb"/Dest \[(\d+) 0 R", content)[1]
        assert heading == page_of_picture(content), lines
        pages.add(heading)
    assert len(pages) == 2  # of the heights tried, some leave room and some do not


def page_of_picture(content: bytes) -> bytes:
    """Number of the page object whose content draws an image."""
    for page, text in re.findall(rb"(\d+) 0 obj\n<<\n/Contents (\d+) 0 R", content):
        begin = content.index(b"\n%b 0 obj" % text)
        stream = content[content.index(b"stream\n", begin) + 7 : content.index(b"endstream", begin)]
        if b" Do" in zlib.decompress(stream.rstrip(b"\n")):
            return page
    raise AssertionError("no page has a picture")


@pytest.mark.parametrize("alpha", [0.0, -0.05, -0.3])
def test_the_steps_error_is_that_of_the_method(alpha: float) -> None:
    """Against the oscillator integrated step by step."""
    step, frequency = 1e-3, 30.0
    period, damping = step_error(alpha, step, frequency)
    beta, gamma = (1 - alpha) ** 2 / 4, 0.5 - alpha
    k = (2 * np.pi * frequency) ** 2
    u, v, a = 1.0, 0.0, -k
    history = [u]
    for _ in range(4000):
        ahead = u + step * v + step**2 * (0.5 - beta) * a
        new = (-(1 + alpha) * k * ahead + alpha * k * u) / (1 + (1 + alpha) * beta * step**2 * k)
        u, v, a = ahead + beta * step**2 * new, v + step * ((1 - gamma) * a + gamma * new), new
        history.append(u)
    values = np.array(history)
    ups = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0))
    crossings = ups - values[ups] / (values[ups + 1] - values[ups])
    measured = np.diff(crossings).mean() * step
    # A linear interpolation of the crossings is good to a few 1e-6 of a period.
    assert period == pytest.approx(measured * frequency - 1.0, abs=2e-5)
    decay = np.log(np.abs(values[:40]).max() / np.abs(values[-40:]).max())
    turned = 2 * np.pi * frequency / (1 + period) * step * (len(values) - 40)
    # Peaks fall between samples: one percent of the amplitude over 700 radians.
    assert damping == pytest.approx(decay / turned, abs=2e-5)
    if alpha == 0.0:
        # Average acceleration: tan(w' dt / 2) = w dt / 2.
        omega_dt = 2 * np.pi * frequency * step
        assert period == pytest.approx(omega_dt / (2 * np.arctan(omega_dt / 2)) - 1.0, rel=1e-9)


def test_numbers_are_written_as_people_read_them() -> None:
    assert [number(value) for value in (0.0, 1.5, -2.25, 123456.0, 3.0383e-5, None)] == [
        "0",
        "1.5",
        "−2.25",
        "123\N{NARROW NO-BREAK SPACE}456",
        "3.038·10⁻⁵",
        "–",
    ]
    assert shown((120.0,), Units.speed) == "432 km/h"
    assert shown(tuple(np.arange(50.0, 55.0)), Units.length) == "50 to 54 m in steps of 1 (5)"
    assert shown(("car",) * 16, None) == "16 × car"
    assert shown(0.0, Units.speed, "/line_speed") == "not stated"
    assert input_name("/train/vehicle_types/0/carbody_mass") == (
        "Train",
        "vehicle type 1, carbody mass",
    )


def judged_material() -> Material:
    """A job of one judged run, without a store behind it."""
    place = {"name": "slab, span 2", "x": 29.2, "y": 0.0, "z": 1.3}
    peak = {"value": 9.4, "time": 3.48, "place": place}
    span = {"number": 2, "judged": True, "filtered": peak, "raw": peak, "remark": ""}
    verdict = {
        "rule": "deck acceleration",
        "clause": "EN 1990:2002/A1 A2.4.4.2.1(4)",
        "title": "peak vertical deck acceleration along each track, ballasted track",
        "limit": 3.5,
        "value": 9.4,
        "unit": "m/s2",
        "exceeds": True,
        "place": place,
        "time": 3.48,
        "speed": 120.0,
        "filter": "Butterworth",
        "cut_off": 30.0,
        "cut_off_origin": "greatest of 30 Hz",
        "scope": {
            "train": "KHST",
            "speed": 120.0,
            "irregularity": "no irregularities",
            "mesh_level": "coarse",
        },
        "statement": "exceeds 3.5 m/s2",
        "notes": ["Screening mesh: confirm."],
        "raw": peak,
        "points": [{"name": "mid-span 2, axis", "filtered": peak, "raw": peak}],
        "spans": [span],
    }
    car = {"name": "carbody 03", "peak": 1.1, "time": 4.0, "passengers": True, "level": "good"}
    comfort = {
        "clause": "EN 1990:2002/A1 A2.4.4.3.2",
        "levels": [{"name": "very good", "limit": 1.0}, {"name": "good", "limit": 1.3}],
        "cars": [car, {**car, "name": "carbody 01", "passengers": False}],
        "worst": car,
        "note": "At the centre of mass.",
    }
    summary = {
        "verdicts": [verdict],
        "comfort": comfort,
        "peaks": {
            "wheel 01 left/contact force": peak_of(78.4e3, 92.1e3),
            "wheel 02 left/contact force": peak_of(62.3e3, 92.1e3),
            "mid-span 2, axis/displacement": peak_of(-8.0e-3, 4e-3),
            "mid-span 3, axis/displacement": peak_of(-9.3e-3, 4e-3),
        },
        "facts": {"assumed": ["places of the bearings"], "mesh_accuracy": ["within 2.1 percent"]},
    }
    study = studies.template("khst-alverca").study
    job = JobRecord(
        sequence=1,
        id="j",
        kind="crossing",
        name="KHST",
        study=studies.to_json(study),
        state="done",
        steps=1,
        error=None,
        created=0.0,
        started=0.0,
        ended=1.0,
    )
    record = RunRecord(
        id="r",
        job="j",
        batch="b",
        index=0,
        parameters={"speed": 120.0},
        state="done",
        attempt=1,
        progress={},
        verdicts=[verdict],
        error=None,
        started=0.0,
        ended=1.0,
    )
    reader: Any = None
    run = RunMaterial(record=record, reader=reader, summary=summary)
    head = ReportHead(project="P", author="", date="d", remark="")
    return Material(job=job, study=study, runs=(run,), n_run=2, head=head, version="1")


def peak_of(least: float, greatest: float) -> dict[str, float]:
    """Extremes as a summary has them, SI."""
    return {
        "least": least,
        "time_of_least": 2.5,
        "greatest": greatest,
        "time_of_greatest": 3.0,
    }


def test_table_and_figure_of_speeds_show_the_same_displacement() -> None:
    """That of the spans that are judged: the last span's neighbour is not modelled."""
    material = judged_material()
    both = replace(material, runs=(material.runs[0],) * 2)
    section = speeds_section(both)
    assert section is not None
    assert re.search(r"432\s+9\.4\s+9\.4\s+8\s+exceeds", words_of(section))


def words_of(section: Section) -> str:
    return text_of(write_html(Document(title="", subtitle="", head=Facts(rows=()),
                                       sections=(section,)), {}))  # fmt: skip


def test_verdicts_stand_with_clause_value_limit_and_scope() -> None:
    text = words_of(result_section(judged_material()))
    for words in (
        "Exceeds the limit.",
        "EN 1990:2002/A1 A2.4.4.2.1(4)",
        "3.5 m/s²",
        "269 %",
        "x = 29.2 m",
        "KHST at 432 km/h",
        "Screening mesh: confirm.",
        "1 of 2 runs are done",
        "Good in carbody 03: 1.1 m/s²",
        "62.3 kN at wheel 02 left, t = 2.500 s; of 2 contacts none is lost",
        "good, no passengers",
    ):
        assert words in text, words


def test_the_limits_of_other_tracks_are_left_out() -> None:
    text = words_of(statement_section(judged_material()))
    assert "no certificate" in text
    assert "deck twist" in text
    assert "ballasted track" in text
    assert "fastened directly" not in text  # 5.0 m/s2 judged nothing here.


def test_assumed_figures_are_named_unless_somebody_changed_them() -> None:
    material = judged_material()
    text = words_of(data_section(material))
    assert "Neves (2016)" in text
    assert "places of the bearings" in text
    assert "edge mass" in text
    study = replace(material.study, viaduct=replace(material.study.viaduct, edge_mass=350.0))
    changed = words_of(data_section(replace(material, study=study)))
    assert "edge mass" not in changed
    assert "bearing inset" in changed
    assert "figures of the study's author" in changed
