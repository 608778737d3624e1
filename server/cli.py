"""The command line: what commands there are. What one needs is imported when it runs.

Servers: serve, coordinator, scheduler, worker. Jobs of a server: submit, jobs, watch, cancel.
Without one: run, templates, verify. Upkeep: config, migrate, clean.
"""

from __future__ import annotations

import typer

from server.commands import local, maintenance, remote, serving, verification
from server.jobs.environment import single_threaded

__all__ = ["app", "main"]

app = typer.Typer(
    name="trainbridge",
    help="Dynamic interaction of train, track and bridge.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

for command in (
    serving.serve,
    remote.submit,
    remote.jobs,
    remote.watch,
    remote.cancel,
    local.run,
    local.templates,
    verification.verify,
    serving.coordinator,
    serving.scheduler,
    serving.worker,
    maintenance.config,
    maintenance.migrate,
    maintenance.clean,
):
    app.command()(command)


def main() -> None:
    """Runs the command line."""
    # Before numpy is loaded: `trainbridge run` computes in this very process.
    single_threaded()
    app()
