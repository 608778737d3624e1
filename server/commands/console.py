"""How commands talk to people: errors on the standard error stream, one status for each kind."""

from __future__ import annotations

import os
import sys
from collections.abc import Generator, Iterable
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, Protocol

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

if TYPE_CHECKING:
    from server.client import TrainbridgeClient
    from server.settings import ReadSettings

__all__ = [
    "ERRORS",
    "Kind",
    "client_of",
    "fail",
    "print_findings",
    "progress_bar",
    "read_file",
    "settings_of",
    "wide_console",
]

ERRORS = Console(stderr=True)
UNUSABLE = 2
"""Exit status where what was given cannot be used; 1 for every other failure."""


class Kind(StrEnum):
    """What is computed of a study."""

    CROSSING = "crossing"
    MODES = "modes"


class _Finding(Protocol):
    pointer: str
    value: str
    reason: str
    remedy: str


def fail(message: str, status: int = 1) -> NoReturn:
    """Says what went wrong and ends the command."""
    ERRORS.print(message, style="red", markup=False, highlight=False, soft_wrap=True)
    raise typer.Exit(status)


def print_findings(title: str, findings: Iterable[Any]) -> NoReturn:
    """Says each thing that is wrong with what was given, and ends the command."""
    ERRORS.print(f"{title}:", style="red", markup=False)
    shown: Iterable[_Finding] = findings
    for item in shown:
        place = item.pointer or "the file"
        ERRORS.print(f"  {place} = {item.value}", markup=False, highlight=False, soft_wrap=True)
        ERRORS.print(
            f"      {item.reason}. {item.remedy}", markup=False, highlight=False, soft_wrap=True
        )
    raise typer.Exit(UNUSABLE)


def read_file(path: Path) -> bytes:
    """A file's bytes, of the standard input for ``-``."""
    try:
        return sys.stdin.buffer.read() if str(path) == "-" else path.read_bytes()
    except OSError as error:
        fail(f"{path} cannot be read: {error.strerror}.")


def progress_bar() -> Progress:
    """A bar with percentage, time left (field ``left``) and time taken."""
    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %  {task.fields[left]}"),
        TimeElapsedColumn(),
        console=ERRORS,
    )


def wide_console() -> Console:
    """The standard output; into a file or a pipe nobody measures the window."""
    return Console(width=None if sys.stdout.isatty() else 200, markup=False, highlight=False)


def settings_of(*, config: Path | None, listens: bool = False, **given: Any) -> ReadSettings:
    """Settings from the command line, the environment and the file; ends the command on errors."""
    from server.settings import SettingsError, read_settings

    token_file = given.pop("token_file", None)
    try:
        return read_settings(
            os.environ, token_file=token_file, config=config, overrides=given, listens=listens
        )
    except SettingsError as error:
        fail(str(error))


@contextmanager
def client_of(server: str | None) -> Generator[TrainbridgeClient]:
    """A client; what goes wrong while it is used ends the command with a line or its findings."""
    from server.client import ClientError, ProblemError, TrainbridgeClient

    try:
        with TrainbridgeClient.from_environment(server) as client:
            yield client
    except ProblemError as error:
        if error.findings:
            print_findings(error.problem.title, error.findings)
        hint = " Set it in TRAINBRIDGE_TOKEN." if error.status == 401 else ""
        fail(f"{error}{hint}")
    except ClientError as error:
        fail(str(error))
