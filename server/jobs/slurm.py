"""Workers that are jobs of Slurm: as many as the settings say, topped up when they are lost."""

from __future__ import annotations

import getpass
import logging
import subprocess
import time
from typing import Any

import dask.config
from dask_jobqueue.slurm import SLURMCluster

from server.jobs.dask_clusters import OwnCluster, configure
from server.jobs.dask_security import settings_security, write_certificate
from server.jobs.engine import EngineError
from server.jobs.environment import SINGLE_THREAD
from server.settings import Settings

__all__ = ["open_slurm_cluster"]

_log = logging.getLogger("trainbridge.jobs")

_TOP_UP_SECONDS = 5.0
"""How often Slurm is asked for our jobs. [s]"""
_PROLOGUE = [f"export {name}={value}" for name, value in SINGLE_THREAD.items()]


def open_slurm_cluster(settings: Settings) -> OwnCluster:
    """A scheduler in this process and workers in Slurm's jobs: a slot each core.

    The scheduler's port is open to the nodes, so that it always has TLS: with the certificates of
    the settings, else with one made for this cluster, whose files lie in the data folder (which
    the nodes must see). Where the nodes reach this machine by a certain network only, name it in
    Dask's own configuration (``jobqueue.slurm.interface``).

    Raises:
        EngineError: Slurm is not here, or refuses the job.
    """
    configure()
    folder = settings.data.resolve() / "slurm"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    _jobs_of_mine(settings.engine_seconds)
    security = settings_security(settings) if settings.tls_ca_file else write_certificate(folder)
    cluster: Any = SLURMCluster(
        queue=settings.slurm_partition or None,
        account=settings.slurm_account or None,
        walltime=settings.slurm_walltime,
        cores=settings.slurm_cores,
        memory=settings.slurm_memory,
        processes=1,
        # A lost worker is a lost job, which is topped up; nothing else watches over it.
        nanny=False,
        protocol="tls://",
        security=security,
        log_directory=str(folder),
        job_script_prologue=_PROLOGUE,
        worker_command="server.jobs.slurm_worker",
        scheduler_options={"dashboard": False, "dashboard_address": "127.0.0.1:0", **_options()},
        silence_logs="ERROR",
    )
    cluster.scale(jobs=settings.slurm_jobs)
    keeper = _JobKeeper(cluster, settings)
    return OwnCluster(cluster, security, seconds=settings.engine_seconds, keep_up=keeper.top_up)


class _JobKeeper:
    """Replaces jobs that Slurm does not have any more."""

    def __init__(self, cluster: Any, settings: Settings) -> None:
        self._cluster = cluster
        self._jobs = settings.slurm_jobs
        self._seconds = settings.engine_seconds
        self._asked_at = time.monotonic()

    def top_up(self) -> None:
        """Asks Slurm, if that is due, and submits what is missing."""
        now = time.monotonic()
        if now - self._asked_at < _TOP_UP_SECONDS:
            return
        self._asked_at = now
        submitted = {
            job.job_id: name for name, job in list(self._cluster.workers.items()) if job.job_id
        }
        try:
            known = _jobs_of_mine(self._seconds)
        except EngineError as error:
            _log.warning("%s", error)
            return
        lost = [name for job, name in submitted.items() if job not in known]
        if lost:
            _log.warning("%d jobs of Slurm have ended: as many are submitted again", len(lost))
        self._cluster.loop.add_callback(self._replace, lost)

    def _replace(self, lost: list[Any]) -> None:
        """In the cluster's own thread: it submits again what it lacks."""
        for name in lost:
            self._cluster.workers.pop(name, None)
        self._cluster.scale(jobs=self._jobs)


def _options() -> dict[str, Any]:
    """What Dask's own configuration says of the scheduler."""
    return dask.config.get("jobqueue.slurm.scheduler-options", {}) or {}


def _jobs_of_mine(seconds: float) -> set[str]:
    """Numbers of the jobs that Slurm has of this user.

    Raises:
        EngineError: Slurm does not answer.
    """
    command = ["squeue", "--noheader", "--format=%i", f"--user={getpass.getuser()}"]
    try:
        answer = subprocess.run(
            command, capture_output=True, text=True, timeout=seconds, check=True
        )
    except FileNotFoundError:
        raise EngineError(
            "Slurm's command squeue is not here. Start this on a machine that submits jobs of "
            "Slurm, or set another engine."
        ) from None
    except (OSError, subprocess.SubprocessError) as error:
        raise EngineError(f"Slurm does not answer ({error}). Ask its administrator.") from error
    return set(answer.stdout.split())
