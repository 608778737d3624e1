"""How many sudden deaths a campaign has: all of them, or the few that CI has time for."""

from __future__ import annotations

import os
from typing import Any

import pytest

__all__ = ["campaigns"]

MOST = int(os.environ.get("TRAINBRIDGE_KILLS", "100"))


def campaigns(*sizes: Any) -> list[Any]:
    """Parameters of a campaign: the first for everyone, the others slow and as far as is wanted.

    Args:
        sizes: A number of kills, or a tuple that ends with one.
    """
    short, *long = sizes
    kills = [size[-1] if isinstance(size, tuple) else size for size in long]
    wanted = [size for size, count in zip(long, kills, strict=True) if count <= MOST]
    slow = [
        pytest.param(*(size if isinstance(size, tuple) else (size,)), marks=pytest.mark.slow)
        for size in wanted
    ]
    return [short, *slow]
