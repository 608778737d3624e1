"""What a batch's process does, by a name that costs nothing: passing it on loads no solver."""

from __future__ import annotations

from server.jobs.orders import Commands, Order, Send

__all__ = ["compute_order"]


def compute_order(order: Order, send: Send, commands: Commands) -> None:
    """Computes a batch, in its own process."""
    from server.jobs.worker import run_order

    run_order(order, send, commands)
