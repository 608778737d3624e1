"""The command that compares the solver with closed forms and independent solutions."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from server.commands.console import ERRORS, fail, wide_console
from server.version import package_version

__all__ = ["verify"]


def verify(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME]...", help="Cases to run; all by default.")
    ] = None,
    fast: Annotated[bool, typer.Option("--fast", help="Only cases that take seconds.")] = False,
    report: Annotated[
        Path | None, typer.Option(help="Write an HTML page with tables and figures to this file.")
    ] = None,
) -> None:
    """Compare the solver with closed forms and independent solutions."""
    from server.verify import comparison_table, report_page
    from solver.errors import InputError
    from solver.verification import case, cases

    try:
        chosen = [case(name) for name in dict.fromkeys(names)] if names else list(cases())
    except InputError as error:
        fail(f"{error.value}: {error.reason}. {error.remedy}")
    if fast:
        chosen = [item for item in chosen if item.weight == "fast"]
        if not chosen:
            fail("None of these cases is a fast one. Run them without --fast.")
    if report is not None:
        _require_writable(report)
    results = _verified(chosen)
    found = [row for _, result in results for row in result.comparisons]
    wide_console().print(comparison_table(found))
    failed = [item.name for item, result in results if not result.passed]
    if report is not None:
        _write(report, report_page(results, package_version()))
    if failed:
        fail(f"{len(failed)} of {len(results)} cases failed: {', '.join(failed)}.")
    typer.echo(f"All {len(results)} cases passed, {len(found)} comparisons.")


def _require_writable(report: Path) -> None:
    """Refuses a report that could not be written, before any case runs."""
    folder = report.absolute().parent
    if not folder.is_dir():
        fail(f"{report} cannot be written: its folder does not exist.")
    if report.is_dir():
        fail(f"{report} cannot be written: it is a folder. Name a file in it.")
    if not os.access(report if report.exists() else folder, os.W_OK):
        fail(f"{report} cannot be written: no permission. Choose another place.")


def _verified(chosen: list[Any]) -> list[tuple[Any, Any]]:
    """Runs the cases, with a bar for each."""
    from server.verify import run_case

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    results: list[tuple[Any, Any]] = []
    with Progress(*columns, console=ERRORS) as bar:
        for item in chosen:
            task = bar.add_task(item.name, total=1.0)

            def report(fraction: float, task: Any = task) -> None:
                bar.update(task, completed=fraction)

            results.append((item, run_case(item, report)))
            bar.update(task, completed=1.0)
    return results


def _write(file: Path, text: str) -> None:
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        fail(f"{file} cannot be written: {error.strerror}.")
    typer.echo(f"Report: {file}")
