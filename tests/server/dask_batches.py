"""Batches that a worker of Dask computes in the tests; the store is a plain folder."""

from __future__ import annotations

import time
from pathlib import Path

from server.jobs.orders import Commands, Order, Send


def finish(order: Order, send: Send, commands: Commands) -> None:
    """Finishes every run at once."""
    for run in order.runs:
        send(("progress", run.id, {"step": 1, "steps": 1}))
        send(("finished", run.id, {"verdicts": [run.index]}))


def finish_first_then_wait(order: Order, send: Send, commands: Commands) -> None:
    """Finishes its first run, the others when a file named ``go`` appears in the store."""
    first, *others = order.runs
    send(("finished", first.id, {"verdicts": []}))
    while not (Path(order.store) / "go").exists():
        time.sleep(0.01)
    for run in others:
        send(("finished", run.id, {"verdicts": []}))


def wait_for_cancel(order: Order, send: Send, commands: Commands) -> None:
    """Drops the runs that are cancelled, and finishes when one is left."""
    left = [run.id for run in order.runs]
    while len(left) > 1:
        for run in [run for run in left if run in commands.cancelled]:
            left.remove(run)
            send(("cancelled", run, {}))
        time.sleep(0.01)
    for run in left:
        send(("finished", run, {"verdicts": []}))


def resume(order: Order, send: Send, commands: Commands) -> None:
    """Leaves a checkpoint and hangs; another attempt finds it and finishes."""
    checkpoint = Path(order.store) / order.batch
    if checkpoint.exists():
        finish(order, send, commands)
        return
    checkpoint.write_text("step 7")
    send(("checkpoint", "", {"step": 7}))
    time.sleep(600)


def gather(order: Order, send: Send, commands: Commands) -> None:
    """Writes down what it gathered."""
    text = " ".join(run.id for run in order.runs)
    (Path(order.store) / "summary").write_text(text)


class Unreadable:
    """What no worker can unpickle."""

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        return int, ("not a number",)
