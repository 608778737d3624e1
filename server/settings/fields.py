"""The settings as frozen objects: what each means, its default, and its bounds.

Intervals are settings so that tests can shorten them. The attribute docstrings are what
``trainbridge config`` prints.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from annotated_types import Ge, Gt, Interval, Le

from server.settings.addresses import (
    database_trouble,
    engine_trouble,
    is_loopback,
    memory_trouble,
    scheduler_address,
    walltime_trouble,
)
from server.settings.sources import Check, SettingsError

__all__ = ["DATABASE_NAME", "LARGEST_PRIORITY", "Limits", "Settings"]

DATABASE_NAME = "trainbridge.sqlite"
"""Name of the database in the data folder."""

LARGEST_PRIORITY = 100
"""Priorities of jobs lie between this and its negative."""

_MEBIBYTE = 1024 * 1024

Count = Annotated[int, Ge(1)]
Bytes = Annotated[int, Ge(0)]
Seconds = Annotated[float, Gt(0.0)]
Share = Annotated[float, Gt(0.0), Le(1.0)]


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What the server accepts; beyond it a study is refused with the limit in the message.

    Attributes:
        runs_per_job: Runs of one job.
        queued_jobs: Jobs that wait at once.
        steps_per_job: Time steps of all runs of one job.
        memory_fraction: Share of the free memory that one batch may take.
        disk_fraction: Share of the free disk that one job may take.
        body_bytes: Size of a request body, counted while it streams. [B]
        batch_seconds: Wall-clock time of one batch. [s]
        batch_bytes: Resident memory of one batch, 0 for ``memory_fraction`` of what is free when
            it starts. [B]
        pending_figures: Figures that wait for the drawing process.
        plot_points: Points of one curve in an answer.
        event_streams: Event streams that are open at once.
    """

    runs_per_job: Count = 500
    queued_jobs: Count = 1000
    steps_per_job: Count = 100_000_000
    memory_fraction: Share = 0.8
    disk_fraction: Share = 0.8
    body_bytes: Count = 4 * _MEBIBYTE
    batch_seconds: Seconds = 24 * 3600.0
    batch_bytes: Bytes = 0
    pending_figures: Count = 8
    plot_points: Annotated[int, Ge(2)] = 20_000
    event_streams: Count = 200


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Settings of one server.

    Attributes:
        data: Folder of the lock, and of database and results where these are not set otherwise.
        database: URL of the database; empty for SQLite in the data folder.
        store: URL or folder of every run's arrays; empty for the data folder.
        engine: Where runs compute: local, dask, slurm, tcp://HOST:PORT or tls://HOST:PORT.
        coordinator: Whether ``trainbridge serve`` starts the one process that hands out runs;
            false where ``trainbridge coordinator`` is started separately.
        allow_insecure_scheduler: Whether a scheduler without TLS may be used over the network:
            whoever reaches its port can run any code on every worker.
        tls_ca_file: Certificate authority of a tls:// scheduler.
        tls_cert_file: Our certificate for a tls:// scheduler.
        tls_key_file: Our private key for a tls:// scheduler.
        host: Address to listen on.
        port: Port to listen on; 0 for a free one.
        token: Shared secret; empty for none, which only a loopback address allows.
        allowed_hosts: Names besides loopback that the ``Host`` header may carry.
        concurrent_batches: Processes that compute at once, with the engines local and dask.
        slurm_jobs: Jobs of Slurm that are kept running.
        slurm_partition: Partition of Slurm; empty for its default.
        slurm_account: Account that Slurm charges; empty for its default.
        slurm_walltime: Time limit of one job of Slurm.
        slurm_cores: Cores of one job of Slurm.
        slurm_memory: Memory of one job of Slurm.
        limits: What is accepted.
        attempts_limit: Times that a run's own process may die without a new checkpoint between
            before the run fails.
        quota_bytes: Disk that all jobs together may take; 0 for no limit but the disk's. [B]
        retention_days: Days after which a job that ended is removed; 0 for never. [d]
        checkpoint_seconds: Time between two checkpoints of a run. [s]
        progress_seconds: Least time between two progress reports of a run. [s]
        heartbeat_seconds: Silence after which an event stream sends a comment. [s]
        event_poll_seconds: How often a web process without the coordinator looks for events. [s]
        queue_poll_seconds: How often the coordinator looks for new jobs and requests. [s]
        engine_seconds: Time-out of each call to a scheduler. [s]
        grace_seconds: Time between asking a process to end and killing it. [s]
        poll_seconds: How often memory and wall-clock time of processes are looked at. [s]
        figure_seconds: Time that one figure may take to draw. [s]
    """

    data: Path = field(default_factory=lambda: Path("trainbridge-data"))
    database: Annotated[str, Check(database_trouble)] = ""
    store: str = ""
    engine: Annotated[str, Check(engine_trouble)] = "local"
    coordinator: bool = True
    allow_insecure_scheduler: bool = False
    tls_ca_file: Path | None = None
    tls_cert_file: Path | None = None
    tls_key_file: Path | None = None
    host: str = "127.0.0.1"
    port: Annotated[int, Interval(ge=0, le=65535)] = 8000
    token: str = field(default="", repr=False)
    allowed_hosts: tuple[str, ...] = ()
    concurrent_batches: Count = field(default_factory=lambda: max(1, min(2, os.cpu_count() or 1)))
    slurm_jobs: Count = 1
    slurm_partition: str = ""
    slurm_account: str = ""
    slurm_walltime: Annotated[str, Check(walltime_trouble)] = "24:00:00"
    slurm_cores: Count = 1
    slurm_memory: Annotated[str, Check(memory_trouble)] = "8GB"
    limits: Limits = field(default_factory=Limits)
    attempts_limit: Count = 3
    quota_bytes: Bytes = 0
    retention_days: Annotated[float, Ge(0.0)] = 0.0
    checkpoint_seconds: Seconds = 30.0
    progress_seconds: Seconds = 0.1
    heartbeat_seconds: Seconds = 15.0
    event_poll_seconds: Seconds = 0.05
    queue_poll_seconds: Seconds = 0.25
    engine_seconds: Seconds = 10.0
    grace_seconds: Seconds = 2.0
    poll_seconds: Seconds = 0.25
    figure_seconds: Seconds = 60.0

    @property
    def database_url(self) -> str:
        """Where the database is: the setting's URL, or the path of SQLite in the data folder.

        A path, for in a URL the folder's name could hold characters that mean something else.
        """
        return self.database or str(self.data / DATABASE_NAME)

    @property
    def store_url(self) -> str:
        """Where results are: the setting, or the data folder."""
        return self.store or str(self.data)

    @classmethod
    def from_environment(
        cls,
        environment: Mapping[str, str],
        *,
        token_file: Path | None = None,
        config: Path | None = None,
        **overrides: Any,
    ) -> Settings:
        """Settings from the command line, ``TRAINBRIDGE_...`` variables and a file, checked.

        Args:
            environment: Usually ``os.environ``.
            token_file: A file that holds the token; it wins over ``TRAINBRIDGE_TOKEN``.
            config: A TOML file of settings.
            overrides: Fields given on the command line; ``None`` means not given.

        Raises:
            SettingsError: A value cannot be used, or the host or scheduler is unsafe.
        """
        from server.settings.reading import read_settings

        return read_settings(
            environment, token_file=token_file, config=config, overrides=overrides
        ).settings

    def require_safe_host(self) -> None:
        """Refuses to listen to the network without a token.

        Raises:
            SettingsError: The host is not loopback and there is no token, or the token is short.
        """
        if self.token and len(self.token) < 16:
            raise SettingsError(
                "The token has fewer than 16 characters. Make one with: "
                'python -c "import secrets; print(secrets.token_urlsafe(32))"'
            )
        if is_loopback(self.host) or self.token:
            return
        raise SettingsError(
            f"Listening on {self.host} would let everyone on the network run jobs here. Set a "
            "token first, in the variable TRAINBRIDGE_TOKEN or in a file given with --token-file "
            '(python -c "import secrets; print(secrets.token_urlsafe(32))" makes one), and name '
            "the host that browsers will use with --allowed-host. Or keep to --host 127.0.0.1."
        )

    def require_safe_scheduler(self) -> None:
        """Refuses a scheduler that anyone on the network could use.

        Raises:
            SettingsError: It has no TLS and is not on this machine, or its certificates are
                missing.
        """
        address = scheduler_address(self.engine)
        if address is None:
            return
        scheme, host, _ = address
        if scheme == "tls":
            self.require_certificates()
        elif not is_loopback(host) and not self.allow_insecure_scheduler:
            raise SettingsError(
                f"engine = {self.engine}: a Dask scheduler without TLS runs whatever code anyone "
                "on the network sends to its port, on every worker. Use tls://HOST:PORT with "
                "tls_ca_file, tls_cert_file and tls_key_file. On a network that only you can "
                "reach, allow_insecure_scheduler = true permits it."
            )

    def require_certificates(self) -> None:
        """Refuses TLS without its three files.

        Raises:
            SettingsError: One is not set or cannot be found.
        """
        files = {
            "tls_ca_file": self.tls_ca_file,
            "tls_cert_file": self.tls_cert_file,
            "tls_key_file": self.tls_key_file,
        }
        for name, file in files.items():
            if file is None or not file.is_file():
                state = "is not set" if file is None else f"= {file} is not there"
                raise SettingsError(
                    f"{name} {state}: TLS needs tls_ca_file, tls_cert_file and tls_key_file, as "
                    f"PEM files that this process can read. Set it in {name} of the settings file "
                    f"or as TRAINBRIDGE_{name.upper()}."
                )
