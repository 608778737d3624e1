"""The command line, in a process of its own or in this one: what it said, and its exit status."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from unittest.mock import patch

from server.__main__ import main

ROOT = Path(__file__).parents[2]


def trainbridge(*words: str, given: str = "", **variables: str) -> subprocess.CompletedProcess[str]:
    """A command as people start it: half a second of imports comes first."""
    return subprocess.run(
        [sys.executable, "-m", "server", *words],
        input=given,
        capture_output=True,
        text=True,
        timeout=300,
        cwd=ROOT,
        check=False,
        env=_environment(variables),
    )


def refused_here(
    *words: str, given: str = "", **variables: str
) -> subprocess.CompletedProcess[str]:
    """A command that should soon give up, in this process: arguments, variables, standard input,
    streams and status are those of a process, an unexpected exception is the test's own."""
    out, errors = io.StringIO(), io.StringIO()
    status: str | int | None = 0
    with (
        patch.dict(os.environ, _environment(variables), clear=True),
        patch.object(sys, "argv", ["trainbridge", *words]),
        patch.object(sys, "stdin", io.TextIOWrapper(io.BytesIO(given.encode()))),
        redirect_stdout(out),
        redirect_stderr(errors),
        chdir(ROOT),
    ):
        try:
            main()
        except SystemExit as end:
            status = end.code
    code = status if isinstance(status, int) else int(status is not None)
    return subprocess.CompletedProcess(words, code, out.getvalue(), errors.getvalue())


def _environment(variables: dict[str, str]) -> dict[str, str]:
    """This process's variables but for settings, and some more."""
    own = {name: value for name, value in os.environ.items() if "TRAINBRIDGE" not in name}
    return {**own, "COLUMNS": "200", **variables}
