"""The environment of a process that computes: one thread, and the same bits every time."""

from __future__ import annotations

import os

__all__ = ["FORKSERVER_OF", "SINGLE_THREAD", "single_threaded"]

FORKSERVER_OF = "TRAINBRIDGE_FORKSERVER_OF"
"""Variable that tells a forkserver the number of its server's process: by the time that it could
ask the system for its parent, that one may be gone already."""
SINGLE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMEXPR_NUM_THREADS": "1",
}
"""Libraries read these when they are loaded.

One thread and arrays of one alignment (``solver.factorisation.pardiso``) repeat a run bit for bit
on one machine. ``MKL_CBWR=COMPATIBLE`` would do so across processors as well, at 1.6 to 2 times
the cost of each large solve: set it yourself where results must agree between machines.
"""


def single_threaded() -> None:
    """Sets them for this process: call it before numpy is imported."""
    os.environ.update(SINGLE_THREAD)
