"""Every setting of the server, as one frozen object.

Nothing reads the environment at import time: ``Settings.from_environment`` is called once, by the
command line, and the result is passed to ``create_app``. Intervals are settings so that tests can
shorten them.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from ipaddress import ip_address
from pathlib import Path
from typing import Any

__all__ = ["Limits", "Settings", "SettingsError", "is_loopback"]

_MEBIBYTE = 1024 * 1024


class SettingsError(Exception):
    """A setting that cannot be used; the text says what to do."""


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

    runs_per_job: int = 500
    queued_jobs: int = 1000
    steps_per_job: int = 100_000_000
    memory_fraction: float = 0.8
    disk_fraction: float = 0.8
    body_bytes: int = 4 * _MEBIBYTE
    batch_seconds: float = 24 * 3600.0
    batch_bytes: int = 0
    pending_figures: int = 8
    plot_points: int = 20_000
    event_streams: int = 200


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Settings of one server.

    Attributes:
        data: Folder of the database and of every run's arrays.
        host: Address to listen on.
        port: Port to listen on.
        token: Shared secret; empty for none, which only a loopback address allows.
        allowed_hosts: Names besides loopback that the ``Host`` header may carry.
        concurrent_batches: Processes that compute at once.
        limits: What is accepted.
        progress_seconds: Least time between two progress reports of a run. [s]
        heartbeat_seconds: Silence after which an event stream sends a comment. [s]
        grace_seconds: Time between asking a process to end and killing it. [s]
        poll_seconds: How often memory and wall-clock time of processes are looked at. [s]
        figure_seconds: Time that one figure may take to draw. [s]
    """

    data: Path = field(default_factory=lambda: Path("trainbridge-data"))
    host: str = "127.0.0.1"
    port: int = 8000
    token: str = field(default="", repr=False)
    allowed_hosts: tuple[str, ...] = ()
    concurrent_batches: int = field(default_factory=lambda: max(1, min(2, os.cpu_count() or 1)))
    limits: Limits = field(default_factory=Limits)
    progress_seconds: float = 0.1
    heartbeat_seconds: float = 15.0
    grace_seconds: float = 2.0
    poll_seconds: float = 0.25
    figure_seconds: float = 60.0

    @classmethod
    def from_environment(
        cls,
        environment: Mapping[str, str],
        *,
        token_file: Path | None = None,
        **overrides: Any,
    ) -> Settings:
        """Settings from ``TRAINBRIDGE_...`` variables and from the command line, checked.

        Args:
            environment: Usually ``os.environ``.
            token_file: A file that holds the token; it wins over ``TRAINBRIDGE_TOKEN``.
            overrides: Fields given on the command line; ``None`` means not given.

        Raises:
            SettingsError: The token file cannot be read, or the host needs a token.
        """
        token = environment.get("TRAINBRIDGE_TOKEN", "").strip()
        if token_file is not None:
            token = _read_token(token_file)
        given = {name: value for name, value in overrides.items() if value is not None}
        settings = replace(cls(token=token), **given)
        settings.require_safe_host()
        return settings

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


def is_loopback(host: str) -> bool:
    """Whether an address or host name can only be reached from this machine."""
    if host == "localhost":
        return True
    try:
        return ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def _read_token(path: Path) -> str:
    try:
        token = path.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f"The token file {path} cannot be read: {error}.") from error
    if not token:
        raise SettingsError(f"The token file {path} is empty. Put the token on its first line.")
    return token
