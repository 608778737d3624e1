"""What becomes of a job when its parts change: a pure function."""

from __future__ import annotations

from server.jobs.states import ENDED, State, job_state
from server.store import JobDecision, JobView

__all__ = ["decide_job"]


def decide_job(view: JobView) -> JobDecision:
    """The state of a job, and whether its gather is due.

    A job that asks for a gather gets one when its last run has ended, if any run is done and
    nobody cancelled the job; until the gather has ended the job is running.
    """
    state = job_state(State(item) for item in view.runs)
    if state is State.QUEUED and view.prepare not in (None, State.QUEUED):
        return JobDecision(state=State.RUNNING, insert_gather=False)
    gathers = view.wants_gather and State.DONE in view.runs and not view.cancel_requested
    if state not in ENDED or not gathers:
        return JobDecision(state=state, insert_gather=False)
    if view.gather in (None, State.QUEUED, State.RUNNING):
        return JobDecision(state=State.RUNNING, insert_gather=view.gather is None)
    failed = view.gather == State.FAILED
    return JobDecision(state=State.FAILED if failed else state, insert_gather=False)
