"""What the forkserver loads once, so that its children find it loaded.

Nothing else imports this module: it also makes the forkserver leave without the long farewell of
its libraries, so that none of our processes outlives the server by more than a moment.
"""

from __future__ import annotations

import atexit
import os
from importlib import import_module

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

atexit.register(os._exit, 0)
