"""What ``trainbridge verify`` prints and writes: a table, and a self-contained page with figures.

Figures are inline SVG in the page's own colours, so that they follow light and dark. matplotlib is
imported only when a page is written.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape
from io import StringIO
from typing import Any

import numpy as np
from rich.table import Table
from rich.text import Text

from solver.verification import Case, Comparison, Figure, Progress, Result

__all__ = ["comparison_table", "report_page", "run_case"]

_SIZE = (7.2, 3.2)
"""Width and height of a figure. [inch]"""
_MOST_POINTS = 4000
"""Drawn of a curve; more cannot be told apart."""
_INK, _PAPER = "#010203", "none"
_PENS: dict[str, list[tuple[str, str, float]]] = {
    "reference": [("#010204", "solid", 3.2), ("#010207", "solid", 3.2)],
    "other": [("#010205", "dashed", 1.3), ("#010208", "dashdot", 1.3)],
    "ours": [("#010206", "solid", 1.2)],
}
"""Placeholder colour, dashes and width of each role; the page's style sheet sets the colours."""
_VARIABLES = {
    _INK: "currentColor",
    "#010204": "var(--reference)",
    "#010207": "var(--reference)",
    "#010205": "var(--other)",
    "#010208": "var(--other)",
    "#010206": "var(--ours)",
}
_STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "trainbridge",
    "font.size": 10.0,
    "font.family": "sans-serif",
    "text.color": _INK,
    "axes.edgecolor": _INK,
    "axes.labelcolor": _INK,
    "xtick.color": _INK,
    "ytick.color": _INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
}
_CSS = """
:root { color-scheme: light dark; --paper: #fff; --ink: #22303c; --soft: #51606d;
  --line: #d5dbe1; --reference: #b9c2cb; --ours: #0072b2; --other: #b35900; --good: #00664a;
  --bad: #b03a00; --shade: #f4f6f8; }
@media (prefers-color-scheme: dark) { :root { --paper: #14191e; --ink: #e3e9ee; --soft: #a5b2bd;
  --line: #38434d; --reference: #66737f; --ours: #56b4e9; --other: #e69f00; --good: #4cc9a2;
  --bad: #ff9b66; --shade: #1c2329; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper);
  max-width: 76rem; margin: 0 auto; padding: 1rem 1.25rem 4rem; }
h1 { font-size: 1.7rem; } h2 { font-size: 1.25rem; margin-top: 3rem; }
h2, nav li { scroll-margin-top: 1rem; } a { color: var(--ours); }
.source, figcaption, td.reason { color: var(--soft); }
.scroll { overflow-x: auto; } table { border-collapse: collapse; width: 100%; font-size: .875rem; }
th, td { text-align: left; vertical-align: top; padding: .35rem .6rem;
  border-bottom: 1px solid var(--line); }
thead th { background: var(--shade); } tbody th { font-weight: 400; min-width: 14rem; }
th.number, td.number { text-align: right; }
td.number { font-variant-numeric: tabular-nums; }
td.reason { min-width: 16rem; } .passed { color: var(--good); } .failed { color: var(--bad);
  font-weight: 700; }
figure { margin: 1.5rem 0; } figure svg { width: 100%; max-width: 52rem; height: auto; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(30rem, 100%), 1fr));
  gap: 0 2rem; }
:focus-visible { outline: 2px solid var(--ours); outline-offset: 2px; }
@media print { body { max-width: none; } h2 { break-after: avoid; }
  figure { break-inside: avoid; } }
"""


def run_case(case: Case, progress: Progress) -> Result:
    """Runs a case; one that breaks down is a failure, so that the others still run."""
    try:
        return case.run(progress)
    except Exception as error:
        nothing = float("nan")
        broken = Comparison(
            case=case.name,
            quantity="the run itself",
            unit="",
            reference=nothing,
            ours=nothing,
            difference=nothing,
            tolerance=0.0,
            measure="",
            reason=f"It broke down: {type(error).__name__}: {error}",
        )
        return Result(comparisons=(broken,))


def _number_text(value: float) -> str:
    """A number for people: six digits of values."""
    return f"{value:.6g}"


def _small_text(value: float) -> str:
    """A difference or a tolerance: three digits."""
    return f"{value:.3g}"


def comparison_table(comparisons: Sequence[Comparison]) -> Table:
    """The comparisons as a table for the terminal."""
    table = Table(show_lines=False, pad_edge=False)
    for title in ("case", "quantity"):
        table.add_column(title, overflow="fold")
    for title in ("reference", "ours", "difference", "tolerance"):
        table.add_column(title, justify="right", overflow="fold")
    table.add_column("", no_wrap=True)
    table.add_column("reason", overflow="fold", style="dim")
    before = ""
    for item in comparisons:
        # As plain text: a message may hold brackets, which markup would take for its own.
        cells = (
            "" if item.case == before else item.case,
            item.quantity,
            _with_unit(_number_text(item.reference), item.unit),
            _with_unit(_number_text(item.ours), item.unit),
            _with_unit(_small_text(item.difference), item.measure),
            _small_text(item.tolerance),
        )
        verdict = Text("passed", "green") if item.passed else Text("FAILED", "bold red")
        table.add_row(*map(Text, cells), verdict, Text(item.reason))
        before = item.case
    return table


def _with_unit(text: str, unit: str) -> str:
    return f"{text} {unit}".rstrip()


