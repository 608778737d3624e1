"""Commands that stay: the web server, the coordinator, a scheduler, a worker."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from server.commands.console import fail, settings_of

__all__ = ["coordinator", "scheduler", "serve", "worker"]

Config = Annotated[
    Path | None,
    typer.Option(
        "--config",
        help="TOML file of settings; else trainbridge.toml, where there is one.",
    ),
]
Data = Annotated[
    Path | None, typer.Option(help="Folder of the queue and of all results.", show_default=False)
]
DatabaseUrl = Annotated[
    str | None, typer.Option(help="URL of the database; SQLite in the data folder otherwise.")
]
Store = Annotated[
    str | None, typer.Option(help="URL or folder of the results; the data folder otherwise.")
]
Engine = Annotated[
    str | None,
    typer.Option(help="Where runs compute: local, dask, slurm, tcp://HOST:PORT, tls://HOST:PORT."),
]
Insecure = Annotated[
    bool | None,
    typer.Option(
        "--allow-insecure-scheduler",
        help="Take a scheduler without TLS over the network: who reaches it runs any code.",
        show_default=False,
    ),
]
Processes = Annotated[int | None, typer.Option(min=1, help="Processes that compute at once.")]


def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on.")] = None,
    port: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Port to listen on; 0 for a free one.")
    ] = None,
    data: Data = None,
    token_file: Annotated[
        Path | None, typer.Option(help="File that holds the token, instead of TRAINBRIDGE_TOKEN.")
    ] = None,
    allowed_host: Annotated[
        list[str] | None, typer.Option(help="Name that browsers use for this server; may repeat.")
    ] = None,
    config: Config = None,
    engine: Engine = None,
    database: DatabaseUrl = None,
    store: Store = None,
    coordinator: Annotated[
        bool | None,
        typer.Option(
            "--coordinator/--no-coordinator",
            help="Hand out the runs here, or leave it to `trainbridge coordinator`.",
        ),
    ] = None,
    concurrent_batches: Processes = None,
    allow_insecure_scheduler: Insecure = None,
) -> None:
    """Serve the dashboard and the API."""
    read = settings_of(
        config=config,
        listens=True,
        token_file=token_file,
        host=host,
        port=port,
        data=data,
        allowed_hosts=tuple(allowed_host) if allowed_host else None,
        engine=engine,
        database=database,
        store=store,
        coordinator=coordinator,
        concurrent_batches=concurrent_batches,
        allow_insecure_scheduler=allow_insecure_scheduler,
    )
    from server.app import StartError, serve_until_stopped

    try:
        serve_until_stopped(read.settings)
    except StartError as error:
        fail(str(error))


def coordinator(
    data: Data = None,
    config: Config = None,
    engine: Engine = None,
    database: DatabaseUrl = None,
    store: Store = None,
    concurrent_batches: Processes = None,
    allow_insecure_scheduler: Insecure = None,
) -> None:
    """Hand out the runs of the queue, for servers started with --no-coordinator."""
    read = settings_of(
        config=config,
        data=data,
        engine=engine,
        database=database,
        store=store,
        concurrent_batches=concurrent_batches,
        allow_insecure_scheduler=allow_insecure_scheduler,
    )
    from server.coordinate import StartError, run_coordinator

    try:
        run_coordinator(read.settings)
    except StartError as error:
        fail(str(error))


def scheduler(
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port to listen on.")] = 8786,
    config: Config = None,
    allow_insecure_scheduler: Insecure = None,
) -> None:
    """Start a Dask scheduler for workers and one coordinator."""
    read = settings_of(config=config, allow_insecure_scheduler=allow_insecure_scheduler)
    from server.jobs.dask_nodes import run_scheduler
    from server.jobs.engine import EngineError

    try:
        run_scheduler(read.settings, host=host, port=port)
    except EngineError as error:
        fail(str(error))


def worker(
    scheduler: Annotated[
        str | None,
        typer.Option(help="tcp://HOST:PORT or tls://HOST:PORT; the setting engine otherwise."),
    ] = None,
    slots: Annotated[
        int | None,
        typer.Option(min=1, help="Runs that compute at once; the setting concurrent_batches."),
    ] = None,
    config: Config = None,
    allow_insecure_scheduler: Insecure = None,
) -> None:
    """Compute runs for a Dask scheduler."""
    # The scheduler's address is an engine: the same rules hold for it.
    read = settings_of(
        config=config,
        engine=scheduler,
        concurrent_batches=slots,
        allow_insecure_scheduler=allow_insecure_scheduler,
    )
    settings = read.settings
    if "://" not in settings.engine:
        fail(
            f"A worker needs the address of a scheduler, not the engine {settings.engine!r}. Give "
            "--scheduler tls://HOST:PORT (or tcp://HOST:PORT on this machine)."
        )
    from server.jobs.dask_nodes import run_worker
    from server.jobs.engine import EngineError

    try:
        run_worker(settings, scheduler=settings.engine, slots=settings.concurrent_batches)
    except EngineError as error:
        fail(str(error))
