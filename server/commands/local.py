"""Commands that need no server: templates, and a study computed here."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from server.commands.console import fail, print_findings, progress_bar, read_file

__all__ = ["run", "templates"]


def templates(
    name: Annotated[str | None, typer.Argument(help="Print this study as JSON.")] = None,
) -> None:
    """List the templates, or print one as a study."""
    from solver import studies

    found = studies.templates()
    if name is None:
        for template in found.values():
            typer.echo(f"{template.name:24} {template.title}")
    elif name in found:
        typer.echo(json.dumps(studies.to_json(found[name].study), indent=2, ensure_ascii=False))
    else:
        fail(f"There is no template {name!r}. Choose one of {', '.join(found)}.")


def run(
    study: Annotated[Path, typer.Argument(help="Study as JSON; - reads the standard input.")],
    out: Annotated[Path, typer.Option(help="Folder for the results, new or empty.")],
) -> None:
    """Compute a study here, without any server."""
    from server.errors import Problem
    from server.jobs.strict_json import read_json
    from server.jobs.submission import Capacity, Submission, admit, read_study
    from server.settings import Limits

    try:
        loaded = read_study(read_json(read_file(study)))
        folder = _new_folder(out)
        limits = Limits()
        submission = Submission(kind="crossing", study=loaded, path=())
        admit(submission, limits, Capacity.now(limits, folder))
    except Problem as problem:
        print_findings(problem.title, problem.errors)
    _compute(loaded, folder)


def _compute(study: Any, folder: Path) -> None:
    from server.jobs.worker import run_study
    from server.store import StoreError
    from solver import studies
    from solver.errors import SolverError

    parameters = studies.runs_of(study)
    for index, point in enumerate(parameters):
        target = folder if len(parameters) == 1 else folder / f"run-{index:03d}"
        with progress_bar() as bar:
            task = bar.add_task("starting", total=1.0, left="")

            def report(state: Mapping[str, Any], bar: Any = bar, task: Any = task) -> None:
                left = f"{state['remaining'][1]:.0f} s left" if state["remaining"] else ""
                bar.update(task, completed=state["fraction"], description=state["stage"], left=left)

            try:
                summary = run_study(study, index, target, report)
            except (SolverError, StoreError, MemoryError) as error:
                fail(f"The run failed: {error}")
            bar.update(task, completed=1.0, description="done", left="")
        _print_verdicts(summary, point)
        typer.echo(f"Results: {target / 'summary.json'}")


def _print_verdicts(summary: Mapping[str, Any], point: Mapping[str, float]) -> None:
    speed = point.get("speed")
    if speed is not None:
        typer.echo(f"Speed {3.6 * speed:.6g} km/h")
    for verdict in summary["verdicts"]:
        typer.echo(verdict["statement"])
        for note in verdict.get("notes", ()):
            typer.echo(f"  {note}")
    if not summary["verdicts"]:
        typer.echo(summary["unjudged"])


def _new_folder(folder: Path) -> Path:
    """Never empties what someone else wrote."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            fail(f"{folder} is not empty. Give a new folder with --out.")
    except OSError as error:
        fail(f"{folder} cannot be written: {error.strerror}. Give another one with --out.")
    return folder
