"""What an engine is asked to do, and what it tells: plain values that travel between machines."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

__all__ = ["Commands", "Compute", "Order", "OrderLimits", "Report", "RunTask", "Send"]

Purpose = Literal["runs", "prepare", "gather"]

Send = Callable[[tuple[Any, ...]], None]
"""Takes a message of a batch's process: ``("progress" | "finished" | "checkpoint" | "log" |
"cancelled", run, data)``, ``run`` being empty for what concerns the whole batch."""


class Commands:
    """What the supervisor has asked of a batch's process; looked at between steps.

    Attributes:
        stop: Whether to store a checkpoint and end (SIGTERM).
        stepping: Whether somebody looks at ``stop`` soon; otherwise SIGTERM interrupts at once.
        cancelled: Runs that shall leave the batch.
    """

    def __init__(self) -> None:
        self.stop = False
        self.stepping = False
        self.cancelled: set[str] = set()


@dataclass(frozen=True, kw_only=True)
class OrderLimits:
    """What a batch may take, and how often it tells.

    Attributes:
        seconds: Wall-clock time. [s]
        memory_bytes: Resident memory; 0 for ``memory_fraction`` of what is free when it starts. [B]
        memory_fraction: Share of the free memory.
        grace_seconds: Time between asking a process to end and killing it. [s]
        poll_seconds: How often memory and wall-clock time are looked at. [s]
        progress_seconds: Least time between two progress reports of a run. [s]
        checkpoint_seconds: Time between two checkpoints. [s]
    """

    seconds: float
    memory_bytes: int
    memory_fraction: float
    grace_seconds: float
    poll_seconds: float
    progress_seconds: float
    checkpoint_seconds: float


@dataclass(frozen=True, kw_only=True)
class RunTask:
    """One run of a batch.

    Attributes:
        id: The run.
        index: Its place in the study's sweep.
        state: As the database has it when the order is given: it decides what a gather judges.
    """

    id: str
    index: int
    state: str = "running"


Compute = Callable[["Order", Send, Commands], None]
"""Computes a batch in its own process."""


@dataclass(frozen=True, kw_only=True)
class Order:
    """One attempt at a batch, as an engine dispatches it.

    Attributes:
        batch: The batch.
        attempt: Which attempt, from 1.
        job: Its job.
        purpose: Compute runs, prepare the model that they share, or gather what they gave.
        kind: ``crossing`` or ``modes``.
        study: The study as JSON.
        runs: The runs to compute; for a gather, those of the whole job.
        store: URL of the store.
        model: Key of the prepared model, empty for none.
        limits: What it may take.
        compute: What the batch's process does; a function of a module, so that it can be named.
    """

    batch: str
    attempt: int
    job: str
    purpose: Purpose
    kind: str
    study: Mapping[str, Any]
    runs: tuple[RunTask, ...]
    store: str
    model: str
    limits: OrderLimits
    compute: Compute

    @property
    def key(self) -> str:
        """Names this attempt, wherever it computes."""
        return f"{self.batch}-{self.attempt}"


@dataclass(frozen=True, kw_only=True)
class Report:
    """What an engine tells of an attempt, in order.

    Attributes:
        key: The attempt.
        kind: ``started``, ``progress``, ``checkpoint``, ``log``, ``finished`` (a run), ``failed``
            (a run), ``cancelled`` (a run), and at the end, always once, ``ended``.
        run: The run, empty for the batch.
        data: Of ``progress`` the report; of ``checkpoint`` {"step"}; of ``log`` {"text"}; of
            ``finished`` {"verdicts"}; of ``failed`` {"error"}; of ``ended`` {"event", "error"}: one
            of ``server.jobs.states.Event`` and a text for people.
    """

    key: str
    kind: str
    run: str = ""
    data: Mapping[str, Any] = field(default_factory=dict[str, Any])
