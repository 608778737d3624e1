"""Commands that talk to a server: submit, jobs, watch, cancel."""

from __future__ import annotations

import json
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from server.commands.console import (
    ERRORS,
    UNUSABLE,
    Kind,
    client_of,
    fail,
    progress_bar,
    read_file,
    wide_console,
)
from server.jobs.states import State

if TYPE_CHECKING:
    from server.client import TrainbridgeClient
    from server.routes.schemas import Job, StateName

__all__ = ["cancel", "jobs", "submit", "watch"]

Server = Annotated[
    str | None,
    typer.Option(help="Address of the server; TRAINBRIDGE_SERVER, or http://127.0.0.1:8000."),
]
JobId = Annotated[str, typer.Argument(help="The job's id, as `trainbridge jobs` lists it.")]


def submit(
    study: Annotated[Path, typer.Argument(help="Study as JSON; - reads the standard input.")],
    server: Server = None,
    kind: Annotated[Kind, typer.Option(help="What to compute.")] = Kind.CROSSING,
    priority: Annotated[int, typer.Option(help="Greater ones begin first.")] = 0,
    key: Annotated[
        str | None, typer.Option(help="Idempotency key: the same key makes one job.")
    ] = None,
    wait: Annotated[bool, typer.Option("--wait", help="Follow the job to its end.")] = False,
) -> None:
    """Submit a study to a server, and print the job's id."""
    document = _study(study)
    with client_of(server) as client:
        job = client.submit(document, kind=kind.value, priority=priority, key=key)
        typer.echo(job.id)
        if wait:
            _follow(client, job.id)


def jobs(
    server: Server = None,
    state: Annotated[
        list[State] | None, typer.Option(help="Only jobs in this state; may repeat.")
    ] = None,
    name: Annotated[str | None, typer.Option(help="Only jobs whose name contains this.")] = None,
    limit: Annotated[int, typer.Option(min=1, help="Jobs at most, the newest.")] = 20,
    as_json: Annotated[bool, typer.Option("--json", help="Print as JSON.")] = False,
) -> None:
    """List the jobs of a server, newest first."""
    states = cast("list[StateName]", [item.value for item in state or ()])
    with client_of(server) as client:
        found = list(islice(client.jobs(states=states, name=name, page=min(limit, 200)), limit))
    if as_json:
        typer.echo(json.dumps([job.model_dump(mode="json") for job in found], indent=2))
        return
    from rich.table import Table

    table = Table("job", "state", "progress", "runs", "submitted", "name", box=None, pad_edge=False)
    for job in found:
        table.add_row(
            job.id, job.state, _progress(job), str(len(job.runs)), job.created[:19], job.name
        )
    wide_console().print(table)


def watch(job: JobId, server: Server = None) -> None:
    """Follow a job to its end."""
    with client_of(server) as client:
        _follow(client, job)


def cancel(job: JobId, server: Server = None) -> None:
    """Cancel a job: what waits does not begin, what computes ends."""
    with client_of(server) as client:
        before = client.job(job)
        if before.state not in (State.QUEUED, State.RUNNING):
            typer.echo(f"The job is {before.state} already.")
            return
        client.cancel(job)
        typer.echo(f"Cancelling {job}.")


def _study(path: Path) -> dict[str, Any]:
    """A study as JSON; what it holds is the server's to judge."""
    from server.errors import Problem
    from server.jobs.strict_json import read_json

    try:
        document = read_json(read_file(path))
    except Problem as problem:
        fail(f"{path}: {problem.detail}", UNUSABLE)
    if not isinstance(document, dict):
        fail(f"{path} holds no study: a study is a JSON object.", UNUSABLE)
    return document  # pyright: ignore[reportUnknownVariableType]


def _follow(client: TrainbridgeClient, job: str) -> None:
    """Shows a job's progress until it has ended, and ends the command as the job did."""
    last: Job | None = None
    with progress_bar() as bar:
        task = bar.add_task("waiting", total=1.0, left="")
        for event in client.watch(job):
            if event.job is None:
                continue
            last = event.job
            progress = last.progress
            remaining = progress.remaining if progress and not event.is_end else None
            bar.update(
                task,
                completed=1.0 if last.state == "done" else (progress.fraction if progress else 0.0),
                description=_stage(last),
                left=f"{remaining[1]:.0f} s left" if remaining else "",
            )
    if last is None or last.state != "done":
        reason = f": {last.error.detail}" if last is not None and last.error else "."
        fail(f"The job is {last.state if last else 'gone'}{reason}")
    _print_verdicts(client, last)


def _stage(job: Job) -> str:
    if job.state == "queued":
        return f"waiting, {job.position or 0} before it"
    return job.progress.stage if job.state == "running" and job.progress else job.state


def _progress(job: Job) -> str:
    return f"{100 * job.progress.fraction:.0f} %" if job.progress else ""


def _print_verdicts(client: TrainbridgeClient, job: Job) -> None:
    for verdict in client.verdicts(job.id).items:
        typer.echo(str(verdict.get("statement", "")))
    ERRORS.print(f"Results: {client.url}/api/v1/jobs/{job.id}", markup=False, highlight=False)
