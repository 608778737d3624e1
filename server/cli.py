"""The command line: serve, templates, run, verify.

What a command needs is imported when it runs: ``--help`` and ``templates`` answer at once.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from server.jobs.environment import single_threaded

__all__ = ["app", "main"]

app = typer.Typer(
    name="trainbridge",
    help="Dynamic interaction of train, track and bridge.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
_errors = Console(stderr=True)


def main() -> None:
    """Runs the command line."""
    # Before numpy is loaded: `trainbridge run` computes in this very process.
    single_threaded()
    app()


@app.command()
def serve(
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port to listen on.")] = 8000,
    data: Annotated[Path, typer.Option(help="Folder of the queue and of all results.")] = Path(
        "trainbridge-data"
    ),
    token_file: Annotated[
        Path | None, typer.Option(help="File that holds the token, instead of TRAINBRIDGE_TOKEN.")
    ] = None,
    allowed_host: Annotated[
        list[str] | None, typer.Option(help="Name that browsers use for this server; may repeat.")
    ] = None,
) -> None:
    """Serve the dashboard and the API."""
    from server.app import StartError, serve_until_stopped
    from server.settings import Settings, SettingsError

    try:
        settings = Settings.from_environment(
            os.environ,
            token_file=token_file,
            host=host,
            port=port,
            data=data.absolute(),
            allowed_hosts=tuple(allowed_host or ()),
        )
        serve_until_stopped(settings)
    except (SettingsError, StartError) as error:
        _fail(str(error))


@app.command()
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
        _fail(f"There is no template {name!r}. Choose one of {', '.join(found)}.")


@app.command()
def run(
    study: Annotated[Path, typer.Argument(help="Study as JSON; - reads the standard input.")],
    out: Annotated[Path, typer.Option(help="Folder for the results, new or empty.")],
) -> None:
    """Compute a study here, without any server."""
    from server.errors import Problem
    from server.jobs.strict_json import read_json
    from server.jobs.submission import Submission, admit, read_study
    from server.settings import Limits

    try:
        loaded = read_study(read_json(_read(study)))
        folder = _new_folder(out)
        admit(Submission(kind="crossing", study=loaded, path=()), Limits(), folder)
    except Problem as problem:
        _errors.print(f"{problem.title}:", style="red", markup=False)
        for item in problem.errors:
            place = item.pointer or "the file"
            _errors.print(f"  {place} = {item.value}", markup=False, highlight=False)
            _errors.print(f"      {item.reason}. {item.remedy}", markup=False, highlight=False)
        raise typer.Exit(2) from None
    _compute(loaded, folder)


@app.command()
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
        _fail(f"{error.value}: {error.reason}. {error.remedy}")
    if fast:
        chosen = [item for item in chosen if item.weight == "fast"]
        if not chosen:
            _fail("None of these cases is a fast one. Run them without --fast.")
    if report is not None:
        _require_writable(report)
    results = _verified(chosen)
    found = [row for _, result in results for row in result.comparisons]
    # Into a file or a pipe nobody measures the window: lines long enough to read.
    Console(width=None if sys.stdout.isatty() else 200).print(comparison_table(found))
    failed = [item.name for item, result in results if not result.passed]
    if report is not None:
        from server.routes.meta import package_version

        _write(report, report_page(results, package_version()))
    if failed:
        _fail(f"{len(failed)} of {len(results)} cases failed: {', '.join(failed)}.")
    typer.echo(f"All {len(results)} cases passed, {len(found)} comparisons.")


def _require_writable(report: Path) -> None:
    """Refuses a report that could not be written, before any case runs."""
    folder = report.absolute().parent
    if not folder.is_dir():
        _fail(f"{report} cannot be written: its folder does not exist.")
    if report.is_dir():
        _fail(f"{report} cannot be written: it is a folder. Name a file in it.")
    if not os.access(report if report.exists() else folder, os.W_OK):
        _fail(f"{report} cannot be written: no permission. Choose another place.")


def _verified(chosen: list[Any]) -> list[tuple[Any, Any]]:
    """Runs the cases, with a bar for each."""
    from server.verify import run_case

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    results: list[tuple[Any, Any]] = []
    with Progress(*columns, console=_errors) as bar:
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
        _fail(f"{file} cannot be written: {error.strerror}.")
    typer.echo(f"Report: {file}")


def _compute(study: Any, folder: Path) -> None:
    from server.jobs.worker import run_study
    from solver import studies
    from solver.errors import SolverError

    parameters = studies.runs_of(study)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %  {task.fields[left]}"),
        TimeElapsedColumn(),
    )
    for index, point in enumerate(parameters):
        target = folder if len(parameters) == 1 else folder / f"run-{index:03d}"
        with Progress(*columns, console=_errors) as bar:
            task = bar.add_task("starting", total=1.0, left="")

            def report(state: Mapping[str, Any], bar: Any = bar, task: Any = task) -> None:
                left = f"{state['remaining'][1]:.0f} s left" if state["remaining"] else ""
                bar.update(task, completed=state["fraction"], description=state["stage"], left=left)

            try:
                summary = run_study(study, index, target, report)
            except (SolverError, MemoryError) as error:
                _fail(f"The run failed: {error}")
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


def _read(path: Path) -> bytes:
    try:
        return sys.stdin.buffer.read() if str(path) == "-" else path.read_bytes()
    except OSError as error:
        _fail(f"{path} cannot be read: {error.strerror}.")


def _new_folder(folder: Path) -> Path:
    """Never empties what someone else wrote."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            _fail(f"{folder} is not empty. Give a new folder with --out.")
    except OSError as error:
        _fail(f"{folder} cannot be written: {error.strerror}. Give another one with --out.")
    return folder


def _fail(message: str) -> NoReturn:
    _errors.print(message, style="red", markup=False, highlight=False, soft_wrap=True)
    raise typer.Exit(1)
