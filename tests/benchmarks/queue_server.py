"""``trainbridge serve`` whose batches do one of ``BATCHES``, or whose memory rests earlier.

Run as ``python -m tests.benchmarks.queue_server BATCH IDLE_SECONDS``; settings as variables.
"""

from __future__ import annotations

import os
import sys
from functools import partial


def main(batch: str, idle_seconds: float) -> None:
    """Serves until SIGTERM."""
    # Imported here: each child imports this file, as it does the server's own main file.
    from server import app
    from server.jobs import local_engine
    from server.settings import Settings
    from tests.benchmarks.queue_batches import BATCHES

    local_engine._IDLE_SECONDS = idle_seconds  # pyright: ignore[reportPrivateUsage]
    if batch != "run":
        app.create_app = partial(app.create_app, compute=BATCHES[batch])
    app.serve_until_stopped(Settings.from_environment(os.environ))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
