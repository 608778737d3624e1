"""Batches that do in a process what a study rarely does: hang, die, fail, eat memory."""

from __future__ import annotations

import os
import signal
import time
from typing import Any

from server.jobs.orders import Commands, Order, Send
from solver.errors import ConvergenceError


def hang(order: Order, send: Send, commands: Commands) -> None:
    """Reports once, then never again."""
    for run in order.runs:
        send(("progress", run.id, progress(1, 100)))
    time.sleep(600)


def hang_stubbornly(order: Order, send: Send, commands: Commands) -> None:
    """Does not listen to SIGTERM either."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    hang(order, send, commands)


def die(order: Order, send: Send, commands: Commands) -> None:
    """Ends without a word, as after a fault in a library."""
    os.kill(os.getpid(), signal.SIGSEGV)


def fail(order: Order, send: Send, commands: Commands) -> None:
    """Fails as the solver does."""
    raise ConvergenceError(1.25, "wheel 07 right", 3.0e-2)


def break_down(order: Order, send: Send, commands: Commands) -> None:
    """Fails as no solver should."""
    raise ZeroDivisionError("division by zero")


def eat(order: Order, send: Send, commands: Commands) -> None:
    """Takes 300 MB and waits."""
    held = [bytearray(os.urandom(1) * (300 * 1024 * 1024))]
    time.sleep(600)
    del held


def finish(order: Order, send: Send, commands: Commands) -> None:
    """Finishes at once, with a verdict that depends on the run."""
    if order.purpose != "runs":
        return
    for run in order.runs:
        speed = 100.0 + run.index
        verdict = {"rule": "slab", "limit": 3.5, "value": speed / 50.0, "exceeds": speed > 175}
        send(("progress", run.id, progress(100, 100)))
        send(("finished", run.id, {"verdicts": [verdict]}))


def progress(step: int, steps: int) -> dict[str, Any]:
    """A report."""
    return {
        "step": step,
        "steps": steps,
        "fraction": step / steps,
        "stage": "computing",
        "rate": None,
        "remaining": None,
        "simulated_time": 0.0,
    }
