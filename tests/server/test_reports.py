"""The report: everything that the file needs, escaped, self-contained, and of bounded size."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterator
from html import unescape
from typing import Any

import pytest

from solver import studies
from tests.server.report_case import NASTY, text_of
from tests.server.server_case import Client, ended, serving, settings_for, short_study, submit

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """A server that computes."""
    with serving(settings_for(tmp_path_factory.mktemp("server"))) as client:
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
    assert re.search(r"Computed until\s+20\d\d-\d\d-\d\d \d\d:\d\d UTC", text)


def test_the_moment_that_decides_is_seen_in_space(client: Client, sweep: dict[str, Any]) -> None:
    """With its time, scale and colours in words: a picture alone tells nobody any of them."""
    page = html(client, sweep["id"])
    words = re.search(r"Figure 2: Bridge and train<span>([^<]*)</span>", page)
    assert words is not None
    run = client.get(f"/api/v1/runs/{sweep['runs'][-1]['id']}").json()
    peak = run["summary"]["peaks"]["mid-span 1/displacement"]
    frame = float(re.search(r"t = ([\d.]+) s, 126 km/h", words[1])[1])  # type: ignore[index]
    # Shapes are stored every 10 ms in this study.
    assert frame == pytest.approx(peak["time_of_least"], abs=0.0051)
    assert f"nearest to t = {peak['time_of_least']:.3f} s, when the displacement" in words[1]
    assert "deformation × " in words[1]
    assert re.search(
        r"colours: vertical acceleration, −[\d.]+ to [\d.]+ m/s², as computed", words[1]
    )
    assert re.search(r'src="data:image/png;base64,[^"]{1000,}"><figcaption>Figure 2', page)


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
    assert "Figure 1: Shape of mode 1" in text
    assert "deformation × " in text
    assert "share of the greatest displacement, 0 to 1" in text
    # The names of a beam's modes follow from their order: compared with nothing, no criterion.
    assert "1 half wave" in text
    assert "MAC" not in text
    assert "diagonal of the modal damping matrix" in text
    # Neither train nor irregularity have a part in a viaduct's modes.
    assert "Yang and Yau, 25 m" in text
    assert "One sprung mass of Yang" not in text
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
