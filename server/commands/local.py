"""Commands that need no server: templates, and a study computed here."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from server.commands.console import Kind, fail, print_findings, progress_bar, read_file

__all__ = ["run", "templates"]


def templates(
    name: Annotated[str | None, typer.Argument(help="Print this study as JSON.")] = None,
) -> None:
    """List the templates, or print one as a study."""
    from solver import studies

    found = studies.templates()
    if name is None:
        for template in found.values():
            kind = "" if template.kind == "crossing" else f"  (--kind {template.kind})"
            typer.echo(f"{template.name:24} {template.title}{kind}")
    elif name in found:
        typer.echo(json.dumps(studies.to_json(found[name].study), indent=2, ensure_ascii=False))
    else:
        fail(f"There is no template {name!r}. Choose one of {', '.join(found)}.")


def run(
    study: Annotated[Path, typer.Argument(help="Study as JSON; - reads the standard input.")],
    out: Annotated[Path, typer.Option(help="Folder for the results, new or empty.")],
    kind: Annotated[Kind, typer.Option(help="What to compute.")] = Kind.CROSSING,
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
        submission = Submission(kind=kind.value, study=loaded, path=())
        admit(submission, limits, Capacity.now(limits, folder))
    except Problem as problem:
        print_findings(problem.title, problem.errors)
    if kind is Kind.MODES:
        _find_modes(loaded, folder)
    else:
        _compute(loaded, folder)


def _compute(study: Any, folder: Path) -> None:
    from server.jobs.worker import run_study
    from solver import studies

    parameters = studies.runs_of(study)
    for index, point in enumerate(parameters):
        target = folder if len(parameters) == 1 else folder / f"run-{index:03d}"
        summary = _shown(partial(run_study, study, index, target))
        _print_verdicts(summary, point)
        typer.echo(f"Results: {target / 'summary.json'}")


def _find_modes(study: Any, folder: Path) -> None:
    from server.jobs.worker import run_modes

    summary = _shown(partial(run_modes, study, folder))
    typer.echo("  mode  frequency [Hz]  damping [%]  shape")
    for mode in summary["modes"]:
        numbers = f"{mode['number']:6d}  {mode['frequency']:14.4g}  {100 * mode['damping']:11.3g}"
        typer.echo(f"{numbers}  {mode['name']}".rstrip())
    typer.echo(f"Results: {folder / 'summary.json'}")


def _shown(work: Callable[[Callable[[Mapping[str, Any]], None]], Mapping[str, Any]]) -> Any:
    """Does some work while a bar shows how far it is; it is given what takes its progress."""
    from server.store import StoreError
    from solver.errors import SolverError

    with progress_bar() as bar:
        task = bar.add_task("starting", total=1.0, left="")

        def report(state: Mapping[str, Any]) -> None:
            left = f"{state['remaining'][1]:.0f} s left" if state["remaining"] else ""
            bar.update(task, completed=state["fraction"], description=state["stage"], left=left)

        try:
            result = work(report)
        except (SolverError, StoreError, MemoryError) as error:
            fail(f"The run failed: {error}")
        bar.update(task, completed=1.0, description="done", left="")
    return result


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