def report_page(results: Sequence[tuple[Case, Result]], version: str) -> str:
    """One self-contained HTML page with every table and figure.

    Args:
        results: Cases that ran, with what they found.
        version: Of the program.
    """
    failed = sum(not result.passed for _, result in results)
    count = sum(len(result.comparisons) for _, result in results)
    verdict = "all passed" if failed == 0 else f"{failed} failed"
    links = "\n".join(
        f'<li><a href="#{escape(case.name)}">{escape(case.title)}</a> {_mark(result.passed)}</li>'
        for case, result in results
    )
    sections = "\n".join(_section(case, result) for case, result in results)
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Verification of trainbridge {escape(version)}</title>
<style>{_CSS}</style>
</head>
<body>
<header>
<h1>Verification of trainbridge {escape(version)}</h1>
<p>{len(results)} cases with {count} comparisons: {verdict}. Every quantity is computed twice:
by the solver, and by a closed form, a semi-analytical solution, a print of the thesis, or another
formulation or mesh, as its row says.</p>
</header>
<nav aria-label="Cases"><ol>
{links}
</ol></nav>
<main>
{sections}
</main>
</body>
</html>
"""


def _mark(passed: bool) -> str:
    return '<span class="passed">passed</span>' if passed else '<span class="failed">failed</span>'


def _section(case: Case, result: Result) -> str:
    rows = "\n".join(_row(item) for item in result.comparisons)
    figures = "\n".join(
        _figure(figure, f"{case.name}-{index}") for index, figure in enumerate(result.figures)
    )
    name = escape(case.name)
    return f"""<section aria-labelledby="{name}">
<h2 id="{name}">{escape(case.title)} {_mark(result.passed)}</h2>
<p class="source">{escape(case.source)}. Run it alone: <code>trainbridge verify {name}</code></p>
<div class="scroll" role="region" tabindex="0" aria-labelledby="{name}">
<table>
<thead><tr><th scope="col">Quantity</th><th scope="col" class="number">Reference</th>
<th scope="col" class="number">Ours</th><th scope="col" class="number">Difference</th>
<th scope="col" class="number">Tolerance</th><th scope="col">Result</th>
<th scope="col">Reason for the tolerance</th></tr></thead>
<tbody>
{rows}
</tbody>
</table>
</div>
<div class="figures">
{figures}
</div>
</section>"""


def _row(item: Comparison) -> str:
    cells = (
        _with_unit(_number_text(item.reference), item.unit),
        _with_unit(_number_text(item.ours), item.unit),
        _with_unit(_small_text(item.difference), item.measure),
        _small_text(item.tolerance),
    )
    numbers = "".join(f'<td class="number">{escape(cell)}</td>' for cell in cells)
    return (
        f'<tr><th scope="row">{escape(item.quantity)}</th>{numbers}'
        f'<td>{_mark(item.passed)}</td><td class="reason">{escape(item.reason)}</td></tr>'
    )


def _figure(figure: Figure, name: str) -> str:
    caption = escape(figure.title) + (f". {escape(figure.note)}" if figure.note else "")
    return f"<figure>{_drawing(figure, name)}<figcaption>{caption}</figcaption></figure>"


def _drawing(figure: Figure, name: str) -> str:
    """The figure as inline SVG."""
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure as Sheet

    with mpl.rc_context(_STYLE):
        sheet: Any = Sheet(figsize=_SIZE, layout="constrained", facecolor=_PAPER)
        FigureCanvasSVG(sheet)
        axes = sheet.add_subplot(facecolor=_PAPER)
        used: dict[str, int] = {}
        # The reference lies below ours, so that both are seen where they agree.
        for series in sorted(figure.series, key=lambda curve: list(_PENS).index(curve.role)):
            pens = _PENS[series.role]
            color, dashes, width = pens[used.setdefault(series.role, 0) % len(pens)]
            used[series.role] += 1
            stride = -(-len(series.x) // _MOST_POINTS)
            axes.plot(
                np.asarray(series.x)[::stride], np.asarray(series.y)[::stride], label=series.name,
                color=color, linestyle=dashes, linewidth=width,
            )  # fmt: skip
        axes.set_xlabel(figure.x_label)
        axes.set_ylabel(figure.y_label)
        axes.grid(True, color=_INK, alpha=0.15, linewidth=0.6)
        sheet.legend(loc="outside upper center", ncols=3, handlelength=2.5)
        buffer = StringIO()
        sheet.savefig(buffer, format="svg", metadata={"Date": None})
    return _inlined(buffer.getvalue(), figure, name)


def _inlined(text: str, figure: Figure, name: str) -> str:
    """SVG for inside a page: own identifiers, the page's colours, a name for screen readers."""
    drawing = text[text.index("<svg") :]
    drawing = re.sub(r"<metadata>.*?</metadata>", "", drawing, flags=re.S)
    drawing = re.sub(r'\bid="([^"]+)"', rf'id="{name}-\1"', drawing)
    drawing = re.sub(r"url\(#([^)]+)\)", rf"url(#{name}-\1)", drawing)
    drawing = re.sub(r'href="#([^"]+)"', rf'href="#{name}-\1"', drawing)
    for placeholder, variable in _VARIABLES.items():
        drawing = drawing.replace(placeholder, variable)
    # Text is drawn in the page's own fonts.
    drawing = drawing.replace("<svg ", f'<svg role="img" aria-label="{escape(figure.title)}" ', 1)
    return re.sub(r"(<svg [^>]*?) (?:width|height)=\"[^\"]*pt\"", r"\1", drawing, count=2)
