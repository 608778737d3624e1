"""``trainbridge serve`` whose batches do one of ``BATCHES``, or whose memory rests earlier.

Run as ``python -m tests.benchmarks.queue_server BATCH IDLE_SECONDS``; settings as variables.
"""

from __future__ import annotations

import os
import sys
from functools import partial

_DISK = 10**15
"""Free disk that admission sees. [B]"""


def main(batch: str, idle_seconds: float) -> None:
    """Serves until SIGTERM."""
    # Imported here: each child imports this file, as it does the server's own main file.
    from server import app
    from server.jobs import local_engine, submission
    from server.settings import Settings
    from tests.benchmarks.queue_batches import BATCHES

    local_engine._IDLE_SECONDS = idle_seconds  # pyright: ignore[reportPrivateUsage]
    if batch != "run":
        # These batches store next to nothing: what their studies would take is nobody's disk, and
        # 500 histories of a whole train are 57 GB, more than many a machine has left.
        submission._free = lambda _: _DISK  # pyright: ignore[reportPrivateUsage]
        app.create_app = partial(app.create_app, compute=BATCHES[batch])
    app.serve_until_stopped(Settings.from_environment(os.environ))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
