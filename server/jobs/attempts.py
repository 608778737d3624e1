"""One attempt at a batch, as the coordinator sees it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from server.jobs.orders import Compute, Order, OrderLimits, RunTask
from server.jobs.states import ENDED, Event
from server.settings import Settings
from server.store import BatchRecord, RunRecord

__all__ = ["Attempt", "RunOutcome", "order_for"]


@dataclass(frozen=True, kw_only=True)
class RunOutcome:
    """How a run ended.

    Attributes:
        event: What happened.
        error: Why, for people; empty for none.
        verdicts: Of a run that is done.
    """

    event: Event
    error: str = ""
    verdicts: Sequence[Mapping[str, Any]] | None = None


@dataclass(kw_only=True)
class Attempt:
    """A batch that computes.

    Attributes:
        batch: The batch as this attempt began.
        order: What its engine was asked.
        outcomes: Of runs that have ended and are not written yet.
        settled: Runs whose end is written.
        checkpoint_step: Of the newest checkpoint that this attempt told of, -1 for none.
        process: Number of its process, 0 before it is told.
        stages: The stage that each run told of last.
        logged: What its log says already, by run: an engine tells it again when it is reattached.
        ending: Whether the engine was asked to end it.
        ended: How it ended, None while it computes.
    """

    batch: BatchRecord
    order: Order
    outcomes: dict[str, RunOutcome] = field(default_factory=dict[str, RunOutcome])
    settled: set[str] = field(default_factory=set[str])
    checkpoint_step: int = -1
    process: int = 0
    stages: dict[str, str] = field(default_factory=dict[str, str])
    logged: set[tuple[str | None, str]] = field(default_factory=set[tuple[str | None, str]])
    ending: bool = False
    ended: RunOutcome | None = None

    @property
    def key(self) -> str:
        """Names the attempt."""
        return self.order.key

    @property
    def open_runs(self) -> list[RunRecord]:
        """Runs of the batch that have not ended."""
        done = self.settled | self.outcomes.keys()
        return [run for run in self.batch.runs if run.id not in done and run.state not in ENDED]


def order_for(
    batch: BatchRecord, settings: Settings, compute: Compute, gathered: Sequence[RunRecord] = ()
) -> Order:
    """The order of a batch's present attempt.

    Args:
        batch: The batch.
        settings: Limits, intervals, where the store is.
        compute: What the process does.
        gathered: The runs of the whole job, for a gather.
    """
    limits = settings.limits
    runs = gathered if batch.purpose == "gather" else batch.runs
    return Order(
        batch=batch.id,
        attempt=batch.attempt,
        job=batch.job,
        purpose=batch.purpose,
        kind=batch.kind,
        study=batch.study,
        runs=tuple(
            RunTask(id=run.id, index=run.index, state=run.state)
            for run in runs
            if batch.purpose == "gather" or run.state not in ENDED
        ),
        store=settings.store_url,
        model=batch.model or "",
        limits=OrderLimits(
            seconds=limits.batch_seconds,
            memory_bytes=limits.batch_bytes,
            memory_fraction=limits.memory_fraction,
            grace_seconds=settings.grace_seconds,
            poll_seconds=settings.poll_seconds,
            progress_seconds=settings.progress_seconds,
            checkpoint_seconds=settings.checkpoint_seconds,
        ),
        compute=compute,
    )
