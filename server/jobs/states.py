"""The states of a run and of a job, and how they change: pure functions, no input or output.

queued --start--> running --finish--> done
   |                 |-----fail-----> failed
   |                 |---time out---> timed_out
   |                 |-run out of memory-> out_of_memory
   |                 |----cancel----> cancelled
   |                 `-----lose-----> queued      (its server or its process went away)
   `-----cancel----> cancelled
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

__all__ = ["ENDED", "Event", "State", "TransitionError", "job_state", "next_state"]


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
    LOSE = "lose"


class TransitionError(Exception):
    """An event that the state does not allow."""


ENDED = frozenset({State.DONE, State.FAILED, State.CANCELLED, State.TIMED_OUT, State.OUT_OF_MEMORY})
"""States that a run never leaves."""

_TRANSITIONS = {
    (State.QUEUED, Event.START): State.RUNNING,
    (State.QUEUED, Event.CANCEL): State.CANCELLED,
    (State.RUNNING, Event.FINISH): State.DONE,
    (State.RUNNING, Event.FAIL): State.FAILED,
    (State.RUNNING, Event.CANCEL): State.CANCELLED,
    (State.RUNNING, Event.TIME_OUT): State.TIMED_OUT,
    (State.RUNNING, Event.EXHAUST_MEMORY): State.OUT_OF_MEMORY,
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


def job_state(runs: Iterable[State]) -> State:
    """The state of a job from those of its runs: done only if every run is."""
    states = set(runs)
    if states <= {State.QUEUED}:
        return State.QUEUED
    if not states <= ENDED:
        return State.RUNNING
    return next((state for state in _WORST_FIRST if state in states), State.DONE)
