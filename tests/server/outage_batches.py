"""Real runs to which something happens, by the name of their study."""

from __future__ import annotations

import ctypes
import os
import resource
import struct
import time
from pathlib import Path

from server.jobs.orders import Commands, Order, Send
from server.jobs.worker import run_order
from solver.errors import ConvergenceError
from tests.server.odd_batches import progress

__all__ = ["AWAY", "compute"]

AWAY = "away"
"""A file of this name in the store stands for the outage."""

_LARGEST_FILE = 20_000
"""What a full disk still takes in one file. [B]"""
_TOO_MUCH = 700 * 1024 * 1024
_CAPABILITY_VERSION = 0x20080522


def compute(order: Order, send: Send, commands: Commands) -> None:
    """As ``run_order``, after what the study's name asks for."""
    if order.purpose == "runs":
        _TROUBLES.get(order.study["name"], _none)(order, send)
    run_order(order, send, commands)


def _none(order: Order, send: Send) -> None:
    del order, send


def _fill_disk(order: Order, send: Send) -> None:
    """No file grows beyond a limit: the system refuses as it does on a full disk."""
    del send
    if (Path(order.store) / AWAY).exists():
        resource.setrlimit(resource.RLIMIT_FSIZE, (_LARGEST_FILE, _LARGEST_FILE))


def _obey_modes(order: Order, send: Send) -> None:
    """Root may write wherever it likes: without its capabilities it is a user like others."""
    del send
    if (Path(order.store) / AWAY).exists():
        header = struct.pack("=Ii", _CAPABILITY_VERSION, 0)
        if ctypes.CDLL(None, use_errno=True).capset(header, bytes(24)) != 0:
            raise OSError(ctypes.get_errno(), "capset")


def _eat(order: Order, send: Send) -> None:
    """Takes memory until it is ended."""
    send(("progress", order.runs[0].id, progress(1, 100)))
    held = bytearray(os.urandom(1) * _TOO_MUCH)
    time.sleep(600)
    del held


def _diverge(order: Order, send: Send) -> None:
    """The middle run of a sweep gets some way."""
    [run] = order.runs
    if run.index == 1:
        send(("progress", run.id, progress(1, 100)))
        raise ConvergenceError(1.25, "wheel 07 right", 3.0e-2)


_TROUBLES = {
    "diverging": _diverge,
    "hungry": _eat,
    "disk full": _fill_disk,
    "store read-only": _obey_modes,
}
