"""The report: everything that the file needs, escaped, self-contained, and of bounded size."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterator
from dataclasses import replace
from html import unescape
from typing import Any

import numpy as np
import pytest

from server.reports.basis import data_section, statement_section
from server.reports.document import Bullets, Document, Facts, Paragraph, Picture, Section, Table
from server.reports.html_writer import write_html
from server.reports.material import Material, ReportHead, RunMaterial
from server.reports.numerics import step_error
from server.reports.pdf_writer import write_pdf
from server.reports.results import result_section
from server.reports.words import input_name, number, shown
from server.store import JobRecord, RunRecord
from solver import studies
from solver.units import Units
from tests.server.server_case import Client, ended, serving, settings_for, short_study, submit

NASTY = "<script>alert(1)</script> \"&' </style> \u202e\0 漢字 čeština"


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """A server that computes."""
    with serving(settings_for(tmp_path_factory.mktemp("server"))) as client:
        client.timeout = 120.0
        yield client


@pytest.fixture(scope="module")
def sweep(client: Client) -> dict[str, Any]:
    """A job of two speeds with one input changed."""
    study = short_study(sweep={"speeds": [20.0, 35.0]}, name=f"Beam {NASTY}"[:100])
    study["train"]["mass"] = 8000.0
    job = ended(client, submit(client, study)["id"])
    assert job["state"] == "done", job
    return job


def html(client: Client, job: str, **head: Any) -> str:
    answer = client.get(f"/api/v1/jobs/{job}/report.html", params=head)
    assert answer.status_code == 200, answer.text
    return answer.text


def text_of(page: str) -> str:
    return unescape(re.sub(r"<[^>]*>", " ", page))


def test_the_html_holds_what_the_file_needs(client: Client, sweep: dict[str, Any]) -> None:
    page = html(client, sweep["id"], project="Viaduct 7", author="A. B.", date="2026-01-02")
    text = text_of(page)
    for words in (
        "Viaduct 7",
        "A. B.",
        "2026-01-02",
        "Not judged",
        "Inputs that differ from the template",
        "One sprung mass on a simple beam",
        "Data, assumptions and confidence",
        "Error of the time step",
        "Software and identity",
        "Model hash",
        studies.source_digest()[:16],
        "The solver that computed is the one that wrote this report",
        "What this report states, and what it does not",
        "Appendix: all inputs",
        sweep["id"],
    ):
        assert words in text, words
    # The input that was changed, with both values in display units.
    assert re.search(r"Train\s+mass\s+5\.75 t\s+8 t", text)
    assert "126" in text  # 35 m/s in km/h, of the sweep's table.
    assert page.count("<figure>") >= 4
    assert text.count("Figure 1:") == 1


def test_the_html_is_closed_to_the_world(client: Client, sweep: dict[str, Any]) -> None:
    answer = client.get(
        f"/api/v1/jobs/{sweep['id']}/report.html",
        params={"project": NASTY, "author": NASTY, "remark": NASTY},
    )
    page = answer.text
    assert "<script" not in page.lower()
    assert " style=" not in page
    assert not re.search(r'(?:src|href)="(?!data:)', page)
    assert "alert(1)" in text_of(page)
    policy = answer.headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'self'" in policy
    assert "unsafe" not in policy
    # The digest in the policy is that of the style in the file, or nothing would be styled.
    [style] = re.findall(r"<style>(.*?)</style>", page, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
    assert f"'sha256-{digest}'" in policy
    assert f"sha256-{digest}" in unescape(page)
    assert answer.headers["content-disposition"].startswith("attachment; filename=")
    preview = client.get(f"/api/v1/jobs/{sweep['id']}/report.html", params={"preview": "true"})
    assert preview.headers["content-disposition"].startswith("inline")


def test_the_pdf_is_one_with_every_text(client: Client, sweep: dict[str, Any]) -> None:
    answer = client.get(
        f"/api/v1/jobs/{sweep['id']}/report.pdf", params={"remark": NASTY, "project": NASTY}
    )
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/pdf"
    assert answer.content.startswith(b"%PDF-")
    assert answer.content.rstrip().endswith(b"%%EOF")
    assert len(re.findall(rb"/Type /Page\b", answer.content)) >= 4
    assert len(re.findall(rb"/Subtype /Image", answer.content)) >= 4
    assert len(answer.content) < 5_000_000


def test_a_modal_analysis_has_a_report(client: Client) -> None:
    job = ended(client, submit(client, short_study(), kind="modes")["id"])
    text = text_of(html(client, job["id"]))
    assert "Natural modes" in text
    assert "frequency [Hz]" in text
    assert client.get(f"/api/v1/jobs/{job['id']}/report.pdf").status_code == 200


def test_nothing_is_reported_of_what_is_not_done(client: Client) -> None:
    job = submit(client, short_study(integration={"alpha": 0.0, "time_step": 1e-6}))
    client.post(f"/api/v1/jobs/{job['id']}/cancel")
    ended(client, job["id"])
    answer = client.get(f"/api/v1/jobs/{job['id']}/report.html")
    assert answer.status_code == 409
    assert "none of its runs is done" in answer.json()["detail"]
    assert client.get("/api/v1/jobs/none/report.html").status_code == 404
    assert client.get(f"/api/v1/jobs/{job['id']}/report.doc").status_code == 422


def test_fields_of_the_head_are_bounded(client: Client, sweep: dict[str, Any]) -> None:
    for name, size in (("project", 201), ("author", 201), ("date", 41), ("remark", 2001)):
        answer = client.get(f"/api/v1/jobs/{sweep['id']}/report.html", params={name: "x" * size})
        assert answer.status_code == 422, name
    page = html(client, sweep["id"])
    assert "Beam" in text_of(page).split("Dynamic interaction")[0]  # The job's name by default.


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
        "x = 29.20 m",
        "KHST at 432 km/h",
        "Screening mesh: confirm.",
        "1 of 2 runs are done",
        "Good in carbody 03: 1.1 m/s²",
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
