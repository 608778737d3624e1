"""Reads a Compose file as Compose does, as far as ours goes: YAML, and ``${VARIABLE...}``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from dockerfile import Stage

# $$, $NAME, ${NAME}, and with what stands for a missing one: :- - :? ?
_VARIABLE = re.compile(r"\$(?:(\$)|(\w+)|\{(\w+)(?:(:?[-?])([^}]*))?\})")


class MissingVariableError(Exception):
    """A variable that the file demands is not set, or empty."""


@dataclass(frozen=True, kw_only=True)
class Service:
    """One service.

    Attributes:
        name: Its name, which is also its address in the networks.
        given: What the file says of it.
        ours: Whether it runs the image that the Dockerfile makes.
        image: The last stage of that Dockerfile.
    """

    name: str
    given: Mapping[str, Any]
    ours: bool
    image: Stage

    @property
    def command(self) -> list[str]:
        """What runs in its container; of our image only."""
        entrypoint = self.given.get("entrypoint") or self.image.last("ENTRYPOINT").exec_form
        return [*entrypoint, *self.given["command"]]

    @property
    def health_command(self) -> list[str]:
        """What tells whether it works; empty where nothing does."""
        check = self.given.get("healthcheck", {})
        if check.get("disable"):
            return []
        how, *command = check["test"]
        if how != "CMD":
            raise ValueError(f"{self.name}: the health check runs through a shell ({how})")
        return command

    @property
    def environment(self) -> dict[str, str]:
        """Variables of its processes: the image's, then its own."""
        own = {name: str(value) for name, value in self.given.get("environment", {}).items()}
        return {**(self.image.environment if self.ours else {}), **own}


def read_compose(path: Path, variables: Mapping[str, str], image: Stage) -> dict[str, Any]:
    """The file with variables put in, its services as ``Service``.

    Raises:
        MissingVariableError: One is missing that must be set.
    """
    document: dict[str, Any] = _filled(yaml.safe_load(path.read_text("utf-8")), variables)
    document["services"] = {
        name: Service(name=name, given=given, ours="build" in given, image=image)
        for name, given in document["services"].items()
    }
    return document


def _filled(value: Any, variables: Mapping[str, str]) -> Any:
    if isinstance(value, dict):
        return {key: _filled(item, variables) for key, item in value.items()}
    if isinstance(value, list):
        return [_filled(item, variables) for item in value]
    if not isinstance(value, str):
        return value

    def replacement(found: re.Match[str]) -> str:
        escaped, plain, braced, how, text = found.groups()
        if escaped:
            return "$"
        name = plain or braced
        given = variables.get(name)
        missing = not given if (how or "").startswith(":") else given is None
        if not missing:
            return given or ""
        if how and how.endswith("?"):
            raise MissingVariableError(f"{name}: {text}")
        return text or "" if how else ""

    return _VARIABLE.sub(replacement, value)
