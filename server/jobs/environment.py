"""The environment of a process that computes: one thread, and the same bits every time."""

from __future__ import annotations

import os

__all__ = ["SINGLE_THREAD", "single_threaded"]

SINGLE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMEXPR_NUM_THREADS": "1",
    "MKL_CBWR": "COMPATIBLE",
}
"""Libraries read these when they are loaded."""


def single_threaded() -> None:
    """Sets them for this process: call it before numpy is imported."""
    os.environ.update(SINGLE_THREAD)
