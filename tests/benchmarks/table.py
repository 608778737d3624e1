"""The table that benchmarks print: what was measured beside what was promised."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

__all__ = ["Row", "print_table"]


@dataclass(frozen=True, kw_only=True)
class Row:
    """One line of the table.

    Attributes:
        name: What was measured.
        unit: Of value and bound.
        value: Measured.
        bound: What was promised; None for what is only told.
    """

    name: str
    unit: str
    value: float
    bound: float | None = None

    @property
    def text(self) -> str:
        """As a line of Markdown."""
        if self.bound is None:
            return f"| {self.name} | {self.value:.3g} {self.unit} | | |"
        kept = "yes" if self.value <= self.bound else "NO"
        return (
            f"| {self.name} | {self.value:.3g} {self.unit} | {self.bound:g} {self.unit} | {kept} |"
        )


def print_table(
    document: str | None,
    rows: Callable[..., Iterable[Row]],
    arguments: Sequence[str] | None,
    *,
    quick: str,
) -> None:
    """Prints rows as they are measured, then the load of the machine.

    Args:
        document: Of the benchmark; its first line is the command's help.
        rows: Measures; takes ``quick``.
        arguments: Of the command line.
        quick: What ``--quick`` leaves out.
    """
    parser = argparse.ArgumentParser(description=(document or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help=quick)
    chosen = parser.parse_args(arguments)
    with _load():
        print("| | measured | promised at most | kept |\n|---|--:|--:|---|", flush=True)
        for row in rows(quick=chosen.quick):
            print(row.text, flush=True)


@contextmanager
def _load() -> Generator[None]:
    """Says how busy the machine was: numbers of a busy one mean little."""
    before = os.getloadavg()[0]
    yield
    after = os.getloadavg()[0]
    print(
        f"\nLoad of the machine ({os.cpu_count()} cores): {before:.1f} before, {after:.1f} after."
    )
