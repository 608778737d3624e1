"""How many sudden deaths a campaign has: all of them, or the few that CI has time for."""

from __future__ import annotations

import os
from typing import TypeVar

__all__ = ["campaigns"]

MOST = int(os.environ.get("TRAINBRIDGE_KILLS", "100"))

Size = TypeVar("Size", int, tuple[int, int])


def campaigns(short: Size, long: Size) -> list[Size]:
    """Parameters of a campaign: a short one, and the long one where it is wanted.

    Args:
        short: A number of kills, or a tuple that ends with one.
        long: Likewise.
    """
    kills = long[-1] if isinstance(long, tuple) else long
    return [short, long] if kills <= MOST else [short]
