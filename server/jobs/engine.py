"""Where batches compute, behind one small interface: this machine, or a cluster."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Protocol

from server.jobs.orders import Order, Report

__all__ = ["Engine", "EngineError"]


class EngineError(Exception):
    """The engine cannot be used; the text says what to do."""


class Engine(Protocol):
    """Runs orders, each in a process of its own that is supervised where it computes.

    The coordinator's thread calls every method but ``wake``. No call blocks for longer than its
    time-out; an engine that has lost its scheduler raises ``EngineError`` from any of them, and the
    coordinator starts it anew and reattaches.
    """

    def start(self) -> None:
        """Connects or starts workers; may take seconds.

        Raises:
            EngineError: The engine's address or its settings cannot be used.
        """
        ...

    def free_slots(self) -> int:
        """Orders that would begin to compute at once."""
        ...

    def run(self, order: Order) -> None:
        """Begins an order and returns at once; ``reports`` tells the rest."""
        ...

    def cancel(self, key: str, runs: Collection[str] = ()) -> None:
        """Takes runs out of an attempt, or ends the whole attempt where none is named.

        The attempt still reports ``ended``. An unknown key is fine: it has ended already.
        """
        ...

    def reattach(self, orders: Sequence[Order]) -> set[str]:
        """Of attempts begun by an earlier coordinator, the keys that still compute (or have ended
        and not been reported); their reports come again. The others are lost."""
        ...

    def reports(self, seconds: float) -> list[Report]:
        """What was told since the last call, in order; waits at most so long for the first. [s]"""
        ...

    def wake(self) -> None:
        """Ends the waiting of ``reports``; from any thread."""
        ...

    def stop(self) -> None:
        """Lets go of everything: what is ours stores checkpoints and ends within the grace time;
        what computes elsewhere goes on, to be reattached."""
        ...
