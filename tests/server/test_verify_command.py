"""``trainbridge verify``: table, page, exit status."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from server.cli import app
from server.verify import report_page
from solver import verification
from solver.verification import Case, Figure, Progress, Result, Series
from solver.verification.case import Findings


def _case(name: str, ours: float, weight: str = "fast") -> Case:
    def run(progress: Progress) -> Result:
        findings = Findings(name)
        findings.value("deflection", "m", 2.0, ours, 1e-3, "A thousandth <b>is</b> enough.")
        findings.figure(
            "Figure 1: a < b", "Time [s]", "Deflection [m]",
            Series(name="closed form", x=np.arange(9.0), y=np.arange(9.0), role="reference"),
            Series(name="ours", x=np.arange(9.0), y=np.arange(9.0) ** 2, role="ours"),
            note="They differ.",
        )  # fmt: skip
        progress(1.0)
        return findings.result()

    return Case(name=name, title=f"Case {name}", source="A book", weight=weight, run=run)  # type: ignore[arg-type]


def _broken(progress: Progress) -> Result:
    raise ArithmeticError("no number came out")


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three cases instead of the real ones: good, bad, slow."""
    made = (_case("good", 2.001), _case("bad", 2.1), _case("slow", 2.0, "slow"))
    monkeypatch.setattr(verification, "cases", lambda: made)
    monkeypatch.setattr(verification, "case", lambda name: {c.name: c for c in made}[name])


@pytest.mark.usefixtures("few")
def test_exit_status_says_whether_all_passed(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    done = CliRunner().invoke(app, ["verify", "good", "slow", "--report", str(page)])
    assert done.exit_code == 0
    assert "2.001 m" in done.stdout
    assert "A thousandth" in done.stdout
    assert "All 2 cases passed" in done.stdout
    assert page.read_text(encoding="utf-8").count("<section") == 2
    failed = CliRunner().invoke(app, ["verify", "good", "bad"])
    assert failed.exit_code == 1
    assert "FAILED" in failed.stdout
    assert "1 of 2 cases failed: bad." in failed.stderr


@pytest.mark.usefixtures("few")
def test_fast_leaves_the_slow_ones_out() -> None:
    done = CliRunner().invoke(app, ["verify", "--fast"])
    assert "good" in done.stdout
    assert "slow" not in done.stdout
    assert CliRunner().invoke(app, ["verify", "slow", "--fast"]).exit_code == 1


def test_a_case_that_breaks_down_fails_and_the_next_one_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    broken = Case(name="broken", title="Broken", source="None", weight="fast", run=_broken)
    monkeypatch.setattr(verification, "cases", lambda: (broken, _case("good", 2.0)))
    done = CliRunner().invoke(app, ["verify"])
    assert done.exit_code == 1
    assert "no number came out" in done.stdout.replace("\n", " ")
    assert "1 of 2 cases failed: broken." in done.stderr


def test_unknown_names_and_folders_are_said(tmp_path: Path) -> None:
    unknown = CliRunner().invoke(app, ["verify", "nothing"])
    assert unknown.exit_code == 1
    assert "sprung-mass" in unknown.stderr
    nowhere = tmp_path / "none" / "page.html"
    refused = CliRunner().invoke(app, ["verify", "two-springs", "--report", str(nowhere)])
    assert refused.exit_code == 1
    assert "folder does not exist" in refused.stderr
    folder = CliRunner().invoke(app, ["verify", "two-springs", "--report", str(tmp_path)])
    assert folder.exit_code == 1
    assert "it is a folder" in folder.stderr.replace("\n", " ")


def test_brackets_in_a_message_are_not_markup(monkeypatch: pytest.MonkeyPatch) -> None:
    def stumble(progress: object) -> object:
        raise ValueError("no closing [/tmp/x] in [red]")

    broken = Case(name="broken", title="Broken", source="None", weight="fast", run=stumble)  # type: ignore[arg-type]
    monkeypatch.setattr(verification, "cases", lambda: (broken,))
    done = CliRunner().invoke(app, ["verify"])
    assert done.exit_code == 1
    assert "[/tmp/x] in [red]" in done.stdout.replace("\n", " ")


@pytest.mark.usefixtures("few")
def test_a_name_given_twice_runs_once() -> None:
    done = CliRunner().invoke(app, ["verify", "good", "good"])
    assert "All 1 cases passed" in done.stdout


def test_a_real_case_from_the_command_line() -> None:
    done = CliRunner().invoke(app, ["verify", "natural-frequencies"])
    assert done.exit_code == 0, done.stdout
    assert "30.02 rad/s" in done.stdout


class _Outline(HTMLParser):
    """Tags, identifiers and references of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.identifiers: list[str] = []
        self.links: list[str] = []
        self.labels: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        if "id" in values:
            self.identifiers.append(values["id"])
        if tag == "svg":
            self.labels.append(values.get("aria-label", ""))
        self.links += [values[name] for name in ("href", "xlink:href", "src") if name in values]


def test_the_page_stands_alone_and_is_well_formed() -> None:
    results = [
        (item, item.run(lambda fraction: None)) for item in (_case("a", 2.0), _case("b", 3.0))
    ]
    page = report_page(results, "1.2")
    outline = _Outline()
    outline.feed(page)
    assert len(set(outline.identifiers)) == len(outline.identifiers), "figures share no identifier"
    assert all(link.startswith("#") for link in outline.links), "nothing is fetched"
    assert {link[1:] for link in outline.links} <= set(outline.identifiers)
    assert outline.labels == ["Figure 1: a < b"] * 2
    assert "<b>is</b>" not in page, "texts are escaped"
    assert "1 failed" in page
    # Placeholder colours have become the page's: it follows light and dark.
    assert "var(--ours)" in page
    assert "var(--reference)" in page
    assert not re.search(r"#01020\d", page)


def test_figures_take_gaps() -> None:
    """Curves interrupted by what is not a number, as those of the wheel-rail pair."""
    gap = np.array([0.0, 1.0, np.nan, 3.0])
    figure = Figure(
        title="Gap",
        x_label="x",
        y_label="y",
        series=(Series(name="curve", x=np.arange(4.0), y=gap, role="ours"),),
    )
    item = _case("gap", 2.0)
    page = report_page([(item, Result(comparisons=(), figures=(figure,)))], "1.2")
    assert "nan" not in page[page.index("<svg") :].lower()
