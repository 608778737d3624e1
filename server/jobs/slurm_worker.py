"""What a job of Slurm runs: ``python -m server.jobs.slurm_worker``, with Dask's arguments.

Slurm ends a job with SIGTERM first, which Dask's own command does not always outlive; ours lets
batches store checkpoints.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from server.jobs.dask_nodes import run_worker
from server.settings import Settings


def main() -> None:
    """Runs a worker until its job ends; arguments of Dask that do not matter here are ignored."""
    parser = argparse.ArgumentParser(description="Worker of trainbridge in a job of Slurm.")
    parser.add_argument("scheduler")
    parser.add_argument("--name", required=True)
    parser.add_argument("--nthreads", type=int, default=1)
    parser.add_argument("--death-timeout", type=float, default=60.0)
    for file in ("ca-file", "cert", "key"):
        parser.add_argument(f"--tls-{file}", type=Path, required=True)
    given, _ = parser.parse_known_args()
    settings = Settings(
        engine_seconds=given.death_timeout,
        tls_ca_file=given.tls_ca_file,
        tls_cert_file=given.tls_cert,
        tls_key_file=given.tls_key,
    )
    run_worker(settings, scheduler=given.scheduler, slots=given.nthreads, name=given.name)


if __name__ == "__main__":
    main()
