"""What the forkserver loads once, so that its children find it loaded.

Nothing else imports this module: it also makes the forkserver leave without the long farewell of
its libraries, so that none of our processes outlives the server by more than a moment.
"""

from __future__ import annotations

import atexit
import os
import signal
from contextlib import suppress
from importlib import import_module

from server.jobs.environment import FORKSERVER_OF

_LOOK_SECONDS = 0.1
"""How often the forkserver looks for its server while it loads. [s]"""
_server = int(os.environ.get(FORKSERVER_OF, os.getppid()))


def _end_without_server(*_: object) -> None:
    """Loading takes a second or more: a server that dies meanwhile, or has died before, is not
    outlived."""
    if os.getppid() != _server:
        os._exit(0)


_end_without_server()
signal.signal(signal.SIGALRM, _end_without_server)
signal.siginterrupt(signal.SIGALRM, False)
signal.setitimer(signal.ITIMER_REAL, _LOOK_SECONDS, _LOOK_SECONDS)
for name in (
    "numpy",
    "scipy.sparse.linalg",
    "scipy.optimize",
    "scipy.signal",
    "zarr",
    "pydantic",
    "server.jobs.worker",
):
    import_module(name)
with suppress(ImportError):
    # MKL, where it is installed: every child would take a fifth of a second to find and load it.
    import_module("solver.factorisation.pardiso")
signal.setitimer(signal.ITIMER_REAL, 0.0)
signal.signal(signal.SIGALRM, signal.SIG_DFL)

atexit.register(os._exit, 0)
# Who stops a whole group of processes means the server: it lets the children store checkpoints, and
# they tell this process how they end.
signal.signal(signal.SIGTERM, signal.SIG_IGN)
