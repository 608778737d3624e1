"""The state machine, without processes."""

from __future__ import annotations

import itertools

import pytest

from server.jobs.decisions import decide_job
from server.jobs.states import (
    BACK_TO_QUEUE,
    ENDED,
    Event,
    State,
    TransitionError,
    deaths_after,
    job_state,
    next_state,
)
from server.store import JobView


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
    assert all(next_state(State.RUNNING, event) is State.QUEUED for event in BACK_TO_QUEUE)
    assert next_state(State.QUEUED, Event.FAIL) is State.FAILED
    assert next_state(State.QUEUED, Event.CANCEL) is State.CANCELLED


@pytest.mark.parametrize(("state", "event"), list(itertools.product(sorted(ENDED), Event)))
def test_an_end_is_an_end(state: State, event: Event) -> None:
    with pytest.raises(TransitionError, match=str(state)):
        next_state(state, event)


@pytest.mark.parametrize("event", [Event.FINISH, Event.DIE, Event.LOSE, Event.TIME_OUT])
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


def test_only_its_own_deaths_with_no_checkpoint_between_count() -> None:
    count = 0
    for event, checkpointed, expected in [
        (Event.DIE, False, 1),
        (Event.LOSE, False, 1),  # The server died: not the run's doing.
        (Event.STOP, False, 1),
        (Event.DIE, False, 2),
        (Event.LOSE, True, 0),  # It got further: what was before is forgotten.
        (Event.DIE, True, 1),
        (Event.DIE, False, 2),
        (Event.DIE, False, 3),
    ]:
        count = deaths_after(count, event, checkpointed)
        assert count == expected


def view(*runs: State, **parts: object) -> JobView:
    values = {"prepare": None, "gather": None, "wants_gather": True, "cancel_requested": False}
    return JobView(runs=tuple(map(str, runs)), **{**values, **parts})  # type: ignore[arg-type]


def test_the_end_of_the_last_run_calls_for_one_gather() -> None:
    done, failed, running = State.DONE, State.FAILED, State.RUNNING
    assert not decide_job(view(done, running)).insert_gather
    assert not decide_job(view(done, done, wants_gather=False)).insert_gather
    last = decide_job(view(done, failed))
    assert (last.state, last.insert_gather) == ("running", True)
    for state in ("queued", "running"):
        waits = decide_job(view(done, failed, gather=state))
        assert (waits.state, waits.insert_gather) == ("running", False)
    assert decide_job(view(done, done, gather="done")).state == "done"
    assert decide_job(view(done, failed, gather="done")).state == "failed"
    assert decide_job(view(done, done, gather="failed")).state == "failed"


def test_nothing_is_gathered_of_a_job_without_results_or_that_was_cancelled() -> None:
    for one in (view(State.FAILED, State.FAILED), view(State.CANCELLED, State.DONE)):
        asked = decide_job(JobView(**{**vars(one), "cancel_requested": True}))
        assert asked.state in ("failed", "cancelled")
        assert not asked.insert_gather
    assert not decide_job(view(State.FAILED, State.FAILED)).insert_gather


def test_a_job_whose_model_is_being_prepared_is_running() -> None:
    queued = (State.QUEUED, State.QUEUED)
    assert decide_job(view(*queued, prepare="queued")).state == "queued"
    assert decide_job(view(*queued, prepare="running")).state == "running"
    assert decide_job(view(*queued)).state == "queued"
