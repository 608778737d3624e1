"""Batches whose duration is known, for the measurements of the queue."""

from __future__ import annotations

import time
from typing import Any

from server.jobs.orders import Commands, Order, Send
from server.store import RunWriter, attempt_place, open_place
from tests.server.odd_batches import finish, hang, hang_stubbornly
from tests.server.store_case import make_plan, samples_of

__all__ = ["BATCHES", "CHANNEL_SAMPLES", "PROGRESS_REPORTS"]

CHANNEL_SAMPLES = 20_000
PROGRESS_REPORTS = 100
_PROGRESS_SECONDS = 0.03
"""Between two reports. [s]"""


def burn(order: Order, send: Send, commands: Commands) -> None:
    """One second of a core for each run, then done; a gather takes no time.

    The verdict tells how long that took: more than a second where others have the cores.
    """
    del commands
    if order.purpose != "runs":
        return
    for run in order.runs:
        begin, limit = time.perf_counter(), time.process_time() + 1.0
        while time.process_time() < limit:
            sum(range(10_000))
        took = time.perf_counter() - begin
        verdict = {"rule": "burn", "limit": 1.0, "value": took, "exceeds": took > 1.0}
        send(("finished", run.id, {"verdicts": [verdict]}))


def tell_the_time(order: Order, send: Send, commands: Commands) -> None:
    """Progress that carries the time at which it was sent."""
    del commands
    [run] = order.runs
    for step in range(1, PROGRESS_REPORTS + 1):
        time.sleep(_PROGRESS_SECONDS)
        report: dict[str, Any] = {
            "step": step,
            "steps": PROGRESS_REPORTS,
            "fraction": step / PROGRESS_REPORTS,
            "stage": "computing",
            "rate": None,
            "remaining": None,
            "simulated_time": 0.0,
            "sent": time.time(),
        }
        send(("progress", run.id, report))
    send(("finished", run.id, {"verdicts": []}))


def store(order: Order, send: Send, commands: Commands) -> None:
    """A finished run of 20,000 samples in 37 channels, and 20 shapes."""
    del commands
    [run] = order.runs
    plan = make_plan(CHANNEL_SAMPLES - 1, n_point=0, frame_stride=1000)
    writer = RunWriter(attempt_place(open_place(order.store), run.id, order.attempt), plan)
    for sample in samples_of(plan):
        writer.append(sample)
    writer.finish({"verdicts": [], "timings": {}, "versions": {}, "peaks": {}})
    send(("finished", run.id, {"verdicts": []}))


BATCHES = {
    "burn": burn,
    "finish": finish,
    "hang": hang,
    "hang_stubbornly": hang_stubbornly,
    "store": store,
    "tell_the_time": tell_the_time,
}
"""By name, for the command line of ``queue_server``."""
