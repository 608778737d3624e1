"""Reads a Dockerfile into its stages and instructions: as much of the language as ours uses.

What it does not know it refuses, so that nothing in the file goes unseen.
"""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

KNOWN = frozenset(
    {"FROM", "ENV", "WORKDIR", "COPY", "RUN", "VOLUME", "USER", "EXPOSE"}
    | {"STOPSIGNAL", "HEALTHCHECK", "ENTRYPOINT", "CMD"}
)


class DockerfileError(Exception):
    """A line that is no Dockerfile, or beyond what this reads."""


@dataclass(frozen=True, kw_only=True)
class Instruction:
    """One instruction.

    Attributes:
        line: Where it begins.
        name: In capitals.
        flags: ``--from`` and the like.
        rest: What follows them, lines joined.
    """

    line: int
    name: str
    flags: dict[str, str]
    rest: str

    @property
    def words(self) -> list[str]:
        """What follows, as a JSON list or as words."""
        if self.rest.startswith("["):
            return self.exec_form
        return shlex.split(self.rest)

    @property
    def exec_form(self) -> list[str]:
        """The command of a JSON list: run as it is, so that signals reach it.

        Raises:
            DockerfileError: It is a line for a shell.
        """
        try:
            found = json.loads(self.rest)
        except json.JSONDecodeError:
            found = None
        if not isinstance(found, list) or not all(isinstance(word, str) for word in found):
            raise DockerfileError(f"line {self.line}: {self.name} wants a list in JSON")
        return found


@dataclass(frozen=True, kw_only=True)
class Stage:
    """What stands between one FROM and the next."""

    image: str
    name: str
    instructions: tuple[Instruction, ...]

    def all(self, name: str) -> list[Instruction]:
        """Every instruction of a name, in order."""
        return [item for item in self.instructions if item.name == name]

    def last(self, name: str) -> Instruction:
        """The one that counts, where a later one replaces those before.

        Raises:
            DockerfileError: There is none.
        """
        found = self.all(name)
        if not found:
            raise DockerfileError(f"the stage from {self.image} has no {name}")
        return found[-1]

    @property
    def environment(self) -> dict[str, str]:
        """Every ENV, as NAME=VALUE."""
        return dict(word.split("=", 1) for item in self.all("ENV") for word in item.words)


def read_dockerfile(path: Path) -> list[Stage]:
    """The stages of a file, in order.

    Raises:
        DockerfileError: It holds what this does not know.
    """
    stages: list[Stage] = []
    pending: list[Instruction] = []
    for item in reversed(list(_instructions(path.read_text(encoding="utf-8")))):
        if item.name != "FROM":
            pending.insert(0, item)
            continue
        image, *named = item.words
        if named and (len(named) != 2 or named[0].upper() != "AS"):
            raise DockerfileError(f"line {item.line}: FROM wants IMAGE [AS NAME]")
        name = named[1] if named else ""
        stages.insert(0, Stage(image=image, name=name, instructions=tuple(pending)))
        pending = []
    if pending or not stages:
        raise DockerfileError("a Dockerfile begins with FROM")
    return stages


def _instructions(text: str) -> Iterator[Instruction]:
    for line, whole in _joined(text):
        found = re.fullmatch(r"([A-Za-z]+)\s+(.+)", whole, re.S)
        name = found[1].upper() if found else ""
        if found is None or name not in KNOWN:
            raise DockerfileError(f"line {line}: {whole[:60]!r} is no instruction known here")
        flags: dict[str, str] = {}
        rest = found[2].strip()
        while flag := re.match(r"--([a-z-]+)=(\S+)\s+", rest):
            flags[flag[1]] = flag[2]
            rest = rest[flag.end() :]
        yield Instruction(line=line, name=name, flags=flags, rest=rest)


def _joined(text: str) -> Iterator[tuple[int, str]]:
    """Lines with those that continue them, comments and empty lines left out."""
    parts: list[str] = []
    begin = 0
    for number, line in enumerate(text.splitlines(), 1):
        stripped = line.strip()
        if not stripped or stripped.startswith("#"):
            continue
        begin = begin if parts else number
        parts.append(stripped.removesuffix("\\").strip())
        if not stripped.endswith("\\"):
            yield begin, " ".join(parts)
            parts = []
    if parts:
        raise DockerfileError(f"line {begin}: the last line goes on, but there is no more")
