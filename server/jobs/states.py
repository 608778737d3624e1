"""The states of a run and of a job, and how they change: pure functions, no input or output.

queued --start--> running --finish--> done
   |                 |-----fail-----> failed
   |                 |---time out---> timed_out
   |                 |-run out of memory-> out_of_memory
   |                 |----cancel----> cancelled
   |                 |-----die------> queued      (its process died: tried again, up to a limit)
   |                 |-----stop-----> queued      (its server was asked to stop)
   |                 `-----lose-----> queued      (its server, scheduler or worker went away)
   |------fail-----> failed                       (what it waits for failed)
   `-----cancel----> cancelled

A run that has ended leaves its state only by a retry that somebody asked for.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

__all__ = [
    "BACK_TO_QUEUE",
    "ENDED",
    "Event",
    "State",
    "TransitionError",
    "deaths_after",
    "job_state",
    "next_state",
]


class State(StrEnum):
    """State of a run, a batch or a job."""

    QUEUED = "queued"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"
    TIMED_OUT = "timed_out"
    OUT_OF_MEMORY = "out_of_memory"


class Event(StrEnum):
    """What happens to a run."""

    START = "start"
    FINISH = "finish"
    FAIL = "fail"
    CANCEL = "cancel"
    TIME_OUT = "time out"
    EXHAUST_MEMORY = "run out of memory"
    DIE = "die"
    STOP = "stop"
    LOSE = "lose"


class TransitionError(Exception):
    """An event that the state does not allow."""


ENDED = frozenset({State.DONE, State.FAILED, State.CANCELLED, State.TIMED_OUT, State.OUT_OF_MEMORY})
"""States that a run never leaves by itself."""

BACK_TO_QUEUE = frozenset({Event.DIE, Event.STOP, Event.LOSE})
"""Events after which a run is tried again: nothing that it did itself ended it."""

_TRANSITIONS = {
    (State.QUEUED, Event.START): State.RUNNING,
    (State.QUEUED, Event.FAIL): State.FAILED,
    (State.QUEUED, Event.CANCEL): State.CANCELLED,
    (State.RUNNING, Event.FINISH): State.DONE,
    (State.RUNNING, Event.FAIL): State.FAILED,
    (State.RUNNING, Event.CANCEL): State.CANCELLED,
    (State.RUNNING, Event.TIME_OUT): State.TIMED_OUT,
    (State.RUNNING, Event.EXHAUST_MEMORY): State.OUT_OF_MEMORY,
    (State.RUNNING, Event.DIE): State.QUEUED,
    (State.RUNNING, Event.STOP): State.QUEUED,
    (State.RUNNING, Event.LOSE): State.QUEUED,
}

_WORST_FIRST = (State.FAILED, State.OUT_OF_MEMORY, State.TIMED_OUT, State.CANCELLED)


def next_state(state: State, event: Event) -> State:
    """The state after an event.

    Raises:
        TransitionError: The state does not allow the event.
    """
    try:
        return _TRANSITIONS[state, event]
    except KeyError:
        raise TransitionError(f"a {state} run cannot {event}") from None


def deaths_after(deaths: int, event: Event, checkpointed: bool) -> int:
    """How often in a row a batch's own process has died with no new checkpoint between.

    The loss of a server, scheduler or worker says nothing about the batch and never counts.

    Args:
        deaths: Before this attempt.
        event: How the attempt ended.
        checkpointed: Whether the attempt stored a checkpoint.
    """
    before = 0 if checkpointed else deaths
    return before + 1 if event is Event.DIE else before


def job_state(runs: Iterable[State]) -> State:
    """The state of a job from those of its runs: done only if every run is."""
    states = set(runs)
    if states <= {State.QUEUED}:
        return State.QUEUED
    if not states <= ENDED:
        return State.RUNNING
    return next((state for state in _WORST_FIRST if state in states), State.DONE)
