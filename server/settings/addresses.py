"""What an address may be: of the engine, the database, a Slurm limit. Pure, and the words why not.

Each check gives None for a value that can be used, else ``(reason, remedy)``.
"""

from __future__ import annotations

import re
from ipaddress import ip_address
from urllib.parse import urlsplit

__all__ = [
    "ENGINES",
    "Trouble",
    "database_trouble",
    "engine_trouble",
    "is_loopback",
    "memory_trouble",
    "scheduler_address",
    "walltime_trouble",
    "without_secrets",
]

Trouble = tuple[str, str]
"""Why a value cannot be used, and what to do."""

ENGINES = ("local", "dask", "slurm")
"""Engines that have a name; the others are addresses of a Dask scheduler."""
_SCHEMES = ("tcp", "tls")
_DATABASES = ("sqlite", "postgresql", "postgresql+psycopg")
_WALLTIME = re.compile(r"(\d+-)?\d{1,3}:\d{2}:\d{2}")
_MEMORY = re.compile(r"\d+(\.\d+)? ?[kKMGT]i?B")


def is_loopback(host: str) -> bool:
    """Whether an address or host name can only be reached from this machine."""
    if host == "localhost":
        return True
    try:
        return ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def scheduler_address(engine: str) -> tuple[str, str, int] | None:
    """Scheme, host and port of a scheduler's address; None for what is none."""
    try:
        parts = urlsplit(engine)
        host, port = parts.hostname, parts.port
    except ValueError:
        return None
    rest = parts.path or parts.query or parts.fragment or parts.username or parts.password
    if parts.scheme not in _SCHEMES or not host or not port or rest:
        return None
    return parts.scheme, host, port


def engine_trouble(engine: str) -> Trouble | None:
    """Whether an engine's name or address is one."""
    if engine in ENGINES or scheduler_address(engine) is not None:
        return None
    return (
        "is not an engine",
        "Choose local (processes on this machine), dask (workers on this machine), slurm (jobs of "
        "a cluster), or the address of a Dask scheduler: tls://HOST:PORT or tcp://HOST:PORT",
    )


def database_trouble(url: str) -> Trouble | None:
    """Whether a database's URL names one that is supported; empty is the data folder's."""
    scheme, separator, rest = url.partition("://")
    if not url or (separator and scheme in _DATABASES and rest):
        return None
    return (
        "is not a database that is supported",
        "Leave it empty for SQLite in the data folder, or give postgresql://USER@HOST/NAME or "
        "sqlite:////ABSOLUTE/PATH",
    )


def walltime_trouble(text: str) -> Trouble | None:
    """Whether a time limit is written as Slurm takes it."""
    if _WALLTIME.fullmatch(text):
        return None
    return "is not a time limit of Slurm", "Write hours, minutes, seconds, for example 24:00:00"


def memory_trouble(text: str) -> Trouble | None:
    """Whether an amount of memory is written with its unit."""
    if _MEMORY.fullmatch(text):
        return None
    return "is not an amount of memory", "Write a number and a unit, for example 8GB"


def without_secrets(url: str) -> str:
    """A URL that can be shown: its password, and what its query may hide, are starred out.

    A password that should have been escaped may hold any character: all to the last @ is hidden.
    """
    if "://" not in url:
        return url
    shown = re.sub(r"(?s)(?<=://)([^:@]*):.*@", r"\1:***@", url)
    return re.sub(r"(?i)([?&][^=&]*(?:pass|secret|token|key)[^=&]*=)[^&]*", r"\1***", shown)
