"""The Slurm engine, with commands in Slurm's place that start jobs as processes of this machine."""

from __future__ import annotations

import os
import signal
import stat
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import dask.config
import pytest

from server.jobs import slurm
from server.jobs.engine import EngineError
from tests.server import dask_batches
from tests.server.dask_case import (
    ROOT,
    ended,
    engine_of,
    events,
    gone,
    hear,
    order_for,
    settings_for,
    told,
    until,
)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.usefixtures("swept", "swept_module"),
    pytest.mark.filterwarnings("ignore:unclosed <socket:ResourceWarning"),
]

_COMMANDS = {
    # A job is a session of its own, so that its whole group can be ended; its number is its pid.
    "sbatch": """
import os, shutil, subprocess, sys
script = shutil.copy(sys.argv[-1], FOLDER / f"script-{os.getpid()}")
job = subprocess.Popen(["bash", script], start_new_session=True,
    stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=open(FOLDER / "errors", "a"))
(FOLDER / f"job-{job.pid}").touch()
print(f"Submitted batch job {job.pid}")
""",
    "scancel": """
import os, signal, sys
os.killpg(int(sys.argv[1]), signal.SIGTERM)
""",
    "squeue": """
import psutil
for file in FOLDER.glob("job-*"):
    number = int(file.name[4:])
    try:
        if psutil.Process(number).status() != "zombie":
            print(number)
    except psutil.NoSuchProcess:
        pass
""",
}


@pytest.fixture
def jobs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a file for each job that was submitted."""
    folder = tmp_path / "slurm"
    folder.mkdir()
    for name, code in _COMMANDS.items():
        file = folder / name
        head = f"#!{sys.executable}\nimport pathlib\nFOLDER = pathlib.Path({str(folder)!r})\n"
        file.write_text(head + code)
        file.chmod(file.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setattr(slurm, "_TOP_UP_SECONDS", 0.2)
    yield folder
    for number in _numbers(folder):
        with suppress(ProcessLookupError):
            os.killpg(number, signal.SIGKILL)


def _numbers(folder: Path) -> list[int]:
    return [int(file.name[4:]) for file in folder.glob("job-*")]


def test_jobs_come_and_are_topped_up(jobs: Path, tmp_path: Path) -> None:
    settings = settings_for(
        tmp_path, "slurm", slurm_jobs=2, slurm_partition="bridges", slurm_memory="2GB"
    )
    engine = engine_of(settings)
    with dask.config.set({"jobqueue.slurm.scheduler-options": {"host": "127.0.0.1"}}):
        engine.start()
    try:
        until(lambda: engine.free_slots() == 2)
        script = next(jobs.glob("script-*")).read_text()
        for line in ("-p bridges", "--mem=2G", "-t 24:00:00", "--tls-key"):
            assert line in script
        first, second = _numbers(jobs)
        for number in range(2):
            engine.run(order_for(tmp_path, dask_batches.resume, f"slurm{number}"))
        hear(engine, told("checkpoint", 2))
        os.killpg(first, signal.SIGKILL)
        lost = events(hear(engine, ended(1)))
        assert list(lost.values()) == ["lose"]
        until(lambda: engine.free_slots() == 1)
        [third] = set(_numbers(jobs)) - {first, second}
        assert not gone(third)
        [key] = lost
        engine.run(order_for(tmp_path, dask_batches.resume, key[:-2], attempt=2))
        assert events(hear(engine, ended(1))) == {f"{key[:-2]}-2": "finish"}
    finally:
        engine.stop()
    assert list(events(engine.reports(0.0)).values()) == ["stop"]
    assert sorted(_numbers(jobs)) == sorted([first, second, third])
    until(lambda: gone(second) and gone(third))
    assert stat.S_IMODE((tmp_path / "data" / "slurm" / "key.pem").stat().st_mode) == 0o600


def test_without_slurm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(EngineError, match="squeue is not here"):
        engine_of(settings_for(tmp_path, "slurm")).start()
