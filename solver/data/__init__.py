"""Package data: trains, sections and rules of standards, each file with source and confidence."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from solver.errors import InputError

__all__ = ["available", "load"]


def available() -> tuple[str, ...]:
    """The names that ``load`` knows, in alphabetical order."""
    names = (entry.name for entry in files(__name__).iterdir())
    return tuple(sorted(name.removesuffix(".json") for name in names if name.endswith(".json")))


def load(name: str) -> dict[str, Any]:
    """Reads one data file of the package.

    Args:
        name: File name without its suffix, for example ``khst``.

    Returns:
        The parsed file, in SI units, with the keys ``title``, ``source`` and ``confidence`` or the
        same for each entry.

    Raises:
        InputError: There is no such file.
    """
    if name not in available():
        raise InputError(
            "data", name, "there is no such data file", f"Use one of {', '.join(available())}."
        )
    text = files(__name__).joinpath(f"{name}.json").read_text("utf-8")
    content: dict[str, Any] = json.loads(text)
    return content
