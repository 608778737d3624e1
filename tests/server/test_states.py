"""The state machine, without processes."""

from __future__ import annotations

import itertools

import pytest

from server.jobs.states import ENDED, Event, State, TransitionError, job_state, next_state


def test_a_run_goes_from_the_queue_to_one_end() -> None:
    assert next_state(State.QUEUED, Event.START) is State.RUNNING
    ends = {
        Event.FINISH: State.DONE,
        Event.FAIL: State.FAILED,
        Event.CANCEL: State.CANCELLED,
        Event.TIME_OUT: State.TIMED_OUT,
        Event.EXHAUST_MEMORY: State.OUT_OF_MEMORY,
    }
    for event, state in ends.items():
        assert next_state(State.RUNNING, event) is state
    assert set(ends.values()) == ENDED
    assert next_state(State.RUNNING, Event.LOSE) is State.QUEUED
    assert next_state(State.QUEUED, Event.CANCEL) is State.CANCELLED


@pytest.mark.parametrize(("state", "event"), list(itertools.product(sorted(ENDED), Event)))
def test_an_end_is_an_end(state: State, event: Event) -> None:
    with pytest.raises(TransitionError, match=str(state)):
        next_state(state, event)


@pytest.mark.parametrize("event", [Event.FINISH, Event.FAIL, Event.LOSE, Event.TIME_OUT])
def test_what_waits_cannot_end(event: Event) -> None:
    with pytest.raises(TransitionError, match="queued"):
        next_state(State.QUEUED, event)


def test_a_job_is_done_only_if_every_run_is() -> None:
    for states in itertools.product(State, repeat=3):
        job = job_state(states)
        assert (job is State.DONE) == all(state is State.DONE for state in states)
        assert (job in ENDED) == all(state in ENDED for state in states)
        assert (job is State.QUEUED) == all(state is State.QUEUED for state in states)
        if job is State.CANCELLED:
            # A failure is never hidden behind a cancellation.
            assert not set(states) & {State.FAILED, State.OUT_OF_MEMORY, State.TIMED_OUT}
