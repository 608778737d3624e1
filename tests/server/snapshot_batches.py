"""Batches that end as their study's name asks for: every state of a job within seconds."""

from __future__ import annotations

import time
from collections.abc import Callable

from server.jobs.computing import compute_order
from server.jobs.orders import Commands, Order, Send
from tests.server import odd_batches

__all__ = ["compute_as_named"]


def _pause(order: Order, send: Send, commands: Commands) -> None:
    """Comes to its first quarter and stays there."""
    for run in order.runs:
        report = {**odd_batches.progress(900, 3600), "simulated_time": 0.225}
        send(("progress", run.id, {**report, "stage": "stepping"}))
    time.sleep(600)


_ODD: dict[str, Callable[[Order, Send, Commands], None]] = {
    "failed": odd_batches.fail,
    "timed_out": odd_batches.hang,
    "out_of_memory": odd_batches.eat,
    "cancelled": _pause,
    "running": _pause,
}


def compute_as_named(order: Order, send: Send, commands: Commands) -> None:
    """Computes the batch, unless its study's name ends in a state that is asked for."""
    odd = _ODD.get(str(order.study["name"]).rpartition(" ")[2], compute_order)
    odd(order, send, commands)
