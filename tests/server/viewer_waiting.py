"""Patience with what a viewing session sends: the machine may have others to serve first."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from functools import partial
from types import SimpleNamespace

import httpx

from tests.server.viewer_client import SceneClient

__all__ = ["PATIENCE", "http", "quiet", "until"]

PATIENCE = 60.0
"""Longest wait for an answer, or for something to be received. [s]"""
_GAP = 0.02
"""Between two messages at least; pictures that play come every 0.07 s. [s]"""

http = SimpleNamespace(
    **{
        method: partial(getattr(httpx, method), timeout=PATIENCE)
        for method in ("get", "post", "put", "delete")
    }
)
"""As httpx itself, which gives up after 5 s."""


def until(client: SceneClient, arrived: Callable[[], bool], what: str = "what is shown") -> None:
    """Receives until something has arrived.

    Args:
        client: Receives.
        arrived: Whether it has; a node that is not there yet has not.
        what: Is waited for, in words.
    """
    limit = time.monotonic() + PATIENCE
    while True:
        client.settle(quiet=_GAP)
        with contextlib.suppress(KeyError):
            if arrived():
                return
        assert time.monotonic() < limit, f"{what}: not received within {PATIENCE:.0f} s"


def quiet(client: SceneClient, seconds: float) -> None:
    """Receives until nothing comes for so long: what moves by itself would never let it end.

    Args:
        client: Receives.
        seconds: Of silence. [s]
    """
    last = begun = time.monotonic()
    while (now := time.monotonic()) - last < seconds:
        if client.settle(quiet=_GAP):
            last = now
        assert now - begun < PATIENCE, f"never {seconds} s without a message"
